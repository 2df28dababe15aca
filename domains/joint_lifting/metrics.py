"""The domain's own measures of a finished run."""

from collections.abc import Iterator, Mapping

import numpy as np

from hybrid_tamp.authoring import BlockInstance, Recording, State, Task, Token, rotate, split_mode

from .lifting import GRASPED
from .places import UP, corner_heights, offset_in_box

CONTROLLED: Mapping[str, tuple[float, float]] = {
    "height [m]": (0.1, 0.3),
    "tilt [deg]": (0.0, 3.0),
    "slip [m]": (0.0, 0.01),
}
"""Bounds of a controlled lift."""


def metrics(task: Task, recording: Recording) -> Mapping[tuple[str, str], float]:
    """Return the measures of every lift, each by the name of its instance and its own.

    From when the hands of LIFTING bear the box until their HOLDING ends: how high the lowest corner of the box is in
    the end and how far it is tilted at most; how far a hand slips along its face at most; and with which force a hand
    presses on the box at most as it is lifted, where the backend measures it.
    """
    found: dict[tuple[str, str], float] = {}
    for instance in recording.instances:
        if split_mode(instance.block)[0] == "LIFTING":
            found |= {(instance.name, name): value for name, value in _lift(task, recording, instance)}
    return found


def _lift(task: Task, recording: Recording, lift: BlockInstance) -> Iterator[tuple[str, float]]:
    thing = task.token_by_name[lift.slots["object"]]
    hands = [task.token_by_name[name] for slot, name in lift.slots.items() if slot != "object"]
    hold = next((i for i in recording.instances if i.slots.get("object") == thing.name and i.start == lift.end), lift)
    rows = slice(*(round(time / recording.timestep) for time in (lift.start + GRASPED, hold.end)))
    run = State(recording.layout, recording.states[rows])
    if not len(run.values):
        return
    upright = rotate(run[thing, "orientation"], UP)[..., 2]
    yield "height [m]", float(corner_heights(run, thing)[-1].min())
    yield "tilt [deg]", float(np.degrees(np.arccos(np.clip(upright, -1.0, 1.0))).max())
    yield "slip [m]", max(_slip(run, hand, thing) for hand in hands)
    names = {hand.name for hand in hands}
    forces = [
        contact.force
        for contact in recording.contacts
        if thing.name in contact.tokens and names & set(contact.tokens) and lift.name in contact.instances
    ]
    if forces:
        yield "contact [N]", max(forces)


def _slip(run: State, hand: Token, thing: Token) -> float:
    """Return how far a hand goes along its face, across and up, since it bears the box [m]."""
    along = offset_in_box(run, hand, thing)[..., 1:]
    return float(np.linalg.norm(along - along[0], axis=-1).max())

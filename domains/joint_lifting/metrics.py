"""Metrics of joint lifting in a finished run."""

from collections.abc import Iterator, Mapping

import numpy as np

from hybrid_tamp.authoring import BlockInstance, Recording, State, Task, Token
from hybrid_tamp.skills import in_body, measure_instances, run_of, z_axis

from .lifting import GRASPED
from .places import height

CONTROLLED: Mapping[str, tuple[float, float]] = {
    "height [m]": (0.1, 0.3),
    "tilt [deg]": (0.0, 3.0),
    "slip [m]": (0.0, 0.01),
}
"""Maps each metric to its bounds in a controlled lift."""


def metrics(task: Task, recording: Recording) -> Mapping[tuple[str, str], float]:
    """Return the metrics of every lift. The result maps each pair of (instance, metric) to a value.

    The metrics are the final height of the lowest corner of the box, the largest tilt of the box, and the largest slip
    of a hand along its face. The measurement starts when the hands bear the box and lasts until HOLDING ends. If the
    backend measures contact forces, a further metric is the largest force of a hand on the box during LIFTING.
    """
    return measure_instances(task, recording, {"LIFTING": _lift})


def _lift(task: Task, recording: Recording, lift: BlockInstance) -> Iterator[tuple[str, float]]:
    thing = task.token_by_name[lift.slots["object"]]
    hands = [task.token_by_name[name] for slot, name in lift.slots.items() if slot != "object"]
    hold = next((i for i in recording.instances if i.slots.get("object") == thing.name and i.start == lift.end), lift)
    run = run_of(recording, lift.start + GRASPED, hold.end)
    if not len(run.values):
        return
    upright = z_axis(run, thing)[..., 2]
    yield "height [m]", float(height(run, thing)[-1])
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
    """Return the largest displacement [m] of a hand along its face since the hand began to bear the box."""
    along = in_body(run, thing, run[hand, "position"])[..., 1:]
    return float(np.linalg.norm(along - along[0], axis=-1).max())

"""Checks of declared final poses.

`Block.ends` declares that a final pose depends only on the initial pose and on listed targets. `Block.vertical`
declares that a token only moves up and down.
"""

from collections.abc import Sequence

import numpy as np

from hybrid_tamp.model.block import Block
from hybrid_tamp.model.expectation import declared_end
from hybrid_tamp.model.predicate import Binding
from hybrid_tamp.model.state import State
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.testing.disagreement import Disagreements
from hybrid_tamp.testing.rollouts import Rollouts

_DISTANCE = 0.05
"""Largest allowed distance between the declared and the final position [m], unless a listed region is larger."""
_ANGLE = float(np.radians(5.0))
"""Largest angle between the declared and the final orientation [rad]."""
_UPRIGHT_PATH = 5e-3
"""Largest horizontal displacement of a token that only moves up and down [m]."""
_SAME = 1e-6
"""Largest difference between equal poses [m or rad]."""
_MOVED = 0.1
"""Largest displacement along each axis for tokens on which a final pose must not depend [m]."""


def check_ends(rolled: Rollouts, possible: Sequence[Binding], found: Disagreements, rng: np.random.Generator) -> None:
    """Compare the declared final poses with rollouts of the block, and with the block's outcomes for other tokens.

    Args:
        rolled: rollouts of the block.
        possible: other bindings of the block for the same initial state.
        found: collection to which disagreements are added.
        rng: random generator.
    """
    block = rolled.block
    for slot in block.vertical:
        _check_vertical(rolled, slot, found)
    for slot, targets in block.ends.items():
        declared = f"the final pose of {slot} depends only on {' and '.join(('its initial pose', *targets))}"
        if block.outcome is None:
            found.add("ends", block, rolled.binding, declared, "the block has no outcome", slot)
            continue
        _check_outcome(rolled, slot, targets, declared, found)
        _check_others(rolled, slot, targets, declared, possible, found)
        _check_surroundings(rolled, slot, targets, declared, found, rng)


def _check_vertical(rolled: Rollouts, slot: str, found: Disagreements) -> None:
    token = rolled.binding[slot]
    assert isinstance(token, Token)
    for row in rolled.rows:
        end = rolled.end(row)
        aside = float(np.linalg.norm((end[token, "position"] - rolled.start[token, "position"])[:2]))
        _, angle = _differences(token, rolled.start, end)
        if aside > _UPRIGHT_PATH or angle > _ANGLE:
            declared, measured = f"{slot} only moves up and down", f"{slot} ends {_off(aside, angle)} off the vertical"
            found.add("ends", rolled.block, rolled.binding, declared, measured, slot)


def _check_outcome(rolled: Rollouts, slot: str, targets: Sequence[str], declared: str, found: Disagreements) -> None:
    tolerance = max([_DISTANCE, *(_radius(rolled.binding, target) for target in targets)])
    outcome = _outcome(rolled.block, rolled.binding, rolled.start)
    for row in rolled.rows:
        distance, angle = _differences(rolled.binding[slot], outcome, rolled.end(row))
        if distance > tolerance or angle > _ANGLE:
            found.add(
                "ends",
                rolled.block,
                rolled.binding,
                declared,
                f"the final pose in a rollout differs from the outcome by {_off(distance, angle)}",
                slot,
            )


def _check_others(
    rolled: Rollouts,
    slot: str,
    targets: Sequence[str],
    declared: str,
    possible: Sequence[Binding],
    found: Disagreements,
) -> None:
    """Compare the outcome with the outcomes of bindings that differ in roles that are not listed."""
    outcome = _outcome(rolled.block, rolled.binding, rolled.start)
    for other in possible:
        if all(other[role] == rolled.binding[role] for role in (slot, *targets)):
            distance, angle = _differences(other[slot], outcome, _outcome(rolled.block, other, rolled.start))
            if distance > _SAME or angle > _SAME:
                roles = ", ".join(sorted(role for role in other if other[role] != rolled.binding[role]))
                measured = f"for another choice of {roles}, the outcome differs by {_off(distance, angle)}"
                found.add("ends", rolled.block, rolled.binding, declared, measured, slot)


def _check_surroundings(
    rolled: Rollouts, slot: str, targets: Sequence[str], declared: str, found: Disagreements, rng: np.random.Generator
) -> None:
    """Compare the outcomes for two states. In the second state, all tokens that are not listed are displaced."""
    listed = {rolled.binding[role] for role in (slot, *targets)}
    others = [v for v in rolled.binding.values() if isinstance(v, Token) and v not in listed]
    moved = rolled.start.replace(
        {(t.name, "position"): rolled.start[t, "position"] + rng.uniform(-_MOVED, _MOVED, 3) for t in others}
    )
    outcome = _outcome(rolled.block, rolled.binding, rolled.start)
    distance, angle = _differences(rolled.binding[slot], outcome, _outcome(rolled.block, rolled.binding, moved))
    if distance > _SAME or angle > _SAME:
        names = ", ".join(sorted(token.name for token in others))
        measured = f"after a displacement of {names}, the outcome differs by {_off(distance, angle)}"
        found.add("ends", rolled.block, rolled.binding, declared, measured, slot)


def _outcome(block: Block, binding: Binding, state: State) -> State:
    after = declared_end(block, binding, state)
    assert after is not None
    return after


def _radius(binding: Binding, target: str) -> float:
    value = binding[target]
    return float(value.properties.get("radius", 0.0)) if isinstance(value, Token) and value.place else 0.0


def _differences(token: object, one: State, other: State) -> tuple[float, float]:
    """Return the distance [m] and the angle [rad] between the poses of a token in two states."""
    assert isinstance(token, Token)
    distance = float(np.linalg.norm(one[token, "position"] - other[token, "position"]))
    return distance, _angle(one[token, "orientation"], other[token, "orientation"])


def _angle(one: FloatArray, other: FloatArray) -> float:
    """Return the angle [rad] between two orientations. The arcsine is accurate for small angles, unlike arccos."""
    nearer = other if float(one @ other) >= 0 else -other
    return float(4.0 * np.arcsin(min(1.0, float(np.linalg.norm(one - nearer)) / 2.0)))


def _off(distance: float, angle: float) -> str:
    return f"{distance:.3g} m and {np.degrees(angle):.3g} degrees"

"""Checks of declared ends: the final poses that follow from the initial pose of a token and from listed targets."""

from collections.abc import Sequence

import numpy as np

from hybrid_tamp.model.block import Block
from hybrid_tamp.model.predicate import Binding
from hybrid_tamp.model.state import State
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.testing.disagreement import Disagreements
from hybrid_tamp.testing.rollouts import Rollouts

_DISTANCE = 0.05
"""Largest distance between the declared and the final position [m], unless a target of the end is a larger region."""
_ANGLE = float(np.radians(5.0))
"""Largest angle between the declared and the final orientation [rad]."""
_SAME = 1e-6
"""Largest difference between equal poses [m or rad]."""
_MOVED = 0.1
"""Largest displacement of tokens on which an end must not depend, along each axis [m]."""


def check_ends(rolled: Rollouts, possible: Sequence[Binding], found: Disagreements, rng: np.random.Generator) -> None:
    """Compare the declared ends of a block with its rollouts, and with its outcomes for other tokens.

    Args:
        rolled: rollouts of the block.
        possible: other bindings of the block for the same initial state.
        found: collection to which disagreements are added.
        rng: random generator.
    """
    block = rolled.block
    for slot, targets in block.ends.items():
        declared = f"the end of {slot} follows from {', '.join(targets) or 'nothing else'}"
        if block.outcome is None:
            found.add("ends", block, rolled.binding, declared, "the block has no outcome")
            continue
        _check_outcome(rolled, slot, targets, declared, found)
        _check_others(rolled, slot, targets, declared, possible, found)
        _check_surroundings(rolled, slot, targets, declared, found, rng)


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
                f"a rollout ends {_off(distance, angle)} from the outcome",
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
                measured = f"with another {roles}, the outcome is {_off(distance, angle)} away"
                found.add("ends", rolled.block, rolled.binding, declared, measured)


def _check_surroundings(
    rolled: Rollouts, slot: str, targets: Sequence[str], declared: str, found: Disagreements, rng: np.random.Generator
) -> None:
    """Compare the outcome with the outcome for a state in which all tokens that are not listed have moved."""
    listed = {rolled.binding[role] for role in (slot, *targets)}
    others = [v for v in rolled.binding.values() if isinstance(v, Token) and v not in listed]
    moved = rolled.start.replace(
        {(t.name, "position"): rolled.start[t, "position"] + rng.uniform(-_MOVED, _MOVED, 3) for t in others}
    )
    outcome = _outcome(rolled.block, rolled.binding, rolled.start)
    distance, angle = _differences(rolled.binding[slot], outcome, _outcome(rolled.block, rolled.binding, moved))
    if distance > _SAME or angle > _SAME:
        names = ", ".join(sorted(token.name for token in others))
        measured = f"if {names} are displaced, the outcome is {_off(distance, angle)} away"
        found.add("ends", rolled.block, rolled.binding, declared, measured)


def _outcome(block: Block, binding: Binding, state: State) -> State:
    after = block.expected_end(binding, state)
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
    """Return the angle [rad] between two orientations. The sine is accurate for small angles, the cosine is not."""
    nearer = other if float(one @ other) >= 0 else -other
    return float(4.0 * np.arcsin(min(1.0, float(np.linalg.norm(one - nearer)) / 2.0)))


def _off(distance: float, angle: float) -> str:
    return f"{distance:.3g} m and {np.degrees(angle):.3g} degrees"

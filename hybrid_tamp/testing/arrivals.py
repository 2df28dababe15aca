"""Exit conditions that no rollout reaches, that hold before the movement, or from which a block moves away."""

from collections import defaultdict
from collections.abc import Iterator

import numpy as np

from hybrid_tamp.model.block import Block
from hybrid_tamp.model.control import Parameters
from hybrid_tamp.model.expectation import expect
from hybrid_tamp.model.forward_model import ForwardModel
from hybrid_tamp.model.predicate import Literal
from hybrid_tamp.model.state import State
from hybrid_tamp.testing.disagreement import Disagreements, first_role, with_unit
from hybrid_tamp.testing.rollouts import Rollouts

_WORSE = 0.1
"""A block moves away from a condition if its margin falls by more than this share of its scale and of its value."""
_LEAST = 3
"""Least number of rollouts with which a block is reported because its exit conditions always hold at the start."""
_STILL = 1e-3
"""Largest change of a property of a block that holds its tokens in place, in SI units."""
_LONGEST = 10.0
"""Longest time for which a block is rolled out beyond its exit conditions [s]."""

_Key = tuple[str, tuple[str, ...]]
"""Pair of (name of a block, values of its targets)."""


class Arrivals:
    """The rollouts of each block that failed, and the rollouts whose exit conditions held from the start."""

    def __init__(self, dt: float) -> None:
        self._dt = dt
        self._failed: dict[_Key, Rollouts] = {}
        self._succeeded: set[_Key] = set()
        self._idle: dict[str, Rollouts] = {}
        self._busy: set[str] = set()
        self._count: dict[str, int] = defaultdict(int)

    def note(self, key: _Key, rolled: Rollouts) -> None:
        """Note rollouts of a block towards certain targets."""
        name = rolled.block.name
        self._count[name] += 1
        if rolled.rows:
            self._succeeded.add(key)
        else:
            self._failed.setdefault(key, rolled)
        if all(margin >= 0 for _, margin in _margins(rolled, rolled.start)):
            self._idle.setdefault(name, rolled)
        else:
            self._busy.add(name)

    def ran(self, block: Block) -> bool:
        """Return whether a block was rolled out."""
        return self._count[block.name] > 0

    def report(self, found: Disagreements) -> None:
        """Report the failed exit conditions of each block whose rollouts towards certain targets never succeeded.

        A block that fails only from some states is not reported, because a feasibility fact can be an upper bound. Such
        a fact can also hold in some states from which the block fails.
        """
        for key, rolled in self._failed.items():
            if key not in self._succeeded:
                _report_failure(rolled, found)
        for name, rolled in self._idle.items():
            if name not in self._busy and rolled.block.measured_exits and self._count[name] >= _LEAST:
                self._report_idle(rolled, found)

    def _report_idle(self, rolled: Rollouts, found: Disagreements) -> None:
        """Report a block whose exit conditions always held at the start. Roll the block out beyond this time."""
        end, elapsed = self._beyond(rolled)
        count = self._count[rolled.block.name]
        for literal, margin in _margins(rolled, end):
            before = float(literal.margin(rolled.start, rolled.binding))
            if margin < 0:
                measured = (
                    f"the margin is {with_unit(before, literal.predicate)} at the start of all {count} rollouts, and "
                    f"{with_unit(margin, literal.predicate)} after {elapsed:.3g} s of movement"
                )
                _add("sign", rolled, literal, measured, found)
                return
        if any(each.predicate.maintained for each in rolled.block.exit):
            return  # The block may end what an earlier block maintained, e.g. the place of a hand at a box.
        if float(np.abs(end.values - rolled.start.values).max(initial=0.0)) < _STILL:
            return  # The block holds its tokens in place.
        literal, margin = next(_margins(rolled, rolled.start))
        measured = (
            f"the margin is {with_unit(margin, literal.predicate)} at the start, and all exit conditions hold at the "
            f"start of all {count} rollouts"
        )
        _add("idle", rolled, literal, measured, found)

    def _beyond(self, rolled: Rollouts) -> tuple[State, float]:
        """Return the state after the expected duration of a block, and this duration [s]."""
        block, binding, state = rolled.block, rolled.binding, rolled.start
        values = block.initial_values(binding, state)
        expected = expect(block, binding, state, values).seconds
        steps = int(np.ceil(min(max(expected, block.duration.minimum), block.duration.maximum, _LONGEST) / self._dt))
        model = ForwardModel(block, binding, state, Parameters(values))
        for step in range(steps):
            state = model.step(np.float64(step * self._dt), state, self._dt)[0]
        return state, steps * self._dt


def _margins(rolled: Rollouts, state: State) -> Iterator[tuple[Literal, float]]:
    for literal in rolled.block.measured_exits:
        yield literal, float(literal.margin(state, rolled.binding))


def _add(kind: str, rolled: Rollouts, literal: Literal, measured: str, found: Disagreements) -> None:
    role = first_role(rolled.block, literal.arguments)
    found.add(kind, rolled.block, rolled.binding, literal.text, measured, role)


def _report_failure(rolled: Rollouts, found: Disagreements) -> None:
    """Report the exit conditions that fail at the end of a rollout.

    If the block moves away from conditions that it had to establish, only these conditions are reported. If all failed
    conditions held at the start, the block has made them false.
    """
    missed: list[tuple[str, Literal, str]] = []
    before = dict(_margins(rolled, rolled.start))
    after = dict(_margins(rolled, rolled.end(0)))
    gained = any(before[each] < 0 <= after[each] for each in after)
    for literal, margin in after.items():
        if margin >= 0:
            continue
        start, predicate = before[literal], literal.predicate
        measured = f"the margin is {with_unit(margin, predicate)} at the end of the rollout"
        lost = start >= 0 and all(before[each] >= 0 for each in after if after[each] < 0)
        if (start < 0 or lost) and margin < start - _WORSE * max(predicate.scale, abs(start)):
            missed.append(("sign", literal, f"{measured}, and {with_unit(start, predicate)} at its start"))
        elif gained and rolled.varies(literal) <= 1e-9 * predicate.scale:
            missed.append(("effect", literal, f"{measured}, and no rollout changes the margin"))
        else:
            missed.append(("exit", literal, measured))
    away = [each for each in missed if each[0] == "sign"]
    for kind, literal, measured in away or missed:
        _add(kind, rolled, literal, measured, found)

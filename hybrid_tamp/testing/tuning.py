"""Checks of hyperparameters: their bounds, their initial values and their influence, and of expected durations."""

from collections import defaultdict

import numpy as np

from hybrid_tamp.model.authored import authored
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.control import Hyperparameter, Parameters
from hybrid_tamp.model.expectation import declared_duration
from hybrid_tamp.model.forward_model import ForwardModel
from hybrid_tamp.model.measure import Measure
from hybrid_tamp.model.predicate import Binding
from hybrid_tamp.model.state import State
from hybrid_tamp.model.view import View
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.testing.disagreement import Disagreements
from hybrid_tamp.testing.rollouts import Rollouts, roll_out_rows
from hybrid_tamp.testing.units import LARGEST

_ATTEMPTS = 3
"""Number of states from which the influence of a hyperparameter is tested."""
_ROUNDING = 1e-9

_EXPECTED = "the expected duration"

_Key = tuple[str, str]
"""Pair of (name of a block, name of a hyperparameter)."""


class Tuning:
    """The initial values and the influences of the hyperparameters in all rollouts."""

    def __init__(self, dt: float) -> None:
        self._dt = dt
        self._inside: set[_Key] = set()
        self._outside: dict[_Key, tuple[Block, Binding, str, str]] = {}
        self._attempts: dict[_Key, int] = defaultdict(int)
        self._influential: set[_Key] = set()
        self._without: dict[_Key, tuple[Block, Binding, str]] = {}

    def note(self, rolled: Rollouts, found: Disagreements) -> None:
        """Note the bounds, the initial values and the influences of the hyperparameters for the start of a rollout."""
        block, binding = rolled.block, rolled.binding
        view = View(binding, rolled.start.layout).of(rolled.start)
        for hyperparameter in block.hyperparameters:
            if self._note_bounds(block, binding, hyperparameter, view, found):
                self._note_influence(rolled, hyperparameter)
        initial = block.initial_values(binding, rolled.start)
        expected = declared_duration(block, binding, rolled.start, initial)
        if expected is None:
            return
        measured = (
            f"the expected duration is {expected:.4g} s, and the longest duration is {block.duration.maximum:g} s"
        )
        sound = 0.0 <= expected <= block.duration.maximum * (1.0 + _ROUNDING)
        self._note(block, binding, _EXPECTED, sound, measured)

    def report(self, found: Disagreements) -> None:
        """Report initial values that are always outside their bounds, and hyperparameters without influence."""
        for key, (block, binding, name, measured) in self._outside.items():
            if key not in self._inside:
                what, role = (name, "") if name == _EXPECTED else (f"the initial value of {name}", name)
                found.add("bounds", block, binding, f"{what} is within its bounds", measured, role)
        for key, (block, binding, measured) in self._without.items():
            if key not in self._influential:
                found.add("influence", block, binding, f"{key[1]} has an influence on the block", measured, key[1])

    def _note(self, block: Block, binding: Binding, name: str, sound: bool, measured: str) -> None:
        if sound:
            self._inside.add((block.name, name))
        else:
            self._outside.setdefault((block.name, name), (block, binding, name, measured))

    def _note_bounds(
        self, block: Block, binding: Binding, each: Hyperparameter, view: State, found: Disagreements
    ) -> bool:
        """Note whether the initial value is within the bounds. Return whether the bounds are in order."""
        with authored(f"{block.name}.{each.name}", binding):
            low, high = (each.lower, each.upper) if each.within is None else each.within(binding)
            guess = float(each.initial(binding, view))
        if low > high + _ROUNDING:
            declared = f"the lower bound of {each.name} does not exceed the upper bound"
            measured = f"the bounds are [{low:.4g}, {high:.4g}] {each.unit}"
            found.add("bounds", block, binding, declared, measured, each.name)
            return False
        bound, largest = max(abs(low), abs(high)), LARGEST.get(each.unit, np.inf)
        if np.isfinite(bound) and bound > largest:
            declared = f"the bounds of {each.name} are plausible for the unit {each.unit}"
            measured = (
                f"the bounds are [{low:g}, {high:g}] {each.unit}, and up to {largest:.4g} {each.unit} is plausible"
            )
            found.add("unit", block, binding, declared, measured, each.name)
        slack = _ROUNDING * max(1.0, abs(low), abs(high))
        inside = max(low, each.lower) - slack <= guess <= min(high, each.upper) + slack
        measured = (
            f"the initial value is {guess:.4g} {each.unit}, and the bounds are [{low:.4g}, {high:.4g}] {each.unit}"
        )
        self._note(block, binding, each.name, inside, measured)
        return True

    def _note_influence(self, rolled: Rollouts, each: Hyperparameter) -> None:
        """Roll the block out with both bounds of a hyperparameter, unless an influence is already known.

        If the exit conditions already hold, the block has nothing to do, so nothing can have an influence.
        """
        block, binding = rolled.block, rolled.binding
        if block.measured_exits and all(float(e.margin(rolled.start, binding)) >= 0 for e in block.measured_exits):
            return
        key = block.name, each.name
        low, high = each.bounds(binding)
        if key in self._influential or self._attempts[key] >= _ATTEMPTS or high - low <= _ROUNDING:
            return
        self._attempts[key] += 1
        values = block.initial_values(binding, rolled.start)
        chosen = {name: np.array([value, value], dtype=float) for name, value in values.items()}
        chosen[each.name] = np.array([low, high])
        if _differ(rolled, chosen, self._dt):
            self._influential.add(key)
            return
        measured = f"the rollouts with {low:.4g} and with {high:.4g} {each.unit} are identical"
        self._without.setdefault(key, (block, binding, measured))


def _differ(rolled: Rollouts, chosen: dict[str, FloatArray], dt: float) -> bool:
    """Return whether the commands, the states or the measures differ between two rows of hyperparameters."""
    block, binding, start = rolled.block, rolled.binding, rolled.start
    pair = roll_out_rows(block, binding, start, chosen, 2, dt)
    if not np.array_equal(pair.states.values[:, 0], pair.states.values[:, 1], equal_nan=True):
        return True
    both = start.repeated(2)
    model = ForwardModel(block, binding, both, Parameters(chosen))
    for elapsed in (0.0, 0.25, 1.0):
        after, commands, _ = model.step(np.float64(elapsed), both, dt)
        if any(not np.array_equal(each[0], each[1]) for each in commands.values()):
            return True
    return any(_measures_differ(rolled, measure, both, after, chosen) for measure in block.performance)


def _measures_differ(
    rolled: Rollouts, measure: Measure, before: State, after: State, chosen: dict[str, FloatArray]
) -> bool:
    if measure.end is None:
        return False
    one, other = measure.at_end(rolled.block.name, rolled.binding, before, after, chosen)
    return bool(one != other)

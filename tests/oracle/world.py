"""The continuous side of the search: states of tokens, margins of conditions, and the ends of movements."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import product

import numpy as np

from hybrid_tamp.model.bindings import enumerate_bindings
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.control import CONTROL_PERIOD, Parameters
from hybrid_tamp.model.expectation import Beginning, Expectations, expect
from hybrid_tamp.model.forward_model import BoolArray, ForwardModel
from hybrid_tamp.model.predicate import Literal, Predicate, Value, name_of
from hybrid_tamp.model.state import State, StateLayout
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.poses import rotate

Ids = Mapping[str, int]
"""Maps each token to the number of its state."""
Roles = tuple[tuple[str, str], ...]
"""Pairs of (role, name of the token or symbol)."""
Ends = tuple[tuple[str, int], ...]
"""Pairs of (token, number of its state) at the end of a movement."""

SAMPLES = 5
"""Number of hyperparameter vectors for each movement: the initial values and four drawn vectors."""
_SPREADS = (0.02, 0.1, 0.3, 1.0)
"""Widths of the four draws, as fractions of the initial value, or of half the range if the initial value is zero."""
_CHECKED_EVERY = 8
"""Number of control periods between two checks of the conditions of a movement."""
_AWAKE = 1.5
"""Minimum time after which a movement without its exit conditions may count as failed [s]."""
_STILL = 1e-6
"""Largest change between two checks at which all tokens count as still, in SI units."""
_CELL = 0.01
"""Distance at which two states are merged [m]."""
_TURN = np.radians(5.0)
"""Angle at which two states are merged [rad]."""
_ROUNDING = 1e-9
_TIPS = ("TIPPING:opposite", "TIPPING:adjacent")


@dataclass(frozen=True)
class Started:
    """A block with its binding, which begins in a reassignment."""

    block: Block
    roles: Roles

    @property
    def slots(self) -> tuple[tuple[str, str], ...]:
        """Pairs of (slot, token)."""
        own = {slot.name for slot in self.block.slots}
        return tuple((role, name) for role, name in self.roles if role in own)

    @property
    def text(self) -> str:
        """Block and binding as one line."""
        return f"{self.block.name}({', '.join(name for _, name in self.roles)})"


class World:
    """Numbered states of tokens. Margins and movements are computed only once for each number.

    Attributes:
        task: task whose tokens move.
        start: maps each token to the number of its initial state.
        rolled: number of movements that were simulated so far.
    """

    def __init__(self, task: Task) -> None:
        self.task = task
        self.rolled = 0
        self._rows: list[FloatArray] = []
        self._number: dict[tuple[str, bytes], int] = {}
        self._cells: list[tuple[int, ...]] = []
        self._margins: dict[tuple[object, ...], float] = {}
        self._bindings: dict[tuple[object, ...], list[Roles]] = {}
        self._ends: dict[tuple[object, ...], tuple[Ends, ...]] = {}
        self._simulated: dict[tuple[object, ...], tuple[Ends | None, ...]] = {}
        self._expected = Expectations()
        self._upright: dict[int, int] = {}
        """Maps the number of a tipped box's state to the number of its state before the tip."""
        self._layouts = {token.name: StateLayout.of((token,)) for token in task.tokens}
        self.start = {token.name: self._intern(token.name, self._initial(token)) for token in task.tokens}

    def _initial(self, token: Token) -> FloatArray:
        parts = [self.task.state[token, varying.name] for varying in token.varying]
        return np.concatenate(parts) if parts else np.zeros(0)

    def _intern(self, name: str, row: FloatArray) -> int:
        row = np.round(row, 7) + 0.0
        key = (name, row.tobytes())
        if key not in self._number:
            self._number[key] = len(self._rows)
            self._rows.append(row)
            self._cells.append(self._cell(name, row))
        return self._number[key]

    def _cell(self, name: str, row: FloatArray) -> tuple[int, ...]:
        state, found = State(self._layouts[name], row), list[int]()
        for _, each, _ in self._layouts[name].entries:
            value = state[name, each]
            if each == "orientation":
                axes = np.concatenate([rotate(value, unit) for unit in np.eye(3)[:2]])
                found += np.round(axes / _TURN).astype(int).tolist()
            elif "velocity" not in each:
                found += np.round(value / _CELL).astype(int).tolist()
        return tuple(found)

    def cell(self, number: int) -> tuple[int, ...]:
        """Return the cell of a state. States in the same cell are merged."""
        return self._cells[number]

    def _state(self, names: Iterable[str], ids: Ids) -> State:
        tokens = [self.task.token_by_name[name] for name in names]
        rows = [self._rows[ids[token.name]] for token in tokens]
        return State(StateLayout.of(tokens), np.concatenate(rows) if rows else np.zeros(0))

    def _is_token(self, name: str) -> bool:
        return name in self.task.token_by_name

    def margin(self, literal: Literal, roles: Mapping[str, str], ids: Ids) -> float:
        """Return the margin of a literal in the current state.

        For a static predicate, only the properties that the predicate reads have their current values. All other
        properties have their initial values. A predicate with `at_start` is measured in the initial state. For a tipped
        box, a static predicate may also hold in the pose before the tip.
        """
        names = tuple(roles.get(argument, argument) for argument in literal.arguments)
        tokens = tuple(dict.fromkeys(name for name in names if self._is_token(name)))
        key = (literal.predicate.name, names, tuple(ids[name] for name in tokens))
        if key not in self._margins:
            self._margins[key] = self._measure(literal.predicate, names, tokens, ids)
        margin = self._margins[key]
        return margin if literal.positive else -margin

    def _measure(self, predicate: Predicate, names: tuple[str, ...], tokens: tuple[str, ...], ids: Ids) -> float:
        values = [self.task.value(name) for name in names]
        if not predicate.static:
            return float(predicate.evaluate(self._state(tokens, ids), *values))
        start, margins = self._state(tokens, self.start), list[float]()
        if _at_start(predicate):
            return float(predicate.evaluate(start, *values))
        for poses in (ids, {name: self._upright.get(number, number) for name, number in ids.items()}):
            now = self._state(tokens, poses)
            read = {
                (name, each): now[name, each]
                for name, parameter in zip(names, predicate.parameters, strict=True)
                for each in predicate.reads.get(parameter.name, ())
            }
            margins.append(float(predicate.evaluate(start.replace(read), *values)))
        return max(margins)

    def holds(self, literals: Iterable[Literal], roles: Mapping[str, str], ids: Ids) -> bool:
        """Return whether all conditions hold in the current state. Negative rounding errors count as zero."""
        return all(self.margin(literal, roles, ids) >= -_ROUNDING for literal in literals)

    def bindings(self, block: Block, tokens: Mapping[str, str], ids: Ids) -> list[Roles]:
        """Return the bindings of a block, given the tokens in its slots, for which all entry conditions hold."""
        kinds = {target.name: self.task.values_of(target.sort) for target in block.targets}
        places = [role for role, values in kinds.items() if any(isinstance(value, Token) for value in values)]
        if any(not values for values in kinds.values()):
            return []
        found: list[Roles] = []
        for chosen in product(*(kinds[role] for role in places)):
            roles = dict(tokens) | {role: name_of(value) for role, value in zip(places, chosen, strict=True)}
            if len(set(roles.values())) == len(roles):
                found += self._symbols(block, roles, ids)
        return found

    def _symbols(self, block: Block, roles: dict[str, str], ids: Ids) -> list[Roles]:
        key = (block.name, tuple(roles.items()), tuple(ids[name] for name in roles.values()))
        if key not in self._bindings:
            choices: dict[str, tuple[Value, ...]] = {
                role: (self.task.value(roles[role]),) if role in roles else self.task.values_of(sort)
                for role, sort in block.roles.items()
            }
            free = [literal for literal in block.entry if set(literal.arguments) <= set(roles)]
            found: list[Roles] = []
            if self.holds(free, roles, ids):
                for bound in enumerate_bindings(choices, block.entry, self._test(ids)):
                    found.append(tuple((role, name_of(value)) for role, value in bound.items()))
            self._bindings[key] = found
        return self._bindings[key]

    def _test(self, ids: Ids):  # type: ignore[no-untyped-def]
        def holds(literal: Literal, bound: Mapping[str, Value]) -> bool:
            return self.margin(literal, {role: name_of(value) for role, value in bound.items()}, ids) >= -_ROUNDING

        return holds

    def ends(self, started: Started, ids: Ids, samples: int) -> tuple[Ends, ...]:
        """Return the possible ends of a movement.

        A movement into a region is simulated, because hyperparameters determine its end. Every other movement ends in
        its declared outcome, or as in a rollout. Movements that miss their exit conditions have no end.
        """
        block, roles = started.block, dict(started.roles)
        if not block.moves:
            return ((),)
        if into_region(block):
            ends = [end for end in self.simulate(started, ids, samples) if end is not None]
            apart = {tuple(self.cell(number) for _, number in end): end for end in reversed(ends)}
            return tuple(dict.fromkeys(reversed(apart.values())))
        key = self._key(started, ids)
        if key not in self._ends:
            tokens = [name for name in roles.values() if self._is_token(name)]
            binding, state = self.task.bind(roles), self._state(tokens, ids)
            begin = Beginning(block, binding, state, block.initial_values(binding, state))
            after = block.outcome(binding, state) if block.outcome else self._expected.of([begin])[0].end
            assert after is not None, "a block that moves tokens has an expected end"
            end = self._keep(started, ids, after)
            good = self.holds(block.measured_exits, roles, {**ids, **dict(end)})
            self._ends[key] = (end,) if good else ()
        return self._ends[key]

    def forget(self, started: Started, ids: Ids) -> None:
        """Remove a movement from the search because its simulation failed."""
        self._ends[self._key(started, ids)] = ()
        self._simulated[(*self._key(started, ids), 0)] = (None,)
        self._simulated[(*self._key(started, ids), 1)] = (None,) * (SAMPLES - 1)

    def _key(self, started: Started, ids: Ids) -> tuple[object, ...]:
        names = [name for _, name in started.roles if self._is_token(name)]
        return (started.block.name, started.roles, tuple(ids[name] for name in names))

    def _keep(self, started: Started, ids: Ids, after: State) -> Ends:
        """Return the ends of the tokens in slots, at rest."""
        still = after.replace({(t, each): 0.0 for t, each, _ in after.layout.entries if "velocity" in each})
        rows = {
            name: np.concatenate([still[name, each] for _, each, _ in self._layouts[name].entries])
            for _, name in started.slots
        }
        end = tuple((name, self._intern(name, row)) for name, row in rows.items())
        for name, number in end:
            if started.block.name in _TIPS and number not in self._upright:
                self._upright[number] = self._upright.get(ids[name], ids[name])
        return end

    def simulate(self, started: Started, ids: Ids, samples: int = SAMPLES) -> tuple[Ends | None, ...]:
        """Roll out a movement for the first samples of its hyperparameters. The result of a failed sample is None.

        The initial values are rolled out separately, because the drawn samples are seldom needed.
        """
        found: tuple[Ends | None, ...] = ()
        for part in (slice(0, 1), slice(1, SAMPLES))[: 1 if samples == 1 else 2]:
            key = (*self._key(started, ids), part.start)
            if key not in self._simulated:
                self._simulated[key] = self._simulate(started, ids, part)
            found += self._simulated[key]
        return found

    def _simulate(self, started: Started, ids: Ids, part: slice) -> tuple[Ends | None, ...]:
        block, roles, count = started.block, dict(started.roles), part.stop - part.start
        if not block.moves:
            return ((),) * count
        self.rolled += 1
        binding = self.task.bind(roles)
        start = self._state([name for name in roles.values() if self._is_token(name)], ids)
        values = self._sample(block, binding, start)
        first = {name: column[0] for name, column in values.items()}
        longest = min(block.duration.maximum, 1.5 * expect(block, binding, start, first).seconds + 3.0)
        state, found = start.repeated(count), [None] * count  # type: list[Ends | None]
        model = ForwardModel(block, binding, state, Parameters({name: each[part] for name, each in values.items()}))
        alive, before = np.ones(count, dtype=bool), state.values
        for step in range(int(longest / CONTROL_PERIOD)):
            elapsed = step * CONTROL_PERIOD
            if step % _CHECKED_EVERY == 0:
                alive &= _all_hold(block.invariants, state, binding, count)
                done = alive & _all_hold(block.measured_exits, state, binding, count)
                done &= elapsed >= block.duration.minimum
                for index in np.flatnonzero(done):
                    found[index] = self._keep(started, ids, State(state.layout, state.values[index]))
                alive &= ~done
                still = elapsed > _AWAKE and np.abs(state.values - before).max() < _STILL
                if not alive.any() or still:
                    break
                before = state.values
            with np.errstate(all="ignore"):
                state = model.step(np.float64(elapsed), state)[0]
        return tuple(found)

    def _sample(self, block: Block, binding: Mapping[str, Value], start: State) -> dict[str, FloatArray]:
        """Return the initial values, and four draws around them. The draws depend only on the block and the binding."""
        seed = [self.task.seed, *f"{block.name}{sorted((r, name_of(v)) for r, v in binding.items())}".encode()]
        rng = np.random.default_rng(seed)
        found: dict[str, FloatArray] = {}
        for each in block.hyperparameters:
            first = float(each.initial_value(binding, start))
            low, high = each.bounds(binding)
            width = min(abs(first), high - low) or (high - low) / 2.0
            drawn = [np.clip(first + spread * width * rng.uniform(-1.0, 1.0), low, high) for spread in _SPREADS]
            found[each.name] = np.array([first, *drawn])
        return found


def into_region(block: Block) -> bool:
    """Return whether the block moves a token into a region, in which the token may end anywhere."""
    return any(literal.positive and literal.predicate.name == "inside" for literal in block.exit)


def _all_hold(literals: Iterable[Literal], state: State, binding: Mapping[str, Value], count: int) -> BoolArray:
    found = np.ones(count, dtype=bool)
    for literal in literals:
        found &= np.asarray(literal.margin(state, binding)) >= -_ROUNDING
    return found


def _at_start(predicate: Predicate) -> bool:
    return bool(getattr(predicate, "at_start", False)) or predicate.name in ("home", "handle_within_reach")

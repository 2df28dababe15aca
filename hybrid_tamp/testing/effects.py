"""Checks of what a block changes: written properties, declared effects, undeclared effects and broken invariants."""

from collections import defaultdict
from collections.abc import Iterator

import numpy as np

from hybrid_tamp.execution.monitors import TOLERANCE
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.predicate import ANY, Atom, Binding, Literal, Predicate, name_of
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.testing.disagreement import Disagreements, atom_text, first_role, role_of, with_unit
from hybrid_tamp.testing.facts import Values, atoms_with
from hybrid_tamp.testing.rollouts import Rollouts

_ROUNDING = 1e-9
"""Largest change of a property that counts as a rounding error, in SI units."""
_SLOW = 1e-6
"""Speed below which velocities are not compared with poses [m/s or rad/s]."""
_STEPS = 10
"""Least number of time steps with which velocities are compared with poses."""
_FASTEST = 10.0
"""Largest plausible ratio between the change of a pose and the velocity. For degrees and millimetres, it is larger."""
_STARTS = 2
"""Least number of states from which a block must have been rolled out before a failure in all rollouts is reported."""
_UNITS = {"position": "m", "velocity": "m/s", "orientation": "", "angular_velocity": "rad/s"}


def check_writes(rolled: Rollouts, found: Disagreements) -> None:
    """Report each property that changes in a rollout, although the block does not declare this in `writes`."""
    block, binding = rolled.block, rolled.binding
    slots = {slot.name for slot in block.slots}
    for row in range(len(rolled.lengths)):
        length = rolled.lengths[row]
        changes = np.abs(rolled.states.values[: length + 1, row] - rolled.start.values).max(axis=0)
        for role, token in ((r, value) for r, value in binding.items() if isinstance(value, Token)):
            for varying in token.varying:
                change = float(changes[rolled.start.layout.slices[token.name, varying.name]].max(initial=0.0))
                if change <= _ROUNDING or varying.name in block.writes.get(role, ()):
                    continue
                unit = _UNITS.get(varying.name, varying.unit)
                measured = f"the {varying.name} of {token.name} changes by {change:.4g} {unit}".rstrip()
                if role in slots:
                    written = ", ".join(block.writes.get(role, ())) or "nothing"
                    found.add("writes", block, binding, f"the block writes {written} of {role}", measured, role)
                else:
                    found.add(
                        "holds",
                        block,
                        binding,
                        f"the block changes only tokens in its slots, not {role}",
                        measured,
                        role,
                    )


def check_velocities(rolled: Rollouts, found: Disagreements) -> None:
    """Compare how fast the poses of tokens change with their velocities, in row 0 of the rollouts."""
    block, dt = rolled.block, rolled.dt
    states = State(rolled.states.layout, rolled.states.values[: rolled.lengths[0] + 1, 0])
    for slot, written in block.writes.items():
        token = rolled.binding[slot]
        assert isinstance(token, Token)
        for pose, velocity, unit in (("position", "velocity", "m"), ("orientation", "angular_velocity", "rad")):
            if pose not in written or velocity not in written:
                continue
            speed = np.linalg.norm(states[token, velocity][1:], axis=-1)
            change = np.linalg.norm(np.diff(states[token, pose], axis=0), axis=-1) * (2.0 if unit == "rad" else 1.0)
            moving = (speed > _SLOW) & (change > 0.0)
            ratio = float(np.median(change[moving] / (speed[moving] * dt))) if moving.sum() >= _STEPS else 1.0
            if not 1.0 / _FASTEST < ratio < _FASTEST:
                declared = f"the {velocity} of {slot} is the rate of its {pose}"
                measured = (
                    f"the {pose} of {token.name} changes by {ratio:.4g} {unit} where the {velocity} says 1 {unit}"
                )
                found.add("unit", block, rolled.binding, declared, measured, slot)


def check_undeclared(task: Task, rolled: Rollouts, found: Disagreements) -> None:
    """Report each atom that becomes true or false in a successful rollout, although no exit condition declares this."""
    declared = [literal.ground(rolled.binding) for literal in rolled.block.exit]
    for predicate in task.domain.predicates:
        if not predicate.measured or predicate in rolled.block.keeps:
            continue
        atoms = atoms_with(task, predicate, rolled)
        if not atoms:
            continue
        old, new = predicate.margins(rolled.start, atoms)[:, None], predicate.margins(rolled.ends, atoms)
        for index, row in np.argwhere((old >= 0) != (new >= 0)):
            values, became = atoms[index], bool(new[index, row] >= 0)
            if _is_declared(predicate, values, became, declared):
                continue
            roles = ", ".join(role_of(rolled.binding, [value]) or name_of(value) for value in values)
            text = f"{'' if became else 'not '}{predicate.name}({roles})"
            measured = (
                f"{atom_text(predicate, values)} becomes {str(became).lower()}: the margin changes from "
                f"{with_unit(float(old[index, 0]), predicate)} to {with_unit(float(new[index, row]), predicate)}"
            )
            wanted = f"the block has no effect on {predicate.name} except its exit conditions"
            role = role_of(rolled.binding, values)
            found.add(
                "undeclared", rolled.block, rolled.binding, wanted, measured, role, f"add the effect {text} to 'exit'"
            )
            break


def _is_declared(predicate: Predicate, values: Values, became: bool, declared: list[Atom]) -> bool:
    """Return whether exit conditions declare that an atom becomes true or false.

    A new value of a functional predicate replaces the old value, so this also declares that the old atom becomes false.
    If places overlap, the predicate may also become true for another place.
    """
    atom = Atom(predicate.name, tuple(map(name_of, values)))
    index = predicate.functional_index
    for each in declared:
        if each.positive == became and each.matches(atom):
            return True
        if each.positive and index is not None and each.predicate == atom.predicate:
            wild = Atom(each.predicate, (*each.arguments[:index], ANY, *each.arguments[index + 1 :]))
            if wild.matches(atom):
                return True
    return False


class Promises:
    """What no rollout of a block fulfils: deletions of atoms, and invariants.

    A deletion or an invariant that fails only in some rollouts is not reported, because feasibility facts are upper
    bounds, and because the optimiser chooses hyperparameters for which the invariants hold. Invariants have the same
    tolerance as in runs.
    """

    def __init__(self, task: Task) -> None:
        self._task = task
        self._kept: set[tuple[str, Literal]] = set()
        self._failed: dict[tuple[str, Literal], tuple[Block, Binding, str]] = {}
        self._count: dict[str, int] = defaultdict(int)
        self._starts: dict[str, int] = defaultdict(int)

    def note(self, rolled: Rollouts) -> None:
        """Note the deletions and the invariants of rollouts that reached their exit conditions."""
        block = rolled.block
        self._count[block.name] += len(rolled.rows)
        self._starts[block.name] += 1
        for literal in block.invariants:
            least = rolled.least(literal)
            figure = f"the least margin is {with_unit(least, literal.predicate)}"
            self._note(rolled, literal, least >= -TOLERANCE * literal.predicate.scale, figure)
        for literal, atom, margin in self._deletions(rolled):
            figure = f"{atom} still holds at the end, with a margin of {with_unit(margin, literal.predicate)}"
            self._note(rolled, literal, margin < 0, figure)

    def report(self, found: Disagreements) -> None:
        """Add each deletion and each invariant that failed in all rollouts."""
        for (name, literal), (block, binding, figure) in self._failed.items():
            if (name, literal) in self._kept or self._starts[name] < _STARTS:
                continue
            broken = literal in block.invariants
            kind = "broken" if broken else "effect"
            declared = f"the {'invariant' if broken else 'effect'} {literal.text}"
            measured = f"{figure}, and no rollout of {self._count[name]} is better"
            found.add(kind, block, binding, declared, measured, first_role(block, literal.arguments))

    def _note(self, rolled: Rollouts, literal: Literal, kept: bool, figure: str) -> None:
        key = rolled.block.name, literal
        if kept:
            self._kept.add(key)
        else:
            self._failed.setdefault(key, (rolled.block, rolled.binding, figure))

    def _deletions(self, rolled: Rollouts) -> Iterator[tuple[Literal, str, float]]:
        """Yield a triple of (exit condition, atom, largest final margin) for each atom that must become false."""
        added = {each.ground(rolled.binding) for each in rolled.block.exit if each.positive}
        for literal in rolled.block.exit:
            predicate = literal.predicate
            if literal.positive or ANY not in literal.arguments or not predicate.measured:
                continue
            pattern = literal.ground(rolled.binding)
            for values in atoms_with(self._task, predicate, rolled):
                atom = Atom(predicate.name, tuple(map(name_of, values)))
                if (
                    pattern.matches(atom)
                    and atom not in added
                    and float(predicate.evaluate(rolled.start, *values)) >= 0
                ):
                    margin = float(np.max(predicate.evaluate(rolled.ends, *values)))
                    yield literal, atom.text, margin

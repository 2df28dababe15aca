"""Checks that a block does not change certain facts, and that no margin exceeds its declared bound."""

from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from hybrid_tamp.model.bindings import enumerate_bindings
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.frame import explain_kept
from hybrid_tamp.model.margins import ROUNDING, bound_margin
from hybrid_tamp.model.predicate import Predicate, Value
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.testing.disagreement import Disagreements, atom_text, role_of, with_unit
from hybrid_tamp.testing.rollouts import Rollouts

_RADII = (0.01, 3.0)
"""Least and greatest radius within which tokens are displaced to test a bound [m]."""
_DISPLACEMENTS = 2
"""Number of displacements of the tokens for each atom and state to test a bound."""
_ATOMS = 16
"""Largest number of atoms of a predicate whose bounds are tested after a step. The atoms are chosen at random."""

_POSITION = "position"

Values = tuple[Value, ...]
"""Arguments of an atom."""


def check_facts(task: Task, first: State, rolled: Rollouts, found: Disagreements, rng: np.random.Generator) -> None:
    """Compare the facts before and after rollouts that reached their exit conditions.

    Args:
        task: task that has the tokens and the predicates.
        first: state at the start of the walk to which the rollouts belong.
        rolled: rollouts of a block. At least one of the rollouts reached its exit conditions.
        found: collection to which disagreements are added.
        rng: random generator.
    """
    for predicate in rolled.block.keeps:
        _check_kept(task, predicate, rolled, found)
    for predicate in task.domain.static_predicates:
        if predicate.rows is None and not predicate.reads:
            _check_fixed(task, predicate, rolled, found)
        if predicate.bound is not None:
            _check_bound(task, predicate, first, rolled, found, rng)


def check_keeps(domain: Domain, blocks: Iterable[Block], found: Disagreements) -> None:
    """Report each predicate in `keeps` that a block keeps without this declaration."""
    for block in blocks:
        for predicate in block.keeps:
            if reason := explain_kept(domain, block, predicate):
                declared = f"'keeps' must list {predicate.name}"
                found.add("keeps", block, {}, declared, reason, remedy=f"remove {predicate.name} from 'keeps'")


def _check_kept(task: Task, predicate: Predicate, rolled: Rollouts, found: Disagreements) -> None:
    if predicate.at_start:
        return
    for values, before, after in _changed(predicate, atoms_with(task, predicate, rolled), rolled.start, rolled.ends):
        measured = f"{atom_text(predicate, values)} {_from_to(predicate, before, after)}"
        role = role_of(rolled.binding, values)
        found.add("keeps", rolled.block, rolled.binding, f"the block keeps {predicate.name}", measured, role)


def _check_fixed(task: Task, predicate: Predicate, rolled: Rollouts, found: Disagreements) -> None:
    every = [tuple(bound.values()) for bound in enumerate_bindings(_sorts(task, predicate))]
    for values, before, after in _changed(predicate, every, rolled.start, rolled.ends):
        declared = f"{predicate.name} reads no varying property"
        measured = f"{atom_text(predicate, values)} {_from_to(predicate, before, after)}"
        found.add("fixed", rolled.block, rolled.binding, declared, measured, role_of(rolled.binding, values))


def _changed(
    predicate: Predicate, atoms: Sequence[Values], before: State, after: State
) -> Iterator[tuple[Values, float, float]]:
    """Yield a triple of (arguments, margin before, margin after) for each atom whose truth changes.

    `after` has the shape ``(m,)``.
    """
    if not atoms:
        return
    old, new = predicate.margins(before, atoms)[:, None], predicate.margins(after, atoms)
    for atom, row in np.argwhere((old >= 0) != (new >= 0)):
        yield atoms[atom], float(old[atom, 0]), float(new[atom, row])


def _from_to(predicate: Predicate, before: float, after: float) -> str:
    return f"changes its margin from {with_unit(before, predicate)} to {with_unit(after, predicate)}"


def _check_bound(
    task: Task, predicate: Predicate, first: State, rolled: Rollouts, found: Disagreements, rng: np.random.Generator
) -> None:
    """Compare the margins with bounds, which are computed for current, earlier and random positions of the tokens."""
    moving = _moving_tokens(task)
    every = atoms_with(task, predicate, rolled)
    for values in (every[index] for index in rng.permutation(len(every))[:_ATOMS]):
        tokens = [value for value in values if isinstance(value, Token) and value in moving]
        for row in rolled.rows[:1] + rolled.rows[-1:]:
            state = rolled.end(row)
            margin = float(predicate.evaluate(state, *values))
            for elsewhere, radius in _elsewhere(state, (first, rolled.start), tokens, rng):
                bound = bound_margin(predicate, elsewhere, radius, values)
                if margin > bound + ROUNDING * predicate.scale:
                    declared = f"the margin of {predicate.name} does not exceed its bound"
                    atom, shown = atom_text(predicate, values), with_unit(margin, predicate)
                    limit = f"{with_unit(bound, predicate)} for displacements of up to {radius:.3g} m"
                    measured = f"the margin of {atom} is {shown}, and the bound is {limit}"
                    role = role_of(rolled.binding, values)
                    found.add("bound", rolled.block, rolled.binding, declared, measured, role)
                    return


def _elsewhere(
    state: State, visited: Sequence[State], tokens: Sequence[Token], rng: np.random.Generator
) -> Iterator[tuple[State, float]]:
    """Yield pairs of (state with other positions of the tokens, radius that covers the displacements [m])."""
    yield state, 0.0
    yield state, np.inf
    for other in visited:
        yield _displaced(state, {t.name: other[t, "position"] - state[t, "position"] for t in tokens})
    for _ in range(_DISPLACEMENTS):
        radius = float(np.exp(rng.uniform(*np.log(_RADII))))
        angles, sizes = rng.uniform(0.0, 2.0 * np.pi, len(tokens)), radius * np.sqrt(rng.random(len(tokens)))
        ways = np.stack([np.cos(angles), np.sin(angles)], axis=-1) * sizes[:, None]
        moved, _ = _displaced(state, dict(zip((t.name for t in tokens), ways, strict=True)))
        yield moved, radius


def _displaced(state: State, ways: dict[str, FloatArray]) -> tuple[State, float]:
    """Return the state with tokens displaced horizontally, and the largest displacement [m]."""
    horizontal = {name: np.array([way[0], way[1], 0.0]) for name, way in ways.items()}
    moved = state.replace({(name, "position"): state[name, "position"] + way for name, way in horizontal.items()})
    return moved, max((float(np.linalg.norm(way)) for way in horizontal.values()), default=0.0)


def _moving_tokens(task: Task) -> set[Token]:
    """Return the tokens whose position can be changed by a block of the domain."""
    classes = [
        block.slot(slot).object_class
        for block in task.domain.blocks
        for slot, names in block.writes.items()
        if "position" in names
    ]
    return {token for token in task.tokens if any(map(token.is_member, classes))}


def atoms_with(task: Task, predicate: Predicate, rolled: Rollouts) -> list[Values]:
    """Return the well-typed tuples of arguments that contain a token which the rolled-out block changes."""
    changed = {rolled.binding[slot] for slot in rolled.block.writes}
    every = (tuple(bound.values()) for bound in enumerate_bindings(_sorts(task, predicate)))
    return [values for values in every if not changed.isdisjoint(values)]


def _sorts(task: Task, predicate: Predicate) -> dict[str, tuple[Value, ...]]:
    return {parameter.name: task.values_of(parameter.sort) for parameter in predicate.parameters}

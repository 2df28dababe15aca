"""Checks of margins: their shapes, the varying properties that they read, and how fast they change with them."""

from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from hybrid_tamp.errors import DomainError
from hybrid_tamp.model.affordance import VaryingProperty
from hybrid_tamp.model.bindings import enumerate_bindings
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.margins import ROUNDING
from hybrid_tamp.model.predicate import Literal, Predicate, Value
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.poses import quaternion_from_rotation_vector, quaternion_multiply
from hybrid_tamp.testing.disagreement import Disagreements, atom_text, with_unit
from hybrid_tamp.testing.refusals import add_refusal, predicates_of

_ATOMS = 6
"""Largest number of atoms of a predicate that are examined. The atoms are chosen at random."""
_SIZES = (0.01, 0.1, 1.0)
"""Sizes of the changes of a property, in SI units."""
_SMALL = (1e-3, 3e-2)
"""Sizes of the changes with which rates are measured, in SI units. If the margin jumps, the rates differ."""
_ALIKE = 3.0
"""Largest ratio of two rates with which a margin counts as linear."""
_RATES = 5
"""Number of changes with which a rate is measured."""
_FASTEST = 10.0
"""Largest plausible rate of a margin with respect to a property of the same unit. For millimetres, the rate is 1000."""
_TURNED = {"orientation": "rad"}
"""Maps each property without a unit to the unit of its changes."""

_Owned = tuple[Block, Literal]
"""Block that has a condition on a predicate, and this condition."""


def check_margins(
    task: Task, blocks: Sequence[Block], found: Disagreements, rng: np.random.Generator
) -> frozenset[Predicate]:
    """Examine the margin of each predicate that occurs in a condition of a block.

    Returns:
        The predicates whose margins cannot be evaluated. Blocks with these predicates cannot be rolled out.
    """
    owned: dict[Predicate, _Owned] = {}
    for block in blocks:
        for predicate, literal in predicates_of(block).items():
            if literal is not None and predicate.rows is None:
                owned.setdefault(predicate, (block, literal))
    unsound = set()
    for predicate, owner in owned.items():
        atoms = _atoms(task, predicate, rng)
        try:
            for values in atoms:
                _evaluate_batch(task.state, predicate, values)
        except DomainError as error:
            add_refusal(error, blocks, {}, found)
            unsound.add(predicate)
            continue
        for values in atoms:
            _check_reads(task, predicate, values, owner, found, rng)
            _check_rates(task, predicate, values, owner, found, rng)
    return frozenset(unsound)


def _atoms(task: Task, predicate: Predicate, rng: np.random.Generator) -> list[tuple[Value, ...]]:
    sorts = {parameter.name: task.values_of(parameter.sort) for parameter in predicate.parameters}
    every = [tuple(bound.values()) for bound in enumerate_bindings(sorts)]
    return [every[index] for index in rng.permutation(len(every))[:_ATOMS]]


def _evaluate_batch(state: State, predicate: Predicate, values: Sequence[Value]) -> None:
    """Evaluate a margin so that wrong shapes and other tokens are refused.

    The first state contains only the tokens of the arguments. The second state is a batch of shape ``(2,)``.
    """
    predicate.margins(state, [tuple(values)])
    predicate.evaluate(state.repeated(2), *values)


def _check_reads(
    task: Task,
    predicate: Predicate,
    values: Sequence[Value],
    owner: _Owned,
    found: Disagreements,
    rng: np.random.Generator,
) -> None:
    """Compare the margins in states that differ only in properties that the margin must not read."""
    if predicate.at_start:
        return
    before = float(predicate.evaluate(task.state, *values))
    for role, token, properties in _unread(task, predicate, values, owner):
        for changed, names in _changed_states(task.state, token, properties, rng):
            after = _margin(predicate, changed, values)
            if after is None or abs(after - before) <= ROUNDING * predicate.scale:
                continue
            fixed = predicate.static and not predicate.reads
            reading = " and ".join(f"{key}: {', '.join(each)}" for key, each in predicate.reads.items() if each)
            declared = f"{predicate.name} reads {reading or 'no varying property'}"
            measured = (
                f"the margin of {atom_text(predicate, values)} changes from {with_unit(before, predicate)} to "
                f"{with_unit(after, predicate)} with the {names} of {token.name}"
            )
            found.add("fixed" if fixed else "reads", owner[0], {}, declared, measured, role)
            break


def _unread(
    task: Task, predicate: Predicate, values: Sequence[Value], owner: _Owned
) -> Iterator[tuple[str, Token, list[VaryingProperty]]]:
    """Yield a triple of (role, token, properties) for each token with properties that the margin must not read.

    Properties that no block writes are omitted. A feasibility fact with `reads` may read further properties, because
    the planner updates only the properties in `reads` after a movement.
    """
    block, literal = owner
    for parameter, value, argument in zip(predicate.parameters, values, literal.arguments, strict=True):
        read = predicate.reads.get(parameter.name, ())
        if isinstance(value, Token) and not (predicate.static and predicate.reads):
            hidden = [each for each in changeable(task, value) if each.name not in read]
            yield argument if argument in block.roles else block.anchor, value, hidden


def changeable(task: Task, token: Token) -> list[VaryingProperty]:
    """Return the properties of a token that a block writes. For a place, return the position, which differs by task."""
    written = {
        name
        for block in task.domain.blocks
        for slot, names in block.writes.items()
        if token.is_member(block.slot(slot).object_class)
        for name in names
    }
    return [each for each in token.varying if each.name in written or (token.place and each.name == "position")]


def _changed_states(
    state: State, token: Token, properties: Iterable[VaryingProperty], rng: np.random.Generator
) -> Iterator[tuple[State, str]]:
    """Yield pairs of (state in which one property of a token is changed, name of this property)."""
    for varying in properties:
        for size in _SIZES:
            yield changed_state(state, token, varying, size, rng), varying.name


def changed_state(state: State, token: Token, varying: VaryingProperty, size: float, rng: np.random.Generator) -> State:
    """Return the state with a property changed by a random vector of the given length, in SI units or in radians."""
    turning = varying.name in _TURNED
    way = rng.normal(size=3 if turning else varying.size)
    way *= size / np.linalg.norm(way)
    value = state[token, varying.name]
    after = quaternion_multiply(quaternion_from_rotation_vector(way), value) if turning else value + way
    return state.replace({(token.name, varying.name): after})


def _margin(predicate: Predicate, state: State, values: Sequence[Value]) -> float | None:
    """Return a margin, or None if the margin is not defined in a changed state, e.g. for a body that leans."""
    try:
        return float(predicate.evaluate(state, *values))
    except DomainError:
        return None


def _check_rates(
    task: Task,
    predicate: Predicate,
    values: Sequence[Value],
    owner: _Owned,
    found: Disagreements,
    rng: np.random.Generator,
) -> None:
    """Compare how fast a margin changes with how fast a property of the same unit changes."""
    for parameter, value, argument in zip(predicate.parameters, values, owner[1].arguments, strict=True):
        for varying in value.varying if isinstance(value, Token) else ():
            if _TURNED.get(varying.name, varying.unit) != predicate.unit:
                continue
            assert isinstance(value, Token)
            rates = [_rate(task.state, predicate, values, (value, varying), size, rng) for size in _SMALL]
            rate = min(rates)
            if rate > _FASTEST and max(rates) < _ALIKE * rate:
                role = argument if argument in owner[0].roles else owner[0].anchor
                declared = f"the unit of {predicate.name} is {predicate.unit}"
                measured = (
                    f"the margin changes by {rate:.4g} {predicate.unit} for each {predicate.unit} by which the "
                    f"{varying.name} of {parameter.name} changes"
                )
                found.add("unit", owner[0], {}, declared, measured, role)


def _rate(
    state: State,
    predicate: Predicate,
    values: Sequence[Value],
    owned: tuple[Token, VaryingProperty],
    size: float,
    rng: np.random.Generator,
) -> float:
    """Return the median rate of a margin for random changes of a property by the given size."""
    before = float(predicate.evaluate(state, *values))
    states = [changed_state(state, *owned, size, rng) for _ in range(_RATES)]
    margins = [margin for changed in states if (margin := _margin(predicate, changed, values)) is not None]
    return float(np.median(np.abs(np.array(margins) - before))) / size if margins else 0.0

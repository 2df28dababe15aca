"""Tests of kinds of predicates, and of relations over symbols that are declared as lists of rows."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from hybrid_tamp_domains.rolling_tumbling.tumbling_predicates import LOW_ENOUGH
from hypothesis import given, settings
from hypothesis import strategies as st
from random_tasks.corners import Corner
from random_tasks.hammer import random_hammer
from random_tasks.lifting import random_lifting
from random_tasks.rolling import random_rolling
from random_tasks.tumbling import random_tumbling
from scenes import rolling_task
from serial import COLOURS, Part

from hybrid_tamp.errors import DomainError
from hybrid_tamp.model.kind import Kind
from hybrid_tamp.model.margins import ROUNDING
from hybrid_tamp.model.predicate import Literal, Parameter, Predicate
from hybrid_tamp.model.state import State
from hybrid_tamp.model.token import different
from hybrid_tamp.questions.changes import with_copy
from hybrid_tamp.skills import StaticEndEffector
from hybrid_tamp.taskfile.domains import find_domain

PART, OLD, NEW = Parameter("part", Part), Parameter("old", COLOURS), Parameter("new", COLOURS)
NOTHING = State.of((), {})
DOMAINS = ("rolling_tumbling", "tool_use", "joint_lifting")


def margin(state: State, *values: object) -> np.ndarray:
    return np.zeros(state.values.shape[:-1])


@pytest.mark.parametrize("kind", [Kind.CHANGING, Kind.MAINTAINED, Kind.STATIC])
def test_only_a_functional_predicate_has_a_parameter_with_one_value(kind: Kind) -> None:
    with pytest.raises(DomainError, match="must be set if the predicate is functional"):
        Predicate("painted", (PART, NEW), margin, kind=kind, value_of="new")


def test_a_functional_predicate_names_one_of_its_parameters() -> None:
    with pytest.raises(DomainError, match="must be set if the predicate is functional"):
        Predicate("painted", (PART, NEW), margin, kind=Kind.FUNCTIONAL)
    with pytest.raises(DomainError, match="'value_of' must be a parameter of the predicate; got 'colour'"):
        Predicate("painted", (PART, NEW), margin, kind=Kind.FUNCTIONAL, value_of="colour")
    assert Predicate("painted", (PART, NEW), margin, kind=Kind.FUNCTIONAL, value_of="new").functional_index == 1


def test_a_relation_holds_for_its_rows_and_keeps_them_in_the_order_of_the_sorts() -> None:
    one, two, three, *_ = COLOURS.symbols
    follows = Predicate.relation("follows", (OLD, NEW), [(two, three), (one, two), (two, three)])
    assert follows.rows == ((one, two), (two, three))
    for row in product(COLOURS.symbols, repeat=2):
        assert (float(follows.evaluate(NOTHING, *row)) >= 0) == (row in follows.rows)


@pytest.mark.parametrize("row", [("red",), ("red", "no colour"), ("red", "red", "red")])
def test_a_row_has_a_symbol_of_each_sort(row: tuple[str, ...]) -> None:
    with pytest.raises(DomainError, match="one symbol of each parameter's sort"):
        Predicate.relation("follows", (OLD, NEW), [row])


def test_a_static_predicate_over_symbols_is_declared_by_its_rows_and_no_other_one_is() -> None:
    with pytest.raises(DomainError, match=r"Predicate\.relation"):
        Predicate("follows", (OLD, NEW), margin, kind=Kind.STATIC)
    with pytest.raises(DomainError, match="must be static and must have only symbol parameters"):
        Predicate.relation("painted", (PART, NEW), [])


@pytest.mark.parametrize("name", DOMAINS)
def test_every_bundled_predicate_says_in_words_that_it_holds_and_that_it_does_not(name: str) -> None:
    for predicate in find_domain(name).predicates:
        names = tuple(parameter.name for parameter in predicate.parameters)
        said, denied = predicate.sentence(names), predicate.sentence(names, positive=False)
        assert said != denied
        assert not denied.startswith(("not ", "it is not"))


TASKS = {
    "rolling": random_rolling,
    "tumbling": random_tumbling,
    "lifting": random_lifting,
    "hammer": random_hammer,
}


@pytest.mark.parametrize("name", TASKS)
@given(seed=st.integers(0, 10_000), copies=st.integers(1, 2), batch=st.sampled_from([(), (3,)]))
@settings(max_examples=5, deadline=None)
def test_many_bindings_at_once_have_the_margins_that_they_have_one_at_a_time(
    name: str, seed: int, copies: int, batch: tuple[int, ...]
) -> None:
    """Each token has a copy. A token and its copy differ only in their states."""
    task, rng = TASKS[name](seed), np.random.default_rng(seed)
    for token in list(task.assigned)[:copies]:
        task = with_copy(task, token, task.state[token, "position"] + rng.uniform(0.0, 1.0, 3))
    rows = np.broadcast_to(task.state.values, (*batch, len(task.state.values)))
    state = State(task.state.layout, rows + rng.normal(0.0, 1e-3, rows.shape))
    for predicate in task.domain.predicates:
        if predicate.rows is not None:
            continue
        sorts = (task.values_of(parameter.sort) for parameter in predicate.parameters)
        bindings = [values for values in product(*sorts) if different(values)]
        together = predicate.margins(state, bindings[:60])
        alone = [np.broadcast_to(predicate.evaluate(state, *values), batch) for values in bindings[:60]]
        assert together.shape == (len(alone), *batch)
        assert np.allclose(together, np.reshape(alone, together.shape), rtol=0.0, atol=1e-12), predicate.name


def test_tokens_of_equal_properties_share_one_call_unless_the_margin_asks_for_names() -> None:
    drums = rolling_task(drums=[(0, 0), (0, 1), (0, 2)], regions=[(0.7, 0)])
    calls: list[tuple[object, ...]] = []
    inside = drums.domain.predicate_by_name["inside"]

    def counted(state: State, *values: object) -> np.ndarray:
        calls.append(values)
        return inside.evaluate(state, *values)

    bindings = [(drums.token_by_name[f"drum {i}"], drums.token_by_name["region 0"]) for i in range(3)]
    together = replace(inside, margin=counted).margins(drums.state, bindings)
    assert len(calls) == 1
    assert together.tolist() == replace(inside, margin=counted, by_name=True).margins(drums.state, bindings).tolist()
    assert len(calls) == 4


@pytest.mark.parametrize("positive", [True, False])
def test_a_margin_that_is_negative_by_rounding_only_holds_for_every_user(positive: bool) -> None:
    task = rolling_task(drums=[(0, 0)], regions=[(0.7, 0)])
    drum, region = task.token_by_name["drum 0"], task.token_by_name["region 0"]
    inside = task.domain.predicate_by_name["inside"]
    for off, holds in ((ROUNDING / 2, True), (2 * ROUNDING, False)):
        margin = (-off if positive else off) * inside.scale
        off_by = replace(inside, margin=lambda state, *values, m=margin: np.full(state.values.shape[:-1], m))
        literal = Literal(off_by, ("drum 0", "region 0"), positive)
        assert (float(literal.margin(task.state, task.token_by_name)) >= 0) == holds
        assert (off_by.margins(task.state, [(drum, region)])[0] == 0) == holds
        assert (float(off_by.evaluate(task.state, drum, region)) == 0) == holds


@pytest.mark.parametrize("corner", range(32))
def test_no_corner_of_the_ranges_of_tumbling_is_refused_by_rounding(corner: int) -> None:
    task = random_tumbling(corner, rng=Corner(corner, 5))
    box = task.token_by_name["box 1"]
    for hand in task.values_of(StaticEndEffector):
        assert LOW_ENOUGH.evaluate(task.state, hand, box) >= 0

"""Predicates say what kind they are, and relations over symbols are declared by their rows."""

from itertools import product

import numpy as np
import pytest
from serial import COLOURS, Part

from hybrid_tamp.errors import DomainError
from hybrid_tamp.model.kind import Kind
from hybrid_tamp.model.predicate import Parameter, Predicate
from hybrid_tamp.model.state import State
from hybrid_tamp.taskfile.domains import find_domain

PART, OLD, NEW = Parameter("part", Part), Parameter("old", COLOURS), Parameter("new", COLOURS)
NOTHING = State.of((), {})
DOMAINS = ("rolling_tumbling", "tool_use", "joint_lifting")


def margin(state: State, *values: object) -> np.ndarray:
    return np.zeros(state.values.shape[:-1])


@pytest.mark.parametrize("kind", [Kind.CHANGING, Kind.MAINTAINED, Kind.STATIC])
def test_only_a_functional_predicate_has_a_parameter_with_one_value(kind: Kind) -> None:
    with pytest.raises(DomainError, match="says which parameter has one value"):
        Predicate("painted", (PART, NEW), margin, kind=kind, value_of="new")


def test_a_functional_predicate_names_one_of_its_parameters() -> None:
    with pytest.raises(DomainError, match="says which parameter has one value"):
        Predicate("painted", (PART, NEW), margin, kind=Kind.FUNCTIONAL)
    with pytest.raises(DomainError, match="value_of is a parameter of the predicate; got 'colour'"):
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
    with pytest.raises(DomainError, match="a symbol of each parameter's sort"):
        Predicate.relation("follows", (OLD, NEW), [row])


def test_a_static_predicate_over_symbols_is_declared_by_its_rows_and_no_other_one_is() -> None:
    with pytest.raises(DomainError, match=r"Predicate\.relation"):
        Predicate("follows", (OLD, NEW), margin, kind=Kind.STATIC)
    with pytest.raises(DomainError, match="static and over symbols alone"):
        Predicate.relation("painted", (PART, NEW), [])


@pytest.mark.parametrize("name", DOMAINS)
def test_every_bundled_predicate_says_in_words_that_it_holds_and_that_it_does_not(name: str) -> None:
    for predicate in find_domain(name).predicates:
        names = tuple(parameter.name for parameter in predicate.parameters)
        said, denied = predicate.sentence(names), predicate.sentence(names, positive=False)
        assert said != denied
        assert not denied.startswith(("not ", "it is not"))

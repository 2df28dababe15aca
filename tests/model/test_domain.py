"""A domain is checked when it is created. Messages about faults state the place and a remedy."""

from dataclasses import replace
from typing import ClassVar

import numpy as np
import pytest
from hybrid_tamp_domains.rolling_tumbling import DOMAIN
from hybrid_tamp_domains.rolling_tumbling.classes import Rollable
from hybrid_tamp_domains.rolling_tumbling.predicates import INSIDE
from random_tasks.tumbling import random_tumbling
from scenes import rolling_task

from hybrid_tamp.errors import DomainError
from hybrid_tamp.model.affordance import TOKEN, AffordanceClass, VaryingProperty, quantity
from hybrid_tamp.model.block import Block, Duration, Slot, Target
from hybrid_tamp.model.control import Hyperparameter
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.network import ReassignmentNetwork, parse_slot
from hybrid_tamp.model.predicate import ANY, Parameter, Predicate
from hybrid_tamp.skills import Region, StaticEndEffector
from hybrid_tamp.testing import check_domain

EDGES = [(".".join(source), ".".join(target)) for source, target in DOMAIN.network.edges]
ROLLING = DOMAIN.block_by_name["ROLLING"]


class Elsewhere(AffordanceClass):
    name: ClassVar[str] = "ELSEWHERE"
    varying: ClassVar[tuple[VaryingProperty, ...]] = (VaryingProperty("position", 2, "m", (0.0, 0.0)),)


def with_rolling(**changes: object) -> tuple[Block, ...]:
    return tuple(replace(b, **changes) if b is ROLLING else b for b in DOMAIN.blocks)  # type: ignore[arg-type]


class Painted(AffordanceClass):
    name: ClassVar[str] = "PAINTED"
    mass: float = quantity("g", "mass", gt=0)


FLYING = Predicate("flying", (Parameter("thing", TOKEN),), lambda state, thing: np.zeros(()))
OUTSIDER = replace(INSIDE, name="outside")

FAULTS: dict[str, tuple[dict[str, object], tuple[str, ...]]] = {
    "edge between classes that never share a token": (
        {"network": ReassignmentNetwork([*EDGES, ("REACHING:behind.hand", "ROLLING.object")])},
        ("edge REACHING:behind.hand -> ROLLING.object", "no token can be a member of both", "remove the edge"),
    ),
    "edge to a slot that is not there": (
        {"network": ReassignmentNetwork([*EDGES, ("REACHING:behind.hand", "ROLLING.hands")])},
        ("ROLLING.hands", "did you mean 'ROLLING.hand'"),
    ),
    "condition on a class that the slot does not have": (
        {"blocks": with_rolling(entry=(INSIDE("hand", "region"),))},
        ("ROLLING: inside(hand, region)", "object of inside must have class or sort ROLLABLE"),
    ),
    "condition over an unknown role": (
        {"blocks": with_rolling(entry=(INSIDE("thing", "region"),))},
        ("ROLLING: inside(thing, region)", "'thing'", "available: hand, object, region"),
    ),
    "condition with too few arguments": (
        {"blocks": with_rolling(entry=(INSIDE("object"),))},
        ("inside must have 2 arguments",),
    ),
    "predicate of another domain": (
        {"blocks": with_rolling(entry=(OUTSIDER("object", "region"),))},
        ("outside", "a condition must use a predicate of the domain"),
    ),
    "block without a way in": (
        {"network": ReassignmentNetwork([e for e in EDGES if e[1] != "ROLLING.object"])},
        ("ROLLING.object", "an edge must lead into this slot", "add an edge"),
    ),
    "block without a way out": (
        {"network": ReassignmentNetwork([e for e in EDGES if e[0] != "ROLLING.hand"])},
        ("ROLLING.hand", "an edge must lead out of this slot", "add an edge"),
    ),
    "two blocks of one name": (
        {"blocks": (*DOMAIN.blocks, ROLLING)},
        ("every block must have a unique name", "the name 'ROLLING' more than once", "rename one block"),
    ),
    "anchor that is no slot": ({"blocks": with_rolling(anchor="region")}, ("the anchor must be a slot",)),
    "place in a slot": (
        {"blocks": with_rolling(slots=(*ROLLING.slots, Slot("floor", Region)))},
        ("ROLLING.floor", "must not have a class of places, got REGION", "declare a target"),
    ),
    "slot and target of one name": (
        {"blocks": with_rolling(targets=(*ROLLING.targets, Target("hand", Rollable)))},
        ("ROLLING.hand", "must have different names"),
    ),
    "bounds in the wrong order": (
        {"blocks": with_rolling(hyperparameters=(Hyperparameter("x", "m", 2.0, 1.0, lambda b, s: np.zeros(())),))},
        ("ROLLING.x", "the lower bound must not exceed the upper bound"),
    ),
    "duration of zero": (
        {"blocks": with_rolling(duration=Duration(0.0, 1.0, lambda b, s, h: 1.0))},
        ("ROLLING", "0 < minimum <= maximum"),
    ),
    "classes in conflict": (
        {"classes": (*DOMAIN.classes, Painted)},
        ("PAINTED and ROLLABLE", "declare the same unit for property 'mass'", "disjoint=((Painted, Rollable),)"),
    ),
    "varying property in conflict": (
        {"classes": (*DOMAIN.classes, Elsewhere)},
        ("ELSEWHERE and ROLLABLE", "declare the same size for varying property 'position'", "2 in ELSEWHERE"),
    ),
    "wildcard in a positive exit condition": (
        {"blocks": with_rolling(exit=(*ROLLING.exit, INSIDE("object", ANY)))},
        ("a positive exit condition must not have wildcards",),
    ),
    "wildcard in another than the functional parameter": (
        {"blocks": with_rolling(exit=(*ROLLING.exit, ~INSIDE(ANY, "region")))},
        ("a wildcard must stand for the functional parameter", "declare the predicate as functional"),
    ),
    "negative entry condition on a changing predicate": (
        {"blocks": with_rolling(entry=(~INSIDE("object", "region"),))},
        ("a negative entry condition must use a static predicate", "with the opposite meaning"),
    ),
    "predicate that reads what is written and is not set": (
        {"blocks": with_rolling(exit=tuple(c for c in ROLLING.exit if c.predicate is not INSIDE))},
        ("ROLLING.object", "its effect on inside(object), because the block writes position", "or to 'keeps'"),
    ),
    "predicate with the name of a class": (
        {"predicates": (*DOMAIN.predicates, replace(FLYING, name="REGION"))},
        ("a predicate must not have the name of a class or sort ('REGION')", "rename the predicate"),
    ),
    "no block for what rests": ({"resting": "SLEEPING"}, ("must have the block SLEEPING",)),
}


@pytest.mark.parametrize("name", FAULTS)
def test_fault_is_refused_with_place_and_remedy(name: str) -> None:
    changes, words = FAULTS[name]
    with pytest.raises(DomainError) as caught:
        replace(DOMAIN, **changes)
    for word in words:
        assert word in str(caught.value)


def test_faults_are_all_told_at_once() -> None:
    with pytest.raises(DomainError) as caught:
        replace(DOMAIN, blocks=(*with_rolling(anchor="region"), ROLLING))
    assert len(caught.value.issues) >= 2


def test_disjoint_classes_share_no_token() -> None:
    assert not DOMAIN.relations.can_share_token(StaticEndEffector, Rollable)
    assert not DOMAIN.relations.can_share_token(Region, Rollable)
    assert DOMAIN.relations.can_share_token(Rollable, TOKEN)


def test_slot_names_are_parsed() -> None:
    assert parse_slot("A.B.c") == ("A.B", "c")
    with pytest.raises(ValueError, match=r"BLOCK\.slot"):
        parse_slot("nothing")


def test_forward_models_bring_about_what_blocks_declare() -> None:
    assert check_domain(rolling_task(), samples=2, seed=3) == []


def test_forward_models_of_tumbling_bring_about_what_blocks_declare() -> None:
    assert check_domain(random_tumbling(0), samples=1, seed=0) == []


def test_check_domain_names_a_block_that_nothing_can_enter() -> None:
    task = rolling_task(regions=[(40.0, 0.0)])
    found = check_domain(task, samples=1)
    assert {each.block for each in found} == {"REACHING:behind", "ROLLING"}
    assert all("did not hold in any state that was reached" in str(each) for each in found)


def test_check_domain_sees_a_model_that_does_not_do_what_it_says() -> None:
    lazy = replace(ROLLING, system=lambda binding, start: lambda state, commands, dt: state)
    domain: Domain = replace(DOMAIN, blocks=tuple(lazy if b is ROLLING else b for b in DOMAIN.blocks))
    found = check_domain(rolling_task().replaced(domain=domain), samples=1)
    assert {each.declared for each in found if each.kind == "exit"} == {"inside(object, region)"}

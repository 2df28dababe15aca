"""Tests of the PDDL text: the exact layout for one problem, and the verdicts of VAL."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import pytest
from planning_problems import DELIVER, DELIVERED, DELIVERY, MEETING, SETTLED, TURNED
from validation import read_action, val_accepts

from hybrid_tamp.model.plan import PlannedAction
from hybrid_tamp.symbolic.pddl.operators import Operator, PlanningDomain, PlanningProblem
from hybrid_tamp.symbolic.pddl.text import domain_text, plan_text, problem_text

DOMAIN = """\
; Names here and in the task:
;   home is 'Home'
;   box is 'BOX'
(define (domain delivery)
  (:requirements :strips :typing)
  (:types
    thing place - object
    box - thing
  )
  (:constants
    home - place
  )
  (:predicates
    (at ?box - box ?place - place)
    (road ?from - place ?to - place)
    (marked ?box - box)
    (done)
  )
  (:action move
    :parameters (?box - box ?from - place ?to - place)
    :precondition (and
      (at ?box ?from)
      (road ?from ?to)
    )
    :effect (and
      (not (at ?box ?from))
      (at ?box ?to)
    )
  )
"""

PROBLEM = """\
(define (problem deliver)
  (:domain delivery)
  (:objects
    first - box
    yard shop - place
  )
  (:init
    (at first home)
    (road home yard)
    (road yard shop)
    (road shop home)
  )
  (:goal
    (and
      (at first shop)
    )
  )
)
"""

SOLVED: list[tuple[PlanningProblem, Sequence[PlannedAction]]] = [
    (DELIVER, DELIVERED),
    (TURNED, [read_action("(turn t0 t1 t2 c0 c1 c2)")]),
    (MEETING, [read_action("(light one)"), read_action("(pass one one)"), read_action("(reset hub)")]),
    (SETTLED, [read_action("(see one)")]),
]


def test_texts_look_like_this() -> None:
    assert domain_text(DELIVERY).startswith(DOMAIN)
    assert problem_text(DELIVER) == PROBLEM
    assert plan_text(DELIVERED) == "(move first home yard)\n(move first yard shop)\n"
    assert PlannedAction("rest").text == str(PlannedAction("rest")) == "(rest)"


@pytest.mark.parametrize(("problem", "actions"), SOLVED, ids=lambda value: getattr(value, "name", ""))
def test_val_accepts_right_plans(problem: PlanningProblem, actions: Sequence[PlannedAction], tmp_path: Path) -> None:
    assert val_accepts(tmp_path, problem, actions)


def test_val_refuses_wrong_plans(tmp_path: Path) -> None:
    assert not val_accepts(tmp_path, DELIVER, DELIVERED[1:])
    assert not val_accepts(tmp_path, DELIVER, DELIVERED[:1])


def test_a_name_cannot_end_its_comment(tmp_path: Path) -> None:
    named = (("home", "Home)\n(:action free"), ("yard", 'Hof "Süd"; ☃'), ("shop", "shop"))
    problem = replace(DELIVER, domain=replace(DELIVERY, comments=named), comments=named)
    for text in (domain_text(problem.domain), problem_text(problem)):
        assert text.splitlines()[1:3] == [r";   home is 'Home)\n(:action free'", """;   yard is 'Hof "Süd"; ☃'"""]
        assert "shop is" not in text
    assert val_accepts(tmp_path, problem, DELIVERED)


def test_empty_parts_are_still_pddl(tmp_path: Path) -> None:
    rest = Operator("rest", (), (), (("rested",),), ())
    idle = Operator("idle", (), (), (), ())
    domain = PlanningDomain("empty", (), (), (("rested", ()),), (rest, idle))
    problem = PlanningProblem("empty", domain, (), (), (("rested",),))
    assert val_accepts(tmp_path, problem, [PlannedAction("idle"), PlannedAction("rest")])


def test_what_is_added_back_is_not_deleted() -> None:
    kept = Operator("keep", (("?b", "box"),), (), (("marked", "?b"),), (("marked", "?b"), ("done",)))
    text = domain_text(replace(DELIVERY, operators=(kept,)))
    assert "(not (marked ?b))" not in text
    assert "(not (done))" in text

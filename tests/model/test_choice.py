"""Tests of goals with a choice: the ground goals, their order, and when the goal holds."""

import numpy as np
import pytest
from scenes import rolling_task
from serial import COLOURS, Part, Tool, block, changing, domain, in_series, task

from hybrid_tamp.errors import InputError
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.law import check_law
from hybrid_tamp.model.plan import BlockInstance, TaskPlan
from hybrid_tamp.model.predicate import ANY, Atom, Predicate
from hybrid_tamp.model.task import Task

SOME = Atom("inside", ("drum 0", ANY))


def some_region(*regions: tuple[float, float]) -> Task:
    return rolling_task(regions=regions).replaced(goal=(SOME,))


def resting(task: Task) -> TaskPlan:
    """Return the plan in which all tokens rest."""
    instances = [BlockInstance(f"R-{t.name}", "RESTING", {"token": t.name}, 0.0, 1.0) for t in task.assigned]
    return TaskPlan(tuple(instances), 1.0)


def speaking_of(*predicates: Predicate) -> Domain:
    """Return a domain with these predicates and a block that does nothing."""
    wait = block("WAITING", {"part": Part})
    return domain([wait], predicates, in_series([wait]))


def law_seven(task: Task, measured: bool) -> list[str]:
    found = check_law(task, resting(task), (lambda time: task.state) if measured else None)
    return [str(each) for each in found if each.law == 7]


def test_the_nearest_alternative_comes_first() -> None:
    chosen = [each.goal[0].arguments[1] for each in some_region((1.0, 0), (0.5, 0.1), (-0.8, 0)).alternatives()]
    assert chosen == ["region 1", "region 2", "region 0"]


def test_the_margin_is_that_of_the_best_choice() -> None:
    task = some_region((1.0, 0), (0.5, 0.1))
    assert task.margin(SOME) == task.margin(Atom("inside", ("drum 0", "region 1")))
    assert task.margin(Atom(SOME.predicate, SOME.arguments, positive=False)) == -task.margin(SOME)
    assert rolling_task(regions=[]).margin(SOME) == -np.inf


def test_a_goal_without_a_choice_is_its_own_alternative() -> None:
    task = rolling_task()
    assert task.alternatives() == (task,)


def test_tokens_of_an_atom_are_different_and_of_its_class() -> None:
    given = task(speaking_of(changing("beside", Part, Part), changing("made", Part, Tool)), [], parts=3, tools=1)
    assert [atom.arguments for atom in given.groundings(Atom("beside", ("part 1", ANY)))] == [
        ("part 1", "part 0"),
        ("part 1", "part 2"),
    ]
    assert len(given.groundings(Atom("beside", (ANY, ANY)))) == 6
    assert [atom.arguments[1] for atom in given.groundings(Atom("made", ("part 0", ANY)))] == ["tool 0"]


def test_a_symbol_may_be_left_open() -> None:
    assert len(
        task(speaking_of(changing("painted", Part, COLOURS)), [("painted", "part 0", ANY)]).alternatives()
    ) == len(COLOURS.symbols)


def test_contradictions_are_left_out_and_what_is_said_twice_counts_once() -> None:
    given = rolling_task(regions=[(0.7, 0), (1.0, 0)])
    region = Atom("inside", ("drum 0", "region 1"))
    (only,) = given.replaced(goal=(SOME, region)).alternatives()
    assert only.goal == (region,)


def test_two_choices_are_made_independently() -> None:
    given = rolling_task(drums=[(0, 0), (0, 0.5)], regions=[(0.7, 0), (0.8, 0.5)])
    goals = [each.goal for each in given.replaced(goal=(SOME, Atom("inside", ("drum 1", ANY)))).alternatives()]
    assert len(goals) == 4
    assert [atom.arguments[1] for atom in goals[0]] == ["region 0", "region 1"]


def test_nothing_to_choose_from_and_too_much_are_refused() -> None:
    with pytest.raises(InputError, match="all goal atoms must be true at the same time"):
        rolling_task(regions=[]).replaced(goal=(SOME,)).alternatives()
    atoms = tuple(Atom("inside", (f"drum {number}", ANY)) for number in range(11))
    many = rolling_task(drums=[(0.0, 0.4 * number) for number in range(11)], regions=[(1, 0), (2, 0)])
    with pytest.raises(InputError, match="at most 1000 combinations of choices; got 2048"):
        many.replaced(goal=atoms).alternatives()


@pytest.mark.parametrize("measured", [False, True])
def test_the_law_asks_for_some_region(measured: bool) -> None:
    assert law_seven(some_region((1.0, 0.0), (0.0, 0.0)), measured) == []
    (said,) = law_seven(some_region((1.0, 0.0), (0.5, 0.0)), measured)
    assert "inside(drum 0, *)" in said


@pytest.mark.parametrize("measured", [False, True])
def test_the_law_denies_every_region_where_a_choice_is_denied(measured: bool) -> None:
    none = Atom(SOME.predicate, SOME.arguments, positive=False)
    assert law_seven(some_region((1.0, 0.0), (0.5, 0.0)).replaced(goal=(none,)), measured) == []
    assert law_seven(some_region((1.0, 0.0), (0.0, 0.0)).replaced(goal=(none,)), measured) != []

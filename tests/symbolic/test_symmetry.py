"""Names, order and unrelated tokens do not change the length of an optimal plan or the status.

Optimal engines plan the whole task, here with three drums or one box. Tasks with two boxes take optimal engines about
10 s, and tasks with three boxes take far longer. These tasks are planned by the engine that plans goals separately.
"""

import string
from collections.abc import Sequence

import numpy as np
import pytest
from hybrid_tamp_domains.rolling_tumbling.classes import Rollable
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from random_tasks.tumbling import random_tumbling
from scenes import DRUM, LYING, rolling_task

from hybrid_tamp.geometry.shapes import Cylinder
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.skills import Region
from hybrid_tamp.symbolic.engines.planner_process import PlannerProcess
from hybrid_tamp.symbolic.find_plan import find_plan
from hybrid_tamp.symbolic.strategies.search import SearchResult

FEW = settings(max_examples=3, deadline=None, suppress_health_check=list(HealthCheck))
NAMES = st.text(string.ascii_letters + string.digits + " _-ä", min_size=1, max_size=8)
ROWS = [(0.0, 0.6 * row) for row in range(3)]
REGIONS = [(0.7, 0.6 * row) for row in range(3)]
DRUMS = rolling_task(2, ROWS, REGIONS, [(0, 0), (1, 1), (2, 2)])
BOX = random_tumbling(7, 2, 1)
TASKS = {"three drums": DRUMS, "three boxes": random_tumbling(7, 6, 3), "one hand": random_tumbling(7, 1, 1)}


def other_form(task: Task, names: Sequence[str], order: Sequence[int], bystander: str) -> Task:
    """Return the task with renamed and reordered tokens, and with an unrelated token."""
    extra = Token.make("bystander", [Region], {"radius": 0.05})
    if bystander == "drum":
        extra = Token.make("bystander", [Rollable], DRUM, Cylinder(kind="cylinder", radius=0.1, length=0.3))
    given = {(token.name, v.name): task.state[token, v.name] for token in task.tokens for v in token.varying}
    tokens = [*task.tokens, *([extra] if bystander else [])]
    if bystander:
        given["bystander", "position"] = np.array([-1.2, 9.0, 0.1])
    if bystander == "drum":
        given["bystander", "orientation"] = np.array(LYING)
    new = dict(zip((token.name for token in tokens), names, strict=False))
    renamed = [Token(new[token.name], token.classes, token.properties, token.shape) for token in tokens]
    shuffled = tuple(renamed[index] for index in order if index < len(renamed))
    state = State.of(shuffled, {(new[name], prop): value for (name, prop), value in given.items()})
    goal = tuple(Atom(atom.predicate, tuple(new.get(name, name) for name in atom.arguments)) for atom in task.goal)
    return task.replaced(tokens=shuffled, state=state, goal=goal, agents={})


FORMS = st.tuples(
    st.lists(NAMES, min_size=10, max_size=10, unique_by=str.casefold),
    st.permutations(range(10)),
    st.sampled_from(["", "region", "drum"]),
)


def planned(task: Task, engine: str) -> SearchResult:
    with PlannerProcess() as planner:
        return find_plan(task.replaced(planner=engine), planner)


@FEW
@given(FORMS)
def test_an_optimal_plan_of_three_drums_stays_as_long(form: tuple[Sequence[str], Sequence[int], str]) -> None:
    assert len(planned(other_form(DRUMS, *form), "fast-downward-opt").answer.actions) == 13


@FEW
@given(FORMS)
def test_an_optimal_plan_of_a_box_stays_as_long(form: tuple[Sequence[str], Sequence[int], str]) -> None:
    assert len(planned(other_form(BOX, *form), "symk-opt").answer.actions) == 17


@pytest.mark.parametrize("name", TASKS)
def test_the_default_engine_gives_the_same_status(name: str) -> None:
    status = "unsolvable" if name == "one hand" else "solved"

    @FEW
    @given(FORMS)
    def check(form: tuple[Sequence[str], Sequence[int], str]) -> None:
        assert planned(other_form(TASKS[name], *form), "fast-downward").status == status

    check()

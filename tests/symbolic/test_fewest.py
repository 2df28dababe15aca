"""The number of actions in a plan: counted searches for shorter plans, proofs, and stored optima."""

import json
import re
import subprocess
import sys
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from planning_problems import DELIVER
from random_tasks.several import several_task
from random_tasks.small_tools import hammer_scene
from scenes import rolling_task

import hybrid_tamp
from hybrid_tamp.model.outcome import PlannerFigures, PlanOutcome
from hybrid_tamp.model.plan import Fewest
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.task import Task
from hybrid_tamp.planning.plan import plan_task
from hybrid_tamp.report.documents import document
from hybrid_tamp.report.tables import plan_footer
from hybrid_tamp.symbolic.encoding.problem import compile_task
from hybrid_tamp.symbolic.engines.counted_search import MOST_EVALUATED, SEARCH, follow_log, make_command
from hybrid_tamp.symbolic.engines.planner_process import PlannerProcess
from hybrid_tamp.symbolic.pddl.text import domain_text, problem_text
from hybrid_tamp.symbolic.strategies import fewest as strategy

FOUND = "Solution found!"
NONE_SHORTER = "[t=0.1s, 10548 KB] Search terminated -- no plan with cost 14 or less exists!"
STORED = json.loads((Path(__file__).parent / "fewest.json").read_text(encoding="utf-8"))
IN_SUITE = (
    *("20001", "20003", "20004", "20005", "20006", "20008", "20009", "20010", "20011", "20013", "20015"),
    *("20016", "20017", "20018", "20019", "20020", "20021", "20025", "20029", "20033", "20037", "20041"),
)
"""Seeds of stored optima that are compared in 37 s. ``scripts/fewest`` compares with all stored optima in 100 s."""


def layer(evaluated: int) -> str:
    return f"[t=0.05s, 10676 KB] f = 9, {evaluated} evaluated, 70 expanded"


def planned(task: Task) -> PlanOutcome:
    with PlannerProcess() as planner:
        return plan_task(task, planner)


def two_blocks() -> Task:
    blocks = {"block": (np.zeros(2), 0.0), "other": (np.array([0.0, 0.4]), 0.0)}
    goal = [Atom("inside", ("block", "goal")), Atom("inside", ("other", "goal 2"))]
    goal += [Atom("struck", ("block",)), Atom("struck", ("other",))]
    return hammer_scene("two_blocks", 0, blocks, {"goal": (0.4, 0.0), "goal 2": (0.4, 0.4)}, goal, rack=(-0.35, 0.0))


@pytest.mark.parametrize(
    ("lines", "plans", "proven"),
    [
        ((layer(MOST_EVALUATED + 1), FOUND, layer(MOST_EVALUATED), FOUND), 2, True),
        ((FOUND, layer(MOST_EVALUATED + 1), FOUND), 1, False),
        ((FOUND, layer(MOST_EVALUATED + 1), NONE_SHORTER), 1, False),
        ((FOUND, layer(7), NONE_SHORTER), 1, True),
        ((FOUND,), 1, False),
        ((), 0, False),
    ],
)
def test_the_search_ends_by_its_count(lines: tuple[str, ...], plans: int, proven: bool) -> None:
    """What follows the end of the count is ignored, even if the process has written it already."""
    text = "".join(f"{line}\n" for line in lines)
    script = f"import sys; sys.stdout.write({text!r})"
    command = [sys.executable, "-c", script]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, start_new_session=True) as process:
        assert follow_log(process) == (plans, proven)


@pytest.mark.parametrize(
    ("engine", "known"),
    [
        ("fast-downward", "proven fewest"),
        ("fast-downward-first", "first found"),
        ("fast-downward-opt", "proven fewest"),
        ("symk-opt", "proven fewest"),
        ("symk", "first found"),
        ("fake_engines:Right", "first found"),
    ],
)
def test_engines_know_what_they_prove(engine: str, known: Fewest) -> None:
    with PlannerProcess() as planner:
        assert planner.solve(DELIVER, engine, rolling_task().limits).fewest == known


def test_the_empty_plan_has_the_fewest_actions() -> None:
    with PlannerProcess() as planner:
        answer = planner.solve(
            replace(DELIVER, goal=(("at", "first", "home"),)), "fast-downward", rolling_task().limits
        )
    assert (answer.status, answer.actions, answer.fewest) == ("solved", (), "proven fewest")


def test_a_tool_is_not_put_down_and_taken_up_again() -> None:
    outcome = planned(two_blocks())
    assert (len(outcome.required().actions), outcome.planner.fewest) == (33, "proven fewest")
    text = document(outcome)
    assert text["planner"]["fewest"] == "proven fewest"
    assert plan_footer(text).startswith("33 actions (proven fewest), ")
    first = planned(two_blocks().replaced(planner="fast-downward-first"))
    assert first.planner.fewest == "first found"


def test_a_plan_is_the_same_again() -> None:
    assert planned(two_blocks()).plan == planned(two_blocks()).plan


def test_nothing_is_said_about_actions_where_the_makespan_is_minimised() -> None:
    outcome = planned(rolling_task().replaced(objective="makespan"))
    assert outcome.planner.fewest is None
    assert "actions, " in plan_footer(document(outcome))


def test_a_tool_outside_the_network_may_allow_a_shorter_plan() -> None:
    task = hybrid_tamp.load_task("problems/tool_choice.yaml")
    assert planned(task).planner.fewest == "no shorter one found"


def test_a_proof_with_the_facts_of_the_initial_state_is_no_proof(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without the second problem, a plan with facts that become true after movements may be shorter."""
    monkeypatch.setattr(strategy, "MOST_FACTS", 0)
    assert planned(two_blocks()).planner.fewest == "no shorter one found"


def test_a_proof_without_excluded_bindings_is_no_proof() -> None:
    figures = PlannerFigures("fast-downward", 0.0, fewest="proven fewest")
    assert figures.unproven == replace(figures, fewest="no shorter one found")
    assert replace(figures, fewest="first found").unproven.fewest == "first found"
    outcome = hybrid_tamp.plan(hybrid_tamp.load_task("problems/roll_second_round.yaml"), optimise=True)
    assert outcome.excluded
    assert outcome.planner.fewest == "no shorter one found"


def test_the_search_expands_at_most_as_many_states_as_it_may_evaluate(tmp_path: Path) -> None:
    """A length takes as many expansions as states were evaluated before, so the limit also bounds the last length."""
    problem = compile_task(two_blocks()).problem
    domain_file, problem_file = tmp_path / "domain.pddl", tmp_path / "problem.pddl"
    domain_file.write_text(domain_text(problem.domain), encoding="utf-8")
    problem_file.write_text(problem_text(problem), encoding="utf-8")
    command = [*make_command(str(tmp_path / "plan")), str(domain_file), str(problem_file), "--search", SEARCH]
    log = subprocess.run(command, capture_output=True, text=True, check=True, cwd=tmp_path).stdout
    second = log.split(FOUND)[1]
    counts = [tuple(map(int, each)) for each in re.findall(r"f = \d+, (\d+) evaluated, (\d+) expanded", second)]
    assert len(counts) == 33
    assert all(expanded <= evaluated for (evaluated, _), (_, expanded) in pairwise(counts))


@pytest.mark.parametrize("name", sorted(STORED["bundled"]))
def test_bundled_tasks_are_planned_within_a_tenth_of_the_fewest_actions(name: str) -> None:
    """All of these plans together take 20 s. No plan is optimised or run."""
    task = hybrid_tamp.load_task(f"problems/{name}.yaml")
    assert len(planned(task).required().actions) <= 1.1 * STORED["bundled"][name]


@pytest.mark.parametrize("seed", IN_SUITE)
def test_random_tasks_are_planned_within_a_tenth_of_the_fewest_actions(seed: str) -> None:
    assert len(planned(several_task(int(seed))).required().actions) <= 1.1 * STORED["random"][seed]


def test_enough_optima_are_stored() -> None:
    assert len(STORED["random"]) >= 30
    assert len(STORED["bundled"]) >= 17
    assert set(IN_SUITE) <= set(STORED["random"])

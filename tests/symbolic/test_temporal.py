"""Tests of the temporal encoding and export, with one durative action per block."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from random_tasks.tumbling import random_tumbling
from scenes import rolling_task
from validation import val_accepts_temporal

from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.model.task import Task
from hybrid_tamp.symbolic.decode import decode
from hybrid_tamp.symbolic.encoding.problem import compile_task
from hybrid_tamp.symbolic.engines.planner_process import PlannerProcess
from hybrid_tamp.symbolic.pddl.temporal_text import temporal_domain_text
from hybrid_tamp.symbolic.schedule import schedule
from hybrid_tamp.symbolic.temporal.compilation import compile_durative
from hybrid_tamp.symbolic.temporal.grounding import reachable
from hybrid_tamp.symbolic.temporal.reencoding import reencode_durative
from hybrid_tamp.taskfile.loader import load_task

TWO_DRUMS = rolling_task(hands=2, drums=[(0, 0), (0, 0.5)], regions=[(0.7, 0), (0.7, 0.5)], goal=[(0, 0), (1, 1)])


@pytest.fixture(scope="module")
def tumble() -> tuple[Task, TaskPlan]:
    task = random_tumbling(3)
    compilation = compile_task(task)
    with PlannerProcess() as planner:
        actions = planner.solve(compilation.problem, task.planner, task.limits).actions
    return task, schedule(task, decode(compilation, actions))


def test_a_block_is_one_action_unless_tokens_may_come_along_or_not() -> None:
    running = compile_durative(TWO_DRUMS).encoding.running
    runs = sorted((run.block, sorted(run.along)) for run in running.values())
    assert runs == [
        ("REACHING:away", []),
        ("REACHING:behind", []),
        ("REACHING:beside", []),
        ("RESTING", []),
        ("ROLLING", []),
        ("TILTING", ["hand"]),
        ("TIPPING:adjacent", ["second"]),
        ("TIPPING:lower", []),
        ("TIPPING:lower", ["first"]),
        ("TIPPING:opposite", []),
        ("WITHDRAWING", []),
    ]


def test_the_temporal_domain_does_not_depend_on_the_tokens() -> None:
    one, many = compile_durative(rolling_task()), compile_durative(TWO_DRUMS)
    assert temporal_domain_text(one.problem.domain) == temporal_domain_text(many.problem.domain)
    assert ":requirements :strips :typing :fluents :durative-actions" in temporal_domain_text(one.problem.domain)


def test_runs_whose_states_contradict_their_conditions_last_as_long_as_other_runs() -> None:
    runs = [run for run in reachable(load_task("tumble_two_hands")) if run.block.startswith(("REACHING:b", "TIPPING"))]
    turns = {run.seconds for run in runs if run.block == "TIPPING:lower"}
    assert min(run.seconds for run in runs) > 0.7
    assert 1.7 < min(turns) < max(turns) < 2.3


def test_invariants_hold_over_all_of_an_action() -> None:
    text = temporal_domain_text(compile_durative(TWO_DRUMS).problem.domain)
    rolling = text[text.index("(:durative-action run-rolling") :].split("(:durative-action")[1]
    assert "(over all (in_workspace ?hand))" in rolling


def test_the_temporal_problem_does_not_depend_on_the_order_of_sets() -> None:
    """Hash values of strings differ between processes in Python."""
    code = (
        "from random_tasks.tumbling import random_tumbling;"
        "from hybrid_tamp.symbolic.temporal.compilation import compile_durative;"
        "from hybrid_tamp.symbolic.pddl.temporal_text import temporal_problem_text;"
        "print(temporal_problem_text(compile_durative(random_tumbling(3)).problem))"
    )
    texts = {
        subprocess.run(
            [sys.executable, "-c", code],
            capture_output=True,
            text=True,
            check=True,
            env={**os.environ, "PYTHONHASHSEED": seed, "PYTHONPATH": str(Path(__file__).parents[1])},
            timeout=60,
        ).stdout
        for seed in "123"
    }
    assert len(texts) == 1


def test_a_timeline_comes_back_from_durative_actions(tumble: tuple[Task, TaskPlan], tmp_path: Path) -> None:
    task, plan = tumble
    compilation = compile_durative(task)
    problem, actions = reencode_durative(compilation, plan)
    assert val_accepts_temporal(tmp_path, problem, actions)
    left = [i for i in plan.instances if i.start > 0 or len(i.slots) > 1]
    assert len(actions) == len(left)
    for number, action in enumerate(actions, start=1):
        running = compilation.encoding.running[action.name]
        roles = {role: action.arguments[index] for role, index in running.roles.items()}
        [instance] = [
            i
            for i in left
            if i.block == running.block
            and roles == {role: compilation.words.name(name) for role, name in i.roles.items()}
            # Actions of one instant start 0.01 s apart, in the order of the plan.
            and action.start == pytest.approx(i.start + 0.01 * number, abs=1e-6)
        ]
        assert action.duration == pytest.approx(instance.active.end - instance.start, abs=1e-3)
        left.remove(instance)
    assert left == []


@pytest.mark.parametrize("index", range(6))
def test_val_refuses_a_plan_that_lacks_an_action(index: int, tumble: tuple[Task, TaskPlan], tmp_path: Path) -> None:
    problem, actions = reencode_durative(compile_durative(tumble[0]), tumble[1])
    assert not val_accepts_temporal(tmp_path, problem, [*actions[:index], *actions[index + 1 :]])

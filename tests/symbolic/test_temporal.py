"""One durative action a block: encoded, exported, decoded, and arranged by Aries."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from random_tasks.tumbling import random_tumbling
from scenes import reach_and_roll, rolling_task
from validation import val_accepts_temporal

from hybrid_tamp.model.law import check_law
from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.model.task import Task
from hybrid_tamp.symbolic.decode import UndecodableError, decode
from hybrid_tamp.symbolic.encoding.application import applicable
from hybrid_tamp.symbolic.encoding.problem import compile_task
from hybrid_tamp.symbolic.engines.planner_process import PlannerProcess
from hybrid_tamp.symbolic.pddl.operators import PlannedAction
from hybrid_tamp.symbolic.pddl.temporal_text import temporal_domain_text
from hybrid_tamp.symbolic.schedule import schedule
from hybrid_tamp.symbolic.temporal.arranging import Durative
from hybrid_tamp.symbolic.temporal.compilation import TemporalCompilation, compile_durative
from hybrid_tamp.symbolic.temporal.decoder import decode_durative
from hybrid_tamp.symbolic.temporal.problem import TimedAction
from hybrid_tamp.symbolic.temporal.reencoding import reencode_durative
from hybrid_tamp.symbolic.temporal.sketch import frame, sketch

TWO_DRUMS = rolling_task(hands=2, drums=[(0, 0), (0, 0.5)], regions=[(0.7, 0), (0.7, 0.5)], goal=[(0, 0), (1, 1)])
ONE_HAND = reach_and_roll("hand-0", "drum-0", "region-0") + reach_and_roll("hand-0", "drum-1", "region-1")


def scheduled(task: Task, actions: list[PlannedAction]) -> TaskPlan:
    return schedule(task, decode(compile_task(task), actions))


@pytest.fixture(scope="module")
def tumble() -> tuple[Task, TaskPlan]:
    task = random_tumbling(3)
    compilation = compile_task(task)
    with PlannerProcess() as planner:
        actions = planner.solve(compilation.problem, task.planner, task.limits).actions
    return task, schedule(task, decode(compilation, actions))


def again(compilation: TemporalCompilation, plan: TaskPlan) -> TaskPlan:
    """Return the plan after a round through durative actions."""
    _, actions = reencode_durative(compilation, plan)
    return schedule(compilation.task, decode_durative(compilation, actions))


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
    ]


def test_the_temporal_domain_does_not_depend_on_the_tokens() -> None:
    one, many = compile_durative(rolling_task()), compile_durative(TWO_DRUMS)
    assert temporal_domain_text(one.problem.domain) == temporal_domain_text(many.problem.domain)
    assert ":requirements :strips :typing :fluents :durative-actions" in temporal_domain_text(one.problem.domain)


def test_the_temporal_problem_does_not_depend_on_the_order_of_sets() -> None:
    """Python gives strings other hashes in every process."""
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
            env={**os.environ, "PYTHONHASHSEED": seed},
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
    back = again(compilation, plan)
    assert check_law(task, back) == []
    assert back.makespan == plan.makespan
    spans = {(i.block, tuple(i.roles.items()), i.start, i.end) for i in plan.instances}
    assert spans == {(i.block, tuple(i.roles.items()), i.start, i.end) for i in back.instances}


@pytest.mark.parametrize("index", range(6))
def test_val_refuses_a_plan_that_lacks_an_action(index: int, tumble: tuple[Task, TaskPlan], tmp_path: Path) -> None:
    problem, actions = reencode_durative(compile_durative(tumble[0]), tumble[1])
    assert not val_accepts_temporal(tmp_path, problem, [*actions[:index], *actions[index + 1 :]])


def test_tokens_that_leave_a_little_late_leave_with_the_anchor(tumble: tuple[Task, TaskPlan]) -> None:
    task, plan = tumble
    compilation = compile_durative(task)
    _, actions = reencode_durative(compilation, plan)
    tilts = [action for action in actions if action.name.startswith("run-tilting")]
    after = next(a for a in actions if a.start > tilts[0].start)
    late = [TimedAction(a.start + 0.05, a.name, a.arguments, a.duration) if a is after else a for a in actions]
    found = schedule(task, decode_durative(compilation, late))
    assert check_law(task, found) == []
    assert found.makespan == plan.makespan


def test_what_cannot_be_a_plan_is_refused(tumble: tuple[Task, TaskPlan]) -> None:
    compilation = compile_durative(tumble[0])
    _, actions = reencode_durative(compilation, tumble[1])
    with pytest.raises(UndecodableError, match="no action run-nothing"):
        decode_durative(compilation, [TimedAction(0.1, "run-nothing", (), 1.0)])
    first_tilt = next(i for i, action in enumerate(actions) if action.name.startswith("run-tilting"))
    with pytest.raises(UndecodableError, match="stays in TIPPING:opposite, which has ended"):
        decode_durative(compilation, actions[: first_tilt + 1])


def test_a_sketch_leaves_interchangeable_tokens_open() -> None:
    compilation = compile_durative(TWO_DRUMS)
    steps = sketch(compilation, scheduled(TWO_DRUMS, ONE_HAND))
    rolls = [step for step in steps if step.action == "run-rolling"]
    assert [dict(step.fixed) for step in rolls] == [{1: "drum-0", 2: "region-0"}, {1: "drum-1", 2: "region-1"}]
    assert len(frame(compilation, scheduled(TWO_DRUMS, ONE_HAND), more=0)) == len(steps)


def test_aries_has_both_hands_roll_at_once() -> None:
    plan, classical = scheduled(TWO_DRUMS, ONE_HAND), compile_task(TWO_DRUMS)
    shorter = next(Durative(TWO_DRUMS, classical).shorter(plan, 20.0))
    assert shorter.makespan < 0.6 * plan.makespan
    assert check_law(TWO_DRUMS, shorter) == []
    told = [tuple(line.strip("()").split()) for line in shorter.actions]
    assert applicable(classical, told)


def test_without_time_aries_is_not_asked() -> None:
    plan = scheduled(TWO_DRUMS, ONE_HAND)
    assert list(Durative(TWO_DRUMS, compile_task(TWO_DRUMS)).shorter(plan, 0.5)) == []

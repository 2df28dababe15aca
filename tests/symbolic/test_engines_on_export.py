"""Five engines solve the exported files with an independent reader, and VAL checks each plan."""

import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest
from hybrid_tamp_domains.rolling_tumbling import DOMAIN
from hybrid_tamp_domains.rolling_tumbling.classes import Tumblable
from scenes import rolling_task
from validation import val_accepts, val_accepts_files

import hybrid_tamp
from hybrid_tamp.model.law import check_law
from hybrid_tamp.model.network import ReassignmentNetwork
from hybrid_tamp.model.task import Limits, Task
from hybrid_tamp.planning.plan import plan_task
from hybrid_tamp.report.folder import RunFolder
from hybrid_tamp.skills import find_predicates
from hybrid_tamp.symbolic.encoding.problem import compile_task
from hybrid_tamp.symbolic.engines.planner_process import PlannerProcess
from hybrid_tamp.symbolic.engines.registry import with_java
from hybrid_tamp.taskfile.loader import load_task
from hybrid_tamp.verbs.pddl import export

ROOT = Path(__file__).resolve().parents[2]
_BLOCKS = tuple(block for block in DOMAIN.blocks if block.name in ("REACHING:behind", "ROLLING", "RESTING"))
_SLOTS = {(block.name, slot.name) for block in _BLOCKS for slot in block.slots}
ROLLING_ONLY = replace(
    DOMAIN,
    classes=tuple(c for c in DOMAIN.classes if c is not Tumblable),
    disjoint=DOMAIN.disjoint[:1],
    predicates=find_predicates(_BLOCKS),
    blocks=_BLOCKS,
    network=ReassignmentNetwork(
        (".".join(one), ".".join(other)) for one, other in DOMAIN.network.edges if {one, other} <= _SLOTS
    ),
)
ENGINES = ["fast-downward", "symk", "enhsp", "pyperplan", "aries"]


@pytest.mark.parametrize("engine", ENGINES)
def test_engine_solves_the_task(engine: str, tmp_path: Path) -> None:
    task = rolling_task(hands=2, drums=[(0, 0), (0, 0.5)], regions=[(0.7, 0), (0.7, 0.5)], goal=[(0, 0)])
    task = task.replaced(planner=engine, limits=Limits(time=60.0))
    outcome = hybrid_tamp.plan(task)
    plan = outcome.required()
    assert outcome.planner.name == engine
    assert check_law(task, plan) == []
    assert val_accepts(tmp_path, compile_task(task).problem, plan.actions)


@pytest.mark.parametrize("engine", ["fast-downward", "symk", "enhsp", "pyperplan"])
def test_engine_proves_that_there_is_no_plan(engine: str) -> None:
    task = rolling_task(regions=[(0.7, 0.3)]).replaced(planner=engine, limits=Limits(time=60.0))
    outcome = hybrid_tamp.plan(task)
    assert outcome.status == "unsolvable"
    assert outcome.error is not None
    assert outcome.error.exit_status == 10


def test_optimal_engines_need_no_more_actions_than_the_default() -> None:
    task = rolling_task(hands=2)
    with PlannerProcess() as planner:
        fast = plan_task(task, planner)
    best = hybrid_tamp.plan(task.replaced(planner="fast-downward-opt"))
    assert best.cost == 5
    assert fast.cost is not None
    assert fast.cost >= best.cost


@pytest.mark.parametrize("engine", ENGINES)
def test_engine_solves_the_exported_files_as_they_are(engine: str, tmp_path: Path) -> None:
    """Solve with the command line of unified-planning, which is independent of this project.

    The test uses a part of the domain, for which each engine is fast. The next test uses the whole domain.
    """
    task = rolling_task(hands=2)
    _solve_export(task.replaced(domain=ROLLING_ONLY), engine, tmp_path)


def test_an_engine_solves_the_export_of_the_whole_domain(tmp_path: Path) -> None:
    _solve_export(load_task(ROOT / "problems" / "roll_cylinder.yaml"), "pyperplan", tmp_path)


def _solve_export(task: Task, engine: str, tmp_path: Path) -> None:
    export(task, RunFolder.create(tmp_path))
    files = [str(tmp_path / name) for name in ("domain.pddl", "problem.pddl")]
    words = ["oneshot-planning", "--pddl", *files, "--engine", engine, "--plan", str(tmp_path / "plan.pddl")]
    done = subprocess.run(
        [sys.executable, "-c", "from unified_planning.cmd.up import main; main()", *words],
        capture_output=True,
        text=True,
        check=False,
        timeout=120,
        env=with_java(os.environ),
        cwd=tmp_path,
    )
    assert "SOLVED" in done.stdout, done.stdout + done.stderr
    # The writer of unified-planning renames names that resemble keywords of PDDL. The exported files keep these names.
    plan = tmp_path / "plan.pddl"
    plan.write_text(plan.read_text().replace(" goal_ ", " goal ").replace(" goal_)", " goal)"))
    assert val_accepts_files(tmp_path)

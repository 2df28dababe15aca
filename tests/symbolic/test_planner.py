"""Tests of the planner's process: the answers of the engines, and that no process and no file remains."""

import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import psutil
import pytest
from planning_problems import DELIVER, DELIVERED, EXCLUSIVE, MEETING, ODD, SETTLED, UNREACHABLE
from validation import val_accepts

from hybrid_tamp.errors import InputError, LimitReached
from hybrid_tamp.model.task import Limits
from hybrid_tamp.symbolic.engines import registry as engines
from hybrid_tamp.symbolic.engines.planner_process import PlannerAnswer, PlannerProcess
from hybrid_tamp.symbolic.engines.registry import check_engine, known_engines
from hybrid_tamp.symbolic.pddl.operators import PlanningProblem

FIVE = ["fast-downward", "symk", "enhsp", "pyperplan", "aries"]
AMPLE = Limits(time=120.0, memory=6000.0)


@pytest.fixture(autouse=True)
def left(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """Check that no process and no file remains. Fake engines write the file when they leave a process behind."""
    temporary, left = tmp_path / "temporary", tmp_path / "left"
    temporary.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(temporary))
    monkeypatch.setenv("LEFT", str(left))
    # Other tests may have left idle processes, e.g. the processes of joblib.
    before = psutil.Process().children(recursive=True)
    yield left
    assert set(psutil.Process().children(recursive=True)) <= set(before)
    assert processes_of(left) == []
    assert list(temporary.iterdir()) == []


def processes_of(left: Path) -> list[psutil.Process]:
    """Return all processes that the fake engines of one test and their planner started."""
    found = []
    for process in psutil.process_iter():
        try:
            if process.environ().get("LEFT") == str(left) and process.pid != os.getpid():
                found.append(process)
        except psutil.Error:
            continue
    return found


def solve(engine: str, problem: PlanningProblem = DELIVER, limits: Limits = AMPLE) -> PlannerAnswer:
    with PlannerProcess() as planner:
        return planner.solve(problem, engine, limits)


def wait_for(condition: Callable[[], bool]) -> None:
    deadline = time.monotonic() + 30
    while not condition():
        assert time.monotonic() < deadline
        time.sleep(0.01)


def cases(engines: list[str], *problems: PlanningProblem) -> list[object]:
    return [pytest.param(engine, each, id=f"{engine}-{each.name}") for engine in engines for each in problems]


@pytest.mark.parametrize(("engine", "problem"), cases(FIVE, DELIVER) + cases(["enhsp", "aries"], MEETING, SETTLED))
def test_five_engines_find_plans(engine: str, problem: PlanningProblem, tmp_path: Path) -> None:
    answer = solve(engine, problem)
    assert (answer.status, answer.engine, answer.validated) == ("solved", engine, True)
    assert 0 < answer.seconds < AMPLE.time
    assert val_accepts(tmp_path, problem, answer.actions)


@pytest.mark.parametrize("engine", ["fast-downward-opt", "symk-opt", "enhsp-opt", "pyperplan-opt"])
def test_optimal_engines_find_plans(engine: str) -> None:
    assert solve(engine).actions == DELIVERED


@pytest.mark.parametrize(
    ("engine", "problem"),
    cases(["fast-downward"], EXCLUSIVE)
    + cases(["fast-downward", "symk", "enhsp", "pyperplan"], UNREACHABLE, ODD)
    + cases(["fast-downward-opt", "pyperplan-opt"], ODD),
)
def test_engines_prove_that_there_is_no_plan(engine: str, problem: PlanningProblem) -> None:
    answer = solve(engine, problem)
    assert (answer.status, answer.actions, answer.message) == ("unsolvable", (), "")
    assert not answer.validated


def test_aries_ends_by_the_time_limit_where_there_is_no_plan() -> None:
    with pytest.raises(LimitReached) as caught:
        solve("aries", UNREACHABLE, Limits(time=3.0))
    assert caught.value.limit == "time"


def test_one_planner_answers_again_and_again() -> None:
    with PlannerProcess() as planner:
        for _ in range(2):
            assert planner.solve(DELIVER, "pyperplan", AMPLE).actions == DELIVERED


def test_any_other_engine_by_its_class() -> None:
    assert solve("fake_engines:Right").actions == DELIVERED
    assert solve("fake_engines:Proven").status == "unsolvable"


def test_leftovers_of_an_engine_that_succeeds_are_removed(left: Path) -> None:
    assert solve("fake_engines:Untidy").actions == DELIVERED
    assert left.exists()


def test_an_engine_that_does_not_know_has_not_found() -> None:
    answer = solve("fake_engines:Fake")
    assert answer.status == "not_found"
    assert answer.message == "fake_engines:Fake ended with UNSOLVABLE_INCOMPLETELY"


def test_a_wrong_plan_is_refused() -> None:
    answer = solve("fake_engines:Wrong")
    assert (answer.status, answer.actions, answer.validated) == ("refused", DELIVERED[1:], False)
    assert "Preconditions" in answer.message


@pytest.mark.parametrize(
    ("engine", "message"),
    [("Raising", "RuntimeError: no good mood today"), ("Crashing", "signal 11"), ("Broken", "INTERNAL_ERROR")],
)
def test_a_crash_is_told_and_cleaned_up(engine: str, message: str) -> None:
    answer = solve(f"fake_engines:{engine}")
    assert (answer.status, answer.actions, answer.validated) == ("crashed", (), False)
    assert message in answer.message


def test_an_engine_killed_from_outside_has_crashed() -> None:
    before = psutil.Process().children()
    with PlannerProcess() as planner:
        (worker,) = set(psutil.Process().children()) - set(before)
        threading.Timer(0.1, worker.kill).start()
        answer = planner.solve(DELIVER, "fake_engines:Slow", AMPLE)
    assert answer.status == "crashed"
    assert "signal 9" in answer.message


def test_the_time_limit_holds_for_everything(left: Path) -> None:
    began = time.monotonic()
    with PlannerProcess() as planner, pytest.raises(LimitReached, match="time limit of 5 s") as caught:
        planner.solve(DELIVER, "fake_engines:Stubborn", Limits(time=5.0))
    assert caught.value.limit == "time"
    assert 5.0 <= time.monotonic() - began < 10.0
    assert left.exists()


def test_the_memory_limit_holds_for_everything() -> None:
    with pytest.raises(LimitReached, match="memory limit of 300 MiB") as caught:
        solve("fake_engines:Hog", limits=Limits(time=60.0, memory=300.0))
    assert caught.value.limit == "memory"


@pytest.mark.parametrize(("engine", "limit"), [("OutOfMemory", "memory"), ("OutOfTime", "time")])
def test_limits_that_an_engine_meets_itself(engine: str, limit: str) -> None:
    with pytest.raises(LimitReached) as caught:
        solve(f"fake_engines:{engine}")
    assert caught.value.limit == limit


def test_nothing_is_left_if_nothing_was_asked() -> None:
    with PlannerProcess():
        pass
    with PlannerProcess():
        time.sleep(1.0)


def test_nothing_is_left_if_the_task_is_wrong() -> None:
    with pytest.raises(KeyError), PlannerProcess():
        raise KeyError("a fault in the task")


@contextmanager
def interrupted(when: Callable[[], bool]) -> Iterator[None]:
    """Interrupt the code in this context when a condition holds, as Ctrl-C in a terminal does."""

    def interrupt() -> None:
        wait_for(when)
        os.kill(os.getpid(), signal.SIGINT)

    # If the tests run in the background of a shell, they ignore this signal by default.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    watcher = threading.Thread(target=interrupt)
    watcher.start()
    try:
        with pytest.raises(KeyboardInterrupt):
            yield
        watcher.join()
    finally:
        signal.signal(signal.SIGINT, before)


# The interrupt may come while psutil has a file open, which psutil then leaves to the garbage collector.
may_interrupt_psutil = pytest.mark.filterwarnings(
    "ignore:unclosed file <_io.BufferedReader name='/proc/:ResourceWarning"
)


@may_interrupt_psutil
def test_an_interrupt_leaves_nothing(left: Path) -> None:
    with interrupted(left.exists):
        solve("fake_engines:Slow")


@may_interrupt_psutil
def test_an_interrupt_leaves_nothing_of_java_and_aries(left: Path) -> None:
    for engine, program in (("enhsp", "java"), ("aries", "aries")):
        seen: list[psutil.Process] = []

        def runs(program: str = program, seen: list[psutil.Process] = seen) -> bool:
            seen += [process for process in processes_of(left) if program in process.name()]
            return bool(seen)

        with interrupted(runs):
            # Aries never ends here, and ENHSP has just begun.
            solve(engine, UNREACHABLE if engine == "aries" else ODD)
        assert not [file for file in Path("/tmp").glob(f"hsperfdata_*/{seen[0].pid}")]


@pytest.mark.parametrize("ending", [signal.SIGKILL, signal.SIGTERM])
def test_a_killed_parent_leaves_nothing(ending: signal.Signals, left: Path) -> None:
    program = (
        "import types, planning_problems, hybrid_tamp.symbolic.engines.planner_process as p\n"
        "limits = types.SimpleNamespace(time=60.0, memory=4096.0)\n"
        "with p.PlannerProcess() as planner:\n"
        "    planner.solve(planning_problems.DELIVER, 'fake_engines:Slow', limits)\n"
    )
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path), "TMPDIR": tempfile.gettempdir()}
    with subprocess.Popen([sys.executable, "-c", program], env=environment) as parent:
        try:
            wait_for(left.exists)
        finally:
            parent.send_signal(ending)
    assert parent.returncode == -ending
    wait_for(lambda: not processes_of(left) and not list(Path(tempfile.gettempdir()).iterdir()))


def test_unknown_engines_are_refused_with_a_guess() -> None:
    with pytest.raises(InputError, match="did you mean 'fast-downward'"):
        solve("fast-downwards")
    with pytest.raises(InputError, match=r"available: fast-downward, .*package\.module:ClassName"):
        check_engine("nonsense")
    for name in ("no_such_module:Engine", "no.such:Engine", ":", "..:x"):
        with pytest.raises(InputError):
            check_engine(name)
    with pytest.raises(InputError, match="available: fast-downward"):
        solve("fake_engines:Missing")
    with pytest.raises(InputError):
        solve("fake_engines:leave_processes_and_files")


def test_engines_of_a_configuration_are_left_to_unified_planning(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("HOME", str(tmp_path))
    (tmp_path / "up.ini").write_text("[engine mine]\nmodule_name: fake_engines\nclass_name: Right\n")
    assert solve("mine").actions == DELIVERED
    with pytest.raises(InputError, match="available: fast-downward"):
        solve("yours")


def test_an_engine_for_other_problems_is_refused() -> None:
    with pytest.raises(InputError, match="HIERARCHICAL_TYPING"):
        solve("fake_engines:Untyped")


def test_what_is_missing_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    with monkeypatch.context() as patch:
        patch.setattr(engines, "find_spec", lambda name: None)
        patch.setenv("PATH", "")
        with pytest.raises(InputError, match=r"symk is not installed; pip install 'hybrid-tamp\[planners\]'"):
            check_engine("symk")
    with monkeypatch.context() as patch:
        patch.setattr(shutil, "which", lambda name, path=None: None)
        with pytest.raises(InputError, match="enhsp needs Java"):
            check_engine("enhsp")
    for name in known_engines():
        if name not in ("lpg", "tamer"):
            check_engine(name)


def test_equal_requests_get_equal_answers() -> None:
    problem = replace(ODD, goal=ODD.goal[:1])
    assert solve("pyperplan", problem).actions == solve("pyperplan", problem).actions != ()


def test_the_parent_needs_no_unified_planning() -> None:
    program = (
        "import sys, json, hybrid_tamp.symbolic.engines.planner_process as p\n"
        "p.check_engine('fast-downward')\n"
        "print(json.dumps([name for name in ('unified_planning', 'numpy', 'pydantic') if name in sys.modules]))"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert json.loads(done.stdout) == []

"""Planning engines that misbehave, with names ``fake_engines:Class``. Only the planner process imports them."""

import ctypes
import os
import signal
import subprocess
import sys
import tempfile
import time
import warnings
from pathlib import Path

from unified_planning.engines import Engine, PlanGenerationResult, PlanGenerationResultStatus
from unified_planning.engines.mixins import OneshotPlannerMixin
from unified_planning.model import ProblemKind
from unified_planning.plans import ActionInstance, SequentialPlan

SLEEP = "import time; time.sleep(600)"


class Fake(Engine, OneshotPlannerMixin):
    """Engine that reports that no plan was found."""

    status = PlanGenerationResultStatus.UNSOLVABLE_INCOMPLETELY

    def __init__(self):
        Engine.__init__(self)
        OneshotPlannerMixin.__init__(self)

    @property
    def name(self):
        return type(self).__name__

    @staticmethod
    def supported_kind():
        kind = ProblemKind(version=2)
        kind.set_problem_class("ACTION_BASED")
        kind.set_typing("FLAT_TYPING")
        kind.set_typing("HIERARCHICAL_TYPING")
        return kind

    @classmethod
    def supports(cls, problem_kind):
        return problem_kind <= cls.supported_kind()

    @staticmethod
    def get_credits(**kwargs):
        return None

    def _solve(self, problem, heuristic=None, timeout=None, output_stream=None):
        return PlanGenerationResult(self.status, self.plan(problem), self.name)

    def plan(self, problem):
        return None


class Proven(Fake):
    status = PlanGenerationResultStatus.UNSOLVABLE_PROVEN


class OutOfMemory(Fake):
    status = PlanGenerationResultStatus.MEMOUT


class OutOfTime(Fake):
    status = PlanGenerationResultStatus.TIMEOUT


class Broken(Fake):
    status = PlanGenerationResultStatus.INTERNAL_ERROR


class Untyped(Fake):
    """Engine that does not accept types. No compiler removes the types."""

    @staticmethod
    def supported_kind():
        kind = ProblemKind(version=2)
        kind.set_problem_class("ACTION_BASED")
        return kind


class Right(Fake):
    """Engine whose plan moves the first box over the yard to the shop."""

    status = PlanGenerationResultStatus.SOLVED_SATISFICING
    places = ("home", "yard", "shop")

    def plan(self, problem):
        steps = [("first", *leg) for leg in zip(self.places, self.places[1:], strict=False)]
        move = problem.action("move")
        return SequentialPlan([ActionInstance(move, tuple(problem.object(name) for name in step)) for step in steps])


class Wrong(Right):
    """Engine that omits a step of the plan."""

    places = ("yard", "shop")


class Untidy(Right):
    """Engine that finds a correct plan, and leaves processes and files behind."""

    def plan(self, problem):
        leave_processes_and_files()
        return super().plan(problem)


class Slow(Fake):
    """Engine that leaves processes and files behind, and never ends."""

    def plan(self, problem):
        leave_processes_and_files()
        time.sleep(600)


class Stubborn(Fake):
    """Engine that blocks all other threads of its process."""

    def plan(self, problem):
        leave_processes_and_files()
        # This holds Python's global lock.
        ctypes.PyDLL(None).sleep(600)


class Hog(Fake):
    """Engine with a grandchild process in another session, which takes 400 MiB."""

    def plan(self, problem):
        take = "import time; taken = bytearray(400 * 2**20); time.sleep(600)"
        start = f"import subprocess, sys; subprocess.run([sys.executable, '-c', {take!r}], start_new_session=True)"
        subprocess.run([sys.executable, "-c", start], start_new_session=True, check=False)


class Raising(Fake):
    def plan(self, problem):
        leave_processes_and_files()
        raise RuntimeError("no good mood today")


class Crashing(Fake):
    """Engine that leaves processes and files behind, and ends by a signal."""

    def plan(self, problem):
        leave_processes_and_files()
        os.kill(os.getpid(), signal.SIGSEGV)
        time.sleep(600)


def leave_processes_and_files():
    """Leave a child and an orphan in sessions of their own, a process that they start, and files."""
    warnings.simplefilter("ignore", ResourceWarning)
    nested = f"import subprocess, sys; subprocess.run([sys.executable, '-c', {SLEEP!r}])"
    subprocess.Popen([sys.executable, "-c", nested], start_new_session=True)
    orphan = f"import subprocess, sys; subprocess.Popen([sys.executable, '-c', {SLEEP!r}], start_new_session=True)"
    subprocess.run([sys.executable, "-c", orphan], check=True)
    Path("here.txt").write_text("left")
    tempfile.NamedTemporaryFile(delete=False).close()
    Path(os.environ["LEFT"]).write_text("processes")

"""The planner process, which starts early and answers one planning request.

The planner process imports unified_planning (`engines.worker`) while the main process reads and compiles the task. This
module converts the JSON replies of the planner process to Python objects.
"""

import logging
import time
from dataclasses import dataclass
from types import TracebackType
from typing import TYPE_CHECKING, Any, Literal

from hybrid_tamp.errors import InputError, Issue, LimitReached
from hybrid_tamp.model.plan import Fewest, PlannedAction
from hybrid_tamp.symbolic.engines.registry import check_engine, unknown_engine
from hybrid_tamp.symbolic.engines.worker_process import WorkerProcess
from hybrid_tamp.symbolic.pddl.operators import PlanningProblem

if TYPE_CHECKING:
    # At run time, this slow import would delay the start of the worker.
    from hybrid_tamp.model.task import Limits

_LOG = logging.getLogger(__name__)

Status = Literal["solved", "unsolvable", "not_found", "crashed", "refused"]


@dataclass(frozen=True)
class PlannerAnswer:
    """The answer of a planning engine.

    Attributes:
        status: ``solved`` (the engine found a valid plan), ``unsolvable`` (it proved that there is no plan),
            ``not_found`` (it returned neither a plan nor a proof), ``crashed`` or ``refused`` (its plan is invalid).
        actions: Plan of the engine if the status is ``solved`` or ``refused``, otherwise empty.
        seconds: Time from the request to the answer [s].
        engine: Name of the engine.
        message: Details for the user, or an empty string.
        validated: Whether the validator of unified_planning accepted the actions.
        fewest: What the engine knows about the number of actions, if the status is ``solved``.
    """

    status: Status
    actions: tuple[PlannedAction, ...]
    seconds: float
    engine: str
    message: str = ""
    validated: bool = False
    fewest: Fewest = "first found"


class PlannerProcess:
    """A context manager for planner processes.

    Entering the context starts the first process, so enter the context before the task is read. One process answers one
    request. Each further request starts another process.
    """

    def __init__(self) -> None:
        self._worker: WorkerProcess | None = None

    def __enter__(self) -> "PlannerProcess":
        self._worker = WorkerProcess()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._worker is not None:
            self._worker.stop()
            self._worker = None

    def prepare(self) -> None:
        """Start the process for the next request in advance."""
        self._worker = self._worker or WorkerProcess()

    def solve(self, problem: PlanningProblem, engine: str, limits: "Limits") -> PlannerAnswer:
        """Return the answer of an engine to a problem.

        Args:
            problem: Planning problem to solve.
            engine: Name from `known_engines`, or ``package.module:ClassName``.
            limits: Time limit of the request, and memory limit of the planner and its subprocesses together.

        Raises:
            InputError: If the engine is unknown, is not installed, or does not support the problem.
            LimitReached: If a limit was reached before the engine answered.
        """
        check_engine(engine)
        began = time.monotonic()
        self._worker = worker = self._worker or WorkerProcess()
        try:
            worker.ask({"problem": problem, "engine": engine, "memory": max(1, int(limits.memory))})
            worker.wait(limits, began)
            reply, seconds = worker.reply(), time.monotonic() - began
        finally:
            worker.stop()
            self._worker = None
        _LOG.debug("%s: %s", engine, reply)
        return _read_answer(reply, engine, seconds)


def _read_answer(reply: dict[str, Any], engine: str, seconds: float) -> PlannerAnswer:
    """Convert the reply of a worker to an answer, or raise the exception that the reply stands for."""
    status, message = reply["status"], reply.get("message", "")
    if status == "unknown":
        raise unknown_engine(engine, tuple(reply["available"]))
    if status == "unsupported":
        wanted = f"the engine must support the problem features {message}"
        raise InputError([Issue("planner", wanted, engine, remedy="choose another engine")])
    if status == "limit":
        raise LimitReached(message, limit=reply["limit"])
    actions = tuple(PlannedAction(each["name"], tuple(each["arguments"])) for each in reply.get("actions", ()))
    validated, fewest = status == "solved", reply.get("fewest", "first found")
    return PlannerAnswer(status, actions, seconds, engine, message, validated, fewest)

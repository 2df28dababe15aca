"""The planner as the rest of the library sees it: a process that starts early and answers one request for a plan.

The process imports unified_planning (`engines.worker`) while this one reads and compiles the task. Its replies are
JSON; this module turns them into values.
"""

import logging
import time
from dataclasses import dataclass
from types import TracebackType
from typing import TYPE_CHECKING, Any, Literal

from hybrid_tamp.errors import InputError, Issue, LimitReached
from hybrid_tamp.model.plan import PlannedAction
from hybrid_tamp.symbolic.engines.registry import check_engine, unknown_engine
from hybrid_tamp.symbolic.engines.worker_process import WorkerProcess
from hybrid_tamp.symbolic.pddl.operators import PlanningProblem

if TYPE_CHECKING:
    # The import takes as long as that of the worker, which has to start first.
    from hybrid_tamp.model.task import Limits

_LOG = logging.getLogger(__name__)


Status = Literal["solved", "unsolvable", "not_found", "crashed", "refused"]


@dataclass(frozen=True)
class PlannerAnswer:
    """The answer of a planning engine.

    Attributes:
        status: ``solved``; ``unsolvable``, a proof that there is no plan; ``not_found``, neither a plan nor a proof;
            ``crashed``; or ``refused``, a wrong plan.
        actions: the plan if the status is solved or refused.
        seconds: time from the request to the answer [s].
        engine: name of the engine.
        message: details for people, or empty.
        validated: whether the validator of unified_planning accepted the actions.
    """

    status: Status
    actions: tuple[PlannedAction, ...]
    seconds: float
    engine: str
    message: str = ""
    validated: bool = False


class PlannerProcess:
    """The process of the planner, a context manager. The process starts at once, so enter it before reading the task.

    One process answers one request. A further request starts another process.
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
        """Start the process for the next request now rather than when the request comes."""
        self._worker = self._worker or WorkerProcess()

    def solve(self, problem: PlanningProblem, engine: str, limits: "Limits") -> PlannerAnswer:
        """Return the answer of an engine to a problem.

        Args:
            problem: the problem.
            engine: a name from `known_engines`, or ``package.module:ClassName``.
            limits: limits of the time from now and of the memory of all processes together.

        Raises:
            InputError: if the engine is unknown, is not installed, or does not take such problems.
            LimitReached: if a limit was reached first.
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
    """Return the answer in the reply of a worker.

    Raises:
        InputError: if there is no such engine, or if it does not take such problems.
        LimitReached: if the engine itself ran out of time or memory.
    """
    status, message = reply["status"], reply.get("message", "")
    if status == "unknown":
        raise unknown_engine(engine, tuple(reply["available"]))
    if status == "unsupported":
        wanted = f"an engine is wanted that takes {message}"
        raise InputError([Issue("planner", wanted, engine, remedy="choose another engine")])
    if status == "limit":
        raise LimitReached(message, limit=reply["limit"])
    actions = tuple(PlannedAction(each["name"], tuple(each["arguments"])) for each in reply.get("actions", ()))
    return PlannerAnswer(status, actions, seconds, engine, message, validated=status == "solved")

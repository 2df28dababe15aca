"""The planner, as the rest of the library sees it: a process that is started early and asked for a plan.

The process imports unified_planning (`engines.worker`) while this one reads and compiles the task. Its replies
are JSON; here they become values.
"""

import logging
import time
from collections.abc import Mapping
from dataclasses import dataclass
from types import TracebackType
from typing import TYPE_CHECKING, Any, Literal

from hybrid_tamp.errors import InputError, Issue, LimitReached
from hybrid_tamp.model.plan import PlannedAction
from hybrid_tamp.symbolic.engines.registry import check_engine, unknown_engine
from hybrid_tamp.symbolic.engines.worker_process import WorkerProcess
from hybrid_tamp.symbolic.pddl.operators import PlanningProblem

if TYPE_CHECKING:
    # Its import takes as long as the worker's; the worker ought to have started by then.
    from hybrid_tamp.model.task import Limits

_LOG = logging.getLogger(__name__)


Status = Literal["solved", "unsolvable", "not_found", "crashed", "refused"]


@dataclass(frozen=True)
class PlannerAnswer:
    """What a planning engine answered.

    Attributes:
        status: ``solved``; ``unsolvable``, proven to have no plan; ``not_found``, ended without a plan and
            without a proof; ``crashed``; or ``refused``, returned a plan that is wrong.
        actions: the plan, where it is solved or refused.
        seconds: time from the request to the answer [s].
        engine: name of the engine.
        message: what else there is to say, for people; empty where the status says it all.
        validated: whether unified_planning's validator accepted the actions.
    """

    status: Status
    actions: tuple[PlannedAction, ...]
    seconds: float
    engine: str
    message: str = ""
    validated: bool = False


class PlannerProcess:
    """The planner's process, a context manager; starts at once, so enter it before reading the task.

    One process answers one request; for a further one another process is started.
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
        """Start the process for the next request now, and not when it comes."""
        self._worker = self._worker or WorkerProcess()

    def solve(self, problem: PlanningProblem, engine: str, limits: "Limits") -> PlannerAnswer:
        """Have an engine solve a problem.

        Args:
            problem: the problem.
            engine: a name from `known_engines`, or ``package.module:ClassName``.
            limits: the time from now, and the memory of all processes together.

        Raises:
            InputError: if the engine is unknown, not installed, or not made for such problems.
            LimitReached: if a limit was reached first.
        """
        check_engine(engine)
        reply, seconds = self._request({"problem": problem, "engine": engine}, limits)
        _LOG.debug("%s: %s", engine, reply)
        return _answer(reply, engine, seconds)

    def _request(self, request: Mapping[str, Any], limits: "Limits") -> tuple[dict[str, Any], float]:
        """Return the reply to a request, and how long it took [s].

        Raises:
            LimitReached: if a limit was reached first.
        """
        began = time.monotonic()
        self._worker = worker = self._worker or WorkerProcess()
        try:
            worker.ask({**request, "memory": max(1, int(limits.memory))})
            worker.wait(limits, began)
            return worker.reply(), time.monotonic() - began
        finally:
            worker.stop()
            self._worker = None


def _answer(reply: dict[str, Any], engine: str, seconds: float) -> PlannerAnswer:
    """Return the answer that a worker's reply makes.

    Raises:
        InputError: if there is no such engine, or if it does not take such problems.
        LimitReached: if the engine itself says that it ran out of time or memory.
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

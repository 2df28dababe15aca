"""The parent's side of the planner: a process that is started early, asked once, and never left behind.

The process imports unified_planning (`symbolic.worker`) while this one reads and compiles the task. The
limits hold for it and everything that it starts. However a request ends, by an answer, a limit, a crash or
an interrupt, no process and no file is left.
"""

import json
import logging
import os
import shutil
import signal
import subprocess
import sys
import threading
import time
import uuid
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from tempfile import mkdtemp
from types import TracebackType
from typing import IO, TYPE_CHECKING, Any, Literal

from hybrid_tamp.errors import InputError, Issue, LimitReached
from hybrid_tamp.model.plan import PlannedAction
from hybrid_tamp.symbolic.engines.processes import ProcessTree, marked_environment
from hybrid_tamp.symbolic.engines.registry import check_engine, known_engines, unknown_engine
from hybrid_tamp.symbolic.engines.worker import REPLY, REQUEST
from hybrid_tamp.symbolic.pddl.operators import PlanningProblem

if TYPE_CHECKING:
    # Its import takes as long as the worker's; the worker ought to have started by then.
    from hybrid_tamp.model.task import Limits

__all__ = ["PlannerAnswer", "PlannerProcess", "check_engine", "known_engines"]

_LOG = logging.getLogger(__name__)

_FIRST_LOOK = 0.01  # From the request to the first look at the processes [s]; later ones are further apart,
_LAST_LOOK = 0.05  # up to this [s].
_GRACE = 1.0  # For the worker to end what it started and itself, before it is killed [s].
_LOG_FILE = "log"
_LOG_TAIL = 2000  # How much of a crashed worker's log goes into the message [byte].

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
        self._worker: _Worker | None = None

    def __enter__(self) -> "PlannerProcess":
        self._worker = _Worker()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._worker is not None:
            self._worker.stop()
            self._worker = None

    def prepare(self) -> None:
        """Start the process for the next request now, and not when it comes."""
        self._worker = self._worker or _Worker()

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
        reply, seconds = self._replied({"problem": problem, "engine": engine}, limits)
        _LOG.debug("%s: %s", engine, reply)
        return _answer(reply, engine, seconds)

    def _replied(self, request: Mapping[str, Any], limits: "Limits") -> tuple[dict[str, Any], float]:
        """Return the reply to a request, and how long it took [s].

        Raises:
            LimitReached: if a limit was reached first.
        """
        began = time.monotonic()
        self._worker = worker = self._worker or _Worker()
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


class _Worker:
    """One run of `symbolic.worker`."""

    def __init__(self) -> None:
        self._directory = Path(mkdtemp(prefix="hybrid-tamp-"))
        mark = uuid.uuid4().hex
        try:
            self._process = self._started(mark)
        except BaseException:
            # Also an interrupt.
            shutil.rmtree(self._directory)
            raise
        self._tree = ProcessTree(self._process.pid, mark)
        self._answered, self._ended = threading.Event(), threading.Event()
        self._listener = threading.Thread(target=self._listen, daemon=True)
        self._listener.start()

    def ask(self, request: Mapping[str, Any]) -> None:
        """Send the request, without waiting for the worker to take it."""
        (self._directory / REQUEST).write_text(json.dumps(request, default=vars), encoding="utf-8")
        # A worker that has ended already is noticed soon enough.
        with suppress(BrokenPipeError):
            self._input.write(b"\n")

    def wait(self, limits: "Limits", began: float) -> None:
        """Wait until the worker has answered or ended.

        Raises:
            LimitReached: if a limit is reached first.
        """
        pause = _FIRST_LOOK
        while not self._answered.wait(min(pause, max(0.0, began + limits.time - time.monotonic()))):
            if self._process.poll() is not None:
                return
            if time.monotonic() - began >= limits.time:
                raise LimitReached(f"the planner reached its time limit of {limits.time:g} s", limit="time")
            if self._tree.memory() > limits.memory and self._tree.exact_memory() > limits.memory:
                raise LimitReached(f"the planner reached its memory limit of {limits.memory:g} MiB", limit="memory")
            pause = min(2 * pause, _LAST_LOOK)

    def reply(self) -> dict[str, Any]:
        """Return the reply of a worker that has answered or ended; one that left none has crashed."""
        path, code = self._directory / REPLY, self._process.returncode
        if path.exists():
            reply: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
            return reply
        log = (self._directory / _LOG_FILE).read_bytes()[-_LOG_TAIL:].decode(errors="replace").strip()
        return {"status": "crashed", "message": f"the planner ended with {_ending(code)}\n{log}".strip()}

    def stop(self) -> None:
        """End the worker and everything that it started, and remove its files; again, if that was interrupted."""
        # That is its sign to end. It knows its own descendants best, and leaves no zombies.
        self._input.close()
        self._ended.wait(_GRACE)
        self._tree.kill(search=self._process.returncode != 0)
        self._listener.join()
        if self._directory.exists():
            shutil.rmtree(self._directory)

    def _started(self, mark: str) -> subprocess.Popen[bytes]:
        """Start the process.

        It runs in its directory, because engines write files where they are, and in a session of its own,
        because a terminal's interrupt is for the parent alone.
        """
        temporary = self._directory / "tmp"
        temporary.mkdir()
        signs, descriptor = os.pipe()
        self._signs = os.fdopen(signs, "rb", buffering=0)
        with (self._directory / _LOG_FILE).open("wb") as log, os.fdopen(descriptor, "wb"):
            return subprocess.Popen(
                [sys.executable, "-m", "hybrid_tamp.symbolic.engines.worker", str(self._directory), str(descriptor)],
                bufsize=0,
                stdin=subprocess.PIPE,
                stdout=log,
                stderr=subprocess.STDOUT,
                cwd=self._directory,
                env=marked_environment(mark, temporary),
                pass_fds=(descriptor,),
                start_new_session=True,
            )

    @property
    def _input(self) -> IO[bytes]:
        assert self._process.stdin is not None
        return self._process.stdin

    def _listen(self) -> None:
        """Wait for the worker's sign that it has answered, which may not come, and for its end."""
        with self._signs:
            if not self._signs.read(1):
                self._process.wait()
        self._answered.set()
        self._process.wait()
        self._ended.set()


def _ending(code: int | None) -> str:
    """Say how a worker without a reply has ended, by its exit code; None if it waits for its sign to end."""
    if code is None:
        return "an exception"
    return f"exit code {code}" if code >= 0 else f"signal {-code} ({signal.strsignal(-code)})"

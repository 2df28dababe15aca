"""Control of one planner process by its parent. The planner process starts early and answers one request.

The limits apply to the planner process and its descendants together. After an answer, a limit, a crash or an
interrupt, no process and no file is left.
"""

import json
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
from pathlib import Path
from tempfile import mkdtemp
from typing import IO, TYPE_CHECKING, Any

from hybrid_tamp.errors import LimitReached
from hybrid_tamp.symbolic.engines.processes import ProcessTree, make_environment
from hybrid_tamp.symbolic.engines.worker import REPLY, REQUEST

if TYPE_CHECKING:
    # At run time, this slow import would delay the start of the worker.
    from hybrid_tamp.model.task import Limits

_FIRST_LOOK = 0.01  # Interval from the request to the first check [s]. Each later interval is twice as long.
_LAST_LOOK = 0.05  # Largest interval between two checks [s].
_GRACE = 1.0  # Time limit for the worker to end itself and its descendants before the parent kills them [s].
_LOG_FILE = "log"
_LOG_TAIL = 2000  # Number of bytes of a crashed worker's log in the message.


class WorkerProcess:
    """A planner process, which runs `engines.worker`."""

    def __init__(self) -> None:
        self._directory = Path(mkdtemp(prefix="hybrid-tamp-"))
        self._asked = False
        mark = uuid.uuid4().hex
        try:
            self._process = self._start(mark)
        except BaseException:
            # This includes an interrupt by the user.
            shutil.rmtree(self._directory)
            raise
        self._tree = ProcessTree(self._process.pid, mark)
        self._answered, self._ended = threading.Event(), threading.Event()
        self._listener = threading.Thread(target=self._listen, daemon=True)
        self._listener.start()

    def ask(self, request: Mapping[str, Any]) -> None:
        """Send the request without waiting until the worker reads it."""
        self._asked = True
        (self._directory / REQUEST).write_text(json.dumps(request, default=vars), encoding="utf-8")
        # If the worker has already ended, `wait` returns at once.
        with suppress(BrokenPipeError):
            self._input.write(b"\n")

    def wait(self, limits: "Limits", began: float) -> None:
        """Wait until the worker has answered or ended.

        Raises:
            LimitReached: If a limit is reached before the worker has answered or ended.
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
        """Return the reply after `wait`. If the worker wrote no reply, return the status ``crashed``."""
        path, code = self._directory / REPLY, self._process.returncode
        if path.exists():
            reply: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
            return reply
        log = (self._directory / _LOG_FILE).read_bytes()[-_LOG_TAIL:].decode(errors="replace").strip()
        return {"status": "crashed", "message": f"the planner ended with {_ending(code)}\n{log}".strip()}

    def stop(self) -> None:
        """End the worker and its descendants, and remove its files. Further calls have no effect."""
        # The worker ends when its input is closed. Only the worker can kill its descendants without leaving zombies.
        self._input.close()
        # A worker without a request has no descendants, and may still be busy with its imports.
        self._ended.wait(_GRACE if self._asked else 0.0)
        self._tree.kill(search=self._process.returncode != 0)
        self._listener.join()
        if self._directory.exists():
            shutil.rmtree(self._directory)

    def _start(self, mark: str) -> subprocess.Popen[bytes]:
        """Start the process in its own directory, because engines write files to the working directory."""
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
                env=make_environment(mark, temporary),
                pass_fds=(descriptor,),
                start_new_session=True,  # Only the parent must handle an interrupt from the terminal.
            )

    @property
    def _input(self) -> IO[bytes]:
        assert self._process.stdin is not None
        return self._process.stdin

    def _listen(self) -> None:
        """Set `_answered` when the worker answers or ends. Set `_ended` when the worker ends."""
        with self._signs:
            if not self._signs.read(1):
                self._process.wait()
        self._answered.set()
        self._process.wait()
        self._ended.set()


def _ending(code: int | None) -> str:
    """Describe how a worker without a reply ended. The code of a worker that has not ended yet is None."""
    if code is None:
        return "an exception"
    return f"exit code {code}" if code >= 0 else f"signal {-code} ({signal.strsignal(-code)})"

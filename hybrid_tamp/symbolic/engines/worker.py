"""Main program of the planner process, ``python -m hybrid_tamp.symbolic.engines.worker DIRECTORY DESCRIPTOR``.

The process imports unified_planning at once, while its parent still reads the task. A line on standard input signals
that ``DIRECTORY/request.json`` exists. The process solves the requested problem, writes ``DIRECTORY/reply.json``, and
writes one byte to the file descriptor. Then the process waits until standard input is closed, which also happens if the
parent dies. Finally the process kills all its descendants and removes the directory.

Engines print to standard output and standard error, so both streams go to a log file of the parent. If an exception
occurs, its traceback goes to the same log file and no reply is written.
"""

import json
import os
import shutil
import signal
import sys
import threading
import time
import traceback
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any, BinaryIO, NoReturn

from hybrid_tamp.symbolic.engines.processes import adopt_orphans, kill_descendants
from hybrid_tamp.symbolic.engines.solver import Solver
from hybrid_tamp.symbolic.pddl.operators import Operator, PlanningDomain, PlanningProblem

REQUEST = "request.json"
REPLY = "reply.json"

_GRACE = 0.3  # Time limit for the main thread to end the process [s].
_TRIES = 3  # Number of attempts to remove the directory, because other threads may still write to it.


def main(directory: Path, descriptor: int) -> None:
    """Answer one request and wait until the parent closes the input or dies."""
    signal.signal(signal.SIGTERM, lambda number, frame: _end(directory))
    os.set_inheritable(descriptor, False)
    adopt_orphans()
    asked = threading.Event()
    follower = threading.Thread(target=_follow_parent, args=(_take_input(), asked, directory), daemon=True)
    follower.start()
    try:
        solver = Solver()
        asked.wait()
        request = json.loads((directory / REQUEST).read_text(encoding="utf-8"))
        _bound_java(request["memory"])
        _write(directory / REPLY, solver.reply(decode_problem(request["problem"]), request["engine"]))
    except Exception:  # noqa: BLE001 engines may raise any exception, and the log shows it
        traceback.print_exc()
        sys.stderr.flush()
    # If the parent has died, the follower thread ends this process.
    with suppress(BrokenPipeError):
        os.write(descriptor, b"!")
    follower.join()


def decode_problem(data: Mapping[str, Any]) -> PlanningProblem:
    """Convert a planning problem from its JSON form, in which tuples are lists."""
    fields = {key: _tuples(value) for key, value in data.items() if key != "domain"}
    domain = {key: _tuples(value) for key, value in data["domain"].items()}
    domain["operators"] = tuple(Operator(**each) for each in domain["operators"])
    return PlanningProblem(domain=PlanningDomain(**domain), **fields)


def _tuples(value: Any) -> Any:
    """Return the value with all lists replaced by tuples."""
    if isinstance(value, dict):
        return {key: _tuples(each) for key, each in value.items()}
    return tuple(map(_tuples, value)) if isinstance(value, list) else value


def _take_input() -> BinaryIO:
    """Return the input stream from the parent. Replace standard input by an empty stream, which engines inherit."""
    parent = os.fdopen(os.dup(0), "rb")
    with open(os.devnull, "rb") as nothing:
        os.dup2(nothing.fileno(), 0)
    return parent


def _bound_java(memory: int) -> None:
    """Limit the Java heap to three quarters of a memory limit [MiB], so that Java collects garbage in time."""
    options = os.environ.get("JAVA_TOOL_OPTIONS", "")
    os.environ["JAVA_TOOL_OPTIONS"] = f"{options} -Xmx{max(16, memory * 3 // 4)}m"


def _follow_parent(parent: BinaryIO, asked: threading.Event, directory: Path) -> NoReturn:
    """Set `asked` when a request arrives, and end this process when the parent closes the input or dies."""
    if parent.readline():
        asked.set()
        parent.read()
    # The signal handler ends the process in the main thread, so that the main thread cannot start an engine meanwhile.
    # If the main thread does not run the handler in time, this thread ends the process.
    signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGTERM)
    time.sleep(_GRACE)
    _end(directory)


def _end(directory: Path) -> NoReturn:
    """End this process and its descendants immediately, and remove the directory."""
    kill_descendants()
    # Other threads may still write to the directory, but none of them creates it again.
    for _ in range(_TRIES):
        shutil.rmtree(directory, ignore_errors=True)
    # A normal exit of the interpreter would wait for the threads of engines.
    os._exit(0)


def _write(path: Path, reply: Mapping[str, Any]) -> None:
    """Write the reply to a temporary file and rename the file, so that the parent never reads an incomplete reply."""
    temporary = path.with_suffix(".part")
    temporary.write_text(json.dumps(reply, default=vars), encoding="utf-8")
    temporary.replace(path)


if __name__ == "__main__":
    main(Path(sys.argv[1]), int(sys.argv[2]))

"""The planner's own process: ``python -m hybrid_tamp.symbolic.engines.worker DIRECTORY DESCRIPTOR``.

It imports unified_planning at once, while its parent still reads the task. A line on standard input says that
``DIRECTORY/request.json`` is there. It solves that, leaves its reply in ``DIRECTORY/reply.json``, and says so by
a byte on the descriptor. Then it waits for the end of standard input, which is also what it sees when the
parent dies, at whatever time. That ends everything that was started here, and removes the directory.

Engines print what they like: the parent makes a log of both output streams. An exception goes there as
well, and then there is no reply.
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

_GRACE = 0.3  # For the main thread to end the process [s].
_TRIES = 3  # To remove a directory in which something is still being written.


def main(directory: Path, descriptor: int) -> None:
    """Answer one request, and wait for the end."""
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
    except Exception:  # noqa: BLE001 the outermost boundary: engines raise anything, and the log shows it
        traceback.print_exc()
        sys.stderr.flush()
    # Nobody may be there any more to be told; the follower knows.
    with suppress(BrokenPipeError):
        os.write(descriptor, b"!")
    follower.join()


def decode_problem(data: Mapping[str, Any]) -> PlanningProblem:
    """Return the planning problem from its JSON form, in which tuples are lists."""
    fields = {key: _tuples(value) for key, value in data.items() if key != "domain"}
    domain = {key: _tuples(value) for key, value in data["domain"].items()}
    domain["operators"] = tuple(Operator(**each) for each in domain["operators"])
    return PlanningProblem(domain=PlanningDomain(**domain), **fields)


def _tuples(value: Any) -> Any:
    """Return the value with tuples for lists."""
    if isinstance(value, dict):
        return {key: _tuples(each) for key, each in value.items()}
    return tuple(map(_tuples, value)) if isinstance(value, list) else value


def _take_input() -> BinaryIO:
    """Return the parent's end of standard input; engines, which inherit standard input, find it empty."""
    parent = os.fdopen(os.dup(0), "rb")
    with open(os.devnull, "rb") as nothing:
        os.dup2(nothing.fileno(), 0)
    return parent


def _bound_java(memory: int) -> None:
    """Keep Java's heap within most of a limit [MiB]: Java sooner takes more memory than tidies up."""
    options = os.environ.get("JAVA_TOOL_OPTIONS", "")
    os.environ["JAVA_TOOL_OPTIONS"] = f"{options} -Xmx{max(16, memory * 3 // 4)}m"


def _follow_parent(parent: BinaryIO, asked: threading.Event, directory: Path) -> NoReturn:
    """Tell when the parent asks, and end when it closes its end or is gone, however it went."""
    if parent.readline():
        asked.set()
        parent.read()
    # The main thread ends the process in the signal's handler: what does that starts no engine meanwhile.
    # But it may be somewhere where it does not get to it.
    signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGTERM)
    time.sleep(_GRACE)
    _end(directory)


def _end(directory: Path) -> NoReturn:
    """End this process and everything that it started, at once, and leave no trace.

    Without the interpreter's own end, which waits for the threads of engines and takes its time.
    """
    kill_descendants()
    # Other threads may still be writing there, but none makes the directory anew.
    for _ in range(_TRIES):
        shutil.rmtree(directory, ignore_errors=True)
    os._exit(0)


def _write(path: Path, reply: Mapping[str, Any]) -> None:
    """Write the reply to a temporary name and rename it: half a reply is never read."""
    temporary = path.with_suffix(".part")
    temporary.write_text(json.dumps(reply, default=vars), encoding="utf-8")
    temporary.replace(path)


if __name__ == "__main__":
    main(Path(sys.argv[1]), int(sys.argv[2]))

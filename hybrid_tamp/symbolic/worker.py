"""The planner's own process: ``python -m hybrid_tamp.symbolic.worker DIRECTORY``.

It imports unified_planning at once, while its parent still reads the task. Then it takes one request, a
line of JSON, from standard input, solves it, and leaves its reply in ``DIRECTORY/reply.json``. Standard
input stays open for as long as the parent lives; when it ends, everything that was started here ends too.

Engines print what they like: the parent makes a log of both output streams. An exception goes there as
well, and a worker that ends without a reply has crashed.
"""

import json
import os
import shutil
import signal
import sys
import threading
import traceback
from collections.abc import Mapping
from pathlib import Path
from typing import Any, BinaryIO, NoReturn

from hybrid_tamp.symbolic.operators import Operator, PlanningDomain, PlanningProblem
from hybrid_tamp.symbolic.processes import adopt_orphans, kill_descendants
from hybrid_tamp.symbolic.solving import Solver

REPLY = "reply.json"


def main(directory: Path) -> NoReturn:
    """Answer one request and leave."""
    signal.signal(signal.SIGTERM, lambda number, frame: _leave(1))
    adopt_orphans()
    parent = _take_input()
    code = 1
    try:
        solver = Solver()
        line = parent.readline()
        if not line:
            _abandon(directory)
        threading.Thread(target=_watch, args=(parent, directory), daemon=True).start()
        request = json.loads(line)
        _bound_java(request["memory"])
        _write(directory / REPLY, solver.reply(decoded_problem(request["problem"]), request["engine"]))
        code = 0
    except Exception:  # noqa: BLE001 the outermost boundary: engines raise anything, and the log shows it
        traceback.print_exc()
    _leave(code)


def decoded_problem(data: Mapping[str, Any]) -> PlanningProblem:
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


def _watch(parent: BinaryIO, directory: Path) -> NoReturn:
    """Wait until the parent is gone, however it went."""
    parent.read()
    _abandon(directory)


def _abandon(directory: Path) -> NoReturn:
    """End everything and leave no trace: nobody else will."""
    kill_descendants()
    # The main thread may be writing there.
    shutil.rmtree(directory, ignore_errors=True)
    os._exit(1)


def _leave(code: int) -> NoReturn:
    """End this process and everything that it started, at once.

    Without the interpreter's own end, which waits for the threads of engines and takes its time.
    """
    kill_descendants()
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(code)


def _write(path: Path, reply: Mapping[str, Any]) -> None:
    """Write the reply to a temporary name and rename it: half a reply is never read."""
    temporary = path.with_suffix(".part")
    temporary.write_text(json.dumps(reply), encoding="utf-8")
    temporary.replace(path)


if __name__ == "__main__":
    main(Path(sys.argv[1]))

"""The planner's own process: ``python -m hybrid_tamp.symbolic.worker DIRECTORY``.

It imports unified_planning at once, while its parent is still reading the task, then takes one request, a
line of JSON, from standard input, solves it, and leaves its answer in ``DIRECTORY/reply.json``. Standard
input stays open for as long as the parent lives: where it ends, everything started here ends with it.

Engines print what they like; the parent turns both output streams into a log. An exception is left to the
log, too: a worker that ends without an answer has crashed.
"""

import json
import os
import shutil
import signal
import sys
import threading
import traceback
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from types import FrameType, ModuleType
from typing import Any, NoReturn

from hybrid_tamp.symbolic.engines import Engine, ENGINES
from hybrid_tamp.symbolic.operators import Operator, PlanningDomain, PlanningProblem
from hybrid_tamp.symbolic.unified import UnifiedProblem, original_plan, simplify_for, unify

REPLY = "reply.json"
LOG_TAIL = 2000
"""How much of an engine's log goes into a message [characters]."""


def main(directory: Path) -> NoReturn:
    """Answer one request and leave."""
    signal.signal(signal.SIGTERM, _stop)
    _adopt_orphans()
    code = 1
    try:
        engines = _warm_up()
        line = sys.stdin.buffer.readline()
        if line:
            threading.Thread(target=_outlive_nobody, args=(directory,), daemon=True).start()
            _write(directory / REPLY, _answer(json.loads(line), engines))
        code = 0
    except Exception:  # noqa: BLE001 the process's outermost boundary: an engine may raise anything
        traceback.print_exc()
    _leave(code)


def _answer(request: Mapping[str, Any], engines: Mapping[str, tuple[str, str]]) -> dict[str, Any]:
    """Return the reply to a request: status, actions, message and what else the status needs."""
    name = request["engine"]
    # A Java engine would rather take more memory than collect its garbage.
    os.environ["JAVA_TOOL_OPTIONS"] = f"{os.environ.get('JAVA_TOOL_OPTIONS', '')} -Xmx{request['memory']}m"
    factory = _factory()
    ...

"""A child process for calls of libraries that may end their process, or never return.

For some inputs, a failed assertion of a C++ library ends the whole process, and some calls never return. In a child
process, both are errors like any other. The child is a copy of the calling process, so a function of a domain file
needs no import, and the results have the same bits as in the calling process.
"""

import resource
import signal
import warnings
from collections.abc import Callable
from multiprocessing import get_context
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from typing import Any, TypeVar

from hybrid_tamp.model.deadline import Deadline

_Result = TypeVar("_Result")

Note = Callable[[str], None]
"""Function that stores what the child does next, in words."""

MOST_PROCESSOR_TIME = 600
"""Processor time after which a call counts as a call that never returns [s]. All searches are bounded by counts, and
take a few seconds at most, so this limit ends no call that would return."""
_WAIT = 0.2
"""Time between two checks of the deadline [s]."""


class ChildEnded(Exception):
    """Error for a child process that ended without a result.

    Attributes:
        doing: last note of the child, i.e. what the child did when it ended.
        cause: why the child ended, in words.
    """

    def __init__(self, doing: str, cause: str) -> None:
        super().__init__(f"{doing}: {cause}" if doing else cause)
        self.doing = doing
        self.cause = cause


def run_isolated(function: Callable[[Note], _Result], deadline: Deadline, most: int = MOST_PROCESSOR_TIME) -> _Result:
    """Call a function in a child process, and return its result.

    Args:
        function: function to call. Its result must be picklable.
        deadline: deadline of the command.
        most: processor time that the child may use [s].

    Raises:
        ChildEnded: the child ended without a result.
        LimitReached: the deadline passes.
        Exception: the function raised this exception.
    """
    context = get_context("fork")
    receiver, sender = context.Pipe(duplex=False)
    child = context.Process(target=_work, args=(function, sender, most), daemon=True)
    with warnings.catch_warnings():
        # Python warns because numpy's idle threads do not exist in the child. The child does not need these threads.
        warnings.simplefilter("ignore", DeprecationWarning)
        child.start()
    sender.close()
    try:
        with receiver:
            result: _Result = _receive(child, receiver, deadline, most)
            return result
    finally:
        child.kill()
        child.join()


def _work(function: Callable[[Note], Any], sender: Connection, most: int) -> None:
    """Call the function, and send its notes and then its result or its exception."""
    used = resource.getrusage(resource.RUSAGE_SELF)
    limit = int(used.ru_utime + used.ru_stime) + most
    resource.setrlimit(resource.RLIMIT_CPU, (limit, resource.RLIM_INFINITY))
    try:
        sender.send(("returned", function(lambda words: sender.send(("note", words)))))
    except Exception as error:  # noqa: BLE001  The calling process raises it again.
        sender.send(("raised", error))


def _receive(child: BaseProcess, receiver: Connection, deadline: Deadline, most: int) -> Any:
    doing = ""
    while True:
        while not receiver.poll(_WAIT):
            deadline.check()
        try:
            kind, value = receiver.recv()
        except EOFError:
            child.join()
            raise ChildEnded(doing, _describe_end(child.exitcode, most)) from None
        if kind == "returned":
            return value
        if kind == "raised":
            raise value
        doing = value


def _describe_end(status: int | None, most: int) -> str:
    if status == -signal.SIGXCPU:
        return f"a library did not return within {most} s of processor time"
    if status is not None and status < 0:
        return f"a library ended its process (signal {signal.Signals(-status).name})"
    return f"a library ended its process (exit status {status})"

"""The deadline of a command."""

import pickle
import time

import pytest
from clocks import hurried

from hybrid_tamp.errors import LimitReached
from hybrid_tamp.model.deadline import NEVER, Deadline


def test_a_deadline_counts_from_the_beginning_of_the_command() -> None:
    began = time.monotonic() - 40.0
    early, late = Deadline.after(60.0, began), Deadline.after(30.0, began)
    assert 19.0 < early.left <= 20.0
    early.check()
    assert late.left == 0.0
    with pytest.raises(LimitReached, match="the command reached its time limit of 30 s") as caught:
        late.check()
    assert caught.value.limit == "time"


def test_the_clock_decides_when_a_deadline_passes(monkeypatch: pytest.MonkeyPatch) -> None:
    deadline = Deadline.after(100.0)
    hurried(monkeypatch, rate=1.0, jump=200.0, every=1)
    deadline.check()
    with pytest.raises(LimitReached):
        deadline.check()


def test_no_deadline_never_passes() -> None:
    NEVER.check()
    assert NEVER.left == float("inf")


def test_processes_can_exchange_deadlines_and_their_errors() -> None:
    deadline = Deadline.after(5.0)
    assert pickle.loads(pickle.dumps(deadline)) == deadline  # noqa: S301
    error = pickle.loads(pickle.dumps(LimitReached("too much", limit="memory")))  # noqa: S301
    assert (str(error), error.limit) == ("too much", "memory")

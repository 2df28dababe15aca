"""Tests of calls in a child process, which survive libraries that end their process or never return."""

import os
from pathlib import Path

import numpy as np
import pytest

import hybrid_tamp
from hybrid_tamp.errors import DomainError, Issue, LimitReached
from hybrid_tamp.model.deadline import NEVER, Deadline
from hybrid_tamp.planning.isolation import ChildEnded, Note, run_isolated


def test_the_result_of_a_child_has_the_bits_of_a_call_in_the_process() -> None:
    values = np.random.default_rng(3).normal(size=(40, 3))
    assert np.array_equal(run_isolated(lambda _: np.cross(values, values[::-1]), NEVER), np.cross(values, values[::-1]))


def test_a_child_that_aborts_ends_as_an_error_that_says_what_it_did() -> None:
    def abort(note: Note) -> None:
        note("the path of REACHING-1")
        os.abort()

    with pytest.raises(ChildEnded) as caught:
        run_isolated(abort, NEVER)
    assert (caught.value.doing, caught.value.cause) == (
        "the path of REACHING-1",
        "a library ended its process (signal SIGABRT)",
    )


def test_a_child_that_exits_ends_as_an_error() -> None:
    with pytest.raises(ChildEnded, match=r"^a library ended its process \(exit status 3\)$"):
        run_isolated(lambda _: os._exit(3), NEVER)


def hang(_: Note) -> None:
    """Use the processor for ever."""
    while True:
        pass


def test_a_child_that_never_returns_is_ended_by_its_processor_time() -> None:
    with pytest.raises(ChildEnded, match="a library did not return within 1 s of processor time"):
        run_isolated(hang, NEVER, most=1)


def test_a_deadline_ends_the_child(tmp_path: Path) -> None:
    def tell_and_hang(note: Note) -> None:
        (tmp_path / "pid").write_text(str(os.getpid()))
        hang(note)

    with pytest.raises(LimitReached):
        run_isolated(tell_and_hang, Deadline.after(1.0))
    with pytest.raises(ProcessLookupError):
        os.kill(int((tmp_path / "pid").read_text()), 0)


def test_an_exception_of_the_function_is_raised_in_the_calling_process() -> None:
    def fail(_: Note) -> None:
        raise DomainError([Issue("block.slot", "a slot is missing")])

    with pytest.raises(DomainError) as caught:
        run_isolated(fail, NEVER)
    assert caught.value.issues == (Issue("block.slot", "a slot is missing"),)


def test_a_result_that_cannot_be_sent_is_an_error_of_the_function() -> None:
    with pytest.raises(Exception, match="pickle"):
        run_isolated(lambda _: lambda: None, NEVER)


def test_a_plan_whose_check_aborts_is_not_found_and_the_reason_names_the_movement(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A function that aborts takes the place of the distances of python-fcl."""
    monkeypatch.setattr("hybrid_tamp.planning.clearance.find_nearest", lambda *_: os.abort())
    monkeypatch.setattr("hybrid_tamp.collision.sweeps.find_nearest", lambda *_: os.abort())
    outcome = hybrid_tamp.plan("roll_around_wall")
    assert outcome.failure is not None
    assert (outcome.failure.kind, outcome.plan) == ("not_refined", None)
    reasons = [each.shortfall.text for each in outcome.excluded]
    assert reasons[0] == "ROLLING-1 could not be checked: a library ended its process (signal SIGABRT)"

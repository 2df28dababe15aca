"""A block may follow itself. Here, only a push makes the next push possible."""

from typing import Any

import crates
import numpy as np
import pytest

import hybrid_tamp
from hybrid_tamp.authoring import ANY, FloatArray, Kind, Predicate, State, Target, Task, Token
from hybrid_tamp.model.law import check_law
from hybrid_tamp.symbolic.encoding.encoder import encode_task
from hybrid_tamp.symbolic.encoding.problem import compile_task
from hybrid_tamp.symbolic.reencode import reencode

AGAIN = (("PUSHING.hand", "PUSHING.hand"), ("PUSHING.crate", "PUSHING.crate"))


def close(state: State, dock: Token) -> FloatArray:
    return np.asarray(1.0 - state[dock, "position"][..., 0])


CLOSE = Predicate("close", (crates.DOCK,), close, "m", 0.1, {"dock": ("position",)}, Kind.STATIC)


def push_on(on: crates.Named) -> dict[str, Any]:
    """Return a change of PUSHING, after which the hand is behind the crate for a push to another dock."""
    block = next(each for each in crates.make_blocks(on) if each.name == "PUSHING")
    behind = (~on["behind"]("hand", ANY, ANY), on["behind"]("hand", "crate", "next"))
    return {"exit": (*block.exit, *behind), "targets": (*block.targets, Target("next", crates.Dock))}


def reach_close(on: crates.Named) -> dict[str, Any]:
    """Return a change of REACHING, in which the hand reaches for pushes to close docks only."""
    block = next(each for each in crates.make_blocks(on) if each.name == "REACHING")
    return {"entry": (*block.entry, on["close"]("dock"))}


def make_task(edges: tuple[tuple[str, str], ...]) -> Task:
    changes: dict[str, crates.Change] = {"PUSHING": push_on, "REACHING": reach_close}
    return crates.make_task(changes, (CLOSE,), edges, dock="far")


def test_a_block_follows_itself_without_a_block_between() -> None:
    task = make_task(AGAIN)
    found = hybrid_tamp.plan(task)
    assert found.plan is not None
    assert not check_law(task, found.plan)
    first, second = (each for each in found.plan.instances if each.block == "PUSHING")
    assert (first.targets["dock"], second.targets["dock"]) == ("near", "far")
    assert first.end == second.start
    compilation = compile_task(task)
    assert compilation.reaches_goal(reencode(compilation, found.plan))


@pytest.mark.parametrize("edges", [(), AGAIN[1:]])
def test_a_block_is_copied_only_if_its_anchor_may_stay(edges: tuple[tuple[str, str], ...]) -> None:
    assert not encode_task(make_task(edges)).chains.copies
    assert list(encode_task(make_task(AGAIN)).chains.copies.values()) == ["PUSHING"]

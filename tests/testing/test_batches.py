"""Tests of mistakes with numpy in a correct domain. Each message names the function with the mistake."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any, cast

import numpy as np
import pytest
from toys import MOVING, Pusher, World, free_motion, servo

from hybrid_tamp.model.block import Block, Duration
from hybrid_tamp.model.control import Hyperparameter
from hybrid_tamp.model.kind import Kind
from hybrid_tamp.model.measure import Measure
from hybrid_tamp.model.predicate import Parameter, Predicate
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.testing import check_domain


def fact(margin: Callable[..., Any]) -> Task:
    """Return a task in which `margin` maps the pusher's position ``(..., 3)`` to the margin of `slip`."""
    slip = Predicate(
        "slip",
        (Parameter("pusher", Pusher),),
        lambda state, pusher: margin(state[pusher, "position"]),
        reads={"pusher": ("position",)},
    )
    moving = replace(MOVING, entry=(slip("pusher"),), invariants=(slip("pusher"),), keeps=(slip,))
    return task(moving)


def task(moving: Block) -> Task:
    return World(moving=moving).pusher(limit=1000.0).spot("spot 0", 0.4).spot("spot 1", 0.7).task()


def policy(command: Callable[[Any], Any], name: str = "force", since: float = 0.0) -> Task:
    """Return a task whose policy is wrong after a time [s]. `command` maps the correct command ``(..., 3)`` to a wrong
    one."""

    def make(binding: Any, start: State, parameters: Any) -> Any:
        right = servo(binding, start, parameters)
        pusher = cast(Token, binding["pusher"])

        def commands(elapsed: Any, state: State) -> Any:
            force = right(elapsed, state)[pusher.name, "force"]
            return {(pusher.name, name): force if np.all(elapsed < since) else command(force)}

        return commands

    return task(replace(MOVING, policy=make))


def system(values: Callable[[Any], Any]) -> Task:
    """Return a task whose system is wrong. `values` maps the correct state ``(..., m)`` to a wrong state."""

    def make(binding: Any, start: State) -> Any:
        right = free_motion(binding, start)

        def wrong(state: State, commands: Any, dt: float) -> State:
            after = right(state, commands, dt)
            return State(after.layout, values(after.values))

        return wrong

    return task(replace(MOVING, system=make))


def guess(value: Callable[[Any], Any]) -> Task:
    """Return a task in which `value` maps the pusher's position ``(..., 3)`` to the initial value of a
    hyperparameter."""
    stiffness = Hyperparameter("stiffness", "N/m", 1.0, 1000.0, lambda b, s: 200.0 + value(s[b["pusher"], "position"]))
    return task(replace(MOVING, hyperparameters=(stiffness,)))


def measure(**value: Any) -> Task:
    return task(replace(MOVING, performance=(Measure("slip", "m", -1.0, **value),)))


def outcome(values: Callable[[Any], Any]) -> Task:
    """Return a task in which `values` maps the initial state ``(..., m)`` to the outcome of a block."""
    return task(replace(MOVING, outcome=lambda binding, state: State(state.layout, values(state.values))))


def duration(expected: Callable[[Any], Any]) -> Task:
    """Return a task in which `expected` maps the pusher's position ``(3,)`` to the expected duration of a block."""
    moving = Duration(MOVING.duration.minimum, MOVING.duration.maximum, lambda b, s, h: expected(place(b, s)))
    return task(replace(MOVING, duration=moving))


def bound(expected: Callable[[Any], Any]) -> Task:
    """Return a task in which `expected` maps the pusher's position ``(3,)`` to the bound of a feasibility condition."""
    close = Predicate(
        "close",
        (Parameter("pusher", Pusher),),
        lambda state, pusher: 9.0 - state[pusher, "position"][..., 0],
        kind=Kind.STATIC,
        reads={"pusher": ("position",)},
        bound=lambda state, radius, pusher: expected(state[pusher, "position"]),
    )
    return task(replace(MOVING, entry=(*MOVING.entry, close("pusher"))))


def place(binding: Any, state: State) -> Any:
    return state[binding["pusher"], "position"]


def faults() -> Iterator[Any]:
    yield pytest.param(fact(lambda x: 9.0 - np.linalg.norm(x)), "predicate slip", id="norm without axis")
    yield pytest.param(fact(lambda x: 9.0 - x), "predicate slip", id="a margin for each component")
    yield pytest.param(fact(lambda x: 9.0 - x[..., 0] + x.max()), "predicate slip", id="margins mix the states")
    yield pytest.param(policy(lambda f: f.mean()), "MOVING.policy, force of pusher", id="one number as command")
    yield pytest.param(policy(lambda f: f[..., :2]), "MOVING.policy, force of pusher", id="two components")
    yield pytest.param(
        policy(lambda f: f[..., 0], since=0.05), "MOVING.policy, force of pusher", id="a wrong command after a while"
    )
    yield pytest.param(policy(lambda f: f, "torque"), "MOVING.policy", id="an action that the token lacks")
    yield pytest.param(policy(lambda f: f - 0.1 * np.abs(f).max()), "the policy", id="commands mix the states")
    yield pytest.param(system(lambda x: x.reshape(-1, x.shape[-1])[0]), "MOVING.system", id="only the first state")
    yield pytest.param(system(lambda x: x + 1e-6 * np.linalg.norm(x)), "the system", id="the system mixes the states")
    yield pytest.param(guess(lambda x: np.linalg.norm(x)), "MOVING.stiffness", id="initial value without axis")
    yield pytest.param(guess(lambda x: x), "MOVING.stiffness", id="an initial value for each component")
    yield pytest.param(guess(lambda x: x[..., 0] - x.max()), "initial value stiffness", id="initial values mix states")
    yield pytest.param(
        measure(end=lambda b, before, after, h: np.linalg.norm(place(b, after))), "MOVING.slip", id="end without axis"
    )
    yield pytest.param(measure(peak=lambda b, state: place(b, state).max()), "MOVING.slip", id="peak without axis")
    yield pytest.param(
        measure(rate=lambda b, state, c: c["pusher", "force"]), "MOVING.slip", id="a rate for each component"
    )
    yield pytest.param(
        measure(peak=lambda b, state: place(b, state)[..., 0] + place(b, state).max()),
        "measure slip",
        id="measures mix the states",
    )

    yield pytest.param(outcome(lambda x: x[..., :4]), "MOVING.outcome", id="an outcome without all properties")
    yield pytest.param(outcome(lambda x: x + np.linalg.norm(x)), "the outcome", id="the outcome mixes the states")
    yield pytest.param(duration(lambda x: 1.0 + np.abs(x)), "MOVING.duration", id="a duration for each component")
    yield pytest.param(bound(lambda x: 9.0 + x), "the bound of close", id="a bound for each component")


@pytest.mark.parametrize(("wrong", "where"), list(faults()))
def test_a_slip_is_refused_by_name(wrong: Task, where: str) -> None:
    refused = refusals(wrong)
    assert refused, "nothing is refused"
    assert all(each.startswith(where) for each in refused)


def refusals(wrong: Task) -> list[str]:
    """Return the declarations that a check refuses because of a shape, a command or a mixed batch."""
    found = check_domain(wrong, samples=2, simulate=False)
    return [each.declared for each in found if each.kind in ("batch", "commands", "shape")]


def test_a_correct_domain_is_not_refused() -> None:
    right = measure(peak=lambda b, state: place(b, state)[..., 0])
    assert check_domain(right, samples=2, simulate=False) == []
    assert check_domain(fact(lambda x: 9.0 - np.linalg.norm(x, axis=-1)), samples=2, simulate=False) == []

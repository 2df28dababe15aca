"""Toy domains with intentional faults. `check_domain` reports each kind of fault, and nothing else."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any, cast

import numpy as np
import pytest
import toys
from toys import MOVING, Pusher, Spot, World

from hybrid_tamp.errors import DomainError
from hybrid_tamp.model.block import Block, Duration, Target
from hybrid_tamp.model.control import CONTROL_PERIOD, Commands, Hyperparameter, Parameters
from hybrid_tamp.model.predicate import ANY, Binding, Kind, Parameter, Predicate
from hybrid_tamp.model.state import State
from hybrid_tamp.model.token import Token
from hybrid_tamp.testing import KINDS, Disagreement, check_domain
from hybrid_tamp.testing.disagreement import Disagreements
from hybrid_tamp.testing.ends import check_ends
from hybrid_tamp.testing.rollouts import roll_out_rows

PUSHER, SPOT = Parameter("pusher", Pusher), Parameter("spot", Spot)
NEAR = toys.NEAR
CLEARED = replace(MOVING, exit=(~NEAR("pusher", ANY), *MOVING.exit))


def coordinate(name: str, axis: int, least: float, **changes: Any) -> Predicate:
    """Return a predicate that holds while a coordinate of the pusher is at least `least` [m]."""
    reads = {"pusher": ("position",)}
    return Predicate(
        name, (PUSHER,), lambda state, pusher: state[pusher, "position"][..., axis] - least, "m", reads=reads, **changes
    )


ALOFT = coordinate("aloft", 2, 0.2)
"""Holds throughout: pushers stay at a height of about 0.5 m."""
WEST = Predicate(
    "west",
    (PUSHER,),
    lambda state, pusher: 0.2 - state[pusher, "position"][..., 0],
    "m",
    reads={"pusher": ("position",)},
)
"""Holds at the start, at x = 0 m, and fails at the spot, at x = 0.4 m."""


def arrived(binding: Binding, state: State) -> State:
    """Return the state with the pusher at the spot."""
    return state.replace({(cast(Token, binding["pusher"]).name, "position"): state[binding["spot"], "position"]})


def check(moving: Block, *facts: Predicate, spots: tuple[float, ...] = (0.4,), **how: int) -> list[Disagreement]:
    world = World(moving=moving, facts=facts).pusher(limit=1000.0)
    for number, x in enumerate(spots):
        world = world.spot(f"spot {number}", x)
    return check_domain(world.task(), **{"samples": 2, "simulate": False, **how})


def kinds(found: list[Disagreement]) -> set[tuple[str, str]]:
    return {(each.kind, each.block) for each in found}


def steered(by: Callable[[State, Any], Any], *hyperparameters: Hyperparameter) -> Block:
    """Return a block that ends beside the spot. ``by(start, values)`` returns the offset along y [m]."""

    def policy(binding: Binding, start: State, parameters: Parameters) -> Any:
        pusher, spot = cast(Token, binding["pusher"]), cast(Token, binding["spot"])
        aside = by(start, parameters.hyperparameters) * np.ones(start.values.shape[:-1])

        def command(elapsed: Any, state: State) -> Commands:
            goal = state[spot, "position"] + aside[..., None] * [0.0, 1.0, 0.0]
            return {
                (pusher.name, "force"): 200.0 * (goal - state[pusher, "position"]) - 40.0 * state[pusher, "velocity"]
            }

        return command

    stiffness = MOVING.hyperparameters[0]
    return replace(CLEARED, policy=policy, hyperparameters=(stiffness, *hyperparameters))


def test_a_domain_without_faults_is_not_reported() -> None:
    sound = replace(CLEARED, outcome=arrived, keeps=(ALOFT,))
    assert check(sound, spots=(0.4, -0.3)) == []


def test_an_exit_condition_that_no_rollout_reaches() -> None:
    found = check(replace(CLEARED, system=lambda binding, start: lambda state, commands, dt: state))
    (missed,) = found
    assert (missed.kind, missed.block, missed.declared) == ("exit", "MOVING", "near(pusher, spot)")
    assert missed.binding == (("pusher", "pusher"), ("spot", "spot 0"))
    assert missed.measured.startswith("the margin is -")
    assert missed.measured.endswith(" m at the end of the rollout")
    assert (
        str(missed)
        == f"MOVING(pusher=pusher, spot=spot 0): exit: near(pusher, spot): {missed.measured}; {KINDS['exit'].remedy}"
    )
    assert missed.role == "pusher"


def test_a_kept_predicate_that_changes() -> None:
    (changed,) = check(replace(CLEARED, keeps=(WEST,)))
    assert (changed.kind, changed.block, changed.declared) == ("keeps", "MOVING", "the block keeps west")
    assert changed.measured.startswith("west(pusher) changes its margin from 0.")
    assert changed.measured.endswith(" m")


def test_a_kept_feasibility_fact_that_changes() -> None:
    found = check(replace(CLEARED, keeps=(replace(WEST, kind=Kind.STATIC),)))
    assert kinds(found) == {("keeps", "MOVING")}


def test_a_fixed_fact_that_changes() -> None:
    (changed,) = check(replace(CLEARED), replace(WEST, kind=Kind.STATIC, reads={}))
    assert (changed.kind, changed.declared) == ("fixed", "west reads no varying property")
    assert "west(pusher) changes its margin" in changed.measured


def within(slack: Callable[[float], float]) -> Predicate:
    """Return a feasibility fact with the bound margin + ``slack(radius)``."""

    def bound(state: State, radius: float, pusher: Token) -> Any:
        return np.asarray(WEST.evaluate(state, pusher) + slack(radius))

    return replace(WEST, kind=Kind.STATIC, bound=bound)


def test_a_bound_that_a_new_state_exceeds() -> None:
    (exceeded,) = check(CLEARED, within(lambda radius: 0.9 * radius))
    assert (exceeded.kind, exceeded.declared) == ("bound", "the margin of west does not exceed its bound")
    assert "and the bound is" in exceeded.measured
    assert check(CLEARED, within(lambda radius: radius)) == []


def test_a_fact_of_the_initial_state_is_evaluated_there() -> None:
    """The block leaves the region in which its entry condition holds, but can be entered again."""
    home = replace(WEST, kind=Kind.STATIC, at_start=True)
    assert check(replace(CLEARED, entry=(home("pusher"),)), spots=(0.4, 0.8)) == []
    once = replace(WEST, kind=Kind.STATIC)
    assert kinds(check(replace(CLEARED, entry=(once("pusher"),), keeps=(once,)))) == {("keeps", "MOVING")}


def test_a_fact_of_the_initial_state_holds_after_several_blocks() -> None:
    """The pusher moves from spot to spot. Only its second move changes the kept predicate."""
    following = Predicate(
        "following",
        (Parameter("before", Spot), SPOT),
        lambda s, before, spot: (
            0.1 - np.abs(s[spot, "position"] - s[before, "position"] - [0.4, 0.0, 0.0]).max(axis=-1)
        ),
        "m",
        reads={"before": ("position",), "spot": ("position",)},
        kind=Kind.STATIC,
    )
    home = replace(WEST, kind=Kind.STATIC, at_start=True)
    moving = replace(
        CLEARED,
        targets=(*CLEARED.targets, Target("before", Spot)),
        entry=(home("pusher"), NEAR("pusher", "before"), following("before", "spot")),
        keeps=(replace(WEST, name="not_far_east", margin=lambda s, pusher: 0.6 - s[pusher, "position"][..., 0]),),
    )
    assert kinds(check(moving, spots=(0.0, 0.4, 0.8), samples=1)) == {("keeps", "MOVING")}


@pytest.mark.parametrize("spots", [(0.4,), (0.4, -0.3)])
def test_an_end_that_depends_on_a_target_that_is_not_listed(spots: tuple[float, ...]) -> None:
    found = check(replace(CLEARED, outcome=arrived, ends={"pusher": ()}), spots=spots)
    assert kinds(found) == {("ends", "MOVING")}
    assert found[0].declared == "the final pose of pusher depends only on its initial pose"
    assert "spot" in found[0].measured


def test_an_end_that_depends_on_properties_of_a_target_that_is_not_listed() -> None:
    def at_edge(binding: Binding, state: State) -> State:
        return state.replace({("pusher", "position"): [0.39 + cast(Token, binding["spot"])["radius"], 0.0, 0.5]})

    moving = replace(CLEARED, outcome=at_edge, ends={"pusher": ()})
    task = World(moving=moving).pusher(limit=1000.0).spot("small", 0.4, 0.01).spot("large", 0.4, 0.02).task()
    small, large = (task.bind({"pusher": "pusher", "spot": name}) for name in ("small", "large"))
    rolled = roll_out_rows(moving, small, task.state, {"stiffness": np.array([200.0])}, 1, CONTROL_PERIOD)
    found = Disagreements()
    check_ends(rolled, [small, large], found, np.random.default_rng(0))
    assert [each.measured for each in found.all()] == [
        "for another choice of spot, the outcome differs by 0.01 m and 0 degrees"
    ]


def test_an_end_that_differs_from_the_outcome() -> None:
    def beyond(binding: Binding, state: State) -> State:
        after = arrived(binding, state)
        return after.replace({("pusher", "position"): after["pusher", "position"] + [0.1, 0.0, 0.0]})

    (wrong,) = check(replace(CLEARED, outcome=beyond, ends={"pusher": ("spot",)}))
    assert wrong.kind == "ends"
    assert wrong.declared == "the final pose of pusher depends only on its initial pose and spot"
    assert "differs from the outcome by 0.1" in wrong.measured or "differs from the outcome by 0.09" in wrong.measured
    assert check(replace(CLEARED, outcome=arrived, ends={"pusher": ("spot",)})) == []
    assert kinds(check(replace(CLEARED, ends={"pusher": ("spot",)}))) == {("ends", "MOVING")}


def test_an_end_that_depends_on_hyperparameters() -> None:
    """With the initial value, the pusher ends at the outcome. The exit conditions allow other ends."""
    aside = Hyperparameter("aside", "m", 0.0, 0.3, lambda binding, state: np.asarray(0.0))
    moving = steered(lambda start, chosen: chosen["aside"], aside)
    wide = replace(moving, exit=(toys.AT_REST("pusher"),), keeps=(NEAR,), outcome=arrived, ends={"pusher": ("spot",)})
    assert ("ends", "MOVING") in kinds(check(wide))
    narrow = replace(aside, upper=0.0)
    same = replace(wide, hyperparameters=(MOVING.hyperparameters[0], narrow))
    assert ("ends", "MOVING") not in kinds(check(same))


def test_an_entry_condition_that_holds_throughout() -> None:
    entry = (ALOFT("pusher"), toys.AT_REST("pusher"))
    (standing,) = check(replace(CLEARED, entry=entry, keeps=(ALOFT,)))
    assert (standing.kind, standing.block, standing.binding) == ("invariant", "MOVING", ())
    assert standing.declared == "the entry condition aloft(pusher) is neither an invariant nor waived"
    assert "rollouts, with a least margin of 0." in standing.measured
    assert check(replace(CLEARED, entry=entry, invariants=(ALOFT("pusher"),))) == []
    assert check(replace(CLEARED, entry=entry, keeps=(ALOFT,), waived={ALOFT("pusher"): "toys fly"})) == []


@pytest.mark.parametrize(
    "changes",
    [
        {"waived": {ALOFT("pusher"): "it is no entry condition"}},
        {"entry": (ALOFT("pusher"),), "waived": {ALOFT("pusher"): ""}},
        {"entry": (ALOFT("pusher"),), "invariants": (ALOFT("pusher"),), "waived": {ALOFT("pusher"): "twice"}},
    ],
)
def test_a_waiver_must_have_a_reason_and_an_entry_condition(changes: dict[str, Any]) -> None:
    with pytest.raises(DomainError, match="'waived' must map entry conditions"):
        toys.domain(replace(CLEARED, keeps=(ALOFT,), **changes))


def test_a_block_that_has_nothing_to_do_reaches_its_exit_after_its_least_duration() -> None:
    waiting = replace(MOVING, duration=Duration(0.5, 3.0, lambda binding, state, hyperparameters: 0.1))
    task = World(moving=waiting).pusher().spot(x=0.0).task()
    binding = task.bind({"pusher": "pusher", "spot": "spot"})
    rolled = roll_out_rows(waiting, binding, task.state, {"stiffness": np.array([200.0])}, 1, CONTROL_PERIOD)
    assert rolled.rows == [0]
    assert rolled.lengths.tolist() == [120]


def test_faults_of_drawn_hyperparameters_are_found() -> None:
    """With the initial value, the pusher keeps the predicate."""
    aside = Hyperparameter("aside", "m", 0.0, 0.3, lambda binding, state: np.asarray(0.0))
    wide = replace(steered(lambda start, chosen: chosen["aside"], aside), exit=(toys.AT_REST("pusher"),))
    south = Predicate(
        "south", (PUSHER,), lambda s, p: 0.1 - s[p, "position"][..., 1], "m", reads={"pusher": ("position",)}
    )
    assert ("keeps", "MOVING") in kinds(check(replace(wide, keeps=(NEAR, south)), samples=4))


def test_faults_of_drawn_starts_are_found() -> None:
    """From the initial state of the task, at y = 0 m, the pusher keeps the predicate."""
    central = Predicate(
        "central",
        (PUSHER, SPOT),
        lambda s, p, spot: 0.1 - np.abs(s[p, "position"] - s[spot, "position"])[..., 1],
        "m",
        reads={"pusher": ("position",)},
    )
    assert kinds(check(replace(CLEARED, keeps=(central,)), samples=8)) == {("keeps", "MOVING")}


def test_faults_towards_the_last_target_are_found() -> None:
    east = coordinate("not_far_west", 0, -1.0)
    assert kinds(check(replace(CLEARED, keeps=(east,)), spots=(0.4, 0.2, 0.3, -1.4))) == {("keeps", "MOVING")}
    assert check(replace(CLEARED, keeps=(east,)), spots=(0.4, 0.2, 0.3)) == []


def test_the_seed_decides_the_draws() -> None:
    faulty = replace(CLEARED, keeps=(WEST,))
    assert check(faulty, seed=3) == check(faulty, seed=3)
    assert check(faulty, seed=3) != check(faulty, seed=4)

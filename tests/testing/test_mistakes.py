"""Each of 28 kinds of mistakes is seeded into a correct domain, and is reported by kind, block and role."""

import itertools
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import crates
import numpy as np
import pytest
from crates import CRATE, DOCK, DURATION, HAND, Change, Named, length

from hybrid_tamp.errors import DomainError
from hybrid_tamp.model.block import FLOOR, Duration, Target
from hybrid_tamp.model.control import Hyperparameter
from hybrid_tamp.model.course import Course
from hybrid_tamp.model.key_pose import KeyPose
from hybrid_tamp.model.kind import Kind
from hybrid_tamp.model.predicate import Predicate
from hybrid_tamp.model.state import State
from hybrid_tamp.testing import KINDS, check_domain

ROOT = Path(__file__).parent.parent.parent
ABOVE, UPRIGHT = np.array([0.0, 0.0, 9.0]), np.array([0.0, 0.0, 0.0, 1.0])
MARGINS = {each.name: each.margin for each in crates.PREDICATES}


def policy_with(change: Any, of: Any = crates.push) -> dict[str, Any]:
    """Return a policy in which ``change(commands, elapsed, state, binding)`` changes the correct commands."""

    def make(binding: Any, start: Any, parameters: Any) -> Any:
        right = of(binding, start, parameters)
        return lambda elapsed, state: change(right(elapsed, state), elapsed, state, binding)

    return {"policy": make}


def system_with(change: Any, of: Any = crates.shove) -> dict[str, Any]:
    """Return a system in which ``change(after, before, dt)`` changes the correct next state."""

    def make(binding: Any, start: Any) -> Any:
        right = of(binding, start)
        return lambda state, commands, dt: change(right(state, commands, dt), state, dt)

    return {"system": make}


def margin_with(name: str, change: Any) -> dict[str, Change]:
    """Return a predicate in which ``change(margin, state, *values)`` changes the correct margin."""
    return {name: {"margin": lambda state, *values: change(MARGINS[name](state, *values), state, *values)}}


def scaled(factor: float) -> Any:
    return lambda commands, elapsed, state, binding: {key: factor * value for key, value in commands.items()}


def forgetful() -> Any:
    """Return a change of commands that depends on the number of earlier calls."""

    def make(binding: Any, start: Any, parameters: Any) -> Any:
        right, calls = crates.push(binding, start, parameters), itertools.count()
        return lambda elapsed, state: {
            key: value * (1.0 - 1e-6 * next(calls)) for key, value in right(elapsed, state).items()
        }

    return {"policy": make}


def stretched(after: State, before: State, factor: float) -> State:
    """Return the next state with a movement of the hand that is multiplied by a factor."""
    key = ("hand", "position")
    return after.replace({key: before[key] + factor * (after[key] - before[key])})


def with_entry(name: str, *arguments: str, keeps: str = "low") -> Change:
    """Return PUSHING with one more entry condition, and with a kept predicate."""

    def change(on: Named) -> Mapping[str, Any]:
        return {"entry": (*crates.make_blocks(on)[2].entry, on[name](*arguments)), "keeps": (on["low"], on[keeps])}

    return change


def with_exit(name: str, *arguments: str) -> Change:
    """Return PUSHING with one more exit condition."""
    return lambda on: {"exit": (*crates.make_blocks(on)[2].exit, on[name](*arguments))}


def kept(*names: str) -> Change:
    """Return a block that keeps the named predicates."""
    return lambda on: {"keeps": tuple(on[name] for name in names)}


def waiting(on: Named) -> Mapping[str, Any]:
    """Return PUSHING whose only exit condition holds from the start."""
    return {"exit": (on["at_rest"]("hand"),), "keeps": (on["low"], on["docked"], on["at_rest"])}


def glide(binding: Any, start: State) -> Any:
    """Return a system in which the crate slides into the dock by itself."""
    crate, dock = binding["crate"], binding["dock"]

    def system(state: State, commands: Any, dt: float) -> State:
        left = crates.way(state, crate, dock)
        step = 0.2 * dt * left / np.maximum(length(left), 0.2 * dt)[..., None]
        moving = np.where(length(left)[..., None] > 0.02, step, 0.0)
        return state.replace(
            {(crate.name, "position"): state[crate, "position"] + moving, (crate.name, "velocity"): moving / dt}
        )

    return system


def stay(binding: Any, start: Any, parameters: Any) -> Any:
    hand, damping = binding["hand"], 10.0 * parameters.hyperparameters["duration"]
    return lambda elapsed, state: {(hand.name, "force"): -damping[..., None] * state[hand, "velocity"]}


DRIFT = {("far", "velocity"): [0.1, 0.0, 0.0], ("near", "velocity"): [0.1, 0.0, 0.0]}
RANDOM = np.random.default_rng(0)
IGNORED = Hyperparameter("stiffness", "N/m", 1.0, 2.0, lambda binding, start: np.asarray(1.5))
TILT = Hyperparameter("tilt", "rad", 0.0, 90.0, lambda binding, start: np.asarray(45.0))
_OF_CRATE, _OF_HAND = {"crate": ("position",)}, {"hand": ("velocity",)}
LIT = Predicate("lit", (CRATE,), lambda s, crate: s[crate, "position"][..., 2] - 0.5, "m", 0.05, _OF_CRATE)
CLOSE = Predicate(
    "close",
    (CRATE, DOCK),
    lambda s, crate, dock: 0.3 - length(crates.way(s, crate, dock)),
    "m",
    0.05,
    {**_OF_CRATE, "dock": ("position",)},
)
EAST = Predicate("east", (CRATE,), lambda s, crate: 0.35 - s[crate, "position"][..., 0], "m", 0.1, kind=Kind.STATIC)
WESTERN = replace(EAST, name="western", kind=Kind.CHANGING, reads=_OF_CRATE)
LOADING = lambda state, hand, dock: 1.0 + state[hand, "velocity"][..., 0]  # noqa: E731
LOADED = Predicate(
    "loaded",
    (HAND, DOCK),
    lambda s, hand, dock: 1.0 + s[hand, "velocity"][..., 0],
    kind=Kind.MAINTAINED,
    reads=_OF_HAND,
)
SLIDING = Predicate("sliding", (HAND,), lambda s, hand: length(s[hand, "velocity"]) - 10.0, "m/s", 1.0, _OF_HAND)
CALM = Predicate("calm", (HAND,), lambda s, hand: 0.05 - length(s[hand, "velocity"]), "m/s", 0.05, _OF_HAND)


def seed(kind: str, block: str, role: str, changes: Mapping[str, Change], *more: Predicate, name: str = "") -> Any:
    return pytest.param(kind, block, role, changes, more, id=name or kind)


def mistakes_of_functions() -> Iterator[Any]:
    def push(change: Any) -> dict[str, Change]:
        return {"PUSHING": policy_with(change)}

    def over(change: Any) -> Any:
        return lambda commands, *_: {key: change(value) for key, value in commands.items()}

    yield seed("shape", "PUSHING", "hand", push(over(lambda force: force[..., 0])))
    norm = lambda m, s, crate, dock: np.linalg.norm(s[dock, "position"] - s[crate, "position"])  # noqa: E731
    yield seed("shape", "REACHING", "crate", margin_with("apart", norm), name="shape of a margin")
    yield seed("batch", "PUSHING", "hand", push(over(lambda force: force - 1e-3 * np.abs(force).max())))
    yield seed("error", "PUSHING", "hand", push(lambda commands, *_: commands["nobody", "force"]))
    yield seed("chance", "PUSHING", "hand", push(over(lambda force: force + 1e-3 * RANDOM.random(3))))
    yield seed("memory", "PUSHING", "hand", {"PUSHING": forgetful()})
    peek = lambda c, t, s, b: {k: v + 0.0 * s["far", "position"] + 0.0 * s["near", "position"] for k, v in c.items()}  # noqa: E731
    yield seed("sees", "PUSHING", "hand", push(peek))
    foreign = policy_with(lambda c, *_: {**c, ("crate", "force"): c["hand", "force"]}, crates.reach)
    yield seed("commands", "REACHING", "crate", {"REACHING": foreign})
    yield seed("limit", "PUSHING", "hand", push(over(lambda force: force + 100.0)))
    drag = system_with(lambda after, *_: after.replace({("crate", "velocity"): [0.1, 0.0, 0.0]}), crates.move)
    yield seed("holds", "REACHING", "crate", {"REACHING": drag})
    carry = system_with(lambda after, *_: after.replace(DRIFT))
    yield seed("holds", "PUSHING", "hand", {"PUSHING": carry}, name="write of a token without a role")
    backwards = policy_with(over(lambda force: -0.1 * force), crates.reach)
    yield seed("sign", "REACHING", "hand", {"REACHING": backwards}, name="sign of a force")
    fast = system_with(lambda after, before, dt: stretched(after, before, 1000.0), crates.move)
    yield seed("unit", "REACHING", "hand", {"REACHING": fast}, name="position in millimetres")
    yield seed("exit", "PUSHING", "crate", {"PUSHING": system_with(lambda after, before, dt: before)})
    yield seed("model", "PUSHING", "crate", {"PUSHING": {"policy": stay, "system": glide}})


def mistakes_of_declarations() -> Iterator[Any]:
    def tuned(*hyperparameters: Hyperparameter) -> dict[str, Change]:
        return {"PUSHING": {"hyperparameters": hyperparameters}}

    yield seed("sign", "PUSHING", "crate", margin_with("docked", lambda m, *_: -m))
    negative = margin_with("at_rest", lambda m, *_: -m)
    yield seed("sign", "RESTING", "token", negative, name="sign of an entry condition")
    yield seed("unit", "PUSHING", "crate", margin_with("docked", lambda m, *_: 1000.0 * m), name="millimetres")
    yield seed("unit", "PUSHING", "tilt", tuned(DURATION, TILT), name="degrees")
    yield seed("unit", "PUSHING", "duration", tuned(replace(DURATION, unit="ms")), name="unit with a prefix")
    yield seed("reads", "PUSHING", "crate", {"docked": {"reads": {"dock": ("position",)}}})
    tracking = policy_with(lambda c, t, s, b: {k: v + 0.1 * s["crate", "position"] for k, v in c.items()}, crates.reach)
    targets = (Target("crate", crates.Crate, reads=()), Target("dock", crates.Dock))
    unread = {"REACHING": {**tracking, "targets": targets}}
    yield seed("reads", "REACHING", "crate", unread, name="read of a target")
    other = margin_with("in_hall", lambda m, s, hand: m - 0.1 * s["crate", "position"][..., 0])
    yield seed("reads", "REACHING", "hand", other, name="read of another token")
    written = {"hand": ("position", "velocity"), "crate": ("position",)}
    yield seed("writes", "PUSHING", "crate", {"PUSHING": {"writes": written}})
    yield seed("keeps", "PUSHING", "crate", {"PUSHING": kept("low", "western")}, WESTERN)
    yield seed("fixed", "PUSHING", "crate", {"PUSHING": with_entry("east", "crate")}, EAST)
    yield seed("bound", "PUSHING", "crate", {"apart": {"bound": lambda state, radius, crate, dock: np.asarray(0.3)}})
    yield seed("idle", "PUSHING", "hand", {"PUSHING": waiting})
    sliding = {"PUSHING": with_entry("sliding", "hand", keeps="sliding"), "REACHING": kept("sliding")}
    yield seed("entry", "PUSHING", "hand", sliding, SLIDING)
    loaded = {"PUSHING": with_entry("loaded", "hand", "dock")}
    yield seed("entry", "PUSHING", "hand", loaded, LOADED, name="entry without a block")
    yield seed("effect", "PUSHING", "crate", {"PUSHING": with_exit("lit", "crate")}, LIT)
    yield seed("undeclared", "PUSHING", "crate", {"PUSHING": with_exit("close", "crate", "dock")}, CLOSE)
    calm: dict[str, Change] = {
        "PUSHING": lambda on: {"invariants": (on["in_hall"]("hand"), on["calm"]("hand"))},
        "REACHING": kept("calm"),
    }
    yield seed("broken", "PUSHING", "hand", calm, CALM)
    yield seed("contact", "PUSHING", "hand", {"PUSHING": {"allowed_contacts": (("crate", FLOOR),)}})
    staying = {"sweep": lambda binding, start, parameters: Course(start.repeated(1))}
    yield seed("sweep", "PUSHING", "crate", {"PUSHING": staying})
    away = {"key_poses": lambda binding, start: [KeyPose("crate", ABOVE, UPRIGHT)]}
    yield seed("key_pose", "PUSHING", "crate", {"PUSHING": away})
    yield seed("influence", "PUSHING", "stiffness", tuned(DURATION, IGNORED))
    yield seed("bounds", "PUSHING", "duration", tuned(replace(DURATION, within=lambda binding: (9.0, 2.0))))
    early = replace(DURATION, initial=lambda b, s: -crates.duration(b, s))
    yield seed("bounds", "PUSHING", "duration", tuned(early), name="guess outside the bounds")
    late = Duration(0.5, 20.0, lambda b, s, h: 1000.0 * crates.expected(b, s, h))
    yield seed("bounds", "PUSHING", "hand", {"PUSHING": {"duration": late}}, name="duration in milliseconds")


WITHOUT_FIGURE = ("commands", "error", "sees", "holds", "unit")
PHYSICS = ("contact", "model")
SAMPLES = {"idle": 2, "sign": 2, "undeclared": 3}
SEEDED = [*mistakes_of_functions(), *mistakes_of_declarations()]


@pytest.mark.parametrize(("kind", "block", "role", "changes", "more"), SEEDED)
def test_a_seeded_mistake_is_reported(
    kind: str, block: str, role: str, changes: Mapping[str, Change], more: tuple[Predicate, ...]
) -> None:
    found = check_domain(crates.make_task(changes, more), samples=SAMPLES.get(kind, 1), simulate=kind in PHYSICS)
    mine = [each for each in found if (each.kind, each.block, each.role) == (kind, block, role)]
    assert mine, "\n".join(map(str, found))
    assert all(each.declared and each.measured and each.remedy for each in found)
    assert mine[0].remedy in str(mine[0])
    if kind not in WITHOUT_FIGURE:
        assert any(letter.isdigit() for letter in mine[0].measured + mine[0].declared)


def test_the_correct_domain_has_no_mistake() -> None:
    assert check_domain(crates.make_task(), samples=2) == []


def test_every_kind_is_seeded() -> None:
    """The kinds `ends` and `invariant` have tests of their own."""
    assert {each.values[0] for each in SEEDED} | {"ends", "invariant"} == set(KINDS)


def test_the_page_about_domains_lists_every_kind_with_its_remedy() -> None:
    page = (ROOT / "docs" / "domains.md").read_text(encoding="utf-8")
    for name, kind in KINDS.items():
        assert f"| `{name}` | {kind.meaning} | {kind.remedy} |\n" in page


def test_all_mistakes_are_reported_together() -> None:
    """The failure of one block does not hide the mistakes of another block."""
    changes = {
        "PUSHING": policy_with(lambda commands, *_: {key: value[..., 0] for key, value in commands.items()}),
        "REACHING": {"hyperparameters": (DURATION, IGNORED)},
    }
    found = check_domain(crates.make_task(changes), samples=1, simulate=False)
    assert {(each.kind, each.block) for each in found} == {("shape", "PUSHING"), ("influence", "REACHING")}


def test_bounds_upside_down_are_refused_with_block_figure_and_remedy() -> None:
    with pytest.raises(DomainError) as caught:
        crates.make_task({"PUSHING": {"hyperparameters": (replace(DURATION, lower=9.0, upper=2.0),)}})
    (issue,) = caught.value.issues
    assert (issue.where, issue.came) == ("PUSHING.duration", "[9.0, 2.0] s")
    assert issue.remedy == "exchange the bounds"
    with pytest.raises(DomainError) as caught:
        crates.make_task({"PUSHING": {"duration": Duration(9.0, 2.0, crates.expected)}})
    (issue,) = caught.value.issues
    assert (issue.where, issue.came) == ("PUSHING.duration", "the minimum 9 s and the maximum 2 s")
    assert issue.remedy == "exchange or correct the bounds"

"""What friction, size and weight alone decide is known before planning, and the neighbours just above a limit work."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest
from hybrid_tamp_domains.joint_lifting import predicates as lifting
from hybrid_tamp_domains.rolling_tumbling import control_predicates as tumbling
from hybrid_tamp_domains.rolling_tumbling import resistance as rolling
from hybrid_tamp_domains.rolling_tumbling.sliding import leaning_friction
from hybrid_tamp_domains.rolling_tumbling.tumbling_geometry import PAST_BALANCE, SAG
from hypothesis import given
from hypothesis import strategies as st
from random_tasks.properties import find_failing_facts
from scipy.optimize import linprog

import hybrid_tamp
from hybrid_tamp.authoring import DEFAULT_FRICTION
from hybrid_tamp.execution.execute import execute
from hybrid_tamp.geometry.shapes import Cylinder, Shape, Sphere
from hybrid_tamp.model.predicate import Predicate
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.constants import GRAVITY
from hybrid_tamp.physics.protocol import open_backend

RADIUS = 0.1
DRUM, CUBE, CRATE = ("roll_cylinder", "drum"), ("tumble_two_hands", "box"), ("lift_two_hands", "box")


def changed(where: tuple[str, str], shape: Shape | None = None, **properties: object) -> tuple[Task, Token]:
    """Return a bundled task with other properties of one token, set down on the floor, and this token."""
    name, thing = where
    task = hybrid_tamp.load_task(name)
    before = task.token_by_name[thing]
    kinds = [each for each in task.domain.classes if before.is_member(each)]
    after = Token.make(thing, kinds, {**before.properties, **properties}, shape)
    height = after["radius_of_rotation"] if "radius_of_rotation" in after.properties else after["half_extents"][2]
    place = (*task.state[thing, "position"][:2], height)
    tokens = tuple(after if each.name == thing else each for each in task.tokens)
    return task.replaced(tokens=tokens, state=task.state.replace({(thing, "position"): place})), after


def drum(radius: float = RADIUS, length: float = 0.3, **properties: float) -> Task:
    shape = Cylinder(kind="cylinder", radius=radius, length=length)
    return changed(DRUM, shape, radius_of_rotation=radius, **properties)[0]


def sphere(radius: float = RADIUS, **properties: float) -> Task:
    return changed(DRUM, Sphere(kind="sphere", radius=radius), radius_of_rotation=radius, **properties)[0]


def box(edge: float = 0.3, **properties: float) -> Task:
    return changed(CUBE, half_extents=(edge / 2.0,) * 3, **properties)[0]


def crate(edge: float = 0.3, **properties: float) -> Task:
    return changed(CRATE, half_extents=(edge / 2.0,) * 3, **properties)[0]


LIMITS: Mapping[str, tuple[Task, Task, set[str]]] = {
    "drum without friction": (drum(friction=0.0), drum(friction=0.1), {"rolls"}),
    "sphere without friction": (sphere(friction=0.0), sphere(friction=0.1), {"rolls"}),
    "rolling resistance of a drum": (drum(rolling_friction=0.04), drum(rolling_friction=0.02), {"rolls_steadily"}),
    "drum too heavy to roll": (drum(mass=400.0, friction=0.6), drum(mass=300.0, friction=0.6), {"able_to_roll"}),
    "drum that nothing stops": (drum(rolling_friction=1e-4), drum(rolling_friction=2e-4), {"stops"}),
    "thin drum": (drum(length=0.0035), drum(length=0.0045), {"wide_enough"}),
    "small drum": (drum(0.0055, rolling_friction=1e-4), drum(0.0065, rolling_friction=1e-4), {"touches_axis"}),
    "small sphere": (sphere(0.002, rolling_friction=1e-5), sphere(0.0065, rolling_friction=1e-4), {"touches_axis"}),
    "box without friction": (box(friction=0.0, mass=2.0), box(friction=0.5, mass=2.0), {"rough_enough"}),
    "box that slides off a hand": (box(mass=1.0, friction=0.1), box(mass=1.0, friction=0.11), {"rough_enough"}),
    "small box": (box(0.125, mass=2.0), box(0.1256, mass=2.0), {"large_enough"}),
    "light box": (box(mass=0.01), box(mass=0.0103), {"heavy_enough"}),
    "lifted box without friction": (
        crate(mass=1.0, friction=0.0),
        crate(mass=1.0, friction=0.1),
        {"bears", "grippable"},
    ),
    "smooth lifted box": (crate(mass=0.1, friction=0.017), crate(mass=0.1, friction=0.018), {"grippable"}),
    "light lifted box": (crate(mass=4e-4), crate(mass=4.2e-4), {"heavy_enough"}),
    "small lifted box": (crate(0.079, mass=1.0), crate(0.081, mass=1.0), {"fits"}),
}
"""Maps each limit to a task just below the limit, a task just above the limit, and the facts that fail below."""


@pytest.mark.parametrize("kind", LIMITS)
def test_exactly_the_facts_of_a_limit_fail_below_it_and_none_above(kind: str) -> None:
    below, above, facts = LIMITS[kind]
    assert set(find_failing_facts(below)) - set(find_failing_facts(above)) == facts
    assert not facts & set(find_failing_facts(above))


@pytest.mark.parametrize("kind", ["drum without friction", "small sphere", "light box", "lifted box without friction"])
def test_a_task_below_a_limit_is_refused_and_its_neighbour_is_planned(kind: str) -> None:
    below, above, _ = LIMITS[kind]
    assert hybrid_tamp.plan(below).plan is None
    assert hybrid_tamp.plan(above).plan is not None


ratios, frictions = st.floats(0.001, 0.9), st.floats(0.01, 1.9)


@given(ratios, frictions)
def test_a_drum_rolls_steadily_where_forces_in_the_friction_cones_balance(ratio: float, friction: float) -> None:
    """The forces on a drum of unit weight and radius: the push and the friction of the floor."""
    margin = float(_margin(rolling.ROLLS_STEADILY, friction, ratio))
    at_hand = DEFAULT_FRICTION * friction
    moments = [1.0 - at_hand - ratio * at_hand - DEFAULT_FRICTION * ratio]
    found = linprog([0.0], A_ub=[[1.0 - friction * at_hand]], b_ub=[friction], A_eq=[moments], b_eq=[ratio])
    if abs(margin) > 1e-6:
        assert (margin > 0) == (found.status == 0)


_ROLL = drum()


def _margin(predicate: Predicate, friction: float, ratio: float) -> float:
    before = _ROLL.token_by_name["drum"]
    thing = replace(before, properties={**before.properties, "friction": friction, "rolling_friction": ratio * RADIUS})
    return float(predicate.evaluate(_ROLL.state, _ROLL.token_by_name["hand"], thing))


@pytest.mark.parametrize(("height", "width"), [(0.3, 0.3), (0.2, 0.32), (0.32, 0.2)])
def test_the_edge_of_a_leaning_box_holds_by_the_balance_of_forces_at_the_edge(height: float, width: float) -> None:
    """The unknowns are the push of the hand, the friction of the floor and the load on the edge, in weights."""
    lean = PAST_BALANCE + SAG
    centre = np.hypot(height, width) / 2.0 * np.array([np.sin(lean), np.cos(lean)])
    face = np.arctan2(width, height) + lean
    contact, push = 0.72 * height * np.array([np.sin(face), np.cos(face)]), np.array([-np.cos(face), np.sin(face)])
    moment = contact[0] * push[1] - contact[1] * push[0]
    balance = [[moment, 0.0, 0.0], [push[0], 1.0, 0.0], [push[1], 0.0, 1.0]]
    _, floor, load = np.linalg.solve(balance, [centre[0], 0.0, 1.0])
    assert leaning_friction(height, width) == pytest.approx(floor / load)


def test_a_drum_just_above_the_limit_rolls_in_physics_and_a_drum_below_slides() -> None:
    above, below = drum(friction=0.13, rolling_friction=0.01), drum(friction=0.08, rolling_friction=0.01)
    assert "rolls_steadily" in find_failing_facts(below)
    plan = hybrid_tamp.plan(above).required()
    ratio = {}
    with open_backend("pybullet") as physics:
        for name, task in (("above", above), ("below", below)):
            metrics = task.domain.measure(task, execute(task, plan, physics))
            (ratio[name],) = (value for (_, measure), value in metrics.items() if measure == "roll_ratio")
    assert ratio["above"] > 0.5
    assert ratio["below"] < 0.05


def test_a_weak_hand_cannot_overcome_the_rolling_resistance() -> None:
    task = drum(mass=100.0, friction=0.6, rolling_friction=0.005)
    hand, thing = task.token_by_name["hand"], task.token_by_name["drum"]
    # Moments about the axis: N R = nu N R + rho (m g + nu N) + rho N/2, with nu = 0.3.
    push = 0.05 * 100.0 * GRAVITY / (1.0 - 0.3 - 0.05 * 0.3 - 0.5 * 0.05)
    assert rolling.push_needed(hand, thing) == pytest.approx(push * np.hypot(1.0, 0.3))


def test_the_facts_of_boxes_have_figures_in_their_units() -> None:
    units = [each.unit for each in (tumbling.ROUGH_ENOUGH, tumbling.LARGE_ENOUGH, tumbling.HEAVY_ENOUGH)]
    assert units == ["1", "m", "N"]
    assert [each.unit for each in (lifting.GRIPPABLE, lifting.HEAVY_ENOUGH, rolling.STOPS)] == ["1", "N", "m"]

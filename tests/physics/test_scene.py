"""Comparison of the physical properties of tokens with closed forms."""

import numpy as np
import pytest
from workbench import HAMMER, MOMENT, held

from hybrid_tamp.geometry.shapes import Box, BoxPart, Compound, Cylinder, CylinderPart, Shape, Sphere, SpherePart
from hybrid_tamp.physics.pictures.appearance import draw_tokens
from hybrid_tamp.physics.pictures.outlines import bounding_radius
from hybrid_tamp.physics.scene import compute_inertia, make_bodies

LEVEL = np.array([0.0, 0.0, 0.0, 1.0])


def halves(length: float) -> Compound:
    """Return a bar along z that consists of two boxes, one of them turned."""
    quarter = length / 4
    upper = BoxPart(kind="box", half_extents=(0.1, 0.2, quarter), position=(0.0, 0.0, quarter))
    turned = BoxPart(
        kind="box", half_extents=(0.2, 0.1, quarter), position=(0.0, 0.0, -quarter), rpy=(0.0, 0.0, np.pi / 2)
    )
    return Compound(kind="compound", parts=(upper, turned))


def test_a_bar_of_two_halves_has_the_inertia_of_the_whole() -> None:
    whole = Box(kind="box", half_extents=(0.1, 0.2, 0.3))
    assert compute_inertia(halves(0.6), 5.0) == pytest.approx(compute_inertia(whole, 5.0), rel=1e-12)


def test_a_dumbbell_has_the_inertia_of_its_balls_at_their_distance() -> None:
    balls = tuple(SpherePart(kind="sphere", radius=0.1, position=(x, 0.0, 0.0)) for x in (-0.5, 0.5))
    own = 2 / 5 * 4.0 * 0.1**2
    far = own + 4.0 * 0.5**2
    assert compute_inertia(Compound(kind="compound", parts=balls), 4.0) == pytest.approx((own, far, far))


@pytest.mark.parametrize(
    ("alone", "part"),
    [
        (
            Cylinder(kind="cylinder", radius=0.1, length=0.5),
            CylinderPart(kind="cylinder", radius=0.1, length=0.5, position=(0.0, 0.0, 0.0)),
        ),
        (Sphere(kind="sphere", radius=0.2), SpherePart(kind="sphere", radius=0.2, position=(0.0, 0.0, 0.0))),
    ],
)
def test_a_compound_of_one_part_is_that_part(alone: Shape, part: CylinderPart | SpherePart) -> None:
    assert compute_inertia(Compound(kind="compound", parts=(part,)), 3.0) == pytest.approx(compute_inertia(alone, 3.0))


def test_a_token_that_knows_its_inertia_has_it_and_a_wrist_is_isotropic() -> None:
    hand, hammer = make_bodies(held(0.1, LEVEL))
    assert hammer.inertia == (0.0004, MOMENT, 0.0022)
    assert hand.inertia == (0.002, 0.002, 0.002)


def test_every_part_of_a_compound_is_drawn_where_it_is() -> None:
    task = held(0.1, LEVEL)
    drawn = [part.mesh.vertices for part in draw_tokens(task) if part.token == "hammer"]
    assert len(drawn) == len(HAMMER.parts)
    every = np.concatenate(drawn)
    assert every.min(axis=0) == pytest.approx([-0.175, -0.02, -0.045], abs=1e-6)
    assert every.max(axis=0) == pytest.approx([0.04, 0.02, 0.045], abs=1e-6)
    hammer = next(token for token in task.tokens if token.name == "hammer")
    assert np.linalg.norm(every, axis=1).max() <= bounding_radius(hammer)

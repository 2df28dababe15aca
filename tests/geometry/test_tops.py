"""Level tops of bodies."""

import numpy as np
import pytest

from hybrid_tamp.geometry.shapes import Box, BoxPart, Compound, Cylinder, Sphere
from hybrid_tamp.geometry.tops import find_tops
from hybrid_tamp.motion.poses import quaternion_from_rpy

HALVES = (0.5, 0.3, 0.1)
BOX = Box(kind="box", half_extents=HALVES)
STILL = np.array([0.0, 0.0, 0.0, 1.0])


def test_a_turned_box_has_a_top_with_four_edges() -> None:
    (top,) = find_tops(BOX, np.array([1.0, 2.0, 0.4]), quaternion_from_rpy([0.0, 0.0, 0.5]))
    assert top.height == pytest.approx(0.5)
    assert len(top.edges) == 4
    across = np.array([-np.sin(0.5), np.cos(0.5)])
    points = np.array([1.0, 2.0]) + across * np.array([[0.0], [0.2], [0.4]])
    assert np.allclose(top.depth(points), [0.3, 0.1, -0.1])


def test_a_box_on_another_face_has_another_top() -> None:
    (top,) = find_tops(BOX, np.array([0.0, 0.0, 0.5]), quaternion_from_rpy([0.0, np.pi / 2, 0.0]))
    assert top.height == pytest.approx(1.0)
    assert float(top.depth(np.zeros(2))) == pytest.approx(0.1)


def test_the_top_of_a_cylinder_is_almost_round() -> None:
    (top,) = find_tops(Cylinder(kind="cylinder", radius=0.2, length=0.4), np.array([0.0, 0.0, 0.2]), STILL)
    angles = np.linspace(0.0, 6.0, 20)
    depths = top.depth(0.15 * np.column_stack([np.cos(angles), np.sin(angles)]))
    assert np.all((depths <= 0.05) & (depths > 0.045))


@pytest.mark.parametrize(
    ("shape", "rpy"),
    [
        (Sphere(kind="sphere", radius=0.1), [0.0, 0.0, 0.0]),
        (BOX, [0.1, 0.0, 0.0]),
        (Cylinder(kind="cylinder", radius=0.2, length=0.4), [np.pi / 2, 0.0, 0.0]),
    ],
)
def test_a_body_without_a_level_face_has_no_top(shape: Sphere | Box | Cylinder, rpy: list[float]) -> None:
    tops = find_tops(shape, np.zeros(3), quaternion_from_rpy(rpy))
    # A lying cylinder is a prism with many thin faces, of which the highest may be level.
    assert not tops or max(float(top.depth(np.zeros(2))) for top in tops) < 0.02


def test_each_part_of_a_compound_has_a_top() -> None:
    parts = (
        BoxPart(kind="box", half_extents=HALVES, position=(0.0, 0.0, 0.7)),
        BoxPart(kind="box", half_extents=(0.05, 0.05, 0.3), position=(0.0, 0.0, 0.3)),
    )
    tops = find_tops(Compound(kind="compound", parts=parts), np.zeros(3), STILL)
    assert [round(top.height, 6) for top in tops] == [0.8, 0.6]

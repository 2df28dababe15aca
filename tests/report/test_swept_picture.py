"""The picture of swept paths, from movements made by hand."""

from collections.abc import Iterator
from io import BytesIO
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.path import Path as Outline
from PIL import Image
from scenes import rolling_task

from hybrid_tamp.errors import InputError
from hybrid_tamp.geometry.convex import placed
from hybrid_tamp.geometry.shapes import Box, BoxPart, Compound, Cylinder, Shape, Sphere
from hybrid_tamp.model.closest_pair import ClosestPair
from hybrid_tamp.model.plan import BlockInstance
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.refined import CLEAR, Shortfall
from hybrid_tamp.model.swept import SweptBody, SweptPath, SweptPlan
from hybrid_tamp.motion.poses import quaternion_from_rpy
from hybrid_tamp.report.swept.file import check_picture, write_picture
from hybrid_tamp.report.swept.legend import DISTINCT, colour_of, line_of
from hybrid_tamp.report.swept.outlines import Plane, outline, swept_area
from hybrid_tamp.report.swept.picture import draw_figure, swept_picture
from hybrid_tamp.report.swept.scene import SweptView, divide

TEE = Compound(
    kind="compound",
    parts=(
        BoxPart(kind="box", half_extents=(0.2, 0.02, 0.03), position=(0.0, 0.0, 0.0)),
        BoxPart(kind="box", half_extents=(0.02, 0.1, 0.03), position=(0.2, 0.0, 0.0), rpy=(0.3, 0.0, 0.0)),
    ),
)
SHAPES: list[Shape] = [
    Cylinder(kind="cylinder", radius=0.1, length=0.3),
    Box(kind="box", half_extents=(0.3, 0.1, 0.2)),
    Sphere(kind="sphere", radius=0.15),
    TEE,
]
UPRIGHT = np.array([0.0, 0.0, 0.0, 1.0])


def reach(number: int, distance: float = 0.02) -> SweptPath:
    """Return a reach of the hand over the drum, which ends beside the drum."""
    steps = np.linspace(0.0, 1.0, 12)[:, None]
    positions = np.array([0.25, -0.45, 0.3]) + steps * np.array([-0.45, 0.45 + 0.02 * number, -0.1])
    name = f"REACHING-{number}"
    instance = BlockInstance(name, "REACHING", {"hand": "hand 0"}, 0.0, 1.1)
    points = ((-0.18, 0.0, 0.2), (-0.1, 0.0, 0.2))
    pair = ClosestPair(name, "hand 0", "drum 0", distance, 1.0, points)
    body = SweptBody("hand 0", positions, np.tile(UPRIGHT, (12, 1)))
    return SweptPath(instance, (body,), np.linspace(0.0, 1.1, 12), pair)


def plan(count: int = 1, refused: Shortfall | None = None, distance: float = 0.02) -> SweptPlan:
    return SweptPlan(rolling_task(), tuple(reach(number + 1, distance) for number in range(count)), refused)


@pytest.mark.parametrize("plane", [(0, 1), (0, 2), (1, 2)])
@pytest.mark.parametrize("shape", SHAPES, ids=lambda shape: shape.kind)
def test_the_swept_area_covers_the_body_at_every_pose(shape: Shape, plane: Plane) -> None:
    rng = np.random.default_rng(3)
    turns = np.linspace(0.0, 1.0, 9)[:, None] * rng.uniform(-1.0, 1.0, 3)
    body = SweptBody("thing", np.cumsum(rng.uniform(-0.1, 0.2, (9, 3)), axis=0), quaternion_from_rpy(turns))
    areas = [Outline(each) for each in swept_area(shape, body, plane)]
    for position, orientation in zip(body.positions, body.orientations, strict=True):
        for solid in placed(shape, position, orientation):
            for direction in rng.normal(size=(10, 3)):
                point = (0.97 * solid.support(direction) + 0.03 * solid.position)[list(plane)]
                assert any(area.contains_point(point) for area in areas)


@pytest.mark.parametrize("shape", SHAPES, ids=lambda shape: shape.kind)
def test_outlines_turn_counter_clockwise_so_that_overlapping_areas_are_one_area(shape: Shape) -> None:
    for each in outline(shape, np.ones(3), quaternion_from_rpy(np.array([0.3, 0.7, -0.4])), (0, 2)):
        x, y = each.T
        assert np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)) > 0


@pytest.mark.parametrize(
    ("count", "sizes"), [(0, [0]), (1, [1]), (6, [6]), (7, [4, 3]), (13, [5, 5, 3]), (40, [7] * 5 + [5])]
)
def test_movements_in_one_group_of_views_have_different_colours_if_there_are_few(count: int, sizes: list[int]) -> None:
    chapters = divide(plan(count))
    assert [len(chapter.paths) for chapter in chapters] == sizes
    assert [number for chapter in chapters for number, _ in chapter.paths] == list(range(1, count + 1))
    if count <= DISTINCT * 6:
        for chapter in chapters:
            colours = [colour_of(number) for number, _ in chapter.paths]
            assert len(set(colours)) == len(colours)


def test_a_later_group_shows_the_hand_where_the_earlier_one_left_it() -> None:
    first, second = divide(plan(7))
    places = [
        next(token.outlines[0].mean(axis=0) for token in SweptView(chapter, (0, 1)).tokens if token.name == "hand 0")
        for chapter in (first, second)
    ]
    assert places[0] == pytest.approx([0.25, -0.45], abs=1e-6)
    assert places[1] == pytest.approx(first.paths[-1][1].bodies[0].positions[-1][:2], abs=1e-6)


def labels(swept: SweptPlan) -> Iterator[list[tuple[str, tuple[float, float, float, float]]]]:
    """Yield the labels of each view: texts with the left, lower, right and upper edge [pixels]."""
    figure = draw_figure(swept)
    renderer = FigureCanvasAgg(figure).get_renderer()
    for axes in figure.axes:
        found = []
        for text in axes.texts:
            if not text.get_text().isdecimal():
                box = text.get_window_extent(renderer)
                found.append((text.get_text(), (box.x0, box.y0, box.x1, box.y1)))
        yield found


@pytest.mark.parametrize("count", [1, 6, 9])
def test_labels_do_not_overlap_and_name_bodies_and_distances(count: int) -> None:
    views = list(labels(plan(count)))
    assert len(views) == 2 * len(divide(plan(count)))
    for found in views:
        assert {"hand 0", "drum 0", "region 0"} <= {text for text, _ in found}
        assert any(text.endswith(": 20 mm") for text, _ in found)
        for (one, mine), (other, theirs) in combinations(found, 2):
            apart = mine[2] <= theirs[0] or theirs[2] <= mine[0] or mine[3] <= theirs[1] or theirs[3] <= mine[1]
            assert apart, (one, other)


def test_a_refused_movement_shows_its_depth() -> None:
    refused = Shortfall("REACHING-1", Atom(CLEAR, ("hand 0", "drum 0")), "m", -0.03)
    swept = plan(1, refused, distance=-0.03)
    assert all("1: 30 mm deep" in [text for text, _ in found] for found in labels(swept))
    title = " ".join(text.get_text() for text in draw_figure(swept).texts)
    assert "refused in REACHING-1, because hand 0 hits drum 0, 0.03 m deep" in title
    assert line_of(swept.paths[0]) == "REACHING-1: hand 0 hits drum 0, 30 mm deep"


def test_a_task_without_movements_is_drawn_without_a_side_view() -> None:
    figure = draw_figure(plan(0))
    assert len(figure.axes) == 1
    assert "no plan" in figure.texts[0].get_text()


@pytest.mark.parametrize("form", ["png", "svg", "pdf"])
def test_equal_plans_have_equal_files(form: str) -> None:
    assert swept_picture(plan(2), form) == swept_picture(plan(2), form)


def test_a_picture_is_to_scale_and_1400_pixels_wide() -> None:
    with Image.open(BytesIO(swept_picture(plan(1)))) as picture:
        assert picture.width == 1400
    for axes in draw_figure(plan(1)).axes:
        (width, height), (left, right), (low, high) = axes.bbox.size, axes.get_xlim(), axes.get_ylim()
        assert width / (right - left) == pytest.approx(height / (high - low), rel=1e-6)


def test_the_suffix_of_the_file_is_checked_before_the_plan_is_made(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"must end in \.png, \.svg, \.pdf"):
        check_picture(tmp_path / "movements.jpg")
    with pytest.raises(InputError, match="must be in an existing folder"):
        check_picture(tmp_path / "none" / "movements.png")
    write_picture(plan(1), tmp_path / "movements.PNG")
    with pytest.raises(InputError, match="must not exist yet"):
        check_picture(tmp_path / "movements.PNG")
    check_picture(tmp_path / "movements.PNG", force=True)

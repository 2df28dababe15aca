"""Laws of the labels in pictures."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

from hybrid_tamp.physics.pictures.view import overlap
from hybrid_tamp.report.labels import Labels
from hybrid_tamp.report.lettering import Letters

SIZE = (640, 360)
across, along = st.integers(0, SIZE[0]), st.integers(0, SIZE[1])
box = st.tuples(across, along, across, along).map(
    lambda each: (min(each[0], each[2]), min(each[1], each[3]), max(each[0], each[2]), max(each[1], each[3]))
)
bodies = st.dictionaries(st.sampled_from([f"token-{number}" for number in range(12)]), box, max_size=12)


def labels(names: Any, size: int = 14) -> Labels:
    return Labels(dict.fromkeys(names, (0.2, 0.4, 0.8)), Letters(size))


@given(st.lists(bodies, min_size=1, max_size=4))
def test_labels_are_in_the_picture_and_do_not_overlap(pictures: Any) -> None:
    writer = labels([f"token-{number}" for number in range(12)])
    for boxes in pictures:
        places = list(writer.place(boxes, SIZE).values())
        for index, place in enumerate(places):
            assert 0 <= place[0] < place[2] <= SIZE[0]
            assert 0 <= place[1] < place[3] <= SIZE[1]
            assert not any(overlap(place, other) for other in places[:index])
        # There is room for all labels, so only tokens outside the picture have none.
        assert len(places) == sum(each[0] < each[2] and each[1] < each[3] for each in boxes.values())


def test_label_is_beside_its_body_and_hides_no_other_body() -> None:
    boxes = {"box": (200, 150, 300, 250), "hand": (310, 150, 340, 250), "tool": (160, 120, 195, 250)}
    places = labels(boxes).place(boxes, SIZE)
    for name, place in places.items():
        assert not any(overlap(place, body) for body in boxes.values())
        left, top, right, bottom = boxes[name]
        gaps = (left - place[2], place[0] - right, top - place[3], place[1] - bottom)
        assert max(gaps) < 30


def test_label_keeps_its_side_while_this_side_is_free() -> None:
    writer = labels(["hand", "box"])
    sides = []
    for x in range(200, 420, 5):
        places = writer.place({"hand": (x, 100, x + 30, 160), "box": (300, 40, 360, 90)}, SIZE)
        sides.append(np.sign(places["hand"][1] - 130))
    # While the hand passes below the box, its label changes to another side and back at most once.
    assert np.count_nonzero(np.diff(sides)) <= 2


def test_labels_without_room_are_left_out() -> None:
    names = [f"a long name {number}" for number in range(40)]
    places = labels(names).place(dict.fromkeys(names, (10, 10, 50, 50)), (200, 60))
    assert 0 < len(places) < 40
    assert labels(["x" * 100]).place({"x" * 100: (10, 10, 50, 50)}, (200, 60)) == {}


@pytest.mark.parametrize("name", ["drum", "Würfel", "a-very-long-name-of-a-token"])
def test_label_is_drawn_where_it_is_placed(name: str) -> None:
    picture = Image.new("RGB", SIZE, (90, 90, 90))
    boxes = {name: (300, 200, 340, 240)}
    labels([name]).draw(picture, boxes)
    left, top, right, bottom = labels([name]).place(boxes, SIZE)[name]
    changed = (np.asarray(picture) != 90).any(axis=2)
    assert changed[top + 3 : bottom - 3, left + 3 : right - 3].all()
    changed[top:bottom, left:right] = False
    assert not changed.any()

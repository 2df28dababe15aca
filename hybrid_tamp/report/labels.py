"""Labels with the names of tokens beside their bodies in a picture. Labels never overlap each other."""

from collections.abc import Iterable, Iterator, Mapping
from itertools import product

from PIL import Image, ImageDraw

from hybrid_tamp.physics.pictures.appearance import Colour
from hybrid_tamp.physics.pictures.view import Rectangle, overlap
from hybrid_tamp.report.lettering import Letters

_SIDES = (
    *((0.0, -1), (0.5, -1), (-0.5, -1), (1.0, 0), (-1.0, 0), (0.0, 1)),
    *((0.5, 1), (-0.5, 1), (1.0, -1), (-1.0, -1), (1.0, 1), (-1.0, 1)),
)
"""Directions from a body to its label, to the right and downward. Earlier directions are preferred."""
_RINGS = 4
_GRID = 8
_KEPT, _SIDE, _RING, _COVER, _ANYWHERE = 1.0, 0.08, 1.0, 4.0, 9.0
"""Costs of a place: its bonus if it is the place in the picture before, its side, its distance and covered bodies."""
_INK = (28, 33, 40)
_PAPER = (255, 255, 255, 225)


class Labels:
    """Writer of labels for the pictures of one file. A label keeps its side of the body while this side is free.

    Args:
        colours: maps each token that gets a label to its colour.
        letters: letters of the labels.
    """

    def __init__(self, colours: Mapping[str, Colour], letters: Letters) -> None:
        self._colours = colours
        self._letters = letters
        self._gap = max(letters.size // 3, 2)
        self._height = letters.size + 2 * self._gap
        self._before: dict[str, int] = {}

    def draw(self, picture: Image.Image, bodies: Mapping[str, Rectangle]) -> None:
        """Draw the labels.

        Args:
            picture: picture of the scene, which is changed.
            bodies: maps each token to the part of the picture in which the token appears.
        """
        draw = ImageDraw.Draw(picture, "RGBA")
        places = self.place(bodies, picture.size)
        for name, place in places.items():
            self._connect(draw, place, bodies[name], self._dark(name))
        for name, place in places.items():
            corners = (place[0], place[1], place[2] - 1, place[3] - 1)
            draw.rounded_rectangle(corners, self._gap, fill=_PAPER, outline=self._dark(name), width=self._gap // 4 + 1)
            middle = ((place[0] + place[2]) / 2, (place[1] + place[3]) / 2)
            draw.text(middle, name, _INK, self._letters.font, anchor="mm")

    def place(self, bodies: Mapping[str, Rectangle], size: tuple[int, int]) -> dict[str, Rectangle]:
        """Return the place of each label. Tokens outside the picture, and labels without a free place, are left out.

        Args:
            bodies: maps each token to the part of the picture in which the token appears.
            size: width and height of the picture [pixels].
        """
        placed: dict[str, Rectangle] = {}
        for name in self._colours:
            body = bodies.get(name)
            if body is None or body[0] >= body[2] or body[1] >= body[3]:
                continue
            width = int(self._letters.width(name)) + 3 * self._gap
            choices = _places(body, (width, self._height), self._gap, size)
            best = self._choose(name, choices, body, bodies.values(), placed.values())
            if best is not None:
                self._before[name], placed[name] = best
        return placed

    def _choose(
        self,
        name: str,
        choices: Iterable[Rectangle],
        body: Rectangle,
        bodies: Iterable[Rectangle],
        others: Iterable[Rectangle],
    ) -> tuple[int, Rectangle] | None:
        """Return the number and the place of the cheapest choice that overlaps no other label, or None."""
        best: tuple[float, int, Rectangle] | None = None
        before = self._before.get(name, -1)
        for index, place in enumerate(choices):
            # No later place can be cheaper, because the distance grows.
            if best is not None and index > before and best[0] <= _RING * (index // len(_SIDES)):
                break
            if any(overlap(place, other) for other in others):
                continue
            cost = _cost(index, place, body, bodies) - _KEPT * (index == before)
            if best is None or cost < best[0]:
                best = (cost, index, place)
        return None if best is None else best[1:]

    def _dark(self, name: str) -> tuple[int, int, int]:
        red, green, blue = (round(150 * channel) for channel in self._colours[name])
        return red, green, blue

    def _connect(
        self, draw: ImageDraw.ImageDraw, place: Rectangle, body: Rectangle, colour: tuple[int, int, int]
    ) -> None:
        """Draw a line from a label to its body if the label does not touch the body."""
        leader = self.lead(place, body)
        if leader is not None:
            draw.line(leader, fill=colour, width=self._gap // 4 + 1)

    def lead(self, place: Rectangle, body: Rectangle) -> list[tuple[float, float]] | None:
        """Return the ends of a line from a label to its body, or None if the label is near the body."""
        start = _nearest(place, _middle(body))
        end = _nearest(body, start)
        if max(abs(start[0] - end[0]), abs(start[1] - end[1])) <= 2 * self._gap:
            return None
        # The line ends inside the rectangle, which is usually larger than the body.
        return [start, ((end[0] + _middle(body)[0]) / 2, (end[1] + _middle(body)[1]) / 2)]


def _places(body: Rectangle, label: tuple[int, int], gap: int, size: tuple[int, int]) -> Iterator[Rectangle]:
    """Yield places beside a body, at growing distances, and then places anywhere in the picture."""
    width, height = label
    # No label touches the edge of the picture, unless the picture is too narrow.
    border = max(min(gap, (size[0] - width) // 2, (size[1] - height) // 2), 0)
    if width > size[0] or height > size[1]:
        return
    x, y = _middle(body)
    for ring in range(_RINGS):
        away = gap + ring * 1.3 * height
        for right, down in _SIDES:
            beside = width / 2 if abs(right) == 1 else 0.0
            across = x + right * ((body[2] - body[0]) / 2 + (away if down == 0 else ring * height) + beside)
            along = y + down * ((body[3] - body[1]) / 2 + away + height / 2)
            yield _inside(across - width / 2, along - height / 2, label, size, border)
    for row, column in product(range(_GRID), repeat=2):
        yield _inside(column * size[0] / _GRID, row * size[1] / _GRID, label, size, border)


def _inside(left: float, top: float, label: tuple[int, int], size: tuple[int, int], border: int) -> Rectangle:
    x = int(min(max(left, border), size[0] - label[0] - border))
    y = int(min(max(top, border), size[1] - label[1] - border))
    return x, y, x + label[0], y + label[1]


def _cost(index: int, place: Rectangle, body: Rectangle, bodies: Iterable[Rectangle]) -> float:
    ring, side = divmod(index, len(_SIDES))
    covered = sum(_area(_common(place, other)) for other in bodies) / _area(place)
    if ring < _RINGS:
        return _RING * ring + _SIDE * side + _COVER * covered
    end = _nearest(place, _middle(body))
    away = abs(end[0] - _middle(body)[0]) + abs(end[1] - _middle(body)[1])
    return _ANYWHERE + away / (place[3] - place[1]) + _COVER * covered


def _common(one: Rectangle, other: Rectangle) -> Rectangle:
    return max(one[0], other[0]), max(one[1], other[1]), min(one[2], other[2]), min(one[3], other[3])


def _area(each: Rectangle) -> int:
    return max(each[2] - each[0], 0) * max(each[3] - each[1], 0)


def _middle(each: Rectangle) -> tuple[float, float]:
    return (each[0] + each[2]) / 2, (each[1] + each[3]) / 2


def _nearest(each: Rectangle, point: tuple[float, float]) -> tuple[float, float]:
    """Return the point of a rectangle that is nearest to a point."""
    return min(max(point[0], each[0]), each[2]), min(max(point[1], each[1]), each[3])

"""Appearance of tokens in pictures. Tokens are coloured meshes, and marks on the meshes make rotations visible."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from hybrid_tamp.geometry.meshes import MeshShape
from hybrid_tamp.geometry.shapes import Box, Compound, Cylinder, Solid, solids_of
from hybrid_tamp.geometry.triangles import Mesh, box, cylinder, placed_solid, solid
from hybrid_tamp.model.affordance import TOKEN
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.physics.pictures.outlines import disc_radius, is_raised
from hybrid_tamp.physics.pictures.subject import goal_reach, goal_tokens

Colour = tuple[float, float, float]
"""Components red, green and blue, each from 0 to 1."""

HANDS: Sequence[Colour] = ((0.16, 0.40, 0.74), (0.45, 0.32, 0.70), (0.05, 0.52, 0.62))
THINGS: Sequence[Colour] = (
    *((0.93, 0.58, 0.16), (0.80, 0.28, 0.22), (0.78, 0.45, 0.66)),
    *((0.90, 0.78, 0.22), (0.55, 0.36, 0.24), (0.45, 0.52, 0.18)),
)
GOALS: Sequence[Colour] = ((0.07, 0.60, 0.33),)
FIXED_GOALS: Sequence[Colour] = ((0.44, 0.76, 0.56),)
BYSTANDERS: Sequence[Colour] = ((0.62, 0.60, 0.58),)
PLACES: Sequence[Colour] = ((0.52, 0.60, 0.68), (0.66, 0.60, 0.50))
_SHADES = (0.0, 0.32, -0.28, 0.55, -0.5)
_MARK = 0.35
_THIN = 0.002
_DARK = 0.45
_SEAM = 0.78


@dataclass(frozen=True, eq=False)
class ColouredMesh:
    """A coloured mesh of a token, in the token's body frame.

    Attributes:
        token: name of the token.
        mesh: surface to draw. The surface is convex.
        colour: colour of the surface.
        mark: whether the mesh is only a mark on another mesh of the token.
    """

    token: str
    mesh: Mesh
    colour: Colour
    mark: bool = False


def choose_colours(task: Task) -> Mapping[str, Colour]:
    """Map each token to its colour. Tokens with the same classes have shades of the same colour.

    Hands are blue or violet, objects that blocks can use have warm colours, places in the goal are green, and other
    tokens are grey.
    """
    groups: dict[tuple[int, str], tuple[Colour, list[str]]] = {}
    goals = goal_tokens(task)
    for token in task.tokens:
        scale = _scale_of(token, goals)
        key = (id(scale), class_text(token))
        if key not in groups:
            groups[key] = (scale[sum(known == id(scale) for known, _ in groups) % len(scale)], [])
        groups[key][1].append(token.name)
    return {
        name: _shaded(colour, _SHADES[number % len(_SHADES)])
        for colour, names in groups.values()
        for number, name in enumerate(names)
    }


def legend(task: Task) -> tuple[tuple[str, Colour], ...]:
    """Return pairs of (classes, colour) in the order of the tokens. The classes of several tokens occur once."""
    found: dict[tuple[int, str], tuple[str, Colour]] = {}
    colours, goals = choose_colours(task), goal_tokens(task)
    for token in task.tokens:
        text, goal = class_text(token), token.place and token.name in goals
        found.setdefault((id(_scale_of(token, goals)), text), (f"{text} (goal)" if goal else text, colours[token.name]))
    return tuple(found.values())


def class_text(token: Token) -> str:
    """Return the names of the token's classes, e.g. ``GRASPABLE, STRIKER``, without the class of all tokens."""
    named = [each.name for each in token.classes if each is not TOKEN]
    return ", ".join(named) or ("unknown class" if token.unknown else TOKEN.name)


def draw_tokens(task: Task) -> list[ColouredMesh]:
    """Return the meshes of all tokens with a shape, and of all discs above the floor."""
    colours = choose_colours(task)
    discs = [
        each
        for token in task.tokens
        if is_raised(task.state, token)
        for each in _draw_disc(token.name, disc_radius(token), goal_reach(task, token), colours[token.name])
    ]
    return [*discs, *(each for token in task.tokens for each in _draw_token(token, colours[token.name]))]


def _scale_of(token: Token, goals: frozenset[str]) -> Sequence[Colour]:
    if token.place:
        if token.name not in goals:
            return PLACES
        # A large body is paler than a disc, so that smaller objects remain conspicuous.
        return GOALS if token.shape is None else FIXED_GOALS
    if token.bystander:
        return BYSTANDERS
    return HANDS if token.basic_actions else THINGS


def _draw_token(token: Token, colour: Colour) -> Iterator[ColouredMesh]:
    if token.shape is None:
        return
    if isinstance(token.shape, Compound | MeshShape):
        yield from _compound(token.name, token.shape, colour)
        return
    yield ColouredMesh(token.name, solid(token.shape), colour)
    if not token.fixed_body and not token.place and not token.basic_actions:
        yield ColouredMesh(token.name, _mark(token.shape), _shaded(colour, -_DARK), mark=True)


def _draw_disc(name: str, radius: float, reach: float, colour: Colour) -> Iterator[ColouredMesh]:
    """Yield a disc, and a cross whose arms reach beyond the objects on the disc."""
    yield ColouredMesh(name, cylinder(radius, 2.0 * _THIN), colour)
    if reach > 0.0:
        for halves in ((reach, 2.0 * _THIN, _THIN), (2.0 * _THIN, reach, _THIN)):
            yield ColouredMesh(name, box(halves), colour)


def _compound(name: str, shape: Compound | MeshShape, colour: Colour) -> Iterator[ColouredMesh]:
    """Yield one mesh per convex solid of a shape. Two alternating shades make rotations of the shape visible."""
    shades = (colour, _shaded(colour, _SEAM - 1))
    for number, each in enumerate(solids_of(shape)):
        yield ColouredMesh(name, placed_solid(each), shades[number % 2])


def _mark(shape: Solid) -> Mesh:
    """Return a mark on the surface of a solid. The mark makes rotations of the solid visible."""
    if isinstance(shape, Cylinder):
        return box((shape.radius * 1.006, shape.radius * 0.1, shape.length / 2 + _THIN))
    if isinstance(shape, Box):
        x, y, z = shape.half_extents
        return box((x * _MARK, y * _MARK, _THIN)).moved([0, 0, z])
    return cylinder(shape.radius * 1.004, shape.radius * 0.12)


def _shaded(colour: Colour, amount: float) -> Colour:
    """Return the colour mixed with white (`amount` up to 1) or with black (`amount` down to -1)."""
    end = 1.0 if amount > 0 else 0.0
    red, green, blue = (channel + abs(amount) * (end - channel) for channel in colour)
    return (red, green, blue)

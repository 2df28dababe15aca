"""Appearance of tokens in pictures. Tokens are coloured meshes, and marks on the meshes make rotations visible."""

from collections.abc import Sequence
from dataclasses import dataclass

from hybrid_tamp.geometry.meshes import MeshShape
from hybrid_tamp.geometry.shapes import Box, Compound, Cylinder, Solid, solids_of
from hybrid_tamp.geometry.triangles import Mesh, box, cylinder, disc, joined, solid
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.poses import quaternion_from_rpy
from hybrid_tamp.physics.pictures.camera import disc_radius

Colour = tuple[float, float, float]
"""Components red, green and blue, each from 0 to 1."""

HANDS: Sequence[Colour] = ((0.24, 0.44, 0.78), (0.13, 0.60, 0.72), (0.42, 0.38, 0.76), (0.30, 0.30, 0.45))
THINGS: Sequence[Colour] = ((0.95, 0.65, 0.28), (0.88, 0.42, 0.36), (0.72, 0.50, 0.74), (0.80, 0.72, 0.38))
PLACES: Sequence[Colour] = ((0.62, 0.85, 0.66), (0.62, 0.80, 0.88), (0.86, 0.82, 0.62))
_RIM = 0.06
_MARK = 0.35
_THIN = 0.002
_HAIRLINE = 0.2
_SHADE = 0.7


@dataclass(frozen=True, eq=False)
class ColouredMesh:
    """A coloured mesh of a token, in the token's body frame.

    Attributes:
        token: name of the token.
        mesh: surface to draw.
        colour: colour of the surface.
        flat: whether the mesh is drawn flat on the floor, regardless of the token's height and orientation.
    """

    token: str
    mesh: Mesh
    colour: Colour
    flat: bool = False


def draw_tokens(task: Task) -> list[ColouredMesh]:
    """Return the meshes of all tokens. Hands are blue, other objects have warm colours, and places are green."""
    found: list[ColouredMesh] = []
    counts: dict[int, int] = {}
    for token in task.tokens:
        shades = PLACES if token.place else HANDS if token.basic_actions else THINGS
        count = counts.get(id(shades), 0)
        counts[id(shades)] = count + 1
        found += _draw_token(token, shades[count % len(shades)])
    return found


def _draw_token(token: Token, colour: Colour) -> list[ColouredMesh]:
    dark = _darker(colour, 0.5)
    if token.shape is None:
        radius = disc_radius(token)
        # The rim is slightly above the floor, and the disc is slightly above the rim, to avoid flicker.
        rim = disc(radius).moved([0, 0, _THIN])
        inner = disc(radius * (1 - _RIM)).moved([0, 0, 2 * _THIN])
        green = _darker(colour, 0.6)
        return [
            ColouredMesh(token.name, _cross(radius), green, True),
            ColouredMesh(token.name, rim, green, True),
            ColouredMesh(token.name, inner, colour, True),
        ]
    if isinstance(token.shape, Compound | MeshShape):
        return _compound(token.name, token.shape, colour)
    body = ColouredMesh(token.name, solid(token.shape), colour)
    if token.place or token.basic_actions:
        return [body]
    return [body, ColouredMesh(token.name, _mark(token.shape), dark)]


def _compound(name: str, shape: Compound | MeshShape, colour: Colour) -> list[ColouredMesh]:
    """Return one mesh per convex solid of a shape. Two alternating shades make rotations of the shape visible."""
    solids = solids_of(shape)
    meshes = [solid(each).turned(quaternion_from_rpy(each.rpy)).moved(each.position) for each in solids]
    shades = (colour, _darker(colour, _SHADE))
    return [ColouredMesh(name, mesh, shades[number % 2]) for number, mesh in enumerate(meshes)]


def _cross(radius: float) -> Mesh:
    """Return two crossed hairlines that extend beyond the disc of a place. An object on the disc does not hide them."""
    arm = radius + _HAIRLINE
    return joined(box((arm, _THIN, _THIN / 2)), box((_THIN, arm, _THIN / 2)))


def _mark(shape: Solid) -> Mesh:
    """Return a mark on the surface of a solid. The mark makes rotations of the solid visible."""
    if isinstance(shape, Cylinder):
        return box((shape.radius * 1.006, shape.radius * 0.1, shape.length / 2 + _THIN))
    if isinstance(shape, Box):
        x, y, z = shape.half_extents
        return box((x * _MARK, y * _MARK, _THIN)).moved([0, 0, z])
    return cylinder(shape.radius * 1.004, shape.radius * 0.12)


def _darker(colour: Colour, factor: float) -> Colour:
    red, green, blue = (channel * factor for channel in colour)
    return (red, green, blue)

"""Classes of objects that can be rolled or tumbled."""

from collections.abc import Iterable
from typing import Annotated, ClassVar

from pydantic import AfterValidator

from hybrid_tamp.authoring import (
    AffordanceClass,
    Box,
    Cylinder,
    Direction,
    MeshShape,
    Shape,
    State,
    Token,
    Vector3,
    quantity,
    rolling_likelihood,
    tumbling_likelihood,
)

from ..common.classes import (
    BoxShaped,
    Extents,
    find_box_fault,
    friction_property,
    mass_property,
    not_negative,
    positive,
)
from .standing import start_complaint


class Rollable(AffordanceClass):
    """Objects that can be rolled about an axis (paper, Sec. II-A)."""

    name: ClassVar[str] = "ROLLABLE"

    axis_of_rotation: Direction = quantity("1", "axis of rotation in the body frame")
    radius_of_rotation: float = positive("m", "radius of the rolling surface", 10)
    mass: float = mass_property()
    friction: float = friction_property()
    rolling_friction: float = not_negative("m", "rolling friction: torque per normal force", 1, default=0.005)

    @classmethod
    def features(cls, shape: Shape) -> float:
        """Return how round the shape is about its roundest axis."""
        return rolling_likelihood(shape)

    @staticmethod
    def consistent(token: Token) -> str | None:
        """Return an error message if the shape contradicts the radius of rotation, otherwise None."""
        radius = token["radius_of_rotation"]
        if isinstance(token.shape, Cylinder) and abs(token.shape.radius - radius) > 0.01 * radius:
            return f"radius_of_rotation must equal the radius of the shape, {token.shape.radius} m, got {radius} m"
        if isinstance(token.shape, Box):
            return "a box does not roll: give the token another shape, or remove the class ROLLABLE"
        return None


def _none_negative(vector: Vector3) -> Vector3:
    if min(vector) < 0:
        raise ValueError("all three components must be at least 0")
    return vector


class Tumblable(BoxShaped, AffordanceClass):
    """Objects that several hands can tumble from face to face (paper, Sec. III-A)."""

    name: ClassVar[str] = "TUMBLABLE"

    half_extents: Extents = quantity("m", "half of the edge lengths along x, y, z")
    hollow: Annotated[Vector3, AfterValidator(_none_negative)] = quantity(
        "m", "depth of the hollow in which hands touch the x, y and z faces", default=(0.0, 0.0, 0.0)
    )
    # Declared exactly as in ROLLABLE, so that a token may be a member of both.
    mass: float = mass_property()
    friction: float = friction_property()

    @classmethod
    def features(cls, shape: Shape) -> float:
        """Return how likely the shape can be tumbled: how flat and wide its four sides around some axis are."""
        return tumbling_likelihood(shape)

    @staticmethod
    def consistent(token: Token) -> str | None:
        """Return an error message if the hollow or the shape does not fit the half extents, otherwise None."""
        halves = token["half_extents"]
        if any(depth >= half for depth, half in zip(token["hollow"], halves, strict=True)):
            return f"hollow must be less than half_extents in each component, {halves} m, got {token['hollow']} m"
        if isinstance(token.shape, MeshShape):
            lower, upper = token.shape.corners.tolist()
            ends = [(abs(end), half) for row in (lower, upper) for end, half in zip(row, halves, strict=True)]
            if any(abs(end - half) > 0.03 * half for end, half in ends):
                return f"half_extents must fit the mesh, which extends from {lower} to {upper} m, got {halves} m"
            return None
        other = "the shape of a TUMBLABLE token must be a box or a mesh: remove the shape or the class"
        return find_box_fault(token, other)

    @staticmethod
    def consistent_start(token: Token, state: State, tokens: Iterable[Token]) -> str | None:
        """Return an error message if the box is in no posture or is too high to be tumbled, otherwise None."""
        return start_complaint(token, state, tokens)

"""Classes of things that roll and of things that tumble."""

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
    """Can be rolled about an axis (paper, Sec. II-A)."""

    name: ClassVar[str] = "ROLLABLE"

    axis_of_rotation: Direction = quantity("1", "axis of rotation in the body frame")
    radius_of_rotation: float = positive("m", "radius on which it rolls", 10)
    mass: float = mass_property()
    friction: float = friction_property()
    rolling_friction: float = not_negative("m", "rolling friction: torque per normal force", 1, default=0.005)

    @classmethod
    def features(cls, shape: Shape) -> float:
        """Return how round the shape is about its roundest axis."""
        return rolling_likelihood(shape)

    @staticmethod
    def consistent(token: Token) -> str | None:
        """Complain about a shape that contradicts the radius of rotation."""
        radius = token["radius_of_rotation"]
        if isinstance(token.shape, Cylinder) and abs(token.shape.radius - radius) > 0.01 * radius:
            return f"radius_of_rotation is {radius} m, but the radius of its shape is {token.shape.radius} m"
        if isinstance(token.shape, Box):
            return "a box does not roll: give it another shape, or do not make it a member of ROLLABLE"
        return None


def _none_negative(vector: Vector3) -> Vector3:
    if min(vector) < 0:
        raise ValueError("none of the three may be less than 0")
    return vector


class Tumblable(BoxShaped, AffordanceClass):
    """Can be tumbled from face to face by several hands (paper, Sec. III-A)."""

    name: ClassVar[str] = "TUMBLABLE"

    half_extents: Extents = quantity("m", "half of the edge lengths along x, y, z")
    hollow: Annotated[Vector3, AfterValidator(_none_negative)] = quantity(
        "m", "how far behind the planes of the faces across x, y, z hands touch it", default=(0.0, 0.0, 0.0)
    )
    # Declared exactly as in ROLLABLE, so that a token may be a member of both.
    mass: float = mass_property()
    friction: float = friction_property()

    @classmethod
    def features(cls, shape: Shape) -> float:
        """Return how flat and wide four sides of the shape about some axis are."""
        return tumbling_likelihood(shape)

    @staticmethod
    def consistent(token: Token) -> str | None:
        """Complain about a box or a mesh that does not fit the half extents."""
        halves = token["half_extents"]
        if any(depth >= half for depth, half in zip(token["hollow"], halves, strict=True)):
            return f"hollow is {token['hollow']} m, which is not less than the half_extents {halves} m"
        if isinstance(token.shape, MeshShape):
            lower, upper = token.shape.corners.tolist()
            ends = [(abs(end), half) for row in (lower, upper) for end, half in zip(row, halves, strict=True)]
            if any(abs(end - half) > 0.03 * half for end, half in ends):
                return f"half_extents are {halves} m, but its mesh reaches from {lower} to {upper} m"
            return None
        other = "what tumbles is a box or a mesh so far: remove the shape, or do not make it a member of TUMBLABLE"
        return find_box_fault(token, other)

    @staticmethod
    def consistent_start(token: Token, state: State, tokens: Iterable[Token]) -> str | None:
        """Complain about a box that stands in no posture, or higher than the method of tumbling reaches."""
        return start_complaint(token, state, tokens)

"""What rolls and what tumbles."""

from collections.abc import Iterable, Mapping
from typing import Annotated, Any, ClassVar

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

from ..common.classes import Extents
from .standing import start_complaint


class Rollable(AffordanceClass):
    """Can be rolled about an axis (paper, Sec. II-A)."""

    name: ClassVar[str] = "ROLLABLE"

    axis_of_rotation: Direction = quantity("1", "axis of rotation in the body frame")
    radius_of_rotation: float = quantity("m", "radius on which it rolls", gt=0, le=10, strict=True, allow_inf_nan=False)
    mass: float = quantity("kg", "mass", gt=0, le=1e6, strict=True, allow_inf_nan=False)
    friction: float = quantity("1", "Coulomb friction coefficient", ge=0, le=5, strict=True, allow_inf_nan=False)
    rolling_friction: float = quantity(
        "m",
        "rolling friction: torque per normal force",
        default=0.005,
        ge=0,
        le=1,
        strict=True,
        allow_inf_nan=False,
    )

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


class Tumblable(AffordanceClass):
    """Can be tumbled from face to face by several hands (paper, Sec. III-A)."""

    name: ClassVar[str] = "TUMBLABLE"

    half_extents: Extents = quantity("m", "half of the edge lengths along x, y, z")
    hollow: Annotated[Vector3, AfterValidator(_none_negative)] = quantity(
        "m", "how far behind the planes of the faces across x, y, z hands touch it", default=(0.0, 0.0, 0.0)
    )
    # Declared exactly as in ROLLABLE, so that a token may be a member of both.
    mass: float = quantity("kg", "mass", gt=0, le=1e6, strict=True, allow_inf_nan=False)
    friction: float = quantity("1", "Coulomb friction coefficient", ge=0, le=5, strict=True, allow_inf_nan=False)

    @classmethod
    def features(cls, shape: Shape) -> float:
        """Return how flat and wide the shape stands on four sides about some axis."""
        return tumbling_likelihood(shape)

    @classmethod
    def default_shape(cls, properties: Mapping[str, Any]) -> Shape | None:
        """Return the box of these half extents."""
        return Box(kind="box", half_extents=properties["half_extents"])

    @staticmethod
    def consistent(token: Token) -> str | None:
        """Complain about a shape that the box of the half extents is not, or of a mesh does not hold."""
        halves = token["half_extents"]
        if any(depth >= half for depth, half in zip(token["hollow"], halves, strict=True)):
            return f"hollow is {token['hollow']} m, which is not less than the half_extents {halves} m"
        if isinstance(token.shape, MeshShape):
            lower, upper = token.shape.corners.tolist()
            ends = [(abs(end), half) for row in (lower, upper) for end, half in zip(row, halves, strict=True)]
            if any(abs(end - half) > 0.03 * half for end, half in ends):
                return f"half_extents are {halves} m, but its mesh reaches from {lower} to {upper} m"
            return None
        if not isinstance(token.shape, Box):
            return "what tumbles is a box or a mesh so far: remove the shape, or do not make it a member of TUMBLABLE"
        if any(abs(one - other) > 0.01 * one for one, other in zip(halves, token.shape.half_extents, strict=True)):
            return f"half_extents are {halves} m, but those of its shape are {token.shape.half_extents} m"
        return None

    @staticmethod
    def consistent_start(token: Token, state: State, tokens: Iterable[Token]) -> str | None:
        """Complain about a box that stands in no posture, or higher than the method of tumbling reaches."""
        return start_complaint(token, state, tokens)

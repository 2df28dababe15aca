"""Classes of objects that can be rolled or tumbled."""

from collections.abc import Iterable, Mapping
from typing import Annotated, ClassVar

from pydantic import AfterValidator

from hybrid_tamp.authoring import (
    AffordanceClass,
    AxisOfRotation,
    Box,
    Direction,
    HollowDepths,
    MeshShape,
    RadiusOfRotation,
    Shape,
    ShapeFeature,
    State,
    Token,
    Vector3,
    quantity,
    rolling_likelihood,
    tumbling_likelihood,
)
from hybrid_tamp.skills import (
    BoxShaped,
    Extents,
    Grounded,
    find_box_fault,
    friction_property,
    mass_property,
    not_negative,
    positive,
)

from .standing import start_complaint


class Rollable(Grounded, AffordanceClass):
    """Objects that can be rolled about an axis (paper, Sec. II-A)."""

    name: ClassVar[str] = "ROLLABLE"
    of_shape: ClassVar[Mapping[str, ShapeFeature]] = {
        "axis_of_rotation": AxisOfRotation(),
        "radius_of_rotation": RadiusOfRotation("axis_of_rotation"),
    }

    axis_of_rotation: Direction = quantity("1", "axis of rotation in the body frame")
    radius_of_rotation: float = positive("m", "radius of the rolling surface", 10)
    mass: float = mass_property()
    friction: float = friction_property()
    rolling_friction: float = not_negative("m", "rolling friction, as torque per normal force", 1, default=0.005)

    @classmethod
    def features(cls, shape: Shape) -> float:
        """Return a measure of the shape's roundness about its roundest axis."""
        return rolling_likelihood(shape)

    @staticmethod
    def consistent(token: Token) -> str | None:
        """Return an error message if the shape is a box, otherwise None."""
        if isinstance(token.shape, Box):
            return "a ROLLABLE token must not be a box; change the token's shape or remove its class ROLLABLE"
        return None


def _none_negative(vector: Vector3) -> Vector3:
    if min(vector) < 0:
        raise ValueError("all three components must be at least 0")
    return vector


class Tumblable(BoxShaped, AffordanceClass):
    """Objects that several hands can tumble from face to face (paper, Sec. III-A)."""

    name: ClassVar[str] = "TUMBLABLE"
    of_shape: ClassVar[Mapping[str, ShapeFeature]] = {**BoxShaped.of_shape, "hollow": HollowDepths()}

    half_extents: Extents = quantity("m", "half of each edge length along x, y and z")
    hollow: Annotated[Vector3, AfterValidator(_none_negative)] = quantity(
        "m", "depth of the hollows in the x, y and z faces; hands touch their bottoms", default=(0.0, 0.0, 0.0)
    )
    # Declared exactly as in ROLLABLE, so that a token may belong to both classes.
    mass: float = mass_property()
    friction: float = friction_property()

    @classmethod
    def features(cls, shape: Shape) -> float:
        """Return a measure of the flatness and width of the shape's four sides around its best axis."""
        return tumbling_likelihood(shape)

    @staticmethod
    def consistent(token: Token) -> str | None:
        """Return an error message if the hollow or the shape does not fit the half extents, otherwise None."""
        halves = token["half_extents"]
        if any(depth >= half for depth, half in zip(token["hollow"], halves, strict=True)):
            return f"hollow must be less than half_extents in x, y and z; got {token['hollow']} m and {halves} m"
        if isinstance(token.shape, MeshShape):
            return None
        other = "a TUMBLABLE token must be a box or a mesh; remove the token's shape or its class TUMBLABLE"
        return find_box_fault(token, other)

    @staticmethod
    def consistent_start(token: Token, state: State, tokens: Iterable[Token]) -> str | None:
        """Return an error message if the box is in no posture or is too high to be tumbled, otherwise None."""
        return start_complaint(token, state, tokens)

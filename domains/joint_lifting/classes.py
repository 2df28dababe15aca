"""What hands lift between them."""

from collections.abc import Iterable, Mapping
from typing import Any, ClassVar

from hybrid_tamp.authoring import AffordanceClass, Box, Shape, State, Token, quantity

from ..common.classes import Extents
from .places import FLOOR_TOLERANCE, corner_heights


class Liftable(AffordanceClass):
    """Can be lifted by hands that squeeze it from two opposite sides (paper, Sec. II-E)."""

    name: ClassVar[str] = "LIFTABLE"

    half_extents: Extents = quantity("m", "half of the edge lengths along x, y, z; hands squeeze it along x")
    mass: float = quantity("kg", "mass", gt=0, le=1e6, strict=True, allow_inf_nan=False)
    friction: float = quantity("1", "Coulomb friction coefficient", ge=0, le=5, strict=True, allow_inf_nan=False)

    @classmethod
    def default_shape(cls, properties: Mapping[str, Any]) -> Shape | None:
        """Return the box of these half extents."""
        return Box(kind="box", half_extents=properties["half_extents"])

    @staticmethod
    def consistent(token: Token) -> str | None:
        """Complain about a shape that the box of the half extents is not."""
        halves = token["half_extents"]
        if not isinstance(token.shape, Box):
            return "what is lifted is a box so far: remove the shape, or do not make it a member of LIFTABLE"
        if any(abs(one - other) > 0.01 * one for one, other in zip(halves, token.shape.half_extents, strict=True)):
            return f"half_extents are {halves} m, but those of its shape are {token.shape.half_extents} m"
        return None

    @staticmethod
    def consistent_start(token: Token, state: State, tokens: Iterable[Token]) -> str | None:
        """Complain about a box that does not stand on its bottom face."""
        heights = corner_heights(state, token)
        if abs(heights).max() <= FLOOR_TOLERANCE:
            return None
        low, high = (round(float(end), 4) + 0.0 for end in (heights.min(), heights.max()))
        return (
            f"the corners of its bottom face are {low:g} to {high:g} m above the floor; what is LIFTABLE stands on "
            "its bottom face, the one at -z of its frame"
        )

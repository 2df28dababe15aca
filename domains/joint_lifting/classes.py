"""The class of boxes that several hands can lift together."""

from collections.abc import Iterable
from typing import ClassVar

from hybrid_tamp.authoring import AffordanceClass, State, Token, quantity
from hybrid_tamp.skills import BoxShaped, Extents, find_box_fault, friction_property, mass_property

from .places import FLOOR_TOLERANCE, corner_heights


class Liftable(BoxShaped, AffordanceClass):
    """Boxes that hands can lift by squeezing two opposite sides (paper, Sec. II-E)."""

    name: ClassVar[str] = "LIFTABLE"

    half_extents: Extents = quantity("m", "half of each edge length along x, y and z; hands squeeze along x")
    mass: float = mass_property()
    friction: float = friction_property()

    @staticmethod
    def consistent(token: Token) -> str | None:
        """Return an error message if the shape is not a box with the half extents, otherwise None."""
        return find_box_fault(token, "a LIFTABLE token must be a box; remove the token's shape or its class LIFTABLE")

    @staticmethod
    def consistent_start(token: Token, state: State, tokens: Iterable[Token]) -> str | None:
        """Return an error message if the box does not stand on its bottom face, otherwise None."""
        heights = corner_heights(state, token)
        if abs(heights).max() <= FLOOR_TOLERANCE:
            return None
        low, high = (round(float(end), 4) + 0.0 for end in (heights.min(), heights.max()))
        return (
            f"a LIFTABLE box must stand on its bottom face (-z in its body frame), but the corners of this face are "
            f"{low:g} to {high:g} m above {token.ground.text}"
        )

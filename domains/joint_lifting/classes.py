"""The class of boxes that hands lift together."""

from collections.abc import Iterable
from typing import ClassVar

from hybrid_tamp.authoring import AffordanceClass, State, Token, quantity

from ..common.classes import BoxShaped, Extents, find_box_fault, friction_property, mass_property
from .places import FLOOR_TOLERANCE, corner_heights


class Liftable(BoxShaped, AffordanceClass):
    """Can be lifted by hands that squeeze it from two opposite sides (paper, Sec. II-E)."""

    name: ClassVar[str] = "LIFTABLE"

    half_extents: Extents = quantity("m", "half of the edge lengths along x, y, z; hands squeeze it along x")
    mass: float = mass_property()
    friction: float = friction_property()

    @staticmethod
    def consistent(token: Token) -> str | None:
        """Complain about a shape that is not the box of the half extents."""
        other = "what is lifted is a box so far: remove the shape, or do not make it a member of LIFTABLE"
        return find_box_fault(token, other)

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

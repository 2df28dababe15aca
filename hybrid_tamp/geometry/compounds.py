"""Faults of compounds: parts that lie apart, parts that overlap, and a frame that is not at the centre of mass."""

import numpy as np

from hybrid_tamp.geometry.agreement import Disagreement, length_of, numbers
from hybrid_tamp.geometry.common_volume import MOST_SHARED, find_overlap
from hybrid_tamp.geometry.convex import placed
from hybrid_tamp.geometry.gaps import MOST_APART, find_gap
from hybrid_tamp.geometry.moments import distance_outside
from hybrid_tamp.geometry.shapes import Compound
from hybrid_tamp.geometry.surfaces import hulls_of
from hybrid_tamp.motion.arrays import FloatArray

NEAR_CENTRE = 0.02
"""Largest distance of the centre of mass from the origin, relative to the longest edge of the bounding box."""


def find_compound_fault(compound: Compound, even: bool) -> Disagreement | None:
    """Return the first fault of a compound, or None if it has no fault.

    Args:
        compound: the shape.
        even: whether the mass is distributed evenly over the volume, i.e. whether the moments of inertia are computed
            from the shape. Then no volume may count twice, and the centre of mass follows from the shape.
    """
    size = length_of(compound)
    gap = find_gap(placed(compound, np.zeros(3), np.array([0.0, 0.0, 0.0, 1.0])), MOST_APART * size)
    if gap is not None:
        pair = f"parts[{gap.one}] and parts[{gap.other}]"
        wanted = f"must have parts that touch, with gaps of at most {MOST_APART * size:.2g} m"
        return Disagreement(wanted, f"a gap of {gap.width:.3g} m between {pair}")
    outside = distance_outside(compound)
    if outside > MOST_APART * size:
        wanted = "must contain the origin of the body frame, its centre of mass, within its convex hull"
        return Disagreement(wanted, f"a hull that is {outside:.3g} m away from the origin")
    return _find_uneven(compound, size) if even else None


def _find_uneven(compound: Compound, size: float) -> Disagreement | None:
    overlap = find_overlap(hulls_of(compound))
    if overlap is not None:
        pair = f"parts[{overlap.one}] and parts[{overlap.other}]"
        wanted = f"must not have parts that share more than {MOST_SHARED:.0%} of the smaller volume"
        came = f"{overlap.volume:.3g} m^3 of {overlap.smaller:.3g} m^3 shared by {pair}"
        return Disagreement(f"{wanted}, unless the property inertia is given", came)
    centre = _centre(compound)
    if float(np.linalg.norm(centre)) <= NEAR_CENTRE * size:
        return None
    wanted = f"must have its centre of mass at the origin of the body frame, within {NEAR_CENTRE * size:.2g} m"
    return Disagreement(
        f"{wanted}, unless the property inertia is given", f"a centre of mass at {numbers(centre.round(6))} m"
    )


def _centre(compound: Compound) -> FloatArray:
    volumes, firsts = zip(*(hull.integrals[:2] for hull in hulls_of(compound)), strict=True)
    return np.asarray(np.sum(firsts, axis=0) / sum(volumes))

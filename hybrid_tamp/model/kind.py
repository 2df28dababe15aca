"""The kinds of predicates."""

from enum import Enum


class Kind(Enum):
    """How the atoms of a predicate come to hold, and how they cease to."""

    CHANGING = "changing"
    """Blocks set and delete it."""
    FUNCTIONAL = "functional"
    """One parameter has at most one value for given other arguments (a place, a posture): a new one replaces it."""
    MAINTAINED = "maintained"
    """An atom lives as long as the instance whose exit set it: its hold keeps it; it is void once tokens leave."""
    STATIC = "static"
    """It is decided once, from fixed properties and the initial state: a feasibility fact."""

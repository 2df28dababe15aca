"""The kinds of predicates."""

from enum import Enum


class Kind(Enum):
    """The kind of a predicate, which determines when atoms become true and false."""

    CHANGING = "changing"
    """Blocks add and delete the atoms."""
    FUNCTIONAL = "functional"
    """Given the other parameters, one parameter has at most one value. A new value replaces the old value."""
    MAINTAINED = "maintained"
    """An atom is added by an instance and holds only until this instance ends."""
    STATIC = "static"
    """The atoms are feasibility facts, which depend only on fixed properties and the initial state."""

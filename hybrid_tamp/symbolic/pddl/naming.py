"""Names there and back: every user's name gets one legal PDDL name of its own, and only one.

PDDL folds case and allows letters, digits, hyphens and underscores after a letter; types, predicates and constants
share one namespace. The map is made for a whole set of names at once, so that it stays injective: what would collide
gets a number. Names that are legal already come through unchanged.
"""

import re
from collections.abc import Iterable, Mapping
from functools import cached_property

_ILLEGAL = re.compile(r"[^a-z0-9_-]+")
# Words of PDDL that stand without a colon; ':goal' and the like take nothing from anyone.
_KEYWORDS = frozenset(
    {
        "and",
        "or",
        "not",
        "imply",
        "exists",
        "forall",
        "when",
        "define",
        "domain",
        "problem",
        "duration",
        "minimize",
        "maximize",
        "object",
        "either",
        "number",
        "increase",
        "decrease",
        "assign",
        "scale-up",
        "scale-down",
        "at",
        "over",
        "start",
        "end",
        "all",
        "always",
        "sometime",
        "within",
        "at-most-once",
        "sometime-after",
        "sometime-before",
        "always-within",
        "hold-during",
        "hold-after",
        "preference",
        "total-time",
        "total-cost",
        "is-violated",
        "bool",
        "int",
        "real",
        "fluent",
        "oneof",
        "probabilistic",
        "undefined",
    }
)


def legal(name: str) -> str:
    """Return a legal PDDL identifier that resembles the name; different names may give the same one."""
    folded = _ILLEGAL.sub("-", name.casefold()).strip("-_")
    return folded if folded[:1].isalpha() and folded[:1].isascii() else f"n-{folded}".rstrip("-")


class Naming:
    """An injective map from users' names to PDDL names."""

    def __init__(self, names: Iterable[str], taken: Iterable[str] = ()) -> None:
        """Name the given names; none of the `taken` PDDL names and no PDDL keyword is used.

        The result does not depend on the order of the names.
        """
        used = set(taken) | _KEYWORDS
        self._pddl: dict[str, str] = {}
        # Names that are legal as they stand come first, so that they keep themselves.
        for name in sorted(set(names), key=lambda name: (legal(name) != name, name)):
            chosen, number = legal(name), 2
            while chosen in used:
                chosen, number = f"{legal(name)}-{number}", number + 1
            used.add(chosen)
            self._pddl[name] = chosen

    def pddl(self, name: str) -> str:
        """Return the PDDL name of a user's name; KeyError if it was never named."""
        return self._pddl[name]

    def user(self, pddl: str) -> str:
        """Return the user's name of a PDDL name, in whatever case it comes; KeyError if there is none."""
        return self._user[pddl.lower()]

    def knows(self, pddl: str) -> bool:
        """Say whether the PDDL name is one of this map."""
        return pddl.lower() in self._user

    @cached_property
    def _user(self) -> Mapping[str, str]:
        return {pddl: name for name, pddl in self._pddl.items()}

    @property
    def changed(self) -> tuple[tuple[str, str], ...]:
        """(PDDL name, user's name) pairs that differ, sorted."""
        return tuple(sorted((pddl, name) for name, pddl in self._pddl.items() if pddl != name))

    @property
    def all(self) -> frozenset[str]:
        """All PDDL names given."""
        return frozenset(self._pddl.values())

"""Injective mapping from the user's names to legal PDDL names.

PDDL names are case-insensitive. They start with a letter, followed by letters, digits, hyphens and underscores. Types,
predicates and constants share one namespace. If names collide, a number is appended. Legal names stay unchanged.
"""

import re
from collections.abc import Collection, Iterable, Mapping
from functools import cached_property
from typing import Any, Generic, TypeVar

Key = TypeVar("Key", bound=Any)
"""Key of a named thing, e.g. a name, a number or a tuple. The keys of one mapping must be sortable."""

_ILLEGAL = re.compile(r"[^a-z0-9_-]+")
# PDDL keywords without a colon. Keywords with a colon, such as ':goal', never collide with names.
_KEYWORD_TEXT = """
    and or not imply exists forall when define domain problem duration minimize maximize object either number
    increase decrease assign scale-up scale-down at over start end all always sometime within at-most-once
    sometime-after sometime-before always-within hold-during hold-after preference total-time total-cost
    is-violated bool int real fluent oneof probabilistic undefined
"""
_KEYWORDS = frozenset(_KEYWORD_TEXT.split())

# VAL treats these words as keywords even after a question mark.
_NO_VARIABLES = frozenset(f"?{word}" for word in _KEYWORDS - {"all", "at", "end", "object", "over", "start"})


def legal(name: str) -> str:
    """Return a legal PDDL identifier similar to a name. Different names may have the same identifier."""
    folded = _ILLEGAL.sub("-", name.casefold()).strip("-_")
    return folded if folded[:1].isalpha() and folded[:1].isascii() else f"n-{folded}".rstrip("-")


def name_apart(texts: Mapping[Key, str], taken: Iterable[str] = ()) -> dict[Key, str]:
    """Return a dictionary that maps each key to its own PDDL name.

    Each name is similar to the key's text. PDDL keywords and the names in `taken` are not used. The result does not
    depend on the order of the keys.
    """
    used = set(taken) | _KEYWORDS
    named: dict[Key, str] = {}
    # Legal texts come first, so that they stay unchanged.
    for key, text in sorted(texts.items(), key=lambda item: (legal(item[1]) != item[1], item[1], item[0])):
        named[key] = unused(legal(text), used)
        used.add(named[key])
    return named


def name_variables(names: Iterable[str]) -> list[str]:
    """Return a list with one variable per name. All variables are different."""
    variables: list[str] = []
    for name in names:
        variables.append(variable_of(name, variables))
    return variables


def variable_of(name: str, taken: Collection[str]) -> str:
    """Return a variable that is similar to a name and not in `taken`."""
    return unused(f"?{legal(name)}", {*taken, *_NO_VARIABLES})


def unused(name: str, taken: Collection[str]) -> str:
    """Return the name, with a number appended if the name is in `taken`."""
    chosen, number = name, 2
    while chosen in taken:
        chosen, number = f"{name}-{number}", number + 1
    return chosen


class Naming(Generic[Key]):
    """An injective mapping from named things to PDDL names."""

    def __init__(self, names: Mapping[Key, str], taken: Iterable[str] = ()) -> None:
        """Give each thing a PDDL name of its own, similar to the user's name in `names` and not in `taken`."""
        self._names = names
        self._pddl = name_apart(names, taken)

    def pddl(self, key: Key) -> str:
        """Return the PDDL name of a thing. Raise KeyError for an unknown thing."""
        return self._pddl[key]

    def user(self, pddl: str) -> str:
        """Return the user's name for a PDDL name, ignoring case. Raise KeyError for an unknown PDDL name."""
        return self._user[pddl.lower()]

    def knows(self, pddl: str) -> bool:
        """Return whether the mapping contains a PDDL name, ignoring case."""
        return pddl.lower() in self._user

    @cached_property
    def _user(self) -> Mapping[str, str]:
        return {pddl: self._names[key] for key, pddl in self._pddl.items()}

    @property
    def changed(self) -> tuple[tuple[str, str], ...]:
        """The sorted pairs of (PDDL name, user's name), only where the two names differ."""
        return tuple(sorted((pddl, name) for pddl, name in self._user.items() if pddl != name))

    @property
    def all(self) -> frozenset[str]:
        """All PDDL names of the mapping."""
        return frozenset(self._pddl.values())

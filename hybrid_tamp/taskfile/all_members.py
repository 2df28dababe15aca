"""Goals over all members of a class: ``{all: CLASS}`` stands for one atom per token of the class."""

from itertools import product
from typing import Any

from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.predicate import ANY
from hybrid_tamp.taskfile.places import Faults, KeyPath, shown
from hybrid_tamp.taskfile.tokens import Scene, known_classes

ALL = "all"
"""Key of the mapping that stands for all members of a class."""


def expand(
    arguments: list[Any], path: KeyPath, faults: Faults, domain: Domain | None, scene: Scene
) -> list[tuple[str, ...]]:
    """Return the arguments of each atom that an entry of the goal stands for, in the order of the tokens.

    Args:
        arguments: names and mappings ``{all: CLASS}``.
        path: path of the list of arguments.
        faults: collection to which a fault is added for an unknown class, a class without members, or an entry without
            atoms.
        domain: the domain; None if unknown.
        scene: the tokens.

    Returns:
        One tuple of names for each choice of members in which no token occurs twice. The list is empty if there is a
        fault, or if the classes or tokens of the task are not known because of other faults.
    """
    if not any(isinstance(each, dict) for each in arguments):
        return [tuple(arguments)]
    known = scene.names is not None and set(scene.outlines) == set(scene.names)
    if domain is None or not known:
        return []
    choices = [
        _members(each[ALL], (*path, index), faults, domain, scene) if isinstance(each, dict) else (each,)
        for index, each in enumerate(arguments)
    ]
    every = [names for names in product(*choices) if _are_different(names, scene)]
    if not every and faults.sound(path):
        wanted = f"{ALL!r} must leave at least one atom in which no token occurs twice"
        faults.at(path, wanted, faults.shown(path, arguments), remedy="use another class or another token")
    return every


def _members(name: str, path: KeyPath, faults: Faults, domain: Domain, scene: Scene) -> tuple[str, ...]:
    """Return the names of the tokens that are members of a class."""
    classes = known_classes(domain)
    if name not in classes:
        faults.at((*path, ALL), f"unknown class in the domain {domain.name}", shown(name), sorted(classes))
        return ()
    members = tuple(token.name for token in scene.outlines.values() if token.is_member(classes[name]))
    if not members:
        populated = {
            each: one for each, one in classes.items() if any(t.is_member(one) for t in scene.outlines.values())
        }
        wanted, remedy = f"the class after {ALL!r} must have members", f"add a token of class {name}"
        faults.at((*path, ALL), wanted, f"{name} without members", sorted(populated), remedy)
    return members


def _are_different(names: tuple[str, ...], scene: Scene) -> bool:
    """Return whether no token occurs twice. Symbols and wildcards may occur twice."""
    tokens = [name for name in names if name != ANY and name in (scene.names or ())]
    return len(set(tokens)) == len(tokens)


def check_argument(argument: Any, path: KeyPath, faults: Faults) -> None:
    """Record a fault unless an argument is a name or ``{all: CLASS}``."""
    if isinstance(argument, str):
        return
    if not isinstance(argument, dict):
        wanted = "an argument must be a name or {all: CLASS}"
        faults.at(path, wanted, faults.shown(path, argument), remedy="write a name in quotes")
    elif list(argument) != [ALL]:
        wanted = f"a mapping in place of an argument must have exactly the key {ALL!r}"
        faults.at(path, wanted, f"the keys {', '.join(map(shown, argument)) or 'none'}", remedy="write {all: CLASS}")
    elif not isinstance(argument[ALL], str):
        here = (*path, ALL)
        faults.at(here, f"{ALL!r} must name one class", faults.shown(here, argument[ALL]), remedy="write {all: CLASS}")

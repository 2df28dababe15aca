"""Read the goal of a task file: check each atom, the types of its arguments, and conflicts between atoms."""

from typing import Any

from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.predicate import ANY, Atom, Parameter, Predicate, SymbolSort
from hybrid_tamp.taskfile.all_members import check_argument, expand
from hybrid_tamp.taskfile.places import Faults, KeyPath, plain, shown
from hybrid_tamp.taskfile.tokens import Scene

_FORM = "an atom of the goal must be 'predicate: [tokens]'"


def read_goal(data: dict[str, Any], faults: Faults, domain: Domain | None, scene: Scene) -> dict[Atom, KeyPath]:
    """Read the atoms of the goal and record their faults.

    Returns:
        A mapping from each faultless atom to the path of its arguments.
    """
    items = data.get("goal")
    if not isinstance(items, list):
        return {}
    atoms: dict[Atom, KeyPath] = {}
    values: dict[tuple[Any, ...], Atom] = {}
    for index, item in enumerate(items):
        path: KeyPath = ("goal", index)
        found = _form(item, path, faults) if faults.sound(path) else None
        if found is None:
            continue
        name, arguments = found
        path = (*path, name)
        predicate = _predicate(name, arguments, path, faults, domain)
        for each in expand(arguments, path, faults, domain, scene):
            atom = Atom(name, each)
            _check_arguments(atom, predicate, path, faults, scene)
            _check_different(atom, path, faults, scene)
            if faults.sound(path) and predicate is not None:
                atoms.setdefault(atom, path)
                _check_company(atom, predicate, path, atoms, values, faults)
            if not faults.sound(path):
                break  # The other members of a class would have similar faults.
    return atoms


def _form(item: Any, path: KeyPath, faults: Faults) -> tuple[str, list[Any]] | None:
    """Return the name and the arguments of an atom, or None if the item is not an atom."""
    if isinstance(item, dict) and "not" in item:
        remedy = "remove the negated atom, or replace it by an atom that must hold"
        faults.at((*path, "not"), "a goal atom must not be negated", "'not'", remedy=remedy, key=True)
        return None
    if not isinstance(item, dict) or len(item) != 1:
        came = "several keys" if isinstance(item, dict) and item else faults.shown(path, item)
        faults.at(path, _FORM, came, remedy="write one atom per entry")
        return None
    ((predicate, arguments),) = item.items()
    path = (*path, predicate)
    if not isinstance(arguments, list):
        faults.at(path, _FORM, faults.shown(path, arguments), remedy="write the tokens in brackets")
        return None
    for index, argument in enumerate(arguments):
        check_argument(argument, (*path, index), faults)
    return (predicate, arguments) if faults.sound(path) else None


def _predicate(
    name: str, arguments: list[Any], path: KeyPath, faults: Faults, domain: Domain | None
) -> Predicate | None:
    if domain is None:
        return None
    predicate = domain.predicate_by_name.get(name)
    if predicate is None:
        wanted = f"unknown predicate in the domain {domain.name}"
        # The fault concerns only the key, so the arguments are still checked.
        faults.at(path, wanted, shown(name), sorted(domain.predicate_by_name), key=True, sound=True)
    elif len(arguments) != len(predicate.parameters):
        signature = ", ".join(f"{each.name} ({each.sort.name})" for each in predicate.parameters) or "none"
        wanted, count = f"the arguments of {predicate.name} must be {signature}", len(arguments)
        faults.at(path, wanted, f"{count} argument{'' if count == 1 else 's'}")
    return predicate


def _check_arguments(atom: Atom, predicate: Predicate | None, path: KeyPath, faults: Faults, scene: Scene) -> None:
    """Record a fault for each argument that the predicate does not accept."""
    typed = predicate is not None and len(predicate.parameters) == len(atom.arguments)
    parameters = predicate.parameters if predicate is not None and typed else [None] * len(atom.arguments)
    for index, (argument, parameter) in enumerate(zip(atom.arguments, parameters, strict=True)):
        here = (*path, index)
        if argument == ANY:
            _check_choice(atom, parameter, here, faults, scene)
        elif parameter is not None and isinstance(parameter.sort, SymbolSort):
            if argument not in parameter.sort.symbols:
                wanted = f"{parameter.name} of {atom.predicate} must be a {parameter.sort.name}"
                faults.at(here, wanted, shown(argument), parameter.sort.symbols)
        elif scene.names is not None and argument not in scene.names:
            # If the predicate is unknown, the argument might be a symbol.
            if predicate is not None:
                faults.at(here, "unknown token in the goal", shown(argument), scene.names)
        elif parameter is not None and argument in scene.outlines:
            _check_class(argument, atom, parameter, here, faults, scene)


def _check_choice(atom: Atom, parameter: Parameter | None, path: KeyPath, faults: Faults, scene: Scene) -> None:
    """Record a fault for a wildcard that no token can replace."""
    known = scene.names is not None and set(scene.outlines) == set(scene.names) and ANY not in scene.names
    if parameter is None or isinstance(parameter.sort, SymbolSort) or not known:
        return
    others = [token for name, token in scene.outlines.items() if name not in atom.arguments]
    if not any(token.is_member(parameter.sort) for token in others):
        wanted = f"no token can replace {shown(ANY)} as {parameter.name} of {atom.predicate}"
        faults.at(path, wanted, remedy=f"add a token of class {parameter.sort.name} that does not occur in the atom")


def _check_different(atom: Atom, path: KeyPath, faults: Faults, scene: Scene) -> None:
    """Record a fault for each token that appears more than once among the arguments of an atom."""
    for index, argument in enumerate(atom.arguments):
        if argument in (scene.names or ()) and argument in atom.arguments[:index]:
            wanted = f"the arguments of {plain(atom.predicate)} must be different tokens"
            faults.at((*path, index), wanted, f"{shown(argument)} twice", remedy="use another token")


def _check_class(argument: str, atom: Atom, parameter: Parameter, path: KeyPath, faults: Faults, scene: Scene) -> None:
    sort, outline = parameter.sort, scene.outlines[argument]
    # A token of unknown membership is accepted here. A plan exists only after a probe has confirmed the membership.
    if isinstance(sort, SymbolSort) or outline.is_member(sort) or outline.may_be_member(sort):
        return
    members = ", ".join(member.name for member in outline.classes)
    fitting = [name for name, token in scene.outlines.items() if token.is_member(sort)]
    wanted = f"{parameter.name} of {atom.predicate} must be a member of {sort.name}"
    remedy = "" if fitting else f"no token is a member of {sort.name}"
    faults.at(path, wanted, f"token {shown(argument)}, a member of {members}", fitting, remedy)


def _check_company(
    atom: Atom,
    predicate: Predicate,
    path: KeyPath,
    atoms: dict[Atom, KeyPath],
    values: dict[tuple[Any, ...], Atom],
    faults: Faults,
) -> None:
    """Record a fault for an atom that cannot be true at the same time as an earlier atom."""
    if predicate.functional_index is None or ANY in atom.arguments:
        return
    index = predicate.functional_index
    other = values.setdefault((atom.predicate, atom.arguments[:index], atom.arguments[index + 1 :]), atom)
    if other != atom:
        owners = [f"each {each.name}" for each in predicate.parameters if each.name != predicate.value_of]
        wanted = f"{predicate.name} must have only one {predicate.value_of} for {' and '.join(owners) or 'the task'}"
        came = f"{plain(other.text)} and {plain(atom.text)}{faults.on_line(atoms[other], 'the first')}"
        faults.at(path, wanted, came, remedy="remove one of the atoms")

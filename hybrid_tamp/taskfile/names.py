"""Check names of tokens and tasks: printable, and different from the domain's symbols and the wildcard."""

from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.predicate import ANY, SymbolSort
from hybrid_tamp.taskfile.places import Faults, KeyPath, shown


def check_name(name: str, faults: Faults, domain: Domain | None) -> None:
    """Refuse a token's name that is empty, not printable, a wildcard or a symbol of the domain."""
    path = ("tokens", name)
    if not name:
        faults.at(path, "a token needs a name that is not empty", shown(name), key=True, sound=True)
    check_printable(name, path, faults, "a token needs a name")
    if name == ANY:
        remedy = "it means every value in conditions: rename the token"
        wanted = f"a token needs a name other than {ANY!r}"
        faults.at(path, wanted, shown(name), remedy=remedy, key=True, sound=True)
    for sort in _symbol_sorts(domain) if domain else ():
        if name in sort.symbols:
            wanted = f"a token needs a name that is no {sort.name} of the domain"
            faults.at(path, wanted, shown(name), remedy="rename the token", key=True, sound=True)


def check_printable(name: str, path: KeyPath, faults: Faults, who: str, *, key: bool = True) -> None:
    """Refuse a name that would disturb a terminal or a table: line ends, escapes, invisible characters."""
    odd = next((character for character in name if not character.isprintable()), None)
    if odd is not None:
        came = f"{shown(name)}, in which the character U+{ord(odd):04X} is not"
        faults.at(path, f"{who} of printable characters", came, remedy="rename it", key=key, sound=True)


def _symbol_sorts(domain: Domain) -> tuple[SymbolSort, ...]:
    """Return every symbol sort of the domain, each once, sorted by name."""
    parameters = [parameter.sort for predicate in domain.predicates for parameter in predicate.parameters]
    targets = [target.sort for block in domain.blocks for target in block.targets]
    sorts = {sort for sort in (*domain.sorts, *parameters, *targets) if isinstance(sort, SymbolSort)}
    return tuple(sorted(sorts, key=lambda sort: sort.name))

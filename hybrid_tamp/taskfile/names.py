"""Check the names of tokens and tasks. Names must be printable and differ from the domain's symbols and wildcard."""

from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.predicate import ANY, SymbolSort
from hybrid_tamp.taskfile.places import Faults, KeyPath, shown


def check_name(name: str, faults: Faults, domain: Domain | None) -> None:
    """Record a fault if a token's name is empty, is not printable, or equals the wildcard or a symbol of the domain."""
    path = ("tokens", name)
    if not name:
        faults.at(path, "the name of a token must not be empty", shown(name), key=True, sound=True)
    check_printable(name, path, faults, "the name of a token")
    if name == ANY:
        wanted = f"the name of a token must not be {ANY!r}, because this is the wildcard in conditions"
        faults.at(path, wanted, shown(name), remedy="rename the token", key=True, sound=True)
    for sort in _symbol_sorts(domain) if domain else ():
        if name in sort.symbols:
            wanted = f"the name of a token must not be the name of a {sort.name} in the domain"
            faults.at(path, wanted, shown(name), remedy="rename the token", key=True, sound=True)


def check_printable(name: str, path: KeyPath, faults: Faults, what: str, *, key: bool = True) -> None:
    """Record a fault for a name with line ends, escapes or invisible characters, which spoil printed tables."""
    odd = next((character for character in name if not character.isprintable()), None)
    if odd is not None:
        came = f"{shown(name)} with the character U+{ord(odd):04X}"
        faults.at(
            path, f"{what} must contain only printable characters", came, remedy="change the name", key=key, sound=True
        )


def _symbol_sorts(domain: Domain) -> tuple[SymbolSort, ...]:
    """Return the symbol sorts of the domain without duplicates, sorted by name."""
    parameters = [parameter.sort for predicate in domain.predicates for parameter in predicate.parameters]
    targets = [target.sort for block in domain.blocks for target in block.targets]
    sorts = {sort for sort in (*domain.sorts, *parameters, *targets) if isinstance(sort, SymbolSort)}
    return tuple(sorted(sorts, key=lambda sort: sort.name))

"""Joins, which find the variable bindings that turn all given conditions into known facts."""

from collections import defaultdict
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from itertools import product
from types import MappingProxyType

from hybrid_tamp.symbolic.pddl.operators import Fact

Binding = dict[str, str]
"""Maps each variable to a constant or object."""

Ranges = Mapping[str, Collection[str]]
"""Maps each variable to its possible values."""

_UNLIMITED: Ranges = MappingProxyType({})


class FactIndex:
    """An index of ground facts by predicate and arguments. The attribute `facts` is the set of all facts."""

    def __init__(self, facts: Iterable[Fact]) -> None:
        self.facts: set[Fact] = set()
        self._rows: defaultdict[str, list[Fact]] = defaultdict(list)
        self._tables: defaultdict[str, dict[tuple[int, ...], defaultdict[Fact, list[Fact]]]] = defaultdict(dict)
        for fact in facts:
            self.add(fact)

    def add(self, fact: Fact) -> bool:
        """Add a fact. Return whether the fact is new."""
        if fact in self.facts:
            return False
        self.facts.add(fact)
        self._rows[fact[0]].append(fact)
        for places, table in self._tables[fact[0]].items():
            table[tuple(fact[place] for place in places)].append(fact)
        return True

    def match(self, condition: Fact, binding: Mapping[str, str]) -> Sequence[Fact]:
        """Return the facts that match a condition after its variables are bound, in order of insertion."""
        known = {i: binding.get(a, a) for i, a in enumerate(condition) if a in binding or not a.startswith("?")}
        places, tables = tuple(known), self._tables[condition[0]]
        if places not in tables:
            tables[places] = defaultdict(list)
            for fact in self._rows[condition[0]]:
                tables[places][tuple(fact[place] for place in places)].append(fact)
        return tables[places].get(tuple(known.values()), ())


def join(
    conditions: Sequence[Fact],
    binding: Binding,
    index: FactIndex,
    ranges: Ranges = _UNLIMITED,
    skip: Callable[[Binding], bool] = lambda _: False,
) -> Iterator[Binding]:
    """Yield the extensions of a binding that turn all conditions into known facts.

    Args:
        conditions: Facts whose arguments are variables or constants.
        binding: Maps each bound variable to its value.
        index: Known facts.
        ranges: Maps variables to their possible values. A variable that no condition binds takes each of its values. A
            variable that is not in `ranges` may take any value.
        skip: Function ``skip(binding)``. If the function returns True, all extensions of the binding are left out.
    """
    if skip(binding):
        return
    if not conditions:
        free = [variable for variable in ranges if variable not in binding]
        for values in product(*(ranges[variable] for variable in free)):
            yield binding | dict(zip(free, values, strict=True))
        return
    # The condition with the fewest matching facts is joined first.
    rows, chosen = min(((index.match(each, binding), each) for each in conditions), key=lambda found: len(found[0]))
    rest = [each for each in conditions if each is not chosen]
    for row in rows:
        extended = bind_condition(chosen, row, binding, ranges)
        if extended is not None:
            yield from join(rest, extended, index, ranges, skip)


def bind_condition(condition: Fact, fact: Fact, binding: Binding, ranges: Ranges = _UNLIMITED) -> Binding | None:
    """Extend a binding to turn a condition into the given fact. Return None if this is impossible."""
    extended = dict(binding)
    for argument, value in zip(condition[1:], fact[1:], strict=True):
        if not argument.startswith("?"):
            if argument != value:
                return None
        elif extended.setdefault(argument, value) != value or value not in ranges.get(argument, (value,)):
            return None
    return extended

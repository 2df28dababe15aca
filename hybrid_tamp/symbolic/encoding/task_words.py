"""The PDDL names of a task's tokens, and the facts that the classical and the temporal encoding share."""

from collections.abc import Collection, Iterator
from dataclasses import dataclass
from itertools import permutations, product

from hybrid_tamp.errors import InputError, Issue
from hybrid_tamp.model.affordance import TOKEN
from hybrid_tamp.model.predicate import ANY, Atom, Predicate, name_of
from hybrid_tamp.model.task import Task
from hybrid_tamp.symbolic.encoding.vocabulary import Vocabulary
from hybrid_tamp.symbolic.pddl.naming import Naming
from hybrid_tamp.symbolic.pddl.operators import Fact


@dataclass(frozen=True, eq=False)
class TaskWords:
    """Translates between the user's names and PDDL names, and lists facts that no action changes.

    Attributes:
        task: Task whose tokens and symbols are named.
        vocabulary: PDDL names of the task's domain.
        tokens: PDDL names of the task's tokens.
    """

    task: Task
    vocabulary: Vocabulary
    tokens: Naming[str]

    @classmethod
    def of(cls, task: Task, vocabulary: Vocabulary, taken: Collection[str]) -> "TaskWords":
        """Return the PDDL names of a task. No token gets a name in `taken`."""
        return cls(task, vocabulary, Naming({token.name: token.name for token in task.tokens}, taken))

    @property
    def objects(self) -> tuple[tuple[str, str], ...]:
        """The pairs of (PDDL name, type) of the tokens, sorted by the user's names."""
        tokens = sorted(self.task.tokens, key=lambda token: token.name)
        return tuple((self.tokens.pddl(token.name), self.vocabulary.token_type(token)) for token in tokens)

    def name(self, user: str) -> str:
        """Return the PDDL name of a token or symbol."""
        return self.tokens.pddl(user) if user in self.task.token_by_name else self.vocabulary.symbol(user)

    def user(self, pddl: str) -> str:
        """Return the user's name of a PDDL object."""
        return self.tokens.user(pddl) if self.tokens.knows(pddl) else self.vocabulary.names.user(pddl)

    def guards(self) -> Iterator[Fact]:
        """Yield a fact for each membership of a token in a class, if the class is not a PDDL type."""
        for token in self.task.tokens:
            for member in token.classes:
                if member is not TOKEN:
                    yield from self.vocabulary.guard(self.tokens.pddl(token.name), member)

    def denials(self, static: frozenset[Atom]) -> Iterator[Fact]:
        """Yield the negated static atoms that hold, for each predicate that an entry condition negates."""
        for predicate in self.vocabulary.denied:
            word = self.vocabulary.predicate(predicate.name, positive=False)
            for names in self.combine(predicate):
                if Atom(predicate.name, names) not in static:
                    yield (word, *map(self.name, names))

    def differences(self) -> Iterator[Fact]:
        """Yield the inequality facts of all pairs of different tokens."""
        names = [self.tokens.pddl(token.name) for token in self.task.tokens]
        yield from (("distinct", one, other) for one, other in permutations(names, 2))

    def combine(self, predicate: Predicate, skip: int | None = None) -> Iterator[tuple[str, ...]]:
        """Yield every well-typed tuple of argument names, without the argument at index `skip`."""
        sorts = [parameter.sort for index, parameter in enumerate(predicate.parameters) if index != skip]
        for values in product(*map(self.task.values_of, sorts)):
            yield tuple(map(name_of, values))


def settle_goal(task: Task) -> Task:
    """Return the task with its goal as a conjunction of positive ground atoms.

    Raises:
        InputError: If the goal leaves a choice, has a negative atom, or requires an `unknown` class of a token.
    """
    for atom, token, sort in task.unsettled:
        wanted = f"'{atom.text}' requires a member of {sort.name}, but it is unknown whether {token.name} is a member"
        raise InputError([Issue("goal", wanted, remedy=f"probe {token.name}")])
    first, *others = task.alternatives()
    if others:
        wanted = f"each atom in the goal of a planning problem must name a token, not {ANY!r}"
        named = ", ".join(atom.text for atom in first.goal)
        remedy = f"name tokens instead of {ANY!r}; the nearest choice is {named}"
        raise InputError([Issue("goal", wanted, f"a goal with {len(others) + 1} choices", remedy=remedy)])
    denied = [atom for atom in first.goal if not atom.positive]
    if denied:
        wanted = f"a goal atom must be positive, got '{denied[0].text}'"
        raise InputError([Issue("goal", wanted, remedy="use the opposite predicate")])
    return first

"""A task in the words of its planning domain: the names of its tokens, and the facts that both encodings share."""

from collections.abc import Iterator
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
    """PDDL names of the tokens and symbols of a task, the way back, and the facts about them that never change.

    Attributes:
        task: the task.
        vocabulary: the PDDL words of its domain.
        tokens: the PDDL names of its tokens.
    """

    task: Task
    vocabulary: Vocabulary
    tokens: Naming[str]

    def name(self, user: str) -> str:
        """Return the PDDL name of a token or symbol."""
        return self.tokens.pddl(user) if user in self.task.token_by_name else self.vocabulary.symbol(user)

    def user(self, pddl: str) -> str:
        """Return the name of a PDDL object for the user."""
        return self.tokens.user(pddl) if self.tokens.knows(pddl) else self.vocabulary.names.user(pddl)

    def guards(self) -> Iterator[Fact]:
        """Yield the facts of membership in classes that are not types."""
        for token in self.task.tokens:
            for member in token.classes:
                if member is not TOKEN:
                    yield from self.vocabulary.guard(self.tokens.pddl(token.name), member)

    def denials(self, static: frozenset[Atom]) -> Iterator[Fact]:
        """Yield the opposites of the static atoms that do not hold and that a block may require."""
        for predicate in self.vocabulary.denied:
            word = self.vocabulary.predicate(predicate.name, positive=False)
            for names in self.combine(predicate):
                if Atom(predicate.name, names) not in static:
                    yield (word, *map(self.name, names))

    def differences(self) -> Iterator[Fact]:
        """Yield the facts that any two tokens are different."""
        names = [self.tokens.pddl(token.name) for token in self.task.tokens]
        yield from (("distinct", one, other) for one, other in permutations(names, 2))

    def combine(self, predicate: Predicate, skip: int | None = None) -> Iterator[tuple[str, ...]]:
        """Yield the names of every well-typed tuple of arguments, without the argument at index `skip`."""
        sorts = [parameter.sort for index, parameter in enumerate(predicate.parameters) if index != skip]
        for values in product(*map(self.task.values_of, sorts)):
            yield tuple(map(name_of, values))


def settle_goal(task: Task) -> Task:
    """Return the task with its only ground goal, a conjunction of positive atoms as planners state it.

    Raises:
        InputError: the goal leaves a choice, has a negative atom, or depends on an unknown class of a token.
    """
    for atom, token, sort in task.unsettled:
        wanted = f"'{atom.text}' asks for a member of {sort.name}, and whether {token.name} is one is not known"
        raise InputError([Issue("goal", wanted, remedy="probe the token")])
    first, *others = task.alternatives()
    if others:
        wanted = "a goal that names every token: the goal of a planning problem says that all of it holds"
        named = ", ".join(atom.text for atom in first.goal)
        remedy = f"name tokens instead of {ANY!r}; the nearest choice is {named}"
        raise InputError([Issue("goal", wanted, f"one with {len(others) + 1} choices", remedy=remedy)])
    denied = [atom for atom in first.goal if not atom.positive]
    if denied:
        raise InputError([Issue("goal", f"'{denied[0].text}': a goal says what holds", remedy="ask for its opposite")])
    return first

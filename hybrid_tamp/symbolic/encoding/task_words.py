"""A task in the words of its planning domain: names of its tokens, and the facts that both encodings state alike."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import permutations, product

from hybrid_tamp.model.affordance import TOKEN
from hybrid_tamp.model.predicate import Atom, Predicate, name_of
from hybrid_tamp.model.task import Task
from hybrid_tamp.symbolic.encoding.vocabulary import Vocabulary
from hybrid_tamp.symbolic.pddl.naming import Naming
from hybrid_tamp.symbolic.pddl.operators import Fact


@dataclass(frozen=True, eq=False)
class TaskWords:
    """Names of a task's tokens and symbols, there and back, with the facts about them that never change.

    Attributes:
        task: the task.
        vocabulary: the words of its domain.
        tokens: names of its tokens.
    """

    task: Task
    vocabulary: Vocabulary
    tokens: Naming[str]

    def name(self, user: str) -> str:
        """Return the PDDL name of a token or symbol."""
        return self.tokens.pddl(user) if user in self.task.token_by_name else self.vocabulary.symbol(user)

    def user(self, pddl: str) -> str:
        """Return the user's name of a PDDL object."""
        return self.tokens.user(pddl) if self.tokens.knows(pddl) else self.vocabulary.names.user(pddl)

    def guards(self) -> Iterator[Fact]:
        """Yield the classes of tokens that are no types."""
        for token in self.task.tokens:
            for member in token.classes:
                if member is not TOKEN:
                    yield from self.vocabulary.guard(self.tokens.pddl(token.name), member)

    def denials(self, static: frozenset[Atom]) -> Iterator[Fact]:
        """Yield the opposites of static atoms that do not hold, where a block asks for them."""
        for predicate in self.vocabulary.denied:
            word = self.vocabulary.predicate(predicate.name, positive=False)
            for names in self.combine(predicate):
                if Atom(predicate.name, names) not in static:
                    yield (word, *map(self.name, names))

    def differences(self) -> Iterator[Fact]:
        """Yield that any two tokens are different."""
        names = [self.tokens.pddl(token.name) for token in self.task.tokens]
        yield from (("distinct", one, other) for one, other in permutations(names, 2))

    def combine(self, predicate: Predicate, skip: int | None = None) -> Iterator[tuple[str, ...]]:
        """Yield the names of every well-typed tuple of arguments, without the skipped one."""
        sorts = [parameter.sort for index, parameter in enumerate(predicate.parameters) if index != skip]
        for values in product(*map(self.task.values_of, sorts)):
            yield tuple(map(name_of, values))

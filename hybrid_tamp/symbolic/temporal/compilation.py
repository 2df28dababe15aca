"""Compilation of a task to a ground temporal problem with objects, initial values, durations and a goal."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product

from hybrid_tamp.model.facts import facts, static_facts
from hybrid_tamp.model.predicate import Atom, name_of
from hybrid_tamp.model.task import Task
from hybrid_tamp.symbolic.encoding.task_words import TaskWords, settle_goal
from hybrid_tamp.symbolic.pddl.naming import legal
from hybrid_tamp.symbolic.pddl.operators import Fact
from hybrid_tamp.symbolic.temporal.encoder import TemporalEncoding, encode_durative
from hybrid_tamp.symbolic.temporal.grounding import Run, reachable
from hybrid_tamp.symbolic.temporal.problem import TemporalProblem, Value
from hybrid_tamp.symbolic.temporal.words import NOBODY


@dataclass(frozen=True, eq=False)
class TemporalCompilation:
    """A task compiled to durative actions.

    Attributes:
        task: Task that is compiled, with a ground goal.
        encoding: Encoded domain of the task.
        words: Translation between the user's names and PDDL names.
        problem: Temporal planning problem.
    """

    task: Task
    encoding: TemporalEncoding
    words: TaskWords
    problem: TemporalProblem


def compile_durative(task: Task) -> TemporalCompilation:
    """Compile a task to durative actions.

    Raises:
        InputError: If the goal has a negative atom, leaves a choice, or requires an `unknown` class of a token.
    """
    task = settle_goal(task)
    encoding = encode_durative(task.domain)
    fluents = {fluent.name for fluent in encoding.planning.fluents}
    taken = encoding.vocabulary.names.all | encoding.names.all | fluents
    words = TaskWords.of(task, encoding.vocabulary, taken)
    writer = _Writer(encoding, words, reachable(task))
    problem = TemporalProblem(
        name=legal(task.name),
        domain=encoding.planning,
        objects=words.objects,
        init=tuple(sorted(set(writer.init()), key=str)),
        goal=tuple(sorted(set(writer.goal()), key=str)),
        comments=words.tokens.changed,
    )
    return TemporalCompilation(task, encoding, words, problem)


class _Writer:
    def __init__(self, encoding: TemporalEncoding, task_words: TaskWords, runs: tuple[Run, ...]) -> None:
        self.task, self.task_words = task_words.task, task_words
        self.vocabulary, self.words = encoding.vocabulary, encoding.names
        self.used = {fluent.name: fluent for fluent in encoding.planning.fluents}
        self.runs = runs
        self.name = task_words.name

    def stated(self, atom: Atom) -> tuple[Fact, Value]:
        """Convert an atom to a pair of (fluent, value)."""
        predicate, word = self.task.domain.predicate_by_name[atom.predicate], self.vocabulary.predicate(atom.predicate)
        arguments = tuple(map(self.name, atom.arguments))
        return ((word, *arguments), True) if predicate.static else self.words.stated(predicate, word, arguments)

    def goal(self) -> Iterator[tuple[Fact, Value]]:
        """Yield the user's goal, and the requirement that blocks without a hold have ended (`completed`)."""
        yield from map(self.stated, self.task.goal)
        for token in self.task.assigned:
            bounded = [s for b in self.task.domain.blocks if not b.hold for s in b.slots]
            if any(token.is_member(slot.object_class) for slot in bounded):
                yield (self.words("completed"), self.name(token.name)), True

    def init(self) -> Iterator[tuple[Fact, Value]]:
        """Yield the initial value of each fluent."""
        static, changing = static_facts(self.task), facts(self.task)
        yield from map(self.stated, static | changing)
        yield from self._nothing(changing)
        yield from ((fact, True) for fact in self.task_words.guards())
        yield from ((fact, True) for fact in self.task_words.denials(static))
        yield from ((fact, value) for fact, value in self._assignment() if fact[0] in self.used)
        lasts: dict[tuple[str, ...], float] = {}
        for run in self.runs:
            words = (self.words("lasts", run.block), *(self.name(value) for _, value in run.roles))
            lasts[words] = min(run.seconds, lasts.get(words, run.seconds))
        yield from ((words, round(1e3 * seconds)) for words, seconds in lasts.items())

    def _nothing(self, changing: frozenset[Atom]) -> Iterator[tuple[Fact, Value]]:
        """Yield the value 'none' for each fluent without a value in the initial state."""
        for predicate in self.task.domain.changing_predicates:
            key = self.words.key(predicate)
            if len(key) == len(predicate.parameters):
                continue
            word = self.vocabulary.predicate(predicate.name)
            valued = {tuple(a.arguments[i] for i in key) for a in changing if a.predicate == predicate.name}
            kept = [self.task.values_of(predicate.parameters[i].sort) for i in key]
            for values in product(*([self.task.assigned] if predicate.maintained else kept)):
                names = tuple(map(name_of, values))
                if names not in valued:
                    yield (word, *map(self.name, names)), self.words.none(predicate)

    def _assignment(self) -> Iterator[tuple[Fact, Value]]:
        nobody = self.words(NOBODY)
        for (old, before), (new, slot) in self.task.domain.network.edges:
            blocks = self.task.domain.block_by_name
            yield (self.words("passes"), self.words.slot(blocks[old], before), self.words.slot(blocks[new], slot)), True
        for token in self.task.assigned:
            name = self.name(token.name)
            block = self.task.start_block(token.name)
            yield (self.words("place"), name), (self.words.slot(block, block.anchor),)
            yield (self.words("partner"), name), (nobody,)
            yield (self.words("completed"), name), True
            for number in range(self.words.locks):
                yield (self.words.reads(number), name), (nobody,)
        for name in (nobody, *(self.name(token.name) for token in self.task.assigned)):
            yield (self.words("let-go"), name), True
            yield (self.words("crew"), name), 0
            yield (self.words("readers"), name), 0
        yield from ((fact, True) for fact in self.task_words.differences())

"""Compilation of a task to a ground planning problem with objects, initial facts and a goal."""

from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

from hybrid_tamp.model.facts import StaticFacts, facts, static_facts
from hybrid_tamp.model.plan import PlannedAction
from hybrid_tamp.model.predicate import Atom, Predicate
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.symbolic.encoding.assignment import COUNT, locked_targets
from hybrid_tamp.symbolic.encoding.encoder import EncodedDomain, encode_domain, encode_task
from hybrid_tamp.symbolic.encoding.task_words import TaskWords, settle_goal
from hybrid_tamp.symbolic.pddl.naming import legal
from hybrid_tamp.symbolic.pddl.operators import Fact, PlanningProblem, ground


@dataclass(frozen=True, eq=False)
class Compilation:
    """A task compiled to STRIPS. Slow attributes are computed on first use.

    Attributes:
        task: Task that is compiled, with a ground goal.
        encoded: Encoded domain of the task.
        words: Translation between the user's names and PDDL names.
        numbers: PDDL names of 1, 2, ..., up to the largest number of instances that can read one token at a time.
        goal: Facts that must hold at the end of a plan.
        feasible: Feasibility facts of the task, or of a larger task that contains the task.
    """

    task: Task
    encoded: EncodedDomain
    words: TaskWords
    numbers: tuple[str, ...]
    goal: tuple[Fact, ...]
    feasible: StaticFacts

    @cached_property
    def problem(self) -> PlanningProblem:
        """The planning problem. The number of feasibility facts grows fast with the number of tokens."""
        writer = _Writer(self.encoded, self.words, self.numbers)
        count = self.encoded.vocabulary.type_of(COUNT)
        return PlanningProblem(
            name=legal(self.task.name),
            domain=self.encoded.planning,
            objects=(*self.words.objects, *((number, count) for number in self.numbers)),
            init=tuple(sorted({*writer.changing(), *writer.lasting(self.feasible)})),
            goal=self.goal,
            comments=self.words.tokens.changed,
        )

    @cached_property
    def changing(self) -> frozenset[Fact]:
        """The initial facts without the feasibility and inequality facts (see `always`)."""
        return frozenset(_Writer(self.encoded, self.words, self.numbers).changing())

    def always(self, fact: Fact) -> bool:
        """Return whether a feasibility or inequality fact holds. No action changes these facts."""
        predicate, *names = fact
        if predicate == "distinct":
            return len(set(names)) > 1
        if predicate not in self._static:
            return False
        known, positive = self._static[predicate]
        return (Atom(known.name, tuple(map(self.words.user, names))) in self.feasible) == positive

    def reaches_goal(self, actions: Sequence[PlannedAction]) -> bool:
        """Return whether the actions can be applied in this order and achieve the goal.

        A large task has too many feasibility facts to list, so each fact is computed when an action requires the fact.
        """
        operators = {operator.name: operator for operator in self.encoded.planning.operators}
        facts: set[Fact] = set(self.changing)
        for action in actions:
            operator = operators.get(action.name)
            if operator is None or len(operator.parameters) != len(action.arguments):
                return False
            binding = operator.bind(action)
            if not self._hold([ground(fact, binding) for fact in operator.precondition], facts):
                return False
            facts.difference_update([ground(fact, binding) for fact in operator.delete])
            facts.update([ground(fact, binding) for fact in operator.add])
        return self._hold(self.goal, facts)

    def _hold(self, conditions: Iterable[Fact], facts: Collection[Fact]) -> bool:
        return all(fact in facts or self.always(fact) for fact in conditions)

    @cached_property
    def _static(self) -> dict[str, tuple[Predicate, bool]]:
        """Maps each PDDL name of a static predicate or of its negation to (predicate, whether positive)."""
        vocabulary = self.encoded.vocabulary
        static = {vocabulary.predicate(p.name): (p, True) for p in self.task.domain.static_predicates}
        return static | {vocabulary.predicate(p.name, positive=False): (p, False) for p in vocabulary.denied}


def compile_task(task: Task, whole: Compilation | None = None, chains: bool = True) -> Compilation:
    """Compile a task to STRIPS.

    Args:
        task: Task to compile.
        whole: Compilation of a larger task with the same tokens in the same state. Its encoded domain and its
            feasibility facts are reused.
        chains: Whether blocks in series are compiled as one block.

    Raises:
        InputError: If the goal has a negative atom, leaves a choice, or requires an `unknown` class of a token.
    """
    task = settle_goal(task)
    encoded = whole.encoded if whole else encode_task(task) if chains else encode_domain(task.domain)
    own = {name for name, _ in encoded.planning.predicates}
    numbers = _numbers(task)
    words = TaskWords.of(task, encoded.vocabulary, taken=encoded.vocabulary.names.all | own | set(numbers))
    goal = tuple(sorted(set(_Writer(encoded, words, numbers).goal())))
    return Compilation(task, encoded, words, numbers, goal, whole.feasible if whole else StaticFacts(task))


def _numbers(task: Task) -> tuple[str, ...]:
    """Return the names of the numbers from 1 to the largest number of instances that can read one token at a time."""
    # Instances that run at the same time have different anchors.
    anchors = {
        token
        for block in task.domain.blocks
        if locked_targets(task.domain, block)
        for token in task.values_of(block.slot(block.anchor).object_class)
    }
    return tuple(f"n{number}" for number in range(1, len(anchors) + 1))


class _Writer:
    """Writes the initial facts and the goal of one task with the PDDL names of its encoded domain."""

    def __init__(self, encoded: EncodedDomain, words: TaskWords, numbers: tuple[str, ...]) -> None:
        self.task = words.task
        self.vocabulary = encoded.vocabulary
        self.used = {name for name, _ in encoded.planning.predicates}
        self.words = words
        self.numbers = numbers

    def fact(self, atom: Atom) -> Fact:
        return (self.vocabulary.predicate(atom.predicate), *map(self.words.name, atom.arguments))

    def changing(self) -> Iterator[Fact]:
        """Yield the initial facts, except the feasibility and inequality facts."""
        changing = facts(self.task)
        yield from map(self.fact, changing)
        yield from self.words.guards()
        yield from self._no_values(changing)
        yield from (fact for fact in self._assignment() if fact[0] in self.used)

    def lasting(self, feasible: StaticFacts) -> Iterator[Fact]:
        """Yield the feasibility and inequality facts."""
        static = static_facts(self.task, feasible)
        yield from map(self.fact, static)
        yield from self.words.denials(static)
        if "distinct" in self.used:
            yield from self.words.differences()

    def _no_values(self, changing: frozenset[Atom]) -> Iterator[Fact]:
        """Yield a fact with the value 'none' for each functional predicate and all arguments without a value."""
        for predicate in self.task.domain.predicates:
            index = predicate.functional_index
            if index is None:
                continue
            valued = {a.arguments[:index] + a.arguments[index + 1 :] for a in changing if a.predicate == predicate.name}
            for others in self.words.combine(predicate, skip=index):
                if others not in valued:
                    names = list(map(self.words.name, others))
                    names.insert(index, self.vocabulary.no_value(predicate))
                    yield (self.vocabulary.predicate(predicate.name), *names)

    def _assignment(self) -> Iterator[Fact]:
        none = self.vocabulary.none_reading
        yield ("idle",)
        for token in self.task.assigned:
            name = self.words.name(token.name)
            block = self.task.start_block(token.name)
            yield (self.vocabulary.state("in", block), name)
            yield from ((word, name) for word in ("settled", "unclaimed"))
            if block.hold:
                # A token cannot stay in a block without a hold, so a plan must move the token on.
                yield ("completed", name)
            yield ("readers", name, none)
        yield from (("next", one, more) for one, more in pairwise([none, *self.numbers]))

    def goal(self) -> Iterator[Fact]:
        """Yield the user's goal, and facts that hold if no reassignment and no block without a hold is unfinished."""
        yield from map(self.fact, self.task.goal)
        yield ("idle",)
        for token in self.task.assigned:
            yield from self._at_ease(token)

    def _at_ease(self, token: Token) -> Iterator[Fact]:
        blocks = self.vocabulary.domain.blocks
        anchored = [block for block in blocks if token.is_member(block.slot(block.anchor).object_class)]
        if any(block.others for block in anchored):
            yield ("unclaimed", self.words.name(token.name))
        if any(not block.hold for block in anchored):
            yield ("completed", self.words.name(token.name))

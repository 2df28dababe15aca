"""A temporal problem for one task alone, and as small as that: Aries plans lifted, and slowly.

Blocks that cannot run are left out; so is what is always true. All that never changes, of the tokens and targets of a
block, is one table of its runs; durations depend on those roles that make a difference.
"""

from collections.abc import Iterator
from dataclasses import replace

from hybrid_tamp.symbolic.encoding.conditions import Conditions
from hybrid_tamp.symbolic.pddl.operators import Fact
from hybrid_tamp.symbolic.temporal.compilation import TemporalCompilation
from hybrid_tamp.symbolic.temporal.grounding import Run
from hybrid_tamp.symbolic.temporal.problem import Condition, DurativeAction, Fluent, TemporalProblem, Value

TABLE, LASTS = "run ", "time of "
SOURCE = "from"
"""Stands for the slot from which the anchor comes, among the roles of a run."""


def specialised(compilation: TemporalCompilation) -> TemporalProblem:
    """Return the task's temporal problem, put for a planner that is asked only this."""
    return _Special(compilation).problem()


def _words(fact: Fact, value: Value) -> Iterator[str]:
    """Yield what a fluent with a value mentions."""
    yield from fact[1:]
    yield from value if isinstance(value, tuple) else ()


def _value(run: Run, role: str) -> object:
    return run.source if role == SOURCE else run.binding[role]


class _Special:
    def __init__(self, compilation: TemporalCompilation) -> None:
        self.compilation = compilation
        self.source = compilation.problem
        self.running = compilation.encoding.running
        changing = {e.fact[0]: e for a in self.source.domain.actions for e in a.effects}
        numbers = {fluent.name for fluent in self.source.domain.fluents if fluent.kind == "number"}
        self.static = {f.name for f in self.source.domain.fluents} - set(changing) - numbers
        self.settled = set(self._settled())
        words = compilation.encoding.names
        self.readers = words("readers")
        self.reads = [words.reads(number) for number in range(words.locks)]
        self.reading = [self._reading(number) for number in range(words.locks)]
        self.telling = {name: self._telling(runs) for name, runs in compilation.runs.items()}

    def problem(self) -> TemporalProblem:
        """Return the problem."""
        domain = self.source.domain
        actions = tuple(self._action(a) for a in domain.actions if self.running[a.name].block in self.telling)
        slots = self._slots()
        init = [*((f, v) for f, v in self.source.init if f[0] != "passes" or set(f[1:]) <= slots), *self._tables()]
        used = {fact[0] for action in actions for fact in (*action.facts, action.duration)}
        used |= {fact[0] for fact, _ in self.source.goal}
        fluents = [*domain.fluents, *self._declared()]
        special = replace(domain, fluents=tuple(f for f in fluents if f.name in used), actions=actions)
        init = [(f, v) for f, v in init if f[0] in used]
        named = {word for action in actions for word in action.mentioned}
        named |= {word for fact, value in (*init, *self.source.goal) for word in _words(fact, value)}
        constants = tuple(each for each in domain.constants if each[0] in named)
        special = replace(special, constants=constants)
        return replace(self.source, domain=special, init=tuple(init))

    def _reading(self, number: int) -> list[str]:
        """Return the tokens that may anchor a block with so many targets that others may change, and more."""
        conditions = Conditions(self.compilation.encoding.vocabulary)
        blocks = self.compilation.task.domain.block_by_name
        found = {
            run.binding[blocks[run.block].anchor]
            for run in self.compilation.reached
            if len(conditions.locked(blocks[run.block])) > number
        }
        return sorted(self.compilation.name(token) for token in found)

    def _source(self, run: Run) -> str:
        block, slot = run.source
        return self.compilation.encoding.names.slot(self.compilation.task.domain.block_by_name[block], slot)

    def _slots(self) -> set[str]:
        """Return the slots that tokens can come to."""
        blocks = [self.compilation.task.domain.block_by_name[name] for name in self.telling]
        names = self.compilation.encoding.names
        return {names.slot(block, slot.name) for block in blocks for slot in block.slots}

    def _settled(self) -> Iterator[str]:
        """Yield the truths that are true of everything from the beginning and always will be."""
        true: dict[str, int] = {}
        for fact, value in self.source.init:
            if value is True:
                true[fact[0]] = true.get(fact[0], 0) + 1
        values: dict[str, set[Value]] = {}
        for action in self.source.domain.actions:
            for effect in action.effects:
                values.setdefault(effect.fact[0], set()).add(effect.value)
        for predicate in self.compilation.task.domain.predicates:
            word = self.compilation.encoding.vocabulary.predicate(predicate.name)
            count = 1
            for parameter in predicate.parameters:
                count *= len(self.compilation.task.values_of(parameter.sort))
            if values.get(word) == {True} and true.get(word) == count:
                yield word

    @staticmethod
    def _telling(runs: list[Run]) -> tuple[str, ...]:
        """Return the fewest roles, `SOURCE` among them, that tell how long a run lasts."""
        telling = [SOURCE, *(role for role, _ in runs[0].roles)]
        for role in reversed(tuple(telling)):
            fewer = [other for other in telling if other != role]
            seen: dict[tuple[object, ...], float] = {}
            if all(seen.setdefault(tuple(_value(r, o) for o in fewer), r.seconds) == r.seconds for r in runs):
                telling = fewer
        return tuple(telling)

    def _action(self, action: DurativeAction) -> DurativeAction:
        """Return an action put for this task alone; it keeps the parameters that something mentions."""
        running = self.running[action.name]
        names = [name for name, _ in action.parameters]
        roles = {role: names[index] for role, index in running.roles.items()}
        told = tuple(self._from(action) if role == SOURCE else roles[role] for role in self.telling[running.block])
        conditions = [Condition("start", (TABLE + running.block, *roles.values()))]
        for condition in action.conditions:
            if not self._told(condition.fact, set(roles.values())) and condition.fact[0] not in self.settled:
                conditions += self._unread(condition)
        effects = tuple(e for e in action.effects if e.fact[0] not in self.settled and e.fact[0] != self.readers)
        duration = (LASTS + running.block, *told)
        made = replace(action, duration=duration, conditions=tuple(conditions), effects=effects)
        return replace(made, parameters=tuple(each for each in action.parameters if each[0] in made.mentioned))

    def _from(self, action: DurativeAction) -> str:
        """Return where the anchor comes from: a variable or a constant."""
        running = self.running[action.name]
        block = self.compilation.task.domain.block_by_name[running.block]
        anchor = action.parameters[running.roles[block.anchor]][0]
        place = (self.compilation.encoding.names("place"), anchor)
        return next(c.value[0] for c in action.conditions if c.fact == place and isinstance(c.value, tuple))

    def _unread(self, condition: Condition) -> Iterator[Condition]:
        """Put a condition on the number of readers as one on each token that may read: Aries takes no other."""
        if condition.fact[0] in self.reads:
            return
        if condition.fact[0] != self.readers:
            yield condition
            return
        for number, tokens in enumerate(self.reading):
            for token in tokens:
                yield Condition("over all", (self.reads[number], token), condition.fact[1:], other=True)

    def _told(self, fact: Fact, roles: set[str]) -> bool:
        """Say whether the table of runs says a condition already."""
        constants = {name for name, _ in self.source.domain.constants}
        return fact[0] in self.static and set(fact[1:]) <= roles | constants

    def _declared(self) -> Iterator[Fluent]:
        for block, runs in self.compilation.runs.items():
            action = next(a for a in self.source.domain.actions if self.running[a.name].block == block)
            types = {role: action.parameters[index] for role, index in self.running[action.name].roles.items()}
            yield Fluent(TABLE + block, tuple(types[role] for role, _ in runs[0].roles))
            types[SOURCE] = ("?from", self.compilation.encoding.names("slot"))
            yield Fluent(LASTS + block, tuple(types[role] for role in self.telling[block]), "number")

    def _tables(self) -> Iterator[tuple[Fact, Value]]:
        name = self.compilation.name
        lasts: dict[Fact, Value] = {}
        for run in self.compilation.reached:
            yield (TABLE + run.block, *(name(value) for _, value in run.roles)), True
            told = [
                self._source(run) if role == SOURCE else name(run.binding[role]) for role in self.telling[run.block]
            ]
            fact = (LASTS + run.block, *told)
            lasts[fact] = round(1e3 * run.seconds)
        yield from lasts.items()

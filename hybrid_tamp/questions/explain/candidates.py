"""The single changes that might give a task a plan, those first to which the reasons point."""

from collections.abc import Iterable, Iterator
from functools import partial
from itertools import product

from hybrid_tamp.feasibility.bindings import Bound, Choices, Margins, choices, extensions, static_entry, symbolic
from hybrid_tamp.feasibility.passages import Passages
from hybrid_tamp.feasibility.reasons import Reason
from hybrid_tamp.feasibility.shares import amount
from hybrid_tamp.model.affordance import ObjectClass, is_place
from hybrid_tamp.model.network import SlotName, parse_slot
from hybrid_tamp.model.plan import split_mode
from hybrid_tamp.model.predicate import Atom, Literal
from hybrid_tamp.model.task import Task
from hybrid_tamp.questions.changes import (
    Change,
    more_tokens,
    task_root,
    with_class,
    with_edges,
    with_facts,
    with_ideal,
)
from hybrid_tamp.questions.explain.property_changes import property_changes


def candidates(task: Task, reasons: Iterable[Reason]) -> Iterator[Change]:
    """Yield every single change, each once, in the order in which they are worth a try."""
    seen: set[str] = set()
    for change in _ordered(_Space(task), reasons):
        # One property may make several facts hold.
        if change.what not in seen:
            seen.add(change.what)
            yield change


def answers(task: Task, reason: Reason) -> Iterator[Change]:
    """Yield the single changes that take away what a reason complains of."""
    return _Space(task).pointed(reason)


def together(task: Task, changes: list[Change]) -> Task:
    """Return the task with several edges or several facts, or with any single change or none."""
    if len(changes) == 1:
        return changes[0].made()
    if all(change.kind == "edge" for change in changes):
        return with_edges(task, [(parse_slot(one), parse_slot(other)) for one, other in (c.key for c in changes)])
    return with_facts(task, [parsed(change.key[0]) for change in changes])


def points_to(task: Task, reason: Reason, change: Change) -> bool:
    """Say whether a change takes away what a reason complains of."""
    if change.kind == "token":
        classes = [each.name for each in task.token_by_name[change.key[0]].classes] if change.key[1:] else change.key
        return reason.lacks in classes
    if change.kind == "class":
        return reason.lacks == change.key[1]
    if change.kind == "edge":
        return reason.kind == "no_edge" and reason.lacks == change.key[1]
    return reason.atom in (change.key[0], change.key[-1])


def _ordered(space: "_Space", reasons: Iterable[Reason]) -> Iterator[Change]:
    for reason in reasons:
        yield from space.pointed(reason)
    yield from space.tokens()
    yield from space.classes()
    failing = list(space.failing())
    for atom in failing:
        yield space.fact(atom)
    yield from space.edges()
    for atom in failing:
        yield from property_changes(space.task, atom)


class _Space:
    """The single changes of one task.

    Attributes:
        task: the task.
    """

    def __init__(self, task: Task) -> None:
        self.task = task
        self._margins = Margins(task)
        self._passages = Passages(task)
        self._kept: set[Atom] = set()
        self._slots = {(b.name, s.name): s.object_class for b in task.domain.blocks for s in b.slots}

    def pointed(self, reason: Reason) -> Iterator[Change]:
        """Yield the changes that take away what a reason complains of."""
        if reason.kind == "no_edge":
            yield from self.edges(parse_slot(reason.lacks))
        elif reason.lacks in self.task.domain.class_by_name:
            object_class = self.task.domain.class_by_name[reason.lacks]
            yield from self.tokens(object_class)
            yield from self.classes(object_class)
        elif reason.atom:
            atom = parsed(reason.atom)
            yield from property_changes(self.task, atom)
            yield self.fact(atom)

    def tokens(self, wanted: type[ObjectClass] | None = None) -> Iterator[Change]:
        """Yield one more token, like each that is there, or one of a class of which there is none."""
        for token in self.task.assigned:
            if wanted is None or token.is_member(wanted):
                yield from more_tokens(self.task, token)
        for each in self.task.domain.classes if wanted is None else (wanted,):
            if not is_place(each) and not self.task.values_of(each):
                what = f"a token of class {each.name} that is able to do what is asked of it"
                yield Change("token", (each.name,), what, partial(with_ideal, self.task, each))

    def classes(self, wanted: type[ObjectClass] | None = None) -> Iterator[Change]:
        """Yield one more class for a token."""
        relations = self.task.domain.relations
        for each, token in product(self.task.domain.classes if wanted is None else (wanted,), self.task.assigned):
            own = set(token.classes) - {task_root(self.task)}
            if not is_place(each) and each not in own and all(relations.can_share_token(each, one) for one in own):
                what = f"{token.name} as a member of {each.name}"
                made = partial(with_class, self.task, token, each)
                yield Change("class", (token.name, each.name), what, made)

    def edges(self, towards: SlotName | None = None) -> Iterator[Change]:
        """Yield one more edge from where a token can come; first those that lead to where none can, then likely ones.

        Likely is an edge like one that is there, between the same actions and from or into the same slot.
        """
        sources = {slot for token in self.task.assigned for slot in self._passages.slots(token)}
        network, relations = self.task.domain.network, self.task.domain.relations
        pairs = [
            (one, other)
            for one, other in product(sorted(sources), [towards] if towards else sorted(self._slots))
            if not network.allows(one, other) and relations.can_share_token(self._slots[one], self._slots[other])
        ]
        out_of = {(one, split_mode(other[0])[0]) for one, other in network.edges}
        into = {(split_mode(one[0])[0], other) for one, other in network.edges}

        def likely(one: SlotName, other: SlotName) -> bool:
            return (one, split_mode(other[0])[0]) in out_of or (split_mode(one[0])[0], other) in into

        # Last what stays in one block: an action that follows itself.
        pairs.sort(key=lambda pair: (pair[1] in sources, not likely(*pair), pair[0][0] == pair[1][0]))
        for one, other in pairs:
            source, target = ".".join(one), ".".join(other)
            what = f"an edge {source} -> {target} of the network"
            yield Change("edge", (source, target), what, partial(with_edges, self.task, [(one, other)]))

    def fact(self, atom: Atom) -> Change:
        """Return the change by a feasibility fact that is as it has to be."""
        predicate = self.task.domain.predicate_by_name[atom.predicate]
        short = amount(-self.task.margin(atom), predicate.unit)
        what = f"{atom} as a fact, which fails by {short}"
        return Change("fact", (str(atom),), what, partial(with_facts, self.task, [atom]))

    def failing(self) -> list[Atom]:
        """Return the feasibility facts that alone keep some tokens out of some block, the nearest first."""
        found: dict[Atom, float] = {}
        for block in self.task.domain.blocks:
            bounds: list[tuple[Bound, Atom | None]] = [({}, None)]
            allowed = choices(self.task, block, {})
            for literal in static_entry(block):
                bounds = [more for bound in bounds for more in self._failing_once(literal, *bound, allowed, found)]
            found |= {atom: found[atom] for _, atom in bounds if atom is not None}
            self._kept |= {atom for _, atom in bounds if atom is not None}
        return sorted(self._kept, key=lambda atom: (-found[atom], atom))

    def _failing_once(
        self, literal: Literal, bound: Bound, failed: Atom | None, allowed: Choices, found: dict[Atom, float]
    ) -> Iterator[tuple[Bound, Atom | None]]:
        """Yield the bindings, extended, in which at most one fact fails, which is not about symbols alone."""
        for more in extensions(literal, bound, allowed):
            margin = self._margins.of(literal, more)
            atom = literal.ground(more)
            if margin >= 0 or atom == failed:
                yield more, failed
            elif failed is None and not symbolic(literal):
                found[atom] = margin / literal.predicate.scale
                yield more, atom


def parsed(text: str) -> Atom:
    """Return the atom that was written as a text: names of tokens have no ', ' in them, else nothing is found."""
    positive = not text.startswith("not ")
    name, _, rest = text.removeprefix("not ").partition("(")
    return Atom(name, tuple(rest.removesuffix(")").split(", ")), positive)

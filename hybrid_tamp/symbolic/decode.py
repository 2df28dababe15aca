"""Decoder, which converts planned actions to block instances with tokens.

A `fill` action chooses a token for a slot, which the token enters when the block begins. Each `begin` action is one
reassignment, to which the following `leave` actions also belong. The first block of a chain begins with the action. Its
later blocks begin before the next `begin` action, with one reassignment each.
"""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from hybrid_tamp.model.plan import BlockInstance, PlannedAction, split_mode
from hybrid_tamp.model.task import Task
from hybrid_tamp.symbolic.chaining.series import Link
from hybrid_tamp.symbolic.encoding.problem import Compilation


class NotAPlanError(ValueError):
    """The actions are not a plan of the task."""


class UndecodableError(NotAPlanError):
    """The actions are not a sequence of reassignments."""


@dataclass
class OrderedInstance:
    """A block instance whose beginning and end are given by numbers of reassignments, not by times.

    Attributes:
        name: Unique name of the instance.
        block: Name of the block.
        slots: Maps each slot to its token.
        targets: Maps each target to its token or symbol.
        begin: Number of the reassignment at which the instance begins. 0 is the start of the plan.
        end: Number of the reassignment at which the instance ends, or None for the end of the plan.
    """

    name: str
    block: str
    slots: dict[str, str]
    targets: dict[str, str]
    begin: int
    end: int | None = None

    def timed(
        self, start: float, end: float, hyperparameters: Mapping[str, float], reached: float | None
    ) -> BlockInstance:
        """Return the instance with its times [s] and hyperparameters."""
        slots, targets = dict(self.slots), dict(self.targets)
        return BlockInstance(self.name, self.block, slots, start, end, targets, dict(hyperparameters), reached)


@dataclass
class _Decoding:
    task: Task
    instances: list[OrderedInstance] = field(default_factory=list)
    where: dict[str, OrderedInstance] = field(default_factory=dict)
    numbers: Counter[str] = field(default_factory=Counter)
    reassignment: int = 0
    pending: list[tuple[Link, Mapping[str, str]]] = field(default_factory=list)

    def enter(self, links: Sequence[Link], named: Mapping[str, str]) -> None:
        """Begin the block of the first link. The blocks of the other links begin in `pass_through`."""
        self._begin(links[0], named)
        self.pending += [(link, named) for link in links[1:]]

    def pass_through(self) -> None:
        """Begin the pending blocks of chains, with one reassignment per block."""
        for link, named in self.pending:
            self.reassignment += 1
            self._begin(link, named)
        self.pending.clear()

    def _begin(self, link: Link, named: Mapping[str, str]) -> None:
        roles = {own: named.get(role, role) for own, role in link.roles.items()}
        slots = {slot.name: roles[slot.name] for slot in link.block.slots}
        self.start(link.block.name, slots, {target.name: roles[target.name] for target in link.block.targets})

    def start(self, block: str, slots: dict[str, str], targets: dict[str, str]) -> None:
        """Begin an instance at the current reassignment, and end the previous instances of its tokens."""
        action = split_mode(block)[0]
        self.numbers[action] += 1
        instance = OrderedInstance(f"{action}-{self.numbers[action]}", block, slots, targets, self.reassignment)
        for token in slots.values():
            before = self.where.get(token)
            if before is not None and before.end is None:
                before.end = self.reassignment
            self.where[token] = instance
        self.instances.append(instance)


def decode(compilation: Compilation, actions: Iterable[PlannedAction]) -> list[OrderedInstance]:
    """Return the instances of a plan in the order of their beginnings. The initial instances come first.

    Args:
        compilation: Compiled task for which the plan was made.
        actions: Planned actions with PDDL names.

    Raises:
        UndecodableError: If an action is unknown, or if a block begins with an empty slot.
    """
    task, chains = compilation.task, compilation.encoded.chains
    decoding = _Decoding(task)
    for token in task.assigned:
        block = task.start_block(token.name)
        decoding.start(block.name, {block.anchor: token.name}, {})
    claimed: dict[tuple[str, str], dict[str, str]] = {}
    for action in actions:
        meaning = compilation.encoded.meanings.get(action.name)
        if meaning is None:
            raise UndecodableError(f"the compiled task has no action {action.name!r}")
        block = chains.domain.block_by_name[meaning.block]
        roles = {role: compilation.words.user(action.arguments[index]) for role, index in meaning.roles.items()}
        anchor = roles[block.anchor]
        if meaning.kind == "fill":
            claimed.setdefault((block.name, anchor), {})[meaning.slot] = roles[meaning.slot]
            continue
        slots = {block.anchor: anchor, **claimed.pop((block.name, anchor), {})}
        if set(slots) != {slot.name for slot in block.slots}:
            raise UndecodableError(f"all slots of {block.name} must be filled before it begins (anchor {anchor})")
        if meaning.kind == "begin":
            decoding.pass_through()
            decoding.reassignment += 1
        decoding.enter(chains.expand(block.name), {**roles, **slots})
    decoding.pass_through()
    return decoding.instances

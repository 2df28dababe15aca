"""Search for chains, which are blocks in series that are compiled as one block (paper, Sec. II-C).

"These serial actions do not increase the planning complexity any more than a single action would." Inside a chain, the
only edge from each slot of a block leads to a slot of the next block. A chain is as long as `composing` and `cuts`
allow. The cuts depend on the goal and on the initial assignment of the task.
"""

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise

from hybrid_tamp.model.block import Block
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.network import ReassignmentNetwork, SlotName
from hybrid_tamp.model.plan import BlockInstance, TaskPlan
from hybrid_tamp.model.task import Task
from hybrid_tamp.symbolic.chaining.composing import begin_series, extend_series
from hybrid_tamp.symbolic.chaining.cuts import Cuts
from hybrid_tamp.symbolic.chaining.series import Link, Series
from hybrid_tamp.symbolic.pddl.naming import legal, unused

Follower = tuple[str, Mapping[str, str]]
"""Pair of the next block's name and a dictionary that maps its slots to the slots of the block before."""


@dataclass(frozen=True, eq=False)
class Chains:
    """A domain in which each chain is one block.

    Attributes:
        domain: Domain to compile, with one block per chain.
        links: Maps the name of each chain to the links of the chain.
        copies: Maps the name of each copy of a block to the name of the block (see `repeats`).
    """

    domain: Domain
    links: Mapping[str, tuple[Link, ...]] = field(default_factory=dict)
    copies: Mapping[str, str] = field(default_factory=dict)

    def expand(self, block: str) -> tuple[Link, ...]:
        """Return the blocks of a chain, or the block itself if it is not a chain."""
        block = self.copies.get(block, block)
        whole = self.domain.block_by_name[block]
        return self.links.get(block, (Link(whole, {role: role for role in whole.roles}),))

    @property
    def comments(self) -> tuple[tuple[str, str], ...]:
        """The chains as pairs of (PDDL name, names of the original blocks)."""
        said = {name: " > ".join(link.block.name for link in links) for name, links in self.links.items()}
        return tuple(sorted((legal(name), blocks) for name, blocks in said.items()))


def chain_blocks(task: Task) -> Chains:
    """Return the domain of a task with its chains."""
    followers = dict(_followers(task))
    if not followers:
        return Chains(task.domain)
    cuts = Cuts(task)
    found = [series for run in _runs(followers) for series in _cut(cuts, run, followers) if len(series.links) > 1]
    return _with_chains(task, found)


def _followers(task: Task) -> Iterator[tuple[str, Follower]]:
    """Yield pairs of (block, follower). The block has no other follower, and the follower has no other predecessor."""
    # A token that starts in a block does not pass through the predecessors of the block, so the block is in no chain.
    apart = {task.domain.resting, *task.assignment.values()}
    for block in task.domain.blocks:
        follower = _follower(task.domain, block)
        if follower is not None and not apart & {block.name, follower[0]}:
            yield block.name, follower


def _follower(domain: Domain, block: Block) -> Follower | None:
    slots: dict[str, str] = {}
    names: set[str] = set()
    for slot in block.slots:
        here = (block.name, slot.name)
        ways = domain.network.destinations(here)
        if len(ways) != 1 or domain.network.sources(ways[0]) != (here,):
            return None
        names.add(ways[0][0])
        slots[ways[0][1]] = slot.name
    if len(names) != 1 or block.name in names:
        return None
    name = names.pop()
    return (name, slots) if {slot.name for slot in domain.block_by_name[name].slots} == set(slots) else None


def _runs(followers: Mapping[str, Follower]) -> Iterator[list[str]]:
    """Yield the maximal sequences of followers. A cycle has no first block, so it is left out."""
    inner = {name for name, _ in followers.values()}
    for name in followers:
        if name not in inner:
            run = [name]
            while run[-1] in followers:
                run.append(followers[run[-1]][0])
            yield run


def _cut(cuts: Cuts, run: list[str], followers: Mapping[str, Follower]) -> Iterator[Series]:
    """Divide a sequence of followers into chains. Each chain is as long as possible."""
    blocks = [cuts.domain.block_by_name[name] for name in run]
    symbols = {a for b in blocks for literal in (*b.entry, *b.exit) for a in literal.arguments if a not in b.roles}
    while blocks:
        grown: list[Series] = [begin_series(blocks[0], symbols)]
        for before, block in pairwise(blocks):
            longer = extend_series(grown[-1], block, followers[before.name][1], symbols)
            if longer is None:
                break
            grown.append(longer)
        chain = next((series for series in reversed(grown[1:]) if cuts.is_uncut(series)), grown[0])
        yield chain
        blocks = blocks[len(chain.links) :]


def _with_chains(task: Task, chains: Collection[Series]) -> Chains:
    domain, names = task.domain, _names(task.domain, chains)
    inside = {link.block.name for series in chains for link in series.links}
    asking = [*(block.entry for block in domain.blocks if block.name not in inside), *(s.entry for s in chains)]
    wanted = {literal.predicate.name for entry in asking for literal in entry} | {atom.predicate for atom in task.goal}
    wholes = {series.links[0].block.name: _lean(series, name, wanted) for name, series in names.items()}
    blocks = tuple(
        wholes.get(block.name, block) for block in domain.blocks if block.name in wholes or block.name not in inside
    )
    network = ReassignmentNetwork(_edges(domain, names))
    links = {name: series.links for name, series in names.items()}
    return Chains(replace(domain, blocks=blocks, network=network), links) if chains else Chains(domain)


def _lean(series: Series, name: str, wanted: Collection[str]) -> Block:
    """Return the chain as one block. Effects before the last block are left out if no condition needs them."""
    whole = series.block(name)
    kept = [each for each in whole.exit if each in series.last.exit or each.predicate.name in wanted]
    left_out = [each.predicate for each in whole.exit if each not in kept]
    return replace(whole, exit=tuple(kept), keeps=tuple(dict.fromkeys((*whole.keeps, *left_out))))


def _names(domain: Domain, chains: Iterable[Series]) -> dict[str, Series]:
    """Name each chain after its first and last block, with a PDDL name that no other block has."""
    taken = {legal(block.name) for block in domain.blocks}
    named: dict[str, Series] = {}
    for series in chains:
        name = f"{series.links[0].block.name} to {series.last.block.name}"
        chosen = unused(legal(name), taken)
        taken.add(chosen)
        named[name if chosen == legal(name) else chosen] = series
    return named


def _edges(domain: Domain, chains: Mapping[str, Series]) -> Iterator[tuple[str, str]]:
    """Yield the edges between blocks and chains. Edges inside a chain are left out."""
    into = {series.links[0].block.name: (name, series.links[0]) for name, series in chains.items()}
    out_of = {series.last.block.name: (name, series.last) for name, series in chains.items()}
    leading = {link.block.name for series in chains.values() for link in series.links[:-1]}
    for source, target in domain.network.edges:
        if source[0] not in leading:
            yield _end(source, out_of), _end(target, into)


def _end(slot: SlotName, chains: Mapping[str, tuple[str, Link]]) -> str:
    name, role = slot
    if name in chains:
        name, link = chains[name]
        role = link.roles[role]
    return f"{name}.{role}"


def fold_chains(chains: Chains, plan: TaskPlan) -> TaskPlan:
    """Replace each complete pass through a chain in a timeline by one instance of the chain."""
    instances = list(plan.instances)
    for name, links in chains.links.items():
        whole = chains.domain.block_by_name[name]
        for first in [i for i in plan.instances if i.block == links[0].block.name]:
            run = list(_follow(plan, first, links))
            named = _named(whole, links, run)
            if len(run) < len(links) or named is None:
                continue
            slots, targets = ({role.name: named[role.name] for role in some} for some in (whole.slots, whole.targets))
            instances = [i for i in instances if i not in run]
            instance = replace(run[-1], name=first.name, block=name, start=first.start, slots=slots, targets=targets)
            instances.append(instance)
    return replace(plan, instances=tuple(sorted(instances, key=lambda i: (i.start, i.end, i.name))))


def _follow(plan: TaskPlan, first: BlockInstance, links: Sequence[Link]) -> Iterator[BlockInstance]:
    """Yield the instance `first` and the later instances of its anchor, as long as their blocks follow the chain."""
    timeline = [instance for instance, _ in plan.timeline(first.slots.get(links[0].block.anchor, ""))]
    begin = timeline.index(first) if first in timeline else len(timeline)
    for link, instance in zip(links, timeline[begin:], strict=False):
        if instance.block != link.block.name:
            return
        yield instance


def _named(whole: Block, links: Sequence[Link], run: Sequence[BlockInstance]) -> dict[str, str] | None:
    """Return a dictionary that maps each role of a chain to its value, or None if the instances disagree."""
    named: dict[str, str] = {}
    for link, instance in zip(links, run, strict=False):
        for own, role in link.roles.items():
            value = instance.roles.get(own)
            if value is None or value != (named.setdefault(role, value) if role in whole.roles else role):
                return None
    return named

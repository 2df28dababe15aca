"""Chains: blocks in series compiled as one step, and the way back to every block (paper, Sec. II-C).

"These serial actions do not increase the planning complexity any more than a single action would." A chain is a run
of blocks whose slots map one to one by sole edges, as long as it can be without a cut (`composing`, `cuts`). Where it
is cut depends on the task: on its goal, and on the blocks in which its tokens start.
"""

from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from itertools import pairwise

from hybrid_tamp.model.block import Block
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.network import ReassignmentNetwork, SlotName
from hybrid_tamp.model.task import Task
from hybrid_tamp.symbolic.chaining.composing import begin_series, extend_series
from hybrid_tamp.symbolic.chaining.cuts import Cuts
from hybrid_tamp.symbolic.chaining.series import Link, Series
from hybrid_tamp.symbolic.pddl.naming import legal, unused

Follower = tuple[str, Mapping[str, str]]
"""The one block that can follow a block: its name, and its slots to those of the block before."""


@dataclass(frozen=True, eq=False)
class Chains:
    """A domain in which each chain is one block.

    Attributes:
        domain: the domain to compile.
        links: name of the block of each chain to the blocks that it stands for.
    """

    domain: Domain
    links: Mapping[str, tuple[Link, ...]] = field(default_factory=dict)

    def expanded(self, block: str) -> tuple[Link, ...]:
        """Return the blocks that a block of the domain stands for: those of the chain, or itself."""
        whole = self.domain.block_by_name[block]
        return self.links.get(block, (Link(whole, {role: role for role in whole.roles}),))

    @property
    def comments(self) -> tuple[tuple[str, str], ...]:
        """(PDDL name, blocks in words) pairs of the chains."""
        said = {name: " > ".join(link.block.name for link in links) for name, links in self.links.items()}
        return tuple(sorted((legal(name), blocks) for name, blocks in said.items()))


def chain_blocks(task: Task) -> Chains:
    """Return the task's domain with its chains."""
    followers = dict(_followers(task))
    if not followers:
        return Chains(task.domain)
    cuts = Cuts(task)
    found = [series for run in _runs(followers) for series in _cut(cuts, run, followers) if len(series.links) > 1]
    return _with_chains(task, found)


def _followers(task: Task) -> Iterator[tuple[str, Follower]]:
    """Yield the blocks that only one block can follow, all tokens together, and that alone precede it."""
    # Tokens that start in a block are nowhere else before: it stays a block of its own.
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
    """Yield the maximal runs of blocks; a ring has no beginning and is none."""
    inner = {name for name, _ in followers.values()}
    for name in followers:
        if name not in inner:
            run = [name]
            while run[-1] in followers:
                run.append(followers[run[-1]][0])
            yield run


def _cut(cuts: Cuts, run: list[str], followers: Mapping[str, Follower]) -> Iterator[Series]:
    """Yield the chains of a run, each as long as it can be from where the one before ends."""
    blocks = [cuts.domain.block_by_name[name] for name in run]
    symbols = {a for b in blocks for literal in (*b.entry, *b.exit) for a in literal.arguments if a not in b.roles}
    while blocks:
        grown: list[Series] = [begin_series(blocks[0], symbols)]
        for before, block in pairwise(blocks):
            longer = extend_series(grown[-1], block, followers[before.name][1], symbols)
            if longer is None:
                break
            grown.append(longer)
        chain = next((series for series in reversed(grown[1:]) if cuts.uncut(series)), grown[0])
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
    """Return the whole without effects of its inner blocks that nobody asks for: planners would look into each."""
    whole = series.block(name)
    kept = [each for each in whole.exit if each in series.last.exit or each.predicate.name in wanted]
    left_out = [each.predicate for each in whole.exit if each not in kept]
    return replace(whole, exit=tuple(kept), keeps=tuple(dict.fromkeys((*whole.keeps, *left_out))))


def _names(domain: Domain, chains: Iterable[Series]) -> dict[str, Series]:
    """Name each chain for its first and last block, by a name that also PDDL tells from all others."""
    taken = {legal(block.name) for block in domain.blocks}
    named: dict[str, Series] = {}
    for series in chains:
        name = f"{series.links[0].block.name} to {series.last.block.name}"
        chosen = unused(legal(name), taken)
        taken.add(chosen)
        named[name if chosen == legal(name) else chosen] = series
    return named


def _edges(domain: Domain, chains: Mapping[str, Series]) -> Iterator[tuple[str, str]]:
    """Yield the edges between blocks and chains; those inside a chain are gone."""
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

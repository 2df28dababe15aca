"""Chains in a timeline, put together again: the blocks that one step stands for become one instance of the whole."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

from hybrid_tamp.model.block import Block
from hybrid_tamp.model.plan import BlockInstance, TaskPlan
from hybrid_tamp.symbolic.chaining.chains import Chains
from hybrid_tamp.symbolic.chaining.series import Link


def fold_chains(chains: Chains, plan: TaskPlan) -> TaskPlan:
    """Return the timeline with every chain that is gone through as a whole as one instance."""
    instances = list(plan.instances)
    for name, links in chains.links.items():
        whole = chains.domain.block_by_name[name]
        for first in [i for i in plan.instances if i.block == links[0].block.name]:
            run = list(_run(plan, first, links))
            named = _named(whole, links, run)
            if len(run) < len(links) or named is None:
                continue
            slots, targets = ({role.name: named[role.name] for role in some} for some in (whole.slots, whole.targets))
            instances = [i for i in instances if i not in run]
            instance = replace(run[-1], name=first.name, block=name, start=first.start, slots=slots, targets=targets)
            instances.append(instance)
    return replace(plan, instances=tuple(sorted(instances, key=lambda i: (i.start, i.end, i.name))))


def _run(plan: TaskPlan, first: BlockInstance, links: Sequence[Link]) -> Iterator[BlockInstance]:
    """Yield the instances in which the anchor of the first one goes through the chain, as far as it does."""
    timeline = [instance for instance, _ in plan.timeline(first.slots.get(links[0].block.anchor, ""))]
    begin = timeline.index(first) if first in timeline else len(timeline)
    for link, instance in zip(links, timeline[begin:], strict=False):
        if instance.block != link.block.name:
            return
        yield instance


def _named(whole: Block, links: Sequence[Link], run: Sequence[BlockInstance]) -> dict[str, str] | None:
    """Return what each role of the whole is in all of the instances; None if they differ."""
    named: dict[str, str] = {}
    for link, instance in zip(links, run, strict=False):
        for own, role in link.roles.items():
            value = instance.roles.get(own)
            if value is None or value != (named.setdefault(role, value) if role in whole.roles else role):
                return None
    return named

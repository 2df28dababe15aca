"""What Aries is to arrange: how many times each action may happen, and what is fixed of it already.

Aries finds and proves shortest plans fast where it knows which actions there are to be at most. A plan that is known
to be lawful tells: a *sketch* of it has the same blocks with the same targets, in any order, and leaves open which
interchangeable tokens do what. A *frame* has as many actions of each kind as the plan, and some more, and leaves
open everything else.
"""

from collections import Counter
from collections.abc import Iterator

from hybrid_tamp.model.plan import BlockInstance, TaskPlan
from hybrid_tamp.symbolic.strategies.makespan import interchangeable
from hybrid_tamp.symbolic.temporal.compilation import TemporalCompilation
from hybrid_tamp.symbolic.temporal.problem import Step


def sketch(compilation: TemporalCompilation, plan: TaskPlan, symbols: bool = True) -> tuple[Step, ...]:
    """Return the plan's own actions, without saying which interchangeable tokens take part.

    Args:
        compilation: the compiled task.
        plan: a lawful plan.
        symbols: whether symbols stay as they are, too.
    """
    free = {compilation.name(name) for group in interchangeable(compilation.task) for name in group}
    steps = []
    for instance, action in actions_of(compilation, plan):
        roles = compilation.encoding.running[action].roles
        fixed = {index: compilation.name(instance.roles[role]) for role, index in roles.items()}
        kept = [(i, name) for i, name in sorted(fixed.items()) if symbols or compilation.tokens.knows(name)]
        steps.append(Step(action, tuple((i, name) for i, name in kept if name not in free), optional=True))
    return tuple(steps)


def frame(compilation: TemporalCompilation, plan: TaskPlan, more: int) -> tuple[Step, ...]:
    """Return as many actions of each kind as the plan has, and some more, all of them optional and open."""
    numbers = Counter(action for _, action in actions_of(compilation, plan))
    possible = [a.name for a in compilation.problem.domain.actions]
    runs = compilation.runs
    return tuple(
        Step(action, (), True)
        for action in possible
        if compilation.encoding.running[action].block in runs
        for _ in range(numbers[action] + more)
    )


def actions_of(compilation: TemporalCompilation, plan: TaskPlan) -> Iterator[tuple[BlockInstance, str]]:
    """Yield the instances that begin after the start, each with the name of its action."""
    blocks = compilation.task.domain.block_by_name
    names = {(r.block, r.along): name for name, r in compilation.encoding.running.items()}
    before: dict[str, BlockInstance] = {}
    for instance in sorted(plan.instances, key=lambda i: (i.start, i.end, i.name)):
        block = blocks[instance.block]
        home = before.get(instance.slots[block.anchor])
        along = frozenset(
            slot.name
            for slot in block.others
            if home is not None and home is before.get(instance.slots[slot.name]) and len(home.slots) > 1
        )
        if home is not None:
            yield instance, names[instance.block, along]
        before.update(dict.fromkeys(instance.slots.values(), instance))

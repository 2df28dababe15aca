"""Conversion of a timeline to planned actions, so that PDDL validators can judge any task plan.

A timeline does not contain all parameters of the actions, e.g. the number of readers of a token. The facts that hold
when an action is applied determine its missing parameters. If no operator is applicable, the action is `NO_ACTION`, and
validators reject the plan.
"""

from collections.abc import Iterable, Iterator, Sequence

from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.plan import BlockInstance, PlannedAction, TaskPlan, at
from hybrid_tamp.symbolic.chaining.chains import fold_chains
from hybrid_tamp.symbolic.chaining.repeats import fold_repeats
from hybrid_tamp.symbolic.chaining.series import list_deleted
from hybrid_tamp.symbolic.encoding.problem import Compilation
from hybrid_tamp.symbolic.pddl.joins import FactIndex, join
from hybrid_tamp.symbolic.pddl.operators import Operator

NO_ACTION = PlannedAction("no-such-reassignment")
"""Action that stands for an impossible reassignment. No operator has this name."""


def reencode(compilation: Compilation, plan: TaskPlan) -> list[PlannedAction]:
    """Return the actions for the reassignments of a timeline, in the order of its instants.

    If a token is in no instance or in two instances at any time, the result has a `NO_ACTION` for this token. If the
    plan stops inside a chain, the result is only one `NO_ACTION` per instance of the incomplete chain. To judge plans
    that stop inside a chain, compile the task without chains.
    """
    torn = [token.name for token in compilation.task.assigned if not _tiles(plan, token.name)]
    domain = compilation.encoded.vocabulary.domain
    chains = compilation.encoded.chains
    plan = fold_repeats(chains, fold_chains(chains, plan))
    inside = [i for i in plan.instances if i.block not in domain.block_by_name]
    if inside:
        return [NO_ACTION for _ in inside]
    facts = set(compilation.problem.init)
    operators = {operator.name: operator for operator in compilation.problem.domain.operators}
    actions: list[PlannedAction] = [NO_ACTION for _ in torn]
    for wanted in _reassignments(domain, plan):
        action = _find_action(compilation, operators, wanted, FactIndex(sorted(facts)))
        actions.append(action)
        if action.name in operators:
            operator = operators[action.name]
            facts = operator.effects(operator.bind(action), facts)
    return actions


def plan_actions(compilation: Compilation, plan: TaskPlan) -> Sequence[PlannedAction]:
    """Return the plan's own actions if they achieve the goal of the compiled task, or else its re-encoded timeline."""
    return plan.actions if compilation.reaches_goal(plan.actions) else reencode(compilation, plan)


def _tiles(plan: TaskPlan, token: str) -> bool:
    """Return whether the instances of a token cover the plan without gaps or overlaps."""
    spans = [(instance.start, instance.end) for instance, _ in plan.timeline(token)]
    joints = [0.0, *(end for _, end in spans)]
    starts = [*(start for start, _ in spans), plan.makespan]
    return bool(spans) and all(map(at, joints, starts))


_Wanted = tuple[str, str, str, tuple[str, str] | None, frozenset[str], dict[str, str]]
"""Tuple of (kind, block, slot, source, slots of the source whose tokens move with the anchor, roles)."""


def _reassignments(domain: Domain, plan: TaskPlan) -> Iterator[_Wanted]:
    for time in plan.instants:
        starting = [i for i in plan.instances if at(i.start, time) and time > plan.instants[0]]
        for group in _in_order(domain, plan, group_by_source(plan, starting)):
            yield from _group(domain, plan, group)


def group_by_source(plan: TaskPlan, starting: list[BlockInstance]) -> list[list[BlockInstance]]:
    """Group the starting instances. Instances that take tokens from the same instance are in the same group."""
    groups: list[tuple[set[str], list[BlockInstance]]] = []
    for instance in starting:
        sources = {b[0].name for t in instance.slots.values() if (b := plan.before(instance, t))} | {instance.name}
        joined = [group for group in groups if group[0] & sources]
        members = [member for _, group in joined for member in group]
        groups = [group for group in groups if group not in joined]
        groups.append((sources.union(*(names for names, _ in joined)), [*members, instance]))
    return [group for _, group in groups]


def _in_order(domain: Domain, plan: TaskPlan, groups: list[list[BlockInstance]]) -> list[list[BlockInstance]]:
    """Return the groups in an order in which they can be applied. `_frees` and `_needs` decide on the order."""

    def first(one: list[BlockInstance], other: list[BlockInstance]) -> bool:
        return _frees(plan, one, other) or _needs(domain, one, other)

    ordered: list[list[BlockInstance]] = []
    waiting = list(groups)
    while waiting:
        free = [g for g in waiting if not any(first(other, g) for other in waiting if other is not g)]
        chosen = (free or waiting)[0]
        waiting.remove(chosen)
        ordered.append(chosen)
    return ordered


def _needs(domain: Domain, first: list[BlockInstance], second: list[BlockInstance]) -> bool:
    """Return whether `second` may falsify an entry condition of an instance that `first` starts."""
    entries = [e.ground(i.roles) for i in first for e in domain.block_by_name[i.block].entry]
    taken = [e.ground(i.roles) for i in second for e in list_deleted(domain.block_by_name[i.block])]
    return any(each.matches(entry) for each in taken for entry in entries)


def _frees(plan: TaskPlan, first: list[BlockInstance], second: list[BlockInstance]) -> bool:
    """Return whether `first` ends an instance that conflicts with an instance that `second` starts."""
    ended = [b[0] for i in first for token in i.slots.values() if (b := plan.before(i, token))]
    return any(
        set(old.targets.values()) & set(new.slots.values()) or set(old.slots.values()) & set(new.targets.values())
        for old in ended
        for new in second
    )


def _group(domain: Domain, plan: TaskPlan, group: list[BlockInstance]) -> Iterator[_Wanted]:
    blocks = domain.block_by_name
    several = [i for i in group if len(blocks[i.block].slots) > 1]
    single = [i for i in group if i not in several]
    anchored: list[BlockInstance] = []
    for instance in several:
        block = blocks[instance.block]
        sources = {s: plan.before(instance, t) for s, t in instance.slots.items()}
        for slot in block.others:
            if slot.name in sources:
                yield _wanted("fill", instance, slot.name, sources[slot.name])
        home = sources.get(block.anchor)
        moved = {b[1] for s, b in sources.items() if b and home and s != block.anchor and b[0] is home[0]}
        yield _wanted("begin", instance, block.anchor, home, moved)
    for instance in single:
        source = plan.before(instance, next(iter(instance.slots.values())))
        if source is None or source[1] == blocks[source[0].block].anchor:
            anchored.append(instance)
            yield _wanted("begin", instance, blocks[instance.block].anchor, source)
    leaving = [(plan.before(i, next(iter(i.slots.values()))), i) for i in single if i not in anchored]
    order = {(block.name, slot.name): n for block in domain.blocks for n, slot in enumerate(block.slots)}
    for source, instance in sorted(leaving, key=lambda p: order[p[0][0].block, p[0][1]] if p[0] else 0):
        yield _wanted("leave", instance, blocks[instance.block].anchor, source)


def _wanted(
    kind: str, instance: BlockInstance, slot: str, source: tuple[BlockInstance, str] | None, moved: Iterable[str] = ()
) -> _Wanted:
    before = (source[0].block, source[1]) if source else None
    return (kind, instance.block, slot, before, frozenset(moved), instance.roles)


def _find_action(
    compilation: Compilation, operators: dict[str, Operator], wanted: _Wanted, facts: FactIndex
) -> PlannedAction:
    """Return the first applicable action that performs a reassignment, or `NO_ACTION` if no action is applicable."""
    kind, block, slot, before, moved, roles = wanted
    for name, meaning in compilation.encoded.meanings.items():
        found = (meaning.kind, meaning.block, meaning.slot, meaning.source, meaning.along)
        if found != (kind, block, slot, before, moved):
            continue
        variables = [variable for variable, _ in operators[name].parameters]
        binding = {
            variables[i]: compilation.words.name(roles[role]) for role, i in meaning.roles.items() if role in roles
        }
        full = next(join(operators[name].precondition, binding, facts), None)
        if full is not None:
            return PlannedAction(name, tuple(full[variable] for variable in variables))
    return NO_ACTION

"""A timeline back to plan actions, so that any task plan, wherever it came from, can be judged by PDDL validators.

Parameters that a timeline does not show (old values, counts) are found by applying the actions one by one. Where no
operator fits, or its conditions do not hold, the action is written all the same, so that a validator refuses the plan.
"""

from collections.abc import Iterator, Sequence

from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.plan import BlockInstance, PlannedAction, TaskPlan, at
from hybrid_tamp.symbolic.chaining.folding import fold_chains
from hybrid_tamp.symbolic.chaining.series import undone_by
from hybrid_tamp.symbolic.encoding.application import applicable
from hybrid_tamp.symbolic.encoding.operator_maker import Meaning
from hybrid_tamp.symbolic.encoding.problem import Compilation
from hybrid_tamp.symbolic.pddl.operators import Fact, Operator, ground

NO_ACTION = PlannedAction("no-such-reassignment")
"""Stands for what no operator does."""


def reencode(compilation: Compilation, plan: TaskPlan) -> list[PlannedAction]:
    """Return the actions that make the timeline's reassignments, in the order of its instants.

    A timeline in which a token is nowhere, or in two places, is no sequence of reassignments; each such token gives
    an action that does not exist. So does a block of a chain that is not gone through as a whole: to judge plans that
    stop there, compile the task without chains.
    """
    torn = [token.name for token in compilation.task.assigned if not _tiles(plan, token.name)]
    domain = compilation.encoded.vocabulary.domain
    plan = fold_chains(compilation.encoded.chains, plan)
    inside = [i for i in plan.instances if i.block not in domain.block_by_name]
    if inside:
        return [NO_ACTION for _ in inside]
    facts = set(compilation.problem.init)
    operators = {operator.name: operator for operator in compilation.problem.domain.operators}
    actions: list[PlannedAction] = [NO_ACTION for _ in torn]
    for wanted in _reassignments(domain, plan):
        action = _concrete(compilation, operators, wanted, facts)
        actions.append(action)
        if action.name in operators:
            operator = operators[action.name]
            facts = operator.effects(operator.bind(action), facts)
    return actions


def plan_actions(compilation: Compilation, plan: TaskPlan) -> Sequence[PlannedAction]:
    """Return the actions of a plan in a compiled task: its own, unless they are those of another network."""
    return plan.actions if applicable(compilation, plan.actions) else reencode(compilation, plan)


def _tiles(plan: TaskPlan, token: str) -> bool:
    """Say whether the instances of a token follow each other without gap or overlap from start to end."""
    spans = [(instance.start, instance.end) for instance, _ in plan.timeline(token)]
    joints = [0.0, *(end for _, end in spans)]
    starts = [*(start for start, _ in spans), plan.makespan]
    return bool(spans) and all(map(at, joints, starts))


_Wanted = tuple[str, str, str, tuple[str, str] | None, frozenset[str], dict[str, str]]
"""kind, block, slot, (block, slot) before, slots of the source that move along, roles."""


def _reassignments(domain: Domain, plan: TaskPlan) -> Iterator[_Wanted]:
    for time in plan.instants:
        starting = [i for i in plan.instances if at(i.start, time) and time > plan.instants[0]]
        for group in _in_order(domain, plan, _groups(plan, starting)):
            yield from _group(domain, plan, group)


def _before(plan: TaskPlan, instance: BlockInstance, token: str) -> tuple[BlockInstance, str] | None:
    """Return where the token was before it entered the instance."""
    timeline = plan.timeline(token)
    index = next(i for i, (other, _) in enumerate(timeline) if other is instance)
    return timeline[index - 1] if index else None


def _groups(plan: TaskPlan, starting: list[BlockInstance]) -> list[list[BlockInstance]]:
    """Group starting instances that take their tokens from a common ending one."""
    groups: list[tuple[set[str], list[BlockInstance]]] = []
    for instance in starting:
        sources = {b[0].name for t in instance.slots.values() if (b := _before(plan, instance, t))} | {instance.name}
        joined = [group for group in groups if group[0] & sources]
        members = [member for _, group in joined for member in group]
        groups = [group for group in groups if group not in joined]
        groups.append((sources.union(*(names for names, _ in joined)), [*members, instance]))
    return [group for _, group in groups]


def _in_order(domain: Domain, plan: TaskPlan, groups: list[list[BlockInstance]]) -> list[list[BlockInstance]]:
    """Among reassignments of one instant, those that free or need something come before those that change it."""

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
    """Say whether `first` starts an instance whose entry conditions may not hold when `second` has started."""
    entries = [e.ground(i.roles) for i in first for e in domain.block_by_name[i.block].entry]
    taken = [e.ground(i.roles) for i in second for e in undone_by(domain.block_by_name[i.block])]
    return any(each.matches(entry) for each in taken for entry in entries)


def _frees(plan: TaskPlan, first: list[BlockInstance], second: list[BlockInstance]) -> bool:
    """Say whether `first` ends an instance in conflict with one that `second` starts."""
    ended = [b[0] for i in first for token in i.slots.values() if (b := _before(plan, i, token))]
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
        sources = {s: _before(plan, instance, t) for s, t in instance.slots.items()}
        for slot in block.others:
            if slot.name in sources:
                yield _wanted("fill", instance, slot.name, sources[slot.name], frozenset())
        home = sources.get(block.anchor)
        moved = {b[1] for s, b in sources.items() if b and home and s != block.anchor and b[0] is home[0]}
        yield _wanted("begin", instance, block.anchor, home, frozenset(moved))
    for instance in single:
        source = _before(plan, instance, next(iter(instance.slots.values())))
        if source is None or source[1] == blocks[source[0].block].anchor:
            anchored.append(instance)
            yield _wanted("begin", instance, blocks[instance.block].anchor, source, frozenset())
    leaving = [(_before(plan, i, next(iter(i.slots.values()))), i) for i in single if i not in anchored]
    order = {(block.name, slot.name): n for block in domain.blocks for n, slot in enumerate(block.slots)}
    for source, instance in sorted(leaving, key=lambda p: order[p[0][0].block, p[0][1]] if p[0] else 0):
        yield _wanted("leave", instance, blocks[instance.block].anchor, source, frozenset())


def _wanted(
    kind: str,
    instance: BlockInstance,
    slot: str,
    source: tuple[BlockInstance, str] | None,
    moved: frozenset[str],
) -> _Wanted:
    before = (source[0].block, source[1]) if source else None
    return (kind, instance.block, slot, before, moved, instance.roles)


def _concrete(
    compilation: Compilation, operators: dict[str, Operator], wanted: _Wanted, facts: set[Fact]
) -> PlannedAction:
    """Return the first applicable action that does what is wanted, else one that cannot be applied."""
    kind, block, slot, before, moved, roles = wanted
    for name, meaning in compilation.encoded.meanings.items():
        found = (meaning.kind, meaning.block, meaning.slot, meaning.source, meaning.along)
        if found != (kind, block, slot, before, moved):
            continue
        binding = _known(compilation, operators[name], meaning, roles)
        full = _complete(operators[name], binding, facts)
        if full is not None:
            return PlannedAction(name, tuple(full[variable] for variable, _ in operators[name].parameters))
    return NO_ACTION


def _known(compilation: Compilation, operator: Operator, meaning: Meaning, roles: dict[str, str]) -> dict[str, str]:
    variables = [variable for variable, _ in operator.parameters]
    return {variables[index]: compilation.name(roles[role]) for role, index in meaning.roles.items() if role in roles}


def _complete(operator: Operator, binding: dict[str, str], facts: set[Fact]) -> dict[str, str] | None:
    """Bind the remaining parameters so that every precondition is a fact; None if that cannot be."""
    return match_conditions(list(operator.precondition), binding, facts)


def match_conditions(conditions: list[Fact], binding: dict[str, str], facts: set[Fact]) -> dict[str, str] | None:
    """Return the binding extended so that every condition is a fact, or None if there is no such binding."""
    if not conditions:
        return binding
    # Most constrained first: the condition with the fewest open variables.
    conditions = sorted(conditions, key=lambda c: sum(a.startswith("?") and a not in binding for a in c[1:]))
    first, rest = ground(conditions[0], binding), conditions[1:]
    if not any(argument.startswith("?") for argument in first):
        return match_conditions(rest, binding, facts) if first in facts else None
    for fact in sorted(facts):
        extended = _unify(first, fact, binding)
        if extended is not None:
            found = match_conditions(rest, extended, facts)
            if found is not None:
                return found
    return None


def _unify(pattern: Fact, fact: Fact, binding: dict[str, str]) -> dict[str, str] | None:
    if pattern[0] != fact[0] or len(pattern) != len(fact):
        return None
    extended = dict(binding)
    for wanted, value in zip(pattern[1:], fact[1:], strict=True):
        if wanted.startswith("?"):
            if extended.setdefault(wanted, value) != value:
                return None
        elif wanted != value:
            return None
    return extended

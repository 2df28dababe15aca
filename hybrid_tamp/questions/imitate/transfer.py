"""Transfer of a plan that was seen to another agent with the same capability classes (paper, Sec. II-E).

Objects take the roles that they have in the goal. All other tokens take the roles that their classes allow. The first
lawful assignment of roles counts; assignments with a similar arrangement of tokens are tried first.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import islice

import numpy as np

from hybrid_tamp.errors import NoPlan
from hybrid_tamp.model.affordance import TOKEN, ObjectClass
from hybrid_tamp.model.law import check_law
from hybrid_tamp.model.plan import BlockInstance, TaskPlan, at
from hybrid_tamp.model.predicate import ANY, Atom
from hybrid_tamp.model.task import Task
from hybrid_tamp.symbolic.decode import OrderedInstance
from hybrid_tamp.symbolic.encoding.problem import compile_task
from hybrid_tamp.symbolic.reencode import reencode
from hybrid_tamp.symbolic.schedule import InfeasibleScheduleError, schedule

KIND = "not_imitable"
_MOST = 2000
"""Largest number of assignments of roles that are examined."""
_MOST_BREACHES = 4


@dataclass(frozen=True)
class Transfer:
    """A plan for another agent.

    Attributes:
        plan: the plan, scheduled and lawful.
        task: the task with the ground goal that the plan reaches; the task itself if its goal leaves no choice.
        roles: token that was seen to the token that takes its role.
    """

    plan: TaskPlan
    task: Task
    roles: Mapping[str, str]


def transfer(shown: Task, plan: TaskPlan, task: Task) -> Transfer:
    """Return a plan of a task that imitates the plan that was seen.

    Args:
        shown: the demonstrator's task.
        plan: the plan that was seen; movements that no block explains are left out.
        task: the imitator's task, with the same domain.

    Raises:
        NoPlan: the task has no such plan; the message says why.
    """
    if shown.domain.name != task.domain.name:
        belongs = f"the demonstration belongs to domain {shown.domain.name}, but {task.name} to {task.domain.name}"
        raise _refused(belongs)
    seen = _acting(shown, plan)
    wanted = _classes(shown, seen)
    able = {
        token: [each.name for each in task.tokens if all(map(each.is_member, classes))]
        for token, classes in wanted.items()
    }
    for token, names in able.items():
        if not names:
            classes = ", ".join(sorted(sort.name for sort in wanted[token]))
            raise _refused(f"no token of {task.name} is a member of {classes}, unlike {token} in the demonstration")
    found = list(islice(_assignments(able, _goal_roles(shown, task, able)), _MOST))
    if not found:
        raise _refused(f"{task.name} has too few tokens for the roles: {_counted(wanted, able)}")
    found.sort(key=lambda roles: _compare_arrangements(shown, task, roles))
    why = ""
    for roles in found:
        found_or_why = _transfer_roles(task, plan, seen, roles)
        if isinstance(found_or_why, Transfer):
            return found_or_why
        why = why or found_or_why
    raise _refused(f"the plan that was seen is not lawful for {task.name}: {why}")


def _refused(said: str) -> NoPlan:
    return NoPlan(f"This cannot be imitated: {said}.", proven=False, kind=KIND)


def _acting(shown: Task, plan: TaskPlan) -> list[BlockInstance]:
    """Return the instances of all tokens that do more than rest; gaps of unexplained movements are closed.

    Raises:
        NoPlan: no block explains a movement between blocks that act.
    """
    resting = shown.domain.resting
    busy = {t for i in plan.instances if i.block != resting for t in i.slots.values()}
    found = {i.name: i for i in plan.instances if set(i.slots.values()) & busy}
    for token in sorted(busy):
        last: BlockInstance | None = None
        for instance, _ in plan.timeline(token):
            if last is not None and not at(last.end, instance.start):
                if {last.block, instance.block} != {resting}:
                    gap = f"from {last.end:.2f} s to {instance.start:.2f} s"
                    raise _refused(f"no block explains the movement of {token} {gap}, between blocks that act")
                del found[instance.name]
                instance = replace(last, end=instance.end)
                found[instance.name] = instance
            last = instance
    return sorted(found.values(), key=lambda i: (i.start, i.end, i.name))


def _classes(shown: Task, seen: list[BlockInstance]) -> dict[str, set[type[ObjectClass]]]:
    """Return each token that has a role, with the classes of its roles."""
    found: dict[str, set[type[ObjectClass]]] = {}
    for instance in seen:
        roles = shown.domain.block_by_name[instance.block].roles
        for role, name in instance.roles.items():
            sort = roles[role]
            if name in shown.token_by_name and isinstance(sort, type) and sort is not TOKEN:
                found.setdefault(name, set()).add(sort)
    return found


def _goal_roles(shown: Task, task: Task, able: Mapping[str, list[str]]) -> dict[str, str]:
    """Return the roles that the goals determine: token that was seen to token of the task.

    Raises:
        NoPlan: the goals are not alike.
    """
    taken: dict[str, str] = {}
    left = list(task.goal)
    for atom in shown.goal:
        same = [(other, _alike(shown, task, atom, other, taken, able)) for other in left]
        other, roles = next(((other, roles) for other, roles in same if roles is not None), (None, {}))
        if other is None:
            raise _refused(f"{atom.text} was the goal, and nothing like it is a goal of {task.name}")
        left.remove(other)
        taken |= roles or {}
    if left:
        raise _refused(f"{left[0].text} is a goal of {task.name}, and the demonstration has no goal like it")
    return taken


def _alike(
    shown: Task, task: Task, one: Atom, other: Atom, taken: Mapping[str, str], able: Mapping[str, list[str]]
) -> dict[str, str] | None:
    """Return the roles that make two goal atoms equal, or None if no roles do."""
    if (one.predicate, one.positive) != (other.predicate, other.positive):
        return None
    found: dict[str, str] = {}
    for a, b in zip(one.arguments, other.arguments, strict=True):
        if a in shown.token_by_name and b in task.token_by_name:
            known = {**taken, **found}
            if known.get(a, b) != b or (b in known.values() and known.get(a) != b) or b not in able.get(a, [b]):
                return None
            found[a] = b
        elif ANY not in (a, b) and a != b:
            return None
    return found


def _assignments(able: Mapping[str, list[str]], fixed: dict[str, str]) -> Iterator[dict[str, str]]:
    """Yield every way to give each role to a different token."""
    free = [token for token in able if token not in fixed]
    if not free:
        yield {token: fixed[token] for token in able}
        return
    token = min(free, key=lambda name: len(able[name]))
    for name in able[token]:
        if name not in fixed.values():
            yield from _assignments(able, {**fixed, token: name})


def _compare_arrangements(shown: Task, task: Task, roles: Mapping[str, str]) -> float:
    """Return how much the arrangements of the tokens differ, as a sum over pairs of tokens [m]."""
    before = np.array([shown.state[name, "position"] for name in roles])
    after = np.array([task.state[name, "position"] for name in roles.values()])
    return float(np.linalg.norm((before[:, None] - before) - (after[:, None] - after), axis=-1).sum())


def _counted(wanted: Mapping[str, set[type[ObjectClass]]], able: Mapping[str, list[str]]) -> str:
    said: dict[tuple[str, tuple[str, ...]], list[str]] = {}
    for token, names in able.items():
        classes = ", ".join(sorted(sort.name for sort in wanted[token]))
        said.setdefault((classes, tuple(names)), []).append(token)
    return "; ".join(f"{' and '.join(t)} of {c} by {' or '.join(n)}" for (c, n), t in said.items())


def _transfer_roles(task: Task, plan: TaskPlan, seen: list[BlockInstance], roles: Mapping[str, str]) -> Transfer | str:
    """Return the scheduled plan, or why there is none."""
    instants = [time for time in plan.instants if any(at(i.start, time) for i in seen)]

    def index(time: float) -> int:
        return next(number for number, instant in enumerate(instants) if at(instant, time))

    ordered = [
        OrderedInstance(
            instance.name,
            instance.block,
            {slot: roles[name] for slot, name in instance.slots.items()},
            {target: roles.get(name, name) for target, name in instance.targets.items()},
            index(instance.start),
            None if at(instance.end, plan.makespan) else index(instance.end),
        )
        for instance in seen
    ]
    try:
        scheduled = schedule(task, [*_bystanders(task, set(roles.values())), *ordered])
    except InfeasibleScheduleError as error:
        return str(error)
    breaches = check_law(task, scheduled)
    if breaches:
        return "; ".join(breach.text for breach in breaches[:_MOST_BREACHES])
    ground = next(each for each in task.alternatives() if not check_law(each, scheduled))
    actions = tuple(reencode(compile_task(ground), scheduled))
    return Transfer(replace(scheduled, actions=actions), ground, roles)


def _bystanders(task: Task, acting: set[str]) -> Iterator[OrderedInstance]:
    """Yield instances for the tokens without a role: they stay where they start."""
    for token in task.assigned:
        if token.name not in acting:
            block = task.start_block(token.name)
            slots = {block.anchor: token.name}
            yield OrderedInstance(f"{block.action}-of-{token.name}", block.name, slots, {}, 0)

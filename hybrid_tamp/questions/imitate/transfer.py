"""Transfer of a demonstrated plan to another agent with the same capability classes (paper, Sec. II-E).

Tokens of the imitator take the roles of the demonstrated tokens. A token in the demonstrated goal is replaced by the
token in the imitator's goal. Any other token is replaced by a token of suitable classes. Assignments of roles are tried
one after the other. Assignments in which the imitator's tokens are arranged most like in the demonstration come first.
The first assignment whose plan obeys the law of assignment is used.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import islice

import numpy as np

from hybrid_tamp.errors import NoPlan
from hybrid_tamp.model.affordance import TOKEN, ObjectClass
from hybrid_tamp.model.deadline import NEVER, Deadline
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
"""Maximum number of assignments of roles to try."""
_MOST_BREACHES = 4


@dataclass(frozen=True)
class Transfer:
    """A plan that was transferred to another agent.

    Attributes:
        plan: the scheduled plan, which obeys the law of assignment.
        task: the imitator's task. A goal with a choice is replaced by the alternative that the plan achieves.
        roles: maps each token of the demonstration to the imitator's token that takes its role.
    """

    plan: TaskPlan
    task: Task
    roles: Mapping[str, str]


def transfer(shown: Task, plan: TaskPlan, task: Task, deadline: Deadline = NEVER) -> Transfer:
    """Return a plan for a task that imitates a demonstrated plan.

    Args:
        shown: the demonstrator's task.
        plan: the demonstrated plan, without the movements that no block explains.
        task: the imitator's task, which must have the same domain.
        deadline: deadline of the command.

    Raises:
        LimitReached: if the deadline passes.
        NoPlan: if the plan cannot be transferred to the task. The message gives the reason.
    """
    if shown.domain.name != task.domain.name:
        raise _refused(f"the demonstration uses domain {shown.domain.name}, but {task.name} uses {task.domain.name}")
    seen = _acting(shown, plan)
    wanted = _classes(shown, seen)
    able = {
        token: [each.name for each in task.tokens if all(map(each.is_member, classes))]
        for token, classes in wanted.items()
    }
    for token, names in able.items():
        if not names:
            classes = ", ".join(sorted(sort.name for sort in wanted[token]))
            raise _refused(f"{token} in the demonstration is a member of {classes}, but no token of {task.name} is")
    found = list(islice(_assignments(able, _goal_roles(shown, task, able)), _MOST))
    if not found:
        raise _refused(f"{task.name} has too few tokens to replace {_counted(wanted, able)}")
    found.sort(key=lambda roles: _compare_arrangements(shown, task, roles))
    why = ""
    for roles in found:
        deadline.check()
        found_or_why = _transfer_roles(task, plan, seen, roles)
        if isinstance(found_or_why, Transfer):
            return found_or_why
        why = why or found_or_why
    raise _refused(f"{task.name} does not allow the demonstrated plan: {why}")


def _refused(said: str) -> NoPlan:
    return NoPlan(f"The demonstration cannot be imitated: {said}.", proven=False, kind=KIND)


def _acting(shown: Task, plan: TaskPlan) -> list[BlockInstance]:
    """Return the instances of all tokens that do more than rest, or raise `NoPlan` if no block explains a movement."""
    resting = shown.domain.resting
    busy = {t for i in plan.instances if i.block != resting for t in i.slots.values()}
    found = {i.name: i for i in plan.instances if set(i.slots.values()) & busy}
    for token in sorted(busy):
        last: BlockInstance | None = None
        for instance, _ in plan.timeline(token):
            if last is not None and not at(last.end, instance.start):
                if {last.block, instance.block} != {resting}:
                    gap = f"from {last.end:.2f} s to {instance.start:.2f} s"
                    raise _refused(f"no block explains the movement of {token} {gap}")
                # The movement lies between two resting instances, which are merged.
                del found[instance.name]
                instance = replace(last, end=instance.end)
                found[instance.name] = instance
            last = instance
    return sorted(found.values(), key=lambda i: (i.start, i.end, i.name))


def _classes(shown: Task, seen: list[BlockInstance]) -> dict[str, set[type[ObjectClass]]]:
    """Return a dict that maps each token to the classes of all roles that the token fills."""
    found: dict[str, set[type[ObjectClass]]] = {}
    for instance in seen:
        roles = shown.domain.block_by_name[instance.block].roles
        for role, name in instance.roles.items():
            sort = roles[role]
            if name in shown.token_by_name and isinstance(sort, type) and sort is not TOKEN:
                found.setdefault(name, set()).add(sort)
    return found


def _goal_roles(shown: Task, task: Task, able: Mapping[str, list[str]]) -> dict[str, str]:
    """Map tokens in the demonstrator's goal to tokens in the imitator's goal, or raise `NoPlan` if the goals differ."""
    taken: dict[str, str] = {}
    left = list(task.goal)
    for atom in shown.goal:
        same = [(other, _alike(shown, task, atom, other, taken, able)) for other in left]
        other, roles = next(((other, roles) for other, roles in same if roles is not None), (None, {}))
        if other is None:
            raise _refused(f"the demonstration has the goal {atom.text}, but {task.name} has no matching goal")
        left.remove(other)
        taken |= roles or {}
    if left:
        raise _refused(f"{task.name} has the goal {left[0].text}, but the demonstration has no matching goal")
    return taken


def _alike(
    shown: Task, task: Task, one: Atom, other: Atom, taken: Mapping[str, str], able: Mapping[str, list[str]]
) -> dict[str, str] | None:
    """Return the roles that make two goal atoms equal, or None if there are no such roles."""
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
    """Yield every dict that extends ``fixed`` and maps each token to a different token from its ``able`` list."""
    free = [token for token in able if token not in fixed]
    if not free:
        yield {token: fixed[token] for token in able}
        return
    token = min(free, key=lambda name: len(able[name]))
    for name in able[token]:
        if name not in fixed.values():
            yield from _assignments(able, {**fixed, token: name})


def _compare_arrangements(shown: Task, task: Task, roles: Mapping[str, str]) -> float:
    """Return how much the vectors between the tokens differ, as a sum over all pairs of tokens, in metres."""
    before = np.array([shown.state[name, "position"] for name in roles])
    after = np.array([task.state[name, "position"] for name in roles.values()])
    return float(np.linalg.norm((before[:, None] - before) - (after[:, None] - after), axis=-1).sum())


def _counted(wanted: Mapping[str, set[type[ObjectClass]]], able: Mapping[str, list[str]]) -> str:
    said: dict[tuple[str, tuple[str, ...]], list[str]] = {}
    for token, names in able.items():
        said.setdefault((", ".join(sorted(sort.name for sort in wanted[token])), tuple(names)), []).append(token)
    return "; ".join(f"{' and '.join(t)} ({c}) by {' or '.join(n)}" for (c, n), t in said.items())


def _transfer_roles(task: Task, plan: TaskPlan, seen: list[BlockInstance], roles: Mapping[str, str]) -> Transfer | str:
    """Return the plan scheduled with the given roles, or the reason why the roles are impossible."""
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
    return Transfer(replace(scheduled, actions=tuple(reencode(compile_task(ground), scheduled))), ground, roles)


def _bystanders(task: Task, acting: set[str]) -> Iterator[OrderedInstance]:
    """Yield an instance for each token without a role. The token stays in its initial block."""
    for token in task.assigned:
        if token.name not in acting:
            block = task.start_block(token.name)
            yield OrderedInstance(f"{block.action}-of-{token.name}", block.name, {block.anchor: token.name}, {}, 0)

"""Feasibility conditions of a plan, measured in the predicted states in which its instances begin."""

from bisect import bisect_left
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from hybrid_tamp.model.facts import fact_margin
from hybrid_tamp.model.plan import TIME_TOLERANCE, BlockInstance, TaskPlan
from hybrid_tamp.model.predicate import Atom, Literal
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.symbolic.decode import OrderedInstance
from hybrid_tamp.symbolic.estimates import Estimates
from hybrid_tamp.symbolic.whereabouts.tracking import Tracking


@dataclass(frozen=True)
class BrokenCondition:
    """A feasibility condition that does not hold in the predicted state in which an instance begins.

    Attributes:
        instance: instance of the plan.
        literal: entry condition of the instance's block.
        atom: condition with the names of tokens and symbols.
        margin: margin of the condition [unit of the predicate].
        text: description of the condition in one line.
    """

    instance: BlockInstance
    literal: Literal
    atom: Atom
    margin: float
    text: str


def find_broken_conditions(task: Task, plan: TaskPlan, estimates: Estimates) -> Iterator[BrokenCondition]:
    """Yield the conditions of a plan that depend on moved tokens and that fail in the predicted states.

    Conditions on tokens that have not moved are feasibility facts of the initial state, so they are left out.

    Args:
        task: task of the plan.
        plan: plan whose instances have all their targets.
        estimates: estimates of the task, which predict the states.

    Raises:
        LimitReached: if the deadline passes.
    """
    tracking = Tracking(task.domain)
    if not tracking.parameters:
        return
    moved: set[str] = set()
    states = predict_states(task, plan, estimates)
    for instance in _in_order(plan):
        block, state = task.domain.block_by_name[instance.block], states[instance.name]
        binding = task.bind(instance.roles)
        for literal, roles in tracking.conditions(block):
            tokens = (binding[role] for role in roles)
            if not any(isinstance(token, Token) and token.name in moved for token in tokens):
                continue
            margin = float(fact_margin(literal, task.state, state, binding))
            if margin < 0:
                atom, unit = literal.ground(binding), literal.predicate.unit
                said = literal.predicate.sentence(atom.arguments, not literal.positive)
                text = f"{instance.name}: {said} (off by {-margin:.3g}{'' if unit == '1' else f' {unit}'})"
                yield BrokenCondition(instance, literal, atom, margin, text)
        moved.update(instance.slots[slot] for slot in tracking.moving_slots.get(block.name, ()))


def predict_states(task: Task, plan: TaskPlan, estimates: Estimates | None = None) -> dict[str, State]:
    """Return a dictionary that maps the name of each instance to the expected state in which the instance begins.

    Raises:
        LimitReached: if the deadline of the estimates passes.
    """
    instances = _in_order(plan)
    states = (estimates or Estimates(task)).states(list(_number_reassignments(plan, instances)))
    return {instance.name: state for instance, state in zip(instances, states, strict=True)}


def _in_order(plan: TaskPlan) -> list[BlockInstance]:
    return sorted(plan.instances, key=lambda each: (each.start, each.end, each.name))


def _number_reassignments(plan: TaskPlan, instances: Sequence[BlockInstance]) -> Iterator[OrderedInstance]:
    """Yield the instances with the numbers of the reassignments at which they begin and end."""
    instants = list(plan.instants)
    for each in instances:
        begin, end = (bisect_left(instants, time - TIME_TOLERANCE) for time in (each.start, each.end))
        yield OrderedInstance(each.name, each.block, dict(each.slots), dict(each.targets), begin, end)

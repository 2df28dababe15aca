"""Choice of the encoding in which a task is exported to PDDL."""

from hybrid_tamp.model.facts import StaticFacts
from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.task import Task
from hybrid_tamp.symbolic.encoding.problem import compile_task
from hybrid_tamp.symbolic.relaxation import may_be_solvable
from hybrid_tamp.symbolic.whereabouts.situate import Situation


def needs_whereabouts(task: Task, plan: TaskPlan | None = None) -> bool:
    """Return whether planning problems of a task must contain the whereabouts of tokens.

    A plan needs whereabouts if one of its feasibility conditions does not hold in the initial state. Without a plan, a
    task needs whereabouts if its goal is out of reach with the feasibility facts of the initial state.

    Args:
        task: a task whose goal leaves no choice.
        plan: a plan of the task, or None.
    """
    situation = Situation(task)
    if not situation.tracking.parameters:
        return False
    if plan is None:
        return not may_be_solvable(compile_task(task).problem)
    facts = StaticFacts(task)
    for instance in plan.instances:
        for literal, _ in situation.tracking.conditions(task.domain.block_by_name[instance.block]):
            atom = literal.ground(task.bind(instance.roles))
            if (Atom(atom.predicate, atom.arguments) in facts) != literal.positive:
                return True
    return False


def encoded_task(task: Task, plan: TaskPlan | None = None) -> tuple[Task, TaskPlan | None]:
    """Return the task to encode and its plan, both with the whereabouts of tokens if the task needs them."""
    if not needs_whereabouts(task, plan):
        return task, plan
    situation = Situation(task)
    situated = situation.situated_task(optimistic=False)
    return situated, None if plan is None else situation.situated_plan(situated, plan)

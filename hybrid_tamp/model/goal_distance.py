"""Distance between a state and the desired goal state (paper, Sec. II-D)."""

import numpy as np

from hybrid_tamp.model.authored import authored
from hybrid_tamp.model.predicate import ANY, Atom, Literal
from hybrid_tamp.model.shapes import check_shape
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.motion.arrays import FloatArray


def measure_goal_distance(task: Task, state: State) -> FloatArray:
    """Return the distance between states and the goal of a task, shape ``(...)``, without unit.

    The distance is the sum over all goal atoms. Each term is divided by the scale of its predicate.

    Raises:
        DomainError: a function of the domain raised an exception, or returned a result of the wrong shape.
    """
    terms = [_distance(task, atom, state) for atom in task.goal]
    return np.asarray(np.sum(terms, axis=0) + np.zeros(state.values.shape[:-1]))


def _distance(task: Task, atom: Atom, state: State) -> FloatArray:
    """Return the distance of one goal atom. Without a declared distance, an atom that holds has the distance 0.

    The distance of a goal with a choice is the distance of its nearest alternative.
    """
    if ANY in atom.arguments:
        choices = [_distance(task, each, state) for each in task.groundings(atom)]
        return np.asarray(np.min(choices, axis=0) if atom.positive else np.max(choices, axis=0))
    predicate = task.domain.predicate_by_name[atom.predicate]
    if predicate.distance is None or not atom.positive:
        margin = Literal(predicate, atom.arguments, atom.positive).margin(state, task.token_by_name)
        return np.asarray(np.maximum(0.0, -margin) / predicate.scale)
    values = [task.token_by_name.get(name, name) for name in atom.arguments]
    roles = {parameter.name: value for parameter, value in zip(predicate.parameters, values, strict=True)}
    where = f"the distance of {predicate.name}"
    with authored(where, roles):
        distance = predicate.distance(state, *values)
    check_shape(where, roles, distance, state.values.shape[:-1])
    return np.asarray(distance) / predicate.scale

"""A task without nodes in which feasibility facts hold if they may hold anywhere, for quick proofs."""

from dataclasses import dataclass, replace

import numpy as np

from hybrid_tamp.model.margins import bound_margin
from hybrid_tamp.model.predicate import Predicate, Value
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.symbolic.whereabouts.tracking import Tracking


@dataclass(frozen=True)
class _Anywhere:
    """An upper bound of a predicate's margin over all poses to which blocks may bring the tokens, shape ``(...)``."""

    predicate: Predicate
    turns: bool

    def __call__(self, state: State, *values: Value, **keywords: float) -> FloatArray:
        shape = state.values.shape[:-1]
        if self.turns or self.predicate.bound is None:
            return np.zeros(shape)
        single = (State(state.layout, row) for row in state.values.reshape(-1, state.layout.size))
        bounds = np.array([bound_margin(self.predicate, each, np.inf, values) for each in single]).reshape(shape)
        return np.asarray(np.maximum(bounds, self.predicate.evaluate(state, *values)))


def relax_task(task: Task, tracking: Tracking) -> Task:
    """Return a task in which a condition on moved tokens counts as true if it may be true in some pose.

    If the relaxed task has no plan, the task has none either. Negated conditions on moved tokens are left out.
    """
    domain = task.domain
    relaxed = {name: _relax(domain.predicate_by_name[name], tracking) for name in tracking.parameters}
    blocks = tuple(
        replace(
            block,
            preferences=(),
            entry=tuple(
                replace(each, predicate=relaxed.get(each.predicate.name, each.predicate))
                for each in block.entry
                if each.positive or each.predicate.name not in relaxed
            ),
        )
        for block in domain.blocks
    )
    predicates = tuple(relaxed.get(predicate.name, predicate) for predicate in domain.predicates)
    return task.replaced(domain=replace(domain, blocks=blocks, predicates=predicates))


def _relax(predicate: Predicate, tracking: Tracking) -> Predicate:
    moved = (predicate.parameters[index].name for index in tracking.parameters[predicate.name])
    turns = any("orientation" in predicate.reads.get(name, ()) for name in moved)
    return replace(predicate, margin=_Anywhere(predicate, turns))

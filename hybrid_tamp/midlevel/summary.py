"""The refined plan, as what was searched and the candidates that are left tell it."""

import time
from collections.abc import Iterator
from dataclasses import replace

from hybrid_tamp.midlevel.candidates import Candidates
from hybrid_tamp.midlevel.objective import Objective
from hybrid_tamp.midlevel.physics_refinement import RefinedInPhysics
from hybrid_tamp.midlevel.plan_search import Searched
from hybrid_tamp.model.refined import Performance, RefinedPlan, Tuned
from hybrid_tamp.motion.arrays import FloatArray


def summarise_defaults(objective: Objective, defaults: Candidates, began: float) -> RefinedPlan:
    """Return the plan with its defaults, in which there was nothing to optimise."""
    space = objective.space
    statuses = {variable.name: "kept" for variable in space.variables}
    tuned = _tuned(objective, defaults.point, statuses)
    return _summarise(objective, defaults, tuple(tuned), 0, began)


def summarise(
    searched: Searched, candidates: Candidates, in_physics: RefinedInPhysics | None, began: float
) -> RefinedPlan:
    """Return the plan with the best of the candidates.

    Args:
        searched: what was searched.
        candidates: what is left of it.
        in_physics: what came of going on in physics, if that was asked.
        began: when the work began, by `time.monotonic` [s].
    """
    objective, optimum, influence = searched.objective, searched.optimum, searched.influence
    relevant = searched.screening.relevant
    names = [variable.name for variable in objective.space.variables]
    statuses = {name: "optimised" if name in relevant else "free" for name in names}
    tuned = list(_tuned(objective, candidates.point, statuses))
    tuned = [replace(each, moves=influence.moves.get(name, ())) for name, each in zip(names, tuned, strict=True)]
    if searched.apart is not None:
        tuned = [replace(each, apart=float(at)) for each, at in zip(tuned, searched.apart, strict=True)]
    found = replace(
        _summarise(objective, candidates, tuple(tuned), searched.spent, began),
        apart=None if searched.apart is None else candidates.value(-1),
        optimiser=objective.task.midlevel.optimiser,
        stopped=optimum.stopped,
        history=optimum.history,
    )
    if in_physics is None:
        return found
    return replace(found, physics=in_physics.retuning, shortfall=in_physics.shortfall)


def _summarise(
    objective: Objective, candidates: Candidates, tuned: tuple[Tuned, ...], spent: int, began: float
) -> RefinedPlan:
    """Return the plan with the best of the candidates, but without what only a search can tell."""
    rollout, chosen = candidates.rollout, candidates.chosen
    values = dict(zip(objective.keys, candidates.point.tolist(), strict=True))
    short = rollout.worst(chosen)
    margins = {(c.where, c.atom): float(c.margin[chosen]) for c in rollout.conditions}
    return RefinedPlan(
        plan=objective.plan.set_hyperparameters(values),
        hyperparameters=tuned,
        performance=tuple(_expect_performance(objective, candidates)),
        best=candidates.value(chosen),
        defaults=candidates.value(0),
        apart=None,
        shortfall=None if short is None else short.at(chosen),
        expected=margins,
        optimiser="",
        evaluations=spent + len(candidates.points),
        seconds=time.monotonic() - began,
        stopped="",
        history=(),
    )


def _tuned(objective: Objective, point: FloatArray, statuses: dict[str, str]) -> Iterator[Tuned]:
    """Yield each hyperparameter at a point ``(d,)``, with its status unless its bounds fix it."""
    for key, variable, value in zip(objective.keys, objective.space.variables, point.tolist(), strict=True):
        status = statuses[variable.name] if variable.lower < variable.upper else "fixed"
        yield Tuned(*key, variable.unit, variable.lower, variable.upper, variable.default, value, status)


def _expect_performance(objective: Objective, candidates: Candidates) -> Iterator[Performance]:
    figures = candidates.rollout.figures
    for instance in sorted(objective.plan.instances, key=lambda i: (i.start, i.name)):
        for m in objective.task.domain.block_by_name[instance.block].performance:
            figure = float(figures[instance.name, m.name][candidates.chosen])
            yield Performance(instance.name, m.name, m.unit, m.weight, m.scale, figure)

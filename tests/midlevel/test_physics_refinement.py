"""Tests of the optimisation in physics, where the optimum differs from the optimum of the forward models."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from midlevel.pucks import FIRST, puck_plan, puck_task

from hybrid_tamp.midlevel.objective import Objective
from hybrid_tamp.midlevel.physics_refinement import narrow_space
from hybrid_tamp.midlevel.refinement import refine
from hybrid_tamp.midlevel.rollout import Rollouts
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.measure import Measure
from hybrid_tamp.model.refined import RefinedPlan


def wanting(a: float) -> Block:
    """Return a variant of FIRST in which a different value of a is the best on its own."""

    def near(b: Any, before: Any, after: Any, h: Any) -> Any:
        return -((after[b["puck"], "place"][..., 0] - a) ** 2)

    return replace(FIRST, performance=(Measure("start", "m^2", 1.0, end=near),))


def refined(a: float, refine_by: str = "physics", **more: Any) -> RefinedPlan:
    real = Rollouts(puck_task(first=wanting(a)), puck_plan())
    return refine(puck_task(refine=refine_by, **more), puck_plan(), measured=real)


def test_it_goes_on_towards_the_optimum_of_physics() -> None:
    found = refined(0.3, evaluations=2000)
    assert found.physics is not None
    assert found.physics.evaluations == 40
    assert found.physics.best.value > found.physics.before.value
    # The optimum in physics is a = b = 0.55. The optimum in the forward models is 0.5.
    assert [tuned.value for tuned in found.hyperparameters] == pytest.approx([0.55, 0.55], abs=0.02)
    assert found.physics.history[-1].value == found.physics.best.value
    assert found.best.value < -0.18  # in the forward models, this value is lower than the optimum


def test_the_optimum_is_kept_where_physics_agrees_and_nothing_is_run_unasked() -> None:
    agreed, unasked = refined(0.2), refined(0.2, "none")
    assert agreed.physics is not None
    assert agreed.physics.best.value >= agreed.physics.before.value
    assert unasked.physics is None
    assert agreed.hyperparameters[0].value == pytest.approx(unasked.hyperparameters[0].value, abs=5e-3)


def test_the_share_of_a_small_budget_is_small() -> None:
    found = refined(0.3, evaluations=100)
    assert found.physics is not None
    assert (found.physics.evaluations, found.physics.stopped) == (4, "evaluations")


def test_where_every_run_fails_the_optimum_stays_and_the_condition_is_told() -> None:
    task = puck_task()
    high = replace(task.domain.predicates[0], margin=lambda state, puck: np.full(state.values.shape[:-1], np.nan))
    blocks = [replace(block, exit=(high("puck"),)) for block in task.domain.blocks[:2]]
    domain = replace(task.domain, predicates=(high,), blocks=(*blocks, task.domain.blocks[2]))
    real = Rollouts(task.replaced(domain=domain), puck_plan())
    found = refine(puck_task(refine="physics"), puck_plan(), measured=real)
    assert found.physics is not None
    assert found.physics.stopped == "every run failed"
    assert found.shortfall is not None
    assert (found.shortfall.where, found.shortfall.atom.text) == ("FIRST-1", "slid(puck)")
    assert found.hyperparameters[0].value == pytest.approx(0.5, abs=2e-3)


def test_the_neighbourhood_ends_where_a_condition_does() -> None:
    task = puck_task()
    low = replace(task.domain.predicates[0], margin=lambda state, puck: 0.51 - state[puck, "place"][..., 1])
    blocks = [replace(block, exit=(low("puck"),)) for block in task.domain.blocks[:2]]
    domain = replace(task.domain, predicates=(low,), blocks=(*blocks, task.domain.blocks[2]))
    narrowed = task.replaced(domain=domain)
    objective = Objective(narrowed, puck_plan(), Rollouts(narrowed, puck_plan()), reserves={})
    a, b = narrow_space(objective, np.array([0.95, 0.5]), objective.space.names).variables
    assert (a.lower, a.upper, a.default) == pytest.approx((0.75, 1.0, 0.95))
    assert b.lower == pytest.approx(0.3)
    assert 0.505 <= b.upper <= 0.51

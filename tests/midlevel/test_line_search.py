"""Tests of the search over a single variable: few batches, no repeated rollout, and the true optimum."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from midlevel.pucks import FIRST, SECOND, puck_plan, puck_task

from hybrid_tamp.midlevel.predictions import Chosen, Rollout
from hybrid_tamp.midlevel.refinement import refine
from hybrid_tamp.midlevel.rollout import Rollouts


def one_variable(**settings: Any) -> Any:
    """Return a task in which only the hyperparameter `a` of the first action varies."""
    (chosen,) = SECOND.hyperparameters
    fixed = replace(chosen, lower=0.37, upper=0.37, initial=lambda binding, state: np.asarray(0.37))
    return puck_task(second=replace(SECOND, hyperparameters=(fixed,)), **settings)


class Counted:
    """A rollout function that stores what it was asked for."""

    def __init__(self, task: Any) -> None:
        self.rollouts = Rollouts(task, puck_plan())
        self.batches: list[list[tuple[float, ...]]] = []
        self.until: set[str | None] = set()

    def __call__(self, chosen: Chosen, count: int, until: str | None = None) -> Rollout:
        self.batches.append(list(zip(*(np.asarray(values).tolist() for values in chosen.values()), strict=True)))
        self.until.add(until)
        return self.rollouts(chosen, count, until)


def test_three_batches_find_the_optimum_without_repeating_a_rollout() -> None:
    task = one_variable()
    counted = Counted(task)
    refined = refine(task, puck_plan(), roll_out=counted)
    rolled = [point for batch in counted.batches for point in batch]
    assert len(counted.batches) == 3
    assert len(rolled) == len(set(rolled)) == refined.evaluations
    assert counted.until == {None}  # The rollouts of the search also serve for the summary.
    grid = np.linspace(-1.0, 1.0, 20001)
    exact = Rollouts(task, puck_plan())({("FIRST-1", "a"): grid}, len(grid))
    highest = float(np.max(np.where(exact.violation <= 0, exact.value, -np.inf)))
    gain = highest - refined.defaults.value
    assert gain > 0.01
    assert refined.best.value >= highest - 1e-4 * gain


def test_the_scan_of_the_action_on_its_own_needs_no_further_batch() -> None:
    task = one_variable()
    together, alone = Counted(task), Counted(task)
    compared = refine(task, puck_plan(), roll_out=together)
    assert refine(task, puck_plan(), roll_out=alone, compare=False).apart is None
    assert len(together.batches) == len(alone.batches) == 3
    assert compared.apart is not None
    assert [each.apart for each in compared.hyperparameters if each.name == "a"] == pytest.approx([0.2], abs=1e-2)


@pytest.mark.parametrize("evaluations", [1, 2, 3, 10, 40, 124])
def test_the_budget_is_kept(evaluations: int) -> None:
    task = one_variable(evaluations=evaluations)
    counted = Counted(task)
    refined = refine(task, puck_plan(), roll_out=counted, compare=False)
    assert sum(map(len, counted.batches)) <= evaluations
    assert refined.best.value >= refined.defaults.value


def test_nothing_to_choose_is_one_rollout() -> None:
    task = puck_task(*(replace(block, performance=()) for block in (FIRST, SECOND)))
    counted = Counted(task)
    assert refine(task, puck_plan(), roll_out=counted).evaluations == 1
    assert [len(batch) for batch in counted.batches] == [1]

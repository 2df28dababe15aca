"""Tests of the breadth-first search that checks proofs. It finds chains of movements, and ends on unsolvable tasks."""

import numpy as np
import pytest
from contracts.scripts import load_script
from oracle.search import Search
from random_tasks.small import small_task
from random_tasks.small_lifting import small_lifting
from random_tasks.small_tools import small_tools
from random_tasks.small_tumbling import small_tumbling

from hybrid_tamp.model.task import Task
from hybrid_tamp.taskfile.loader import load_task
from hybrid_tamp.taskfile.saving import save_task


def test_a_simulated_lift_is_found() -> None:
    found = Search(load_task("lift_two_hands")).run()
    assert (found.status, found.movements, found.simulations) == ("found", 1, 4)


def test_a_push_round_a_corner_needs_two_pushes() -> None:
    found = Search(small_tools(0, "corner", np.random.default_rng(0)), simulate=False).run()
    pushes = [each.roles for step in found.steps for each in step if each.block.name == "PUSHING"]
    assert (found.status, found.most_moved) == ("found", 2)
    assert [dict(roles)["region"] for roles in pushes] == ["middle", "goal"]


def test_a_slender_box_tumbles_about_another_axis_first() -> None:
    task = small_tumbling(0, "slender, about two axes", np.random.default_rng(0))
    found = Search(task, simulate=False).run()
    assert (found.status, found.most_moved) == ("found", 2)


@pytest.mark.parametrize(
    "task",
    [
        small_lifting(0, "too heavy", np.random.default_rng(0)),
        small_tools(0, "no corner", np.random.default_rng(0)),
        small_tumbling(0, "about another axis", np.random.default_rng(0)),
        load_task("roll_cylinder_off_axis"),
    ],
    ids=lambda task: task.name,
)
def test_a_task_without_a_plan_is_exhausted(task: Task) -> None:
    assert Search(task).run().status == "exhausted"


def test_small_tasks_pass_the_checks_of_task_files(tmp_path) -> None:  # type: ignore[no-untyped-def]
    for seed in range(0, 60, 2):
        save_task(small_task(seed), tmp_path / "task.yaml")
        load_task(tmp_path / "task.yaml")


def test_a_proof_that_the_search_refutes_is_false() -> None:
    proofs = load_script("proofs")
    assert proofs.VERDICTS["unsolvable", "found"] == proofs.FALSE
    assert proofs.VERDICTS.get(("unsolvable", "cut off"), proofs.OPEN) == proofs.OPEN

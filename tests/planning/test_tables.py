"""Movements on tables stay on their table, and hands avoid the table."""

import numpy as np

import hybrid_tamp
from hybrid_tamp.collision.bodies import Body
from hybrid_tamp.collision.sweeps import Track
from hybrid_tamp.model.contacts import ContactRules
from hybrid_tamp.model.plan import BlockInstance, TaskPlan
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.refined import ON_TOP, Shortfall
from hybrid_tamp.planning.clearance import Sweep
from hybrid_tamp.planning.overhangs import find_overhang

TASK = hybrid_tamp.load_task("roll_on_table")
BOXES = hybrid_tamp.load_task("tumble_on_table")
STILL = np.array([0.0, 0.0, 0.0, 1.0])


def movement(task: hybrid_tamp.Task, name: str, positions: list[list[float]]) -> Sweep:
    """Return the movement of a body without turning."""
    track = Track(Body(name, task.token_by_name[name].solid), np.array(positions), np.tile(STILL, (len(positions), 1)))
    instance = BlockInstance("M-1", "M", {"object": name}, 0.0, 1.0)
    return Sweep(instance, None, (track,), ((),))  # type: ignore[arg-type]  # no trace is needed


def test_a_drum_that_leaves_its_table_is_found_with_the_figure() -> None:
    kept = movement(TASK, "drum", [[0.0, 0, 0.8], [1.0, 0, 0.8]])
    assert find_overhang(TASK, [kept]) is None
    lost = find_overhang(TASK, [kept, movement(TASK, "drum", [[1.0, 0, 0.8], [1.05, 0, 0.8], [1.2, 0, 0.8]])])
    assert lost is not None
    assert (lost.thing, lost.table, round(lost.beyond, 6)) == ("drum", "table", 0.1)


def test_all_corners_of_a_box_must_rest_on_its_table() -> None:
    # The top covers -0.5 <= x <= 0.9, and the half extent of the box along x is 0.15 m.
    lost = find_overhang(BOXES, [movement(BOXES, "box", [[0.0, 0, 0.58], [0.8, 0, 0.58]])])
    assert lost is not None
    assert round(lost.beyond, 6) == 0.05


def test_a_box_that_is_lifted_may_leave_its_table() -> None:
    assert find_overhang(BOXES, [movement(BOXES, "box", [[0.0, 0, 0.58], [0.0, 0, 0.7], [2.0, 0, 0.3]])]) is None


def test_the_reason_names_body_table_figure_and_place() -> None:
    said = Shortfall("ROLLING-1", Atom(ON_TOP, ("drum", "table")), "m", -0.1, place=(1.2, 0.0, 0.8)).text
    assert said == "drum leaves the top of table: it reaches 0.1 m beyond the edge at (1.20, 0.00, 0.80)"


def test_only_the_body_below_counts_as_the_floor() -> None:
    slots, targets = {"hand": "hand", "object": "drum"}, {"region": "goal"}
    rolling = BlockInstance("ROLLING-1", "ROLLING", slots, 0.0, 1.0, targets)
    rules = ContactRules(TASK.domain.block_by_name, [rolling], TASK.fixed_bodies, TASK.token_by_name)
    assert rules.allow("drum", "table", TASK.state)
    assert not rules.allow("hand", "table", TASK.state)
    walled = hybrid_tamp.load_task("roll_around_wall")
    rules = ContactRules(walled.domain.block_by_name, [rolling], walled.fixed_bodies, walled.token_by_name)
    assert not rules.allow("drum", "wall", walled.state)


def test_tasks_on_tables_are_planned() -> None:
    outcome = hybrid_tamp.plan("roll_on_table")
    assert isinstance(outcome.plan, TaskPlan)
    # The hand starts below the top of the table, so it follows a path around the edge.
    assert any(instance.path for instance in outcome.plan.instances)


def test_a_hand_under_a_table_takes_a_path_although_no_straight_reach_meets_its_conditions() -> None:
    below = TASK.replaced(state=TASK.state.replace({("hand", "position"): (0.5, 0.0, 0.5)}))
    found = hybrid_tamp.plan(below, hybrid_tamp.Settings(evaluations=60), optimise=True).required()
    (reach,) = (each for each in found.instances if each.block == "REACHING:behind")
    assert len(reach.path) > 2

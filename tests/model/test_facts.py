import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from scenes import rolling_task

from hybrid_tamp.model.facts import facts, static_facts
from hybrid_tamp.model.predicate import Atom


def test_facts_are_read_off_the_numbers() -> None:
    task = rolling_task()
    resting = {Atom("at_rest", ("drum 0",)), Atom("at_rest", ("hand 0",))}
    free = {Atom("outside", ("hand 0", "drum 0"))}
    assert facts(task) == resting | free | {Atom(name, ("hand 0",)) for name in ("clear_of_floor", "in_workspace")}
    there = task.state.replace({("drum 0", "position"): (0.69, 0.0, 0.1)})
    assert Atom("inside", ("drum 0", "region 0")) in facts(task, there)
    moving = task.state.replace({("drum 0", "velocity"): (0.1, 0.0, 0.0)})
    assert Atom("at_rest", ("drum 0",)) not in facts(task, moving)


def test_feasibility_is_known_before_any_search() -> None:
    task = rolling_task()
    assert {atom for atom in static_facts(task) if task.token_by_name.keys() & set(atom.arguments)} == {
        Atom("lies_on_side", ("drum 0",)),
        *(Atom(name, ("drum 0", "region 0")) for name in ("level_with", "on_rolling_line")),
        *(Atom("free_to_move", (name,)) for name in ("drum 0", "hand 0")),
        Atom("within_workspace", ("hand 0", "drum 0", "region 0")),
        *(Atom(name, ("drum 0",)) for name in ("rolls", "stops", "wide_enough")),
        *(Atom(name, ("hand 0", "drum 0")) for name in ("able_to_roll", "rolls_steadily", "touches_axis")),
    }
    # The region has a radius of 0.02 m. An object may drift by 0.002 m when it rolls.
    aside = static_facts(rolling_task(regions=[(0.7, 0.023)]))
    assert Atom("on_rolling_line", ("drum 0", "region 0")) not in aside
    too_far = static_facts(rolling_task(regions=[(4.0, 0.0)]))
    assert Atom("within_workspace", ("hand 0", "drum 0", "region 0")) not in too_far


def test_a_functional_predicate_has_one_value_the_goal_first() -> None:
    regions = [(0.001, 0.0), (0.005, 0.0)]
    nearest = facts(rolling_task(regions=regions, goal=[]))
    assert {a for a in nearest if a.predicate == "inside"} == {Atom("inside", ("drum 0", "region 0"))}
    wanted = facts(rolling_task(regions=regions, goal=[(0, 1)]))
    assert {a for a in wanted if a.predicate == "inside"} == {Atom("inside", ("drum 0", "region 1"))}


@given(st.floats(-1, 1), st.floats(-1, 1))
def test_symbol_and_margin_agree(x: float, y: float) -> None:
    task = rolling_task()
    state = task.state.replace({("drum 0", "position"): (x, y, 0.1)})
    atom = Atom("inside", ("drum 0", "region 0"))
    assert (atom in facts(task, state)) == (task.margin(atom, state) >= 0)
    assert np.isclose(task.margin(atom, state), 0.02 - np.hypot(x - 0.7, y))


def test_margins_take_a_whole_population_at_once() -> None:
    task = rolling_task()
    many = task.state.repeated(5)
    for predicate in task.domain.predicates:
        if not all(task.values_of(parameter.sort) for parameter in predicate.parameters):
            continue  # facts about boxes, which this task does not contain: see tests/domains
        values = [next(iter(task.values_of(parameter.sort))) for parameter in predicate.parameters]
        assert predicate.evaluate(many, *values).shape == (5,)
        assert np.allclose(predicate.evaluate(many, *values), predicate.evaluate(task.state, *values))


def test_feasibility_does_not_hang_on_where_the_drum_starts() -> None:
    """Hands whose workspaces cover parts of the path can roll a drum in turn, so no proof must exclude this."""
    task = rolling_task(regions=[(0.45, 0.0), (0.7, 0.0)])
    moved = task.replaced(state=task.state.replace({("drum 0", "position"): (-30.0, 0.0, 0.1)}))
    assert static_facts(moved) == static_facts(task)

"""A movement that fails also fails with other hands, if these hands are equal."""

from dataclasses import replace

import hybrid_tamp
from hybrid_tamp.model.plan import BlockInstance
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.refined import CLEAR, Shortfall
from hybrid_tamp.model.task import Task
from hybrid_tamp.planning.equal_hands import swap_equal_hands

SLOTS = {"first": "hand-1", "second": "hand-2", "object": "box"}
TIPPING = BlockInstance("TIPPING-1", "TIPPING:opposite", SLOTS, 0.0, 1.0, {"near": "left"})


def swapped(task: Task, *hit: str) -> list[tuple[str, str]]:
    shortfall = Shortfall("TIPPING-1", Atom(CLEAR, hit), "m", -0.1)
    found = list(swap_equal_hands(task, TIPPING, shortfall))
    assert found[0] == TIPPING
    assert all(each.targets == TIPPING.targets and each.slots["object"] == "box" for each in found)
    return [(each.slots["first"], each.slots["second"]) for each in found]


def test_every_choice_of_equal_hands_fails() -> None:
    assert swapped(hybrid_tamp.load_task("tumble_two_hands"), "hand-1", "wall") == [
        ("hand-1", "hand-2"),
        ("hand-2", "hand-1"),
    ]
    assert len(set(swapped(hybrid_tamp.load_task("tumble_four_hands"), "hand-1", "wall"))) == 12


def test_hands_with_other_properties_may_succeed() -> None:
    task = hybrid_tamp.load_task("tumble_two_hands")
    strong, other = (task.token_by_name[name] for name in ("hand-1", "hand-2"))
    strong = replace(strong, properties={**strong.properties, "max_force": 1e4})
    tokens = [strong if each.name == strong.name else each for each in task.tokens]
    assert swapped(task.replaced(tokens=tokens), "hand-1", "wall") == [("hand-1", "hand-2")]
    assert other.fixed != strong.fixed


def test_a_resting_hand_in_the_way_is_elsewhere_if_hands_are_exchanged() -> None:
    assert swapped(hybrid_tamp.load_task("tumble_four_hands"), "hand-1", "hand-3") == [("hand-1", "hand-2")]

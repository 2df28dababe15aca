"""If several modes of an action have the same reason, the reason is stated once."""

from hybrid_tamp.feasibility.mode_names import BLOCK, merge_reasons
from hybrid_tamp.model.explanation import Reason, ReasonKind
from hybrid_tamp.model.predicate import Atom

GOAL = Atom("up", ("box",))


def reason(block: str, kind: ReasonKind = "too_few_tokens") -> Reason:
    return Reason((), block, kind, f"{BLOCK} needs 2 of class HAND, the task has 1; 1 more token would be enough")


def test_modes_are_named_together() -> None:
    (one,) = merge_reasons(GOAL, [reason("TIPPING:opposite"), reason("TIPPING:lower"), reason("TIPPING:opposite")])
    assert one.goal == (GOAL,)
    assert one.block == "TIPPING"
    assert one.message.startswith("TIPPING (opposite, lower) needs 2 of class HAND")


def test_one_mode_keeps_its_name_and_an_action_without_modes_too() -> None:
    assert merge_reasons(GOAL, [reason("TIPPING:lower")])[0].message.startswith("TIPPING:lower needs")
    assert merge_reasons(GOAL, [reason("ROLLING")])[0].message.startswith("ROLLING needs")


def test_different_reasons_stay_apart() -> None:
    several = [reason("TIPPING:lower"), reason("TIPPING:opposite", "no_token"), reason("ROLLING")]
    assert len(merge_reasons(GOAL, several)) == 3

"""The same reason of several modes is said once."""

from hybrid_tamp.feasibility.reasons import BLOCK, Reason, merged


def reason(block: str, kind: str = "too_few_tokens") -> Reason:
    return Reason("", block, kind, f"{BLOCK} needs 2 of class HAND, the task has 1; 1 more would do")


def test_modes_are_named_together() -> None:
    (one,) = merged("up(box)", [reason("TIPPING:opposite"), reason("TIPPING:lower"), reason("TIPPING:opposite")])
    assert one.goal == "up(box)"
    assert one.block == "TIPPING"
    assert one.message.startswith("TIPPING (opposite, lower) needs 2 of class HAND")


def test_one_mode_keeps_its_name_and_an_action_without_modes_too() -> None:
    assert merged("g", [reason("TIPPING:lower")])[0].message.startswith("TIPPING:lower needs")
    assert merged("g", [reason("ROLLING")])[0].message.startswith("ROLLING needs")


def test_different_reasons_stay_apart() -> None:
    assert len(merged("g", [reason("TIPPING:lower"), reason("TIPPING:opposite", "no_token"), reason("ROLLING")])) == 3

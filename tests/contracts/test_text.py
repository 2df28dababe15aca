"""The results of commands do not depend on the text of atoms, literals and planned actions.

The tests replace this text by random text. `scripts/noise` repeats the tests for all bundled tasks.
"""

import pytest
from contracts.scripts import load_script

CASES = {
    "roll_cylinder": ("check", "plan", "optimise", "affordances"),
    "roll_cylinder_off_axis": ("plan",),
    "tumble_one_hand": ("explain",),
    "tool_choice": ("plan",),
    "lift_two_hands": ("plan",),
    "unknown_box": ("probe",),
}
FEWER = {"probe": ("--class", "TUMBLABLE")}
"""Maps commands to options with which they take less time."""


@pytest.mark.parametrize(("task", "verb"), [(task, verb) for task, verbs in CASES.items() for verb in verbs])
def test_nothing_depends_on_the_text_of_values(task: str, verb: str) -> None:
    script = load_script("noise")
    ((_, words),) = script.commands(task, [verb])
    assert script.differences((*words, *FEWER.get(verb, ()))) == []


def test_the_noise_is_heard() -> None:
    from hybrid_tamp_domains.rolling_tumbling import DOMAIN

    script = load_script("noise")
    atom = next(each for block in DOMAIN.blocks for each in block.exit)
    before = str(atom)
    with script.noise():
        assert str(atom).startswith("noise ")
    assert str(atom) == before

"""The chain of function calls from the command line to the planner is short (`scripts/calls` prints the chain)."""

import pytest
from contracts.scripts import load_script


@pytest.mark.parametrize(
    ("task", "functions", "modules"),
    [("roll_cylinder", 7, 5), ("tumble_two_boxes_four_hands", 11, 6)],
)
def test_the_chain_of_calls_to_the_planner_is_short(task: str, functions: int, modules: int) -> None:
    chain = load_script("calls").planning_chain(task)
    assert chain.functions <= functions, chain.calls
    assert chain.modules <= modules, chain.calls

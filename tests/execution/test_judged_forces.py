"""`scripts/judge` reads commands from the recording and compares them with the properties in the task file."""

from types import SimpleNamespace

import numpy as np
from contracts.scripts import load_script

LAYOUT = [["box", "lift", 1], ["hand", "force", 3], ["hand", "torque", 3]]


def faults(force: tuple[float, float, float]) -> list[str]:
    commands = np.zeros((5, 7))
    commands[3, 1:4] = force
    commands[:, 4:] = 1e3
    tokens = {"box": {"properties": {"mass": 1.0}}, "hand": {"properties": {"maximal_force": 50.0}}}
    run = SimpleNamespace(document={"commands_layout": LAYOUT}, task={"tokens": tokens}, commands=commands)
    return list(load_script("judge").find_hands_too_strong(run))


def test_a_hand_is_commanded_at_most_its_maximal_force() -> None:
    assert faults((30.0, 0.0, -40.0)) == []
    [fault] = faults((30.0, 0.1, -40.0))
    assert fault == "hand was commanded to exert 50.0 N, more than its maximal force of 50 N"

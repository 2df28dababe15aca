"""`scripts/judge` compares the recorded poses of all bodies, without any code of the package."""

from typing import Any

import numpy as np
from contracts.scripts import load_script

TOKENS: dict[str, Any] = {
    "hand": {"properties": {"radius": 0.04, "length": 0.2}},
    "drum": {"shape": {"kind": "cylinder", "radius": 0.1, "length": 0.3}},
    "wall": {"fixed": True, "shape": {"kind": "box", "half_extents": [0.05, 0.5, 0.5]}},
    "goal": {"properties": {"radius": 0.3}},
}
ROLLING = {"name": "ROLLING-1", "block": "ROLLING", "slots": {"hand": "hand", "object": "drum"}, "targets": {}}
RESTING = {"name": "RESTING-1", "block": "RESTING", "slots": {"token": "wall"}, "targets": {}}


class Drawn:
    """A run of 10 s in which a hand moves along x, 5 cm a second, above a drum that moves as fast."""

    def __init__(self, hand: float, drum: float, wall: float) -> None:
        self.task = {"tokens": TOKENS}
        self.times = np.linspace(0.0, 10.0, 201)
        self.instances = {each["name"]: {**each, "start": 0.0, "end": 10.0} for each in (ROLLING, RESTING)}
        self.columns = {(name, "position"): slice(0) for name in TOKENS}
        self.places = {"hand": (hand, 0.05), "drum": (drum, 0.05), "wall": (wall, 0.0), "goal": (0.0, 0.0)}

    def __getitem__(self, key: tuple[str, str]) -> np.ndarray:
        first, speed = self.places[key[0]]
        return np.column_stack([first + speed * self.times, np.zeros(201), np.full(201, 0.5)])

    def turned(self, token: str, row: int) -> np.ndarray:
        return np.eye(3)


def faults(hand: float, drum: float, wall: float) -> list[str]:
    return list(load_script("judge").find_overlaps(Drawn(hand, drum, wall)))


def test_a_hand_may_touch_the_drum_that_it_rolls() -> None:
    assert faults(hand=-0.13, drum=0.0, wall=2.0) == []


def test_a_drum_that_enters_a_wall_is_reported_once() -> None:
    # The drum's front is at 0.1 m, and the wall begins at 0.35 m. Poses are compared every 0.4 s.
    assert faults(hand=-0.2, drum=0.0, wall=0.4) == ["drum and wall overlapped at 5.20 s"]
    assert faults(hand=-0.2, drum=0.0, wall=0.651) == []


def test_a_rotation_is_about_fixed_axes() -> None:
    turn = load_script("judge").turn_by([np.pi / 2, 0.0, np.pi / 2])
    assert np.allclose(turn @ [0.0, 0.0, 1.0], [1.0, 0.0, 0.0])

"""A timetable returns the values of its reference, whatever the size of the batch."""

import numpy as np
import pytest

from hybrid_tamp.model.control import CONTROL_PERIOD
from hybrid_tamp.model.state import State, StateLayout
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.skills import Timetable


@pytest.mark.parametrize("batch", [(), (1,), (50,), (1000,)])
def test_a_timetable_returns_the_values_of_its_reference(batch: tuple[int, ...]) -> None:
    start = State(StateLayout((("thing", "place", 2),)), np.zeros((*batch, 2)))
    slope = np.random.default_rng(3).normal(size=batch)
    sizes = []

    def read(elapsed: FloatArray) -> tuple[FloatArray, ...]:
        sizes.append(np.broadcast(elapsed, slope).size)
        return (np.asarray(elapsed * slope),)

    timetable = Timetable(read, start)
    for step in range(200):
        elapsed = np.float64(step * CONTROL_PERIOD)
        assert timetable(elapsed)[0].tolist() == (elapsed * slope).tolist()
    assert max(sizes) <= 16384
    assert len(sizes) < 200

"""Movements keep their distance from bodies by other hyperparameters, if they have no path."""

import pytest
from hybrid_tamp_domains.rolling_tumbling import DOMAIN
from scenes import rolling_task

import hybrid_tamp
from hybrid_tamp.geometry.shapes import Box
from hybrid_tamp.midlevel.summary import NEARBY
from hybrid_tamp.model.outcome import PlanOutcome
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Limits, Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.skills import Region

END = 0.8
"""Front of a drum that rolls to the middle of the region [m]."""


def walled_task(face: float, clearance: float = Limits.clearance) -> Task:
    """Return a task with a wall behind the region. The wall's face is at x = `face` [m]."""
    task = rolling_task()
    wall = Token.make("wall", [], {}, Box(kind="box", half_extents=(0.05, 0.3, 0.2)), immovable=True)
    region = Token.make("region 0", [Region], {"radius": 0.05})
    tokens = (*(token for token in task.tokens if token.name != "region 0"), region, wall)
    poses = {(token.name, v.name): task.state[token, v.name] for token in task.tokens for v in token.varying}
    state = State.of(tokens, {**poses, ("wall", "position"): (face + 0.05, 0.0, 0.2)})
    return Task("walled", DOMAIN, tokens, state, task.goal, limits=Limits(clearance=clearance))


def rolled(outcome: PlanOutcome) -> float:
    """Return the distance by which the drum is pushed [m]."""
    assert outcome.plan is not None
    (rolling,) = (each for each in outcome.plan.instances if each.block == "ROLLING")
    return rolling.hyperparameters["distance"]


@pytest.mark.parametrize("optimise", [False, True])
def test_a_roll_that_would_graze_a_wall_ends_earlier(optimise: bool) -> None:
    outcome = hybrid_tamp.plan(walled_task(END - 0.01), optimise=optimise)
    assert 0.64 < rolled(outcome) < 0.7 - 0.01
    assert not outcome.excluded
    (pair,) = (each for each in outcome.closest_pairs if each.instance == "ROLLING-1")
    assert (pair.moving, pair.other, pair.kept) == ("drum 0", "wall", Limits.clearance)
    assert pair.margin == pair.distance - pair.kept > 0
    if optimise:
        assert outcome.refinement is not None
        assert outcome.refinement.optimiser == NEARBY


def test_the_distance_to_keep_is_a_limit_of_the_task() -> None:
    assert rolled(hybrid_tamp.plan(walled_task(END + 0.004), optimise=True)) == pytest.approx(0.7)
    farther = hybrid_tamp.plan(walled_task(END + 0.004, clearance=0.01), optimise=True)
    assert rolled(farther) < 0.7 - 0.004


def test_a_roll_without_room_is_refused_with_its_distance() -> None:
    outcome = hybrid_tamp.plan(walled_task(END - 0.08), optimise=True, trials=0)
    assert outcome.plan is None
    (excluded,) = outcome.excluded
    assert excluded.shortfall.atom.text == "clear(drum 0, wall)"
    assert excluded.shortfall.margin == pytest.approx(-0.08 - Limits.clearance, abs=3e-3)
    assert "drum 0 hits wall, 0.0" in excluded.text

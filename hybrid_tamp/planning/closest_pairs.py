"""The closest pair of bodies in each movement of a plan: planned, drawn, and measured in a run."""

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from hybrid_tamp.collision.bodies import Body, Nearest, bodies_of, pose_of
from hybrid_tamp.collision.closest import find_closest
from hybrid_tamp.collision.sweeps import Clearance
from hybrid_tamp.midlevel.rollout import Rollouts
from hybrid_tamp.model.closest_pair import ClosestPair, Point
from hybrid_tamp.model.deadline import NEVER, Deadline
from hybrid_tamp.model.outcome import PlanOutcome
from hybrid_tamp.model.plan import BlockInstance
from hybrid_tamp.model.recording import Recording
from hybrid_tamp.model.refined import CLEAR
from hybrid_tamp.model.state import State
from hybrid_tamp.model.swept import SweptBody, SweptPath, SweptPlan
from hybrid_tamp.model.task import Task
from hybrid_tamp.planning.clearance import Sweep, find_sweeps, require_distance, track_of

NEAR = 0.5
"""Largest distance of a closest pair [m]."""


def find_closest_pairs(movements: Iterable[Sweep]) -> tuple[ClosestPair, ...]:
    """Return the closest pair of each movement that comes near a body at rest.

    A body that the moving body touches at the start of the movement is left out.
    """
    return tuple(pair for pair in map(_find_closest_pair, movements) if pair is not None)


def sweep_plan(outcome: PlanOutcome, deadline: Deadline = NEVER) -> SweptPlan:
    """Return the movements of a plan, or those of the first plan that was refused because it hits a body.

    Args:
        outcome: outcome of planning.
        deadline: deadline of the command.

    Raises:
        LimitReached: the deadline passes.
        NotFinite: the rollout fails.
    """
    task, refused = outcome.chosen or outcome.task, None
    plan = outcome.plan
    if plan is None:
        hits = (each for each in outcome.excluded if each.plan is not None and each.shortfall.atom.predicate == CLEAR)
        first = next(hits, None)
        if first is None:
            return SweptPlan(task, ())
        plan, refused = first.plan, first.shortfall
    assert plan is not None
    paths = []
    for movement in find_sweeps(task, plan, Rollouts(task, plan, deadline).trace(plan), deadline):
        if not movement.tracks:
            continue  # The instance moves only tokens without a shape.
        name = movement.instance.name
        hit = movement.find_hit() if refused is not None and name == refused.where else None
        pair = _find_closest_pair(movement) if hit is None else _describe(movement, hit.nearest, hit.kept)
        bodies = (SweptBody(each.body.name, each.positions, each.orientations) for each in movement.tracks)
        paths.append(SweptPath(movement.instance, tuple(bodies), movement.times, pair))
    return SweptPlan(task, tuple(paths), refused)


def measure_pairs(task: Task, recording: Recording, pairs: Sequence[ClosestPair]) -> tuple[ClosestPair, ...]:
    """Return the closest pairs with the least distances between the same bodies in a run.

    The distance in an instance that did not run is None.
    """
    bodies, ran = bodies_of(task), {each.name: each for each in recording.instances}
    return tuple(
        replace(pair, measured=_measure(recording, ran[pair.instance], bodies[pair.moving], bodies[pair.other]))
        for pair in pairs
        if pair.instance in ran
    )


def _measure(recording: Recording, instance: BlockInstance, moving: Body, other: Body) -> float | None:
    first, last = (round(time / recording.timestep) for time in (instance.start, instance.active.end))
    states = State(recording.layout, recording.states[first : last + 1])
    found = find_closest(track_of(moving, states), [(other, pose_of(recording.state(first), other.name))])
    return None if found is None else found.distance


def _find_closest_pair(movement: Sweep) -> ClosestPair | None:
    best: Clearance | None = None
    kept: dict[tuple[str, str], float] = {}
    for track, neighbours in zip(movement.tracks, movement.neighbours, strict=True):
        near = [each for each in neighbours if track.bound_distance(each.body, each.pose) < NEAR]
        kept |= {(track.body.name, each.body.name): require_distance(track, each) for each in near}
        others = [(each.body, each.pose) for each in near if kept[track.body.name, each.body.name] >= 0.0]
        best = find_closest(track, others, NEAR if best is None else best.distance) or best
    return None if best is None else _describe(movement, best, kept[best.moving, best.other])


def _describe(movement: Sweep, found: Clearance, kept: float) -> ClosestPair:
    """Return the pair of bodies at the phase of their least distance."""
    return ClosestPair(
        instance=movement.instance.name,
        moving=found.moving,
        other=found.other,
        distance=found.distance,
        time=float(np.interp(found.phase, range(len(movement.times)), movement.times)),
        points=_on_surfaces(movement.find_nearest_at(found, found.phase)),
        kept=kept,
    )


def _on_surfaces(nearest: Nearest) -> tuple[Point, Point]:
    """Return the nearest points of two bodies, from those of their cores. They are equal if the bodies overlap."""
    middle, half = nearest.points.mean(axis=0), (nearest.points[1] - nearest.points[0]) / 2.0
    length = 2.0 * float(np.linalg.norm(half))
    share = max(nearest.distance, 0.0) / length if length else 0.0
    one, other = ((float(x), float(y), float(z)) for x, y, z in (middle - share * half, middle + share * half))
    return one, other

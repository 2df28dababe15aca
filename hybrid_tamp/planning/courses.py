"""Comparison of the movements of a plan without a rollout: the courses that its blocks declare.

The end of one instance's course gives the poses at which the next one begins. A rollout stays within the allowances of
the courses. So if no course comes nearer to a body, a rollout cannot hit anything. The independent check then confirms
the courses.
"""

from collections.abc import Iterable, Mapping, Sequence
from itertools import combinations
from typing import NamedTuple

import numpy as np

from hybrid_tamp.collision.nearness import find_parted, may_come_near
from hybrid_tamp.collision.sweeps import Track
from hybrid_tamp.midlevel.predictions import Trace
from hybrid_tamp.model.control import Parameters
from hybrid_tamp.model.course import SKEW, Course
from hybrid_tamp.model.deadline import NEVER, Deadline
from hybrid_tamp.model.expectation import declared_course
from hybrid_tamp.model.plan import BlockInstance, TaskPlan
from hybrid_tamp.model.precedence import Precedence, must_wait
from hybrid_tamp.model.reassignment import initial, reassignments
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.view import View
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.planning.clearance import Neighbour, Sweep, find_sweeps
from hybrid_tamp.planning.collisions import check_plan
from hybrid_tamp.planning.isolation import ChildEnded, Note, run_isolated
from hybrid_tamp.planning.meetings import compared_tracks
from hybrid_tamp.planning.overhangs import find_overhang


def may_collide(task: Task, plan: TaskPlan, deadline: Deadline = NEVER) -> bool:
    """Return whether a movement of a plan may come near a body, or leave its table, as far as the courses tell.

    Args:
        task: task of the plan.
        plan: a valid plan of the task.
        deadline: deadline of the command.

    Returns:
        False if no rollout of the plan can hit anything. True if a course is near something, or if a block declares
        no course.

    Raises:
        DomainError: a function of the domain raised an exception, or returned a result of the wrong shape.
        LimitReached: the deadline passes.
    """
    courses = follow_courses(task, plan)
    if courses is None:
        return True
    traces = {name: Trace(each.course.states, each.world) for name, each in courses.items()}
    movements = [
        (movement, courses[movement.instance.name].course)
        for movement in find_sweeps(task, plan, traces, deadline, every=1)
    ]
    if any(_leaves_table(task, *each) or _is_near_bodies(*each) for each in movements):
        return True
    return _may_meet(task, plan, movements) or not _is_confirmed(task, plan, courses, deadline)


class Followed(NamedTuple):
    """The course of an instance of a plan, and the state of all tokens at its start, without batch dimensions."""

    course: Course
    world: State


def follow_courses(task: Task, plan: TaskPlan) -> dict[str, Followed] | None:
    """Return the courses of all instances that move tokens, or None if a block declares none.

    Raises:
        DomainError: a function of the domain raised an exception, or returned a result of the wrong shape.
    """
    chain = _Chain(task, plan)
    events = [initial(plan), *(event.starting for event in reassignments(task, plan))]
    if not all(chain.begin(starting) for starting in events):
        return None
    return chain.courses


class _Chain:
    """The states of all tokens along the courses of a plan, in the order of the plan's reassignments."""

    def __init__(self, task: Task, plan: TaskPlan) -> None:
        self.task, self.plan = task, plan
        self.courses: dict[str, Followed] = {}
        self._now = task.state
        self._coming: dict[str, tuple[BlockInstance, State]] = {}

    def begin(self, starting: Iterable[BlockInstance]) -> bool:
        """Start instances in the states in which earlier instances leave their tokens. False if a course is unknown."""
        starting = tuple(starting)
        for name, (running, end) in list(self._coming.items()):
            if any(self._is_over(running, each) for each in starting):
                self._now = self._now.replace(self._moved(running, end))
                del self._coming[name]
        for each in starting:
            course = self._course(each)
            if course is None:
                return False
            if self.task.domain.block_by_name[each.block].moves:
                self.courses[each.name] = Followed(course, self._now)
                self._coming[each.name] = each, course.end
        return True

    def _is_over(self, running: BlockInstance, starting: BlockInstance) -> bool:
        """Return whether an instance has moved its tokens when another one starts."""
        taken = not set(running.slots.values()).isdisjoint(starting.slots.values())
        return taken or must_wait(self.task, self.plan, running, starting)

    def _moved(self, instance: BlockInstance, end: State) -> dict[tuple[str, str], FloatArray]:
        """Return the values of the properties that an instance changes, at its end."""
        writes = self.task.domain.block_by_name[instance.block].writes
        written = ((instance.slots[slot], name) for slot, names in writes.items() for name in names)
        return {key: end[key] for key in written}

    def _view(self, instance: BlockInstance) -> View:
        return View(self.task.bind(instance.roles), self.task.state.layout)

    def _course(self, instance: BlockInstance) -> Course | None:
        block, binding = self.task.domain.block_by_name[instance.block], self.task.bind(instance.roles)
        start = self._view(instance).of(self._now)
        values = {**block.initial_values(binding, start), **instance.hyperparameters}
        chosen = {name: np.asarray(value, dtype=np.float64) for name, value in values.items()}
        return declared_course(block, binding, start, Parameters.along(instance.path, chosen))


def _is_confirmed(task: Task, plan: TaskPlan, courses: Mapping[str, Followed], deadline: Deadline) -> bool:
    """Return whether the independent check finds no collision if all instances follow their courses as scheduled."""
    lengths = {each.name: each.end - each.start for each in plan.instances}
    traces = {name: Trace(each.course.paced(lengths[name]), each.world) for name, each in courses.items()}

    def check(note: Note) -> bool:
        note("the check of the whole plan")
        return not check_plan(task, plan, traces)

    try:
        return run_isolated(check, deadline)
    except ChildEnded:
        return False  # The rollouts are compared next, and their check says what failed.


def _leaves_table(task: Task, movement: Sweep, course: Course) -> bool:
    return find_overhang(task, [movement], course.allowance) is not None


def _is_near_bodies(movement: Sweep, course: Course) -> bool:
    """Return whether a course comes near a body at rest. Bodies that touch at the start may part."""
    return any(
        _is_near(track, each, each.kept + course.allowance)
        for track, neighbours in zip(movement.tracks, movement.neighbours, strict=True)
        for each in neighbours
    )


def _is_near(track: Track, other: Neighbour, within: float) -> bool:
    if track.bound_distance(other.body, other.pose) >= within:
        return False
    still = Track(other.body, other.pose.position[None], other.pose.orientation[None])
    parted = find_parted(track, still, within)
    return parted < 0 or may_come_near(track.beginning_at(parted), still, within)


def _may_meet(task: Task, plan: TaskPlan, movements: Sequence[tuple[Sweep, Course]]) -> bool:
    """Return whether two movements may meet.

    Movements that start in one reassignment keep their timing if it is known. All others may have any timing that the
    order of the reassignments allows.
    """
    precedence = Precedence(task, plan)
    for (one, mine), (other, theirs) in combinations(movements, 2):
        if precedence.may_overlap(one.instance, other.instance):
            timed = None
            if precedence.start_together(one.instance, other.instance):
                timed = None if mine.times is None or theirs.times is None else (mine.times, theirs.times)
            within = mine.allowance + theirs.allowance
            if any(_meet(*pair, within, timed) for pair in compared_tracks(task, one, other)):
                return True
    return False


def _meet(one: Track, other: Track, within: float, times: tuple[FloatArray, FloatArray] | None) -> bool:
    """Return whether two movements may meet. With times, they start together, and bodies may part."""
    if times is None:
        return may_come_near(one, other, within)
    instants = np.union1d(*times)
    mine, theirs = (_pass(track, known, instants) for track, known in zip((one, other), times, strict=True))
    index = find_parted(mine, theirs, within)
    if index < 0:
        return True
    left = instants[index:]
    begin, end = left[: max(len(left) - 1, 1)], np.append(left[1:-1], np.inf)
    together = (begin[:, None] <= end[None] + SKEW) & (begin[None] <= end[:, None] + SKEW)
    return may_come_near(mine.beginning_at(index), theirs.beginning_at(index), within, together)


def _pass(track: Track, times: FloatArray, instants: FloatArray) -> Track:
    """Return the track through the poses at some instants [s], where the track has poses at times ``(k,)`` [s]."""
    poses = [track.at(float(phase)) for phase in np.interp(instants, times, range(len(times)))]
    return Track(
        track.body, np.array([each.position for each in poses]), np.array([each.orientation for each in poses])
    )

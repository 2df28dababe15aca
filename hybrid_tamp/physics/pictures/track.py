"""A camera that follows the action: it stands still during some steps of the plan, and glides between them."""

from collections.abc import Collection
from dataclasses import dataclass, replace

import numpy as np

from hybrid_tamp.model.plan import Step
from hybrid_tamp.model.recording import Recording
from hybrid_tamp.model.task import Task
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.minimum_jerk import minimum_jerk
from hybrid_tamp.physics.pictures.camera import Camera, Spheres, fit_camera
from hybrid_tamp.physics.pictures.subject import find_actors, spheres_of
from hybrid_tamp.physics.pictures.view import View

GLIDE = 0.5
"""Duration of a movement of the camera [s]."""
_GLIDE_COST = 1.5
"""Time [s] for which the action must be shown in twice the size to make up for one movement of the camera."""
_SHORTEST = 2.0
"""Time [s] for which the camera must stand still between two movements."""


@dataclass(frozen=True, eq=False)
class Track:
    """The views of a camera during a run.

    Attributes:
        views: views in the order of time. All have the same direction and size.
        changes: middle of each movement from one view to the next [s], one less than `views`.
    """

    views: tuple[View, ...]
    changes: tuple[float, ...]

    def at(self, time: float) -> View:
        """Return the view at a time [s]. What two successive views show is also visible between them."""
        view = self.views[0]
        for change, following in zip(self.changes, self.views[1:], strict=True):
            share = float(minimum_jerk((time - change) / GLIDE + 0.5))
            if share > 0:
                view = following if share == 1 else _mix(view, following, share)
        return view


def follow(task: Task, recording: Recording, overview: View) -> Track:
    """Return the track of a camera that comes nearer while the action takes place in a small part of the overview.

    A view shows the tokens and targets of all blocks other than resting. The last view shows all tokens that take part
    in the run. The views are chosen so that the action is large for a long time, with few movements of the camera.

    Args:
        task: the task of the run.
        recording: the recording of the run.
        overview: view that shows the whole run. Its direction and size are kept.
    """
    steps = tuple(recording.plan.steps)
    if not steps:
        return Track((overview,), ())
    points = [_points(task, recording, step) for step in steps]
    actors = sorted(find_actors(task, recording))
    points[-1] = np.concatenate([points[-1], _seen(task, recording, actors, steps[-1])])
    ends = [float(steps[0].start), *(float(step.end) for step in steps)]
    # Dynamic programming: the best track until the end of each step.
    best: list[tuple[float, Track]] = [(0.0, Track((), ()))]
    for last in range(1, len(ends)):
        found = []
        for first, (cost, before) in enumerate(best[:last]):
            duration = ends[last] - ends[first]
            if first > 0 and duration < _SHORTEST:
                break
            view = _frame(np.concatenate(points[first:last]), overview)
            smaller = float(np.log2(view.camera.distance / overview.camera.distance))
            track = Track((*before.views, view), (*before.changes, ends[first]) if first > 0 else ())
            found.append((cost + duration * smaller + _GLIDE_COST * (first > 0), track))
        best.append(min(found, key=lambda each: each[0]))
    return best[-1][1]


def _frame(points: FloatArray, overview: View) -> View:
    """Return the nearest view that shows points ``(n, 3)`` [m], or the overview if no view is nearer."""
    if len(points) == 0:
        return overview
    spheres = Spheres(points, np.zeros(len(points)))
    camera = fit_camera(spheres, overview.width / overview.height, overview.axes)
    return replace(overview, camera=camera) if camera.distance < overview.camera.distance else overview


def _points(task: Task, recording: Recording, step: Step) -> FloatArray:
    """Return points around the tokens and targets of all busy blocks during a step, shape ``(n, 3)`` [m]."""
    busy = [each for each in step.instances if each.block != task.domain.resting]
    return _seen(task, recording, [n for each in busy for n in each.roles.values() if n in task.token_by_name], step)


def _seen(task: Task, recording: Recording, names: Collection[str], step: Step) -> FloatArray:
    """Return points around tokens while the camera shows a step, shape ``(n, 3)`` [m]."""
    if not names:
        return np.zeros((0, 3))
    near = GLIDE / 2 + recording.timestep
    rows = (recording.times >= step.start - near) & (recording.times <= step.end + near)
    part = replace(recording, times=recording.times[rows], states=recording.states[rows])
    return spheres_of(task, part, set(names)).centres


def _mix(one: View, other: View, share: float) -> View:
    """Return the view between two views. The share of the other view is from 0 to 1."""
    eye, target = (
        (1 - share) * first + share * second
        for first, second in ((one.camera.eye, other.camera.eye), (one.camera.target, other.camera.target))
    )
    return replace(one, camera=Camera(eye, target))

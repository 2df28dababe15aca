"""The verb ``imitate`` (paper, Sec. II-E): an agent imitates another agent with the same capability classes.

The demonstration becomes a plan, which the imitator executes with motor primitives learnt from the demonstration.
"""

import logging
import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

from hybrid_tamp.errors import InputError, Issue
from hybrid_tamp.execution.storage import load_recording
from hybrid_tamp.model.imitation import FittedPrimitive, ImitationResult, Segmentation
from hybrid_tamp.model.law import check_law
from hybrid_tamp.model.outcome import PlannerFigures, PlanningFailure, PlanOutcome
from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.model.planned_network import PlannedNetwork
from hybrid_tamp.model.recording import demonstrated_movements
from hybrid_tamp.model.state import State, StateLayout
from hybrid_tamp.model.task import Task
from hybrid_tamp.planning.replanning import Progress
from hybrid_tamp.questions.imitate.observation import ALLOWANCE, Observation, Shown
from hybrid_tamp.questions.imitate.segmentation import segment
from hybrid_tamp.questions.imitate.transfer import KIND, Transfer, transfer
from hybrid_tamp.report.folder import RunFolder
from hybrid_tamp.taskfile.copying import teach_task
from hybrid_tamp.taskfile.domains import domains_beside
from hybrid_tamp.taskfile.loader import load_task
from hybrid_tamp.taskfile.pose_tables import read_poses
from hybrid_tamp.taskfile.primitives import PrimitiveFile
from hybrid_tamp.verbs.learn import fit_primitive
from hybrid_tamp.verbs.loading import Settings, domain_finder, load, load_timed
from hybrid_tamp.verbs.run import run

_WAY = "imitation"
_ALLOWANCE_OF_POSES = 1.0
"""Tolerance of margins for demonstrations in files, as a multiple of the scale. Poses in files are noisy and lack
velocities, so this tolerance is larger than for recordings of runs.
"""
_logger = logging.getLogger(__name__)


def imitate(
    shown: Path | Shown,
    source: Task | Path | str,
    folder: RunFolder | Path | str,
    settings: Settings = Settings(),  # noqa: B008
    *,
    actor: Task | Path | str | None = None,
    backend: str = "pybullet",
    force: bool = False,
    progress: Progress = lambda share, what: None,
    on_segmentation: Callable[[Segmentation], None] = lambda segmentation: None,
) -> ImitationResult:
    """Imitate a demonstration by another agent.

    Args:
        shown: the demonstration, which is the folder of a run, a file of token poses, or a result of `read_shown`.
        source: the imitator's task, the path of its file, or the name of a bundled task.
        folder: folder for the files of the run.
        settings: settings that override the task file.
        actor: the demonstrator's task if the demonstration is a file of poses; by default the imitator's task.
        backend: name of the physics backend.
        force: whether to replace the files of another run.
        progress: called with the completed fraction of the work and the name of the current activity.
        on_segmentation: called with the segmented demonstration before the run starts.

    Raises:
        NoPlan: the imitator cannot execute the demonstrated plan; the message gives the reason.
        InputError: a task or the demonstration is wrong, the folder is in use, or the backend is unknown.
        LimitReached: the time limit of the imitator's task was reached.
        NotFinite: every rollout of the plan failed.
    """
    task, deadline = load_timed(source, settings)
    seen = shown if isinstance(shown, Shown) else read_shown(shown, task, settings, actor)
    target = RunFolder.open(folder, force=force)
    progress(0.0, "segmenting")
    segmentation = segment(seen.task, seen.observation, deadline)
    on_segmentation(segmentation)
    segmented = time.monotonic()
    with TemporaryDirectory() as temporary:
        primitives = _learn_primitives(seen, segmentation.plan, task)
        find_domain = domain_finder(settings.domain) or domains_beside(Path(task.source or ".").parent)
        taught = teach_task(task, primitives, Path(temporary), find_domain)
        moved = transfer(seen.task, segmentation.plan, taught, deadline)
        find_plan = partial(_outcome, moved=moved, seconds=time.monotonic() - segmented)
        result = run(taught, target, backend=backend, progress=progress, find_plan=find_plan, deadline=deadline)
    fitted = {name: FittedPrimitive(each.rms, each.unit) for name, each in primitives.items()}
    return ImitationResult(seen.source, segmentation, moved.roles, fitted, result)


def read_shown(
    path: Path,
    task: Task,
    settings: Settings = Settings(),  # noqa: B008
    actor: Task | Path | str | None = None,
) -> Shown:
    """Read a demonstration.

    Args:
        path: the folder of a run, or a file of token poses.
        task: the imitator's task, which is also the demonstrator's task if `path` is a file and `actor` is None.
        settings: settings that override the task file.
        actor: the demonstrator's task if `path` is a file and the demonstrator has another task than the imitator.

    Raises:
        InputError: the folder has no complete run, or the file is wrong.
    """
    if not path.is_dir():
        demonstrator, allowance = task if actor is None else load(actor, settings), _ALLOWANCE_OF_POSES
        times, states, noise = read_poses(path, demonstrator)
    else:
        recording, allowance, noise = load_recording(path / "recording.npz"), ALLOWANCE, None
        demonstrator = load_task(path / "task.yaml", domain_finder(settings.domain))
        layout = StateLayout.of(demonstrator.tokens)
        if recording.layout != layout:
            raise InputError([Issue(str(path), "the recording must contain the tokens of task.yaml", "other tokens")])
        times, states = recording.times, State(layout, recording.states)
    observation = Observation.of(times, states, allowance, noise)
    return Shown(path.name, demonstrator.replaced(state=observation.at(0.0)), observation)


def _learn_primitives(shown: Shown, plan: TaskPlan, task: Task) -> dict[str, PrimitiveFile]:
    """Return a primitive for each demonstrated block whose movements can be learnt."""
    found = {}
    for name in sorted({instance.block for instance in plan.instances}):
        block = shown.task.domain.block_by_name[name]
        if block.taught is None or block.movement is None or name not in task.domain.block_by_name:
            continue
        instances = [instance for instance in plan.instances if instance.block == name]
        seen = shown.observation
        try:
            movements = demonstrated_movements(shown.source, seen.times, seen.trajectory, instances, block.movement)
            found[name] = fit_primitive(name, list(movements), block.movement)
        except InputError as error:
            _logger.warning("%s keeps the domain's motor primitive, because no primitive was learnt: %s", name, error)
    return found


def _outcome(task: Task, moved: Transfer, seconds: float) -> PlanOutcome:
    """Return an outcome with the transferred plan, or a failed outcome if the plan does not solve the task."""
    outcome = PlanOutcome(task, PlannerFigures(_WAY, seconds, _WAY), PlannedNetwork.of(task, task))
    breaches = check_law(task, moved.plan)
    if breaches:
        detail = f"the demonstrated plan does not solve the task: {breaches[0].text}"
        return replace(outcome, failure=PlanningFailure(KIND, detail))
    return replace(outcome, plan=moved.plan, chosen=moved.task)

"""Imitation (paper, Sec. II-E): one agent is seen to act, another one with the same capability classes does likewise.

What was shown -> segmentation -> primitives and a plan for the other agent -> a run of it.
"""

import logging
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

from hybrid_tamp.errors import InputError, Issue
from hybrid_tamp.model.demonstrated import demonstrated_movements
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.law import check_law
from hybrid_tamp.model.outcome import PlannedNetwork, PlannerFigures, PlanningFailure, PlanOutcome
from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.model.run_result import RunResult
from hybrid_tamp.model.state import State, StateLayout
from hybrid_tamp.model.task import Task
from hybrid_tamp.planning.replanning import Progress
from hybrid_tamp.questions.imitate.observation import ALLOWANCE, Observation
from hybrid_tamp.questions.imitate.segmentation import Segmentation, segment
from hybrid_tamp.questions.imitate.transfer import KIND, transfer
from hybrid_tamp.report.folder import RunFolder
from hybrid_tamp.taskfile.copying import portable
from hybrid_tamp.taskfile.domains import installed_domain
from hybrid_tamp.taskfile.loader import load_task
from hybrid_tamp.taskfile.pose_tables import read_poses
from hybrid_tamp.taskfile.primitives import PrimitiveFile
from hybrid_tamp.taskfile.yaml.nodes import parse
from hybrid_tamp.verbs.learn import fit_primitive, save_primitive
from hybrid_tamp.verbs.run import run

_WAY = "imitation"
_ALLOWANCE_OF_POSES = 1.0
"""A file says nothing of velocities, and poses are noted with noise."""
_logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class Shown:
    """What an agent was seen to do.

    Attributes:
        source: where it comes from.
        task: the demonstrator's task, as it stood at first.
        observation: the states over time.
    """

    source: str
    task: Task
    observation: Observation


@dataclass(frozen=True)
class Imitation:
    """What came of an imitation.

    Attributes:
        roles: token that was seen to the token that took its role.
        primitives: block to the motor primitive that it was taught.
        result: of the run.
    """

    roles: Mapping[str, str]
    primitives: Mapping[str, PrimitiveFile]
    result: RunResult


def read_shown(
    path: Path, task: Task, find_domain: Callable[[str], Domain] = installed_domain, actor: Task | None = None
) -> Shown:
    """Read what was shown.

    Args:
        path: the folder of a run, of which only the states over time and the task are read; or a file of tokens' poses.
        task: the task whose tokens a file names, if no other one is given.
        find_domain: how the domain is found that a run's task file names.
        actor: the demonstrator's task, for a file.

    Raises:
        InputError: the folder holds no run, or the file is wrong.
    """
    allowance, noise = ALLOWANCE, None
    if not path.is_dir():
        actor, allowance = actor or task, _ALLOWANCE_OF_POSES
        times, states, noise = read_poses(path, actor)
    else:
        from hybrid_tamp.execution.storage import load

        recording = load(path / "recording.npz")
        actor = load_task(path / "task.yaml", find_domain)
        layout = StateLayout.of(actor.tokens)
        if recording.layout != layout:
            raise InputError([Issue(str(path), "a recording of the tokens of its task.yaml", "one of other tokens")])
        times, states = recording.times, State(layout, recording.states)
    observation = Observation.of(times, states, allowance, noise)
    return Shown(path.name, actor.replaced(state=observation.at(0.0)), observation)


def segmented(shown: Shown) -> Segmentation:
    """Return what was shown, in words of the domain."""
    return segment(shown.task, shown.observation)


def imitate(
    shown: Shown,
    segmentation: Segmentation,
    task: Task,
    folder: RunFolder,
    *,
    backend: str = "pybullet",
    progress: Progress | None = None,
    find_domain: Callable[[str], Domain] = installed_domain,
) -> Imitation:
    """Do as was shown.

    Args:
        shown: what an agent was seen to do.
        segmentation: the same, in words of the domain.
        task: the imitator's task.
        folder: where the files of the run go.
        backend: name of the physics backend.
        progress: told how far the work is.
        find_domain: how the domain is found that the task file names.

    Raises:
        NoPlan: what was shown cannot be done so by the imitator; the message says why.
        InputError: the backend is unknown.
        NotFinite: every rollout of the plan failed.
    """
    began = time.monotonic()
    with TemporaryDirectory() as temporary:
        primitives = _learnt(shown, segmentation.plan, task)
        taught = _taught(task, primitives, Path(temporary), find_domain)
        moved = transfer(shown.task, segmentation.plan, taught)
        seconds = time.monotonic() - began

        def find_plan(each: Task) -> PlanOutcome:
            return _outcome(each, moved.task, moved.plan, seconds)

        result = run(taught, folder, backend=backend, progress=progress, find_plan=find_plan)
    return Imitation(moved.roles, primitives, result)


def _learnt(shown: Shown, plan: TaskPlan, task: Task) -> dict[str, PrimitiveFile]:
    """Return the primitives of all blocks that were seen and can be taught."""
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
            _logger.warning("%s keeps its own motor primitive: %s", name, error)
    return found


def _taught(
    task: Task, primitives: Mapping[str, PrimitiveFile], folder: Path, find_domain: Callable[[str], Domain]
) -> Task:
    """Return the task with the primitives; what its file says of its own stays."""
    if not primitives:
        return task
    if task.source is None:
        blocks = [task.domain.block_by_name[name] for name in primitives]
        taught = [b.taught(primitives[b.name].primitive) for b in blocks if b.taught is not None]
        return task.replaced(domain=task.domain.with_blocks(taught))
    text, named = portable(task)
    if "primitives" in parse(text, str(task.source)).data:
        _logger.warning("%s names primitives itself: nothing is taught", task.source)
        return task
    lines = []
    for number, (name, primitive) in enumerate(primitives.items(), start=1):
        file = f"primitive-{number:02d}.json"
        save_primitive(primitive, folder / file)
        lines.append(f"  {name!r}: {file}\n".replace("'", '"'))
    for name, content in named.items():
        (folder / name).write_text(content, encoding="utf-8")
    path = folder / task.source.name
    path.write_text("".join([text.rstrip("\n"), "\n\nprimitives:\n", *lines]), encoding="utf-8")
    taught_task = load_task(path, find_domain)
    return replace(task, domain=taught_task.domain, source=path)


def _outcome(task: Task, chosen: Task, plan: TaskPlan, seconds: float) -> PlanOutcome:
    """Return the plan that was carried over as the outcome of planning a task, which may exclude it by now."""
    outcome = PlanOutcome(task, PlannerFigures(_WAY, seconds, _WAY), PlannedNetwork.of(task, task))
    breaches = check_law(task, plan)
    if breaches:
        return replace(outcome, failure=PlanningFailure(KIND, f"what was seen is no plan of the task: {breaches[0]}"))
    return replace(outcome, plan=plan, chosen=chosen)

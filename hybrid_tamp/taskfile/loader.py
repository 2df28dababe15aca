"""Load a task file as a task, or report every fault of the file at once."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from hybrid_tamp.errors import InputError
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Limits, MidLevel, Range, Task
from hybrid_tamp.taskfile.domains import find_task_file, installed_domain
from hybrid_tamp.taskfile.entries import MidLevelEntry, RangeEntry, TaskFile
from hybrid_tamp.taskfile.goals import read_goal
from hybrid_tamp.taskfile.midlevel import check_bindings, read_midlevel
from hybrid_tamp.taskfile.names import check_printable
from hybrid_tamp.taskfile.places import Faults, KeyPath
from hybrid_tamp.taskfile.primitives import teach
from hybrid_tamp.taskfile.roles import read_agents, read_assignment
from hybrid_tamp.taskfile.starts import check_starts
from hybrid_tamp.taskfile.tokens import read_scene
from hybrid_tamp.taskfile.wording import add_validation_faults
from hybrid_tamp.taskfile.yaml.nodes import check_size, parse, read_text

FindDomain = Callable[[str], Domain]
"""Name to domain; raises InputError for a name that it does not know."""
CheckPlanner = Callable[[str], None]
"""Raises InputError for the name of a planner that cannot be used."""


def load_task(
    source: Task | Path | str,
    find_domain: FindDomain = installed_domain,
    check_planner: CheckPlanner | None = None,
) -> Task:
    """Load a task file, or return the task that is given: every verb takes its task through this function.

    Args:
        source: a task, the path of a YAML file, or a text: a path or the name of a bundled task.
        find_domain: how the domain is found that the file names. The default knows installed domains only, so that
            no file can run code; `domains.find_domain` also takes modules and paths.
        check_planner: how the planner that the file names is checked, or None to leave that to whoever plans.

    Raises:
        InputError: everything that is wrong with the file, each fault with its line and column, in order.
    """
    if isinstance(source, Task):
        return source
    path = source if isinstance(source, Path) else find_task_file(source)
    return _load(read_text(path), str(path), path.stem, path, find_domain, check_planner)


def load_task_text(
    text: str,
    name: str,
    find_domain: FindDomain = installed_domain,
    check_planner: CheckPlanner | None = None,
) -> Task:
    """Load a task from the text of its file.

    Args:
        text: YAML.
        name: what messages call the text, and the task's name if the text does not say.
        find_domain: as in `load_task`.
        check_planner: as in `load_task`.

    Raises:
        InputError: as in `load_task`.
    """
    return _load(text, name, name, None, find_domain, check_planner)


def _load(
    text: str,
    source: str,
    name: str,
    path: Path | None,
    find_domain: FindDomain,
    check_planner: CheckPlanner | None,
) -> Task:
    check_size(len(text.encode("utf-8", "surrogatepass")), source)
    document = parse(text, source)
    folder = path.parent if path else Path()
    return read_task(document.data, document.faults, name, folder, find_domain, check_planner).replaced(source=path)


def read_task(
    data: dict[str, Any],
    faults: Faults,
    name: str,
    folder: Path,
    find_domain: FindDomain,
    check_planner: CheckPlanner | None = None,
) -> Task:
    """Return the task that plain data in the form of a task file describe.

    Args:
        data: keys to lists, mappings, texts and numbers, as a task file has them.
        faults: the places of its parts, and the faults found so far.
        name: the task's name if the data do not say.
        folder: what the paths in it are relative to.
        find_domain: as in `load_task`.
        check_planner: as in `load_task`.

    Raises:
        InputError: everything that is wrong with the data.
    """
    file = _check_form(data, faults)
    domain = read_midlevel(data, faults, teach(data, faults, _find(data, faults, find_domain), folder))
    scene = read_scene(data, faults, domain, folder)
    goal = read_goal(data, faults, domain, scene)
    agents = read_agents(data, faults, scene)
    assignment = read_assignment(data, faults, domain, scene)
    check_starts(data, faults, scene)
    _check_planner(data, faults, check_planner)
    faults.raise_if_any()
    assert file is not None
    assert domain is not None
    task = Task(
        name=file.name or name,
        domain=domain,
        tokens=tuple(scene.tokens),
        state=State.of(scene.tokens, scene.given),
        goal=goal,
        agents=agents,
        assignment=assignment,
        planner=file.planner,
        limits=Limits(**dict(file.limits)),
        seed=file.seed,
        objective=file.objective,
        midlevel=_midlevel(file.midlevel),
        primitives={key: (folder / named).absolute() for key, named in file.primitives.items()},
    )
    check_bindings(task, data, faults)
    _check_choices(task, faults)
    faults.raise_if_any()
    return task


def _midlevel(entry: MidLevelEntry) -> MidLevel:
    ranges = {
        key: Range(**dict(said)) if isinstance(said, RangeEntry) else said
        for key, said in entry.hyperparameters.items()
    }
    return MidLevel(**{**dict(entry), "hyperparameters": ranges})


def _check_form(data: dict[str, Any], faults: Faults) -> TaskFile | None:
    if isinstance(data.get("name"), str):
        check_printable(data["name"], ("name",), faults, "a task needs a name", key=False)
    try:
        return TaskFile.model_validate(data)
    except ValidationError as error:
        add_validation_faults(faults, error, TaskFile)
        return None


def _find(data: dict[str, Any], faults: Faults, find_domain: FindDomain) -> Domain | None:
    path = ("domain",)
    if "domain" not in data or not faults.sound(path):
        return None
    try:
        return find_domain(data["domain"])
    except InputError as error:
        _place(error, path, faults)
        return None


def _check_planner(data: dict[str, Any], faults: Faults, check_planner: CheckPlanner | None) -> None:
    path = ("planner",)
    if check_planner is None or "planner" not in data or not faults.sound(path):
        return
    try:
        check_planner(data["planner"])
    except InputError as error:
        _place(error, path, faults)


def _check_choices(task: Task, faults: Faults) -> None:
    """Note a goal that leaves too many choices, or none."""
    try:
        task.alternatives()
    except InputError as error:
        _place(error, ("goal",), faults)


def _place(error: InputError, path: KeyPath, faults: Faults) -> None:
    """Note at a place of the file what is wrong with the domain, planner or goal named there."""
    for issue in error.issues:
        wanted = issue.wanted if issue.where in ("", *path) else f"{issue.where}: {issue.wanted}"
        faults.at(path, wanted, issue.came, issue.available, issue.remedy)

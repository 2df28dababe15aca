"""Load a task file as a task, or report all faults of the file together."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.state import State
from hybrid_tamp.model.support import with_grounds
from hybrid_tamp.model.task import Limits, MidLevel, Range, Task
from hybrid_tamp.taskfile.domains import domains_beside, find_task_file
from hybrid_tamp.taskfile.entries import MidLevelEntry, RangeEntry, TaskFile
from hybrid_tamp.taskfile.goals import read_goal
from hybrid_tamp.taskfile.midlevel import check_bindings, read_midlevel
from hybrid_tamp.taskfile.names import check_printable
from hybrid_tamp.taskfile.places import Faults, KeyPath
from hybrid_tamp.taskfile.primitives import teach
from hybrid_tamp.taskfile.roles import read_agents, read_assignment
from hybrid_tamp.taskfile.safety import read_safety
from hybrid_tamp.taskfile.starts import check_starts, check_still, put_on_grounds
from hybrid_tamp.taskfile.tokens import read_scene
from hybrid_tamp.taskfile.wording import add_validation_faults
from hybrid_tamp.taskfile.yaml.nodes import parse, read_text

FindDomain = Callable[[str], Domain]
"""Function that returns the domain with the given name, or raises InputError if the name is unknown."""
CheckPlanner = Callable[[str], None]
"""Function that raises InputError if the planner with the given name cannot be used."""


def load_task(
    source: Task | Path | str, find_domain: FindDomain | None = None, check_planner: CheckPlanner | None = None
) -> Task:
    """Load a task file. If `source` is already a task, return this task.

    Args:
        source: a task, the path of a YAML file, or the name of a bundled task.
        find_domain: function that finds the domain by the name in the file. The default finds installed domains and the
            domain in the file ``domain.py`` beside the task file. A task file can name no other code.
            `domains.find_domain` also finds modules and Python files.
        check_planner: function that checks the name of the planner in the file. If None, the name is not checked.

    Raises:
        InputError: the file has faults; the issues list all faults with their lines and columns, in order. Or a fixed
            body of a task has a velocity.
    """
    if isinstance(source, Task):
        check_still(source)
        tokens = with_grounds(source.tokens, source.state)
        return source if tokens == source.tokens else source.replaced(tokens=tokens)
    path = source if isinstance(source, Path) else find_task_file(source)
    document = parse(read_text(path), str(path))
    finder = find_domain or domains_beside(path.parent)
    task = read_task(document.data, document.faults, path.stem, path.parent, finder, check_planner)
    return task.replaced(source=path)


def read_task(
    data: dict[str, Any],
    faults: Faults,
    name: str,
    folder: Path,
    find_domain: FindDomain,
    check_planner: CheckPlanner | None = None,
) -> Task:
    """Return the task described by the data of a task file.

    Args:
        data: mapping with the keys of a task file.
        faults: the places of the values, and the faults found so far.
        name: name of the task if the data have no name.
        folder: folder to which relative paths in the data refer.
        find_domain: see `load_task`.
        check_planner: see `load_task`.

    Raises:
        InputError: the data have faults; the issues list all faults.
    """
    file = _check_form(data, faults)
    found = teach(data, faults, _find(data, faults, find_domain), folder)
    domain = read_safety(data, faults, read_midlevel(data, faults, found))
    scene = read_scene(data, faults, domain, folder)
    put_on_grounds(data, faults, scene)
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
        goal=tuple(goal),
        agents=agents,
        assignment=assignment,
        planner=file.planner,
        limits=Limits(**dict(file.limits)),
        seed=file.seed,
        objective=file.objective,
        midlevel=_midlevel(file.midlevel),
        safety=file.safety,
        primitives={key: (folder / named).absolute() for key, named in file.primitives.items()},
    )
    return _checked(task, data, faults, goal)


def _checked(task: Task, data: dict[str, Any], faults: Faults, goal: Mapping[Atom, KeyPath]) -> Task:
    check_bindings(task, data, faults)
    with faults.collecting(("goal",)):
        # Raises InputError if a wildcard of the goal has no value, or if the wildcards have too many combinations.
        alternatives = task.alternatives()
    faults.raise_if_any()
    crowdings = [each.crowding() for each in alternatives]
    if crowdings and crowdings[0] is not None and None not in crowdings:
        path = goal.get(crowdings[0].atom, ("goal", 0))
        wanted = "the goal must leave enough room for each body" + (", for at least one choice" * (len(crowdings) > 1))
        faults.at(path[:2], wanted, crowdings[0].text)
    faults.raise_if_any()
    return task


def _midlevel(entry: MidLevelEntry) -> MidLevel:
    ranges = {k: Range(**dict(v)) if isinstance(v, RangeEntry) else v for k, v in entry.hyperparameters.items()}
    return MidLevel(**{**dict(entry), "hyperparameters": ranges})


def _check_form(data: dict[str, Any], faults: Faults) -> TaskFile | None:
    if isinstance(data.get("name"), str):
        check_printable(data["name"], ("name",), faults, "the name of a task", key=False)
    try:
        return TaskFile.model_validate(data)
    except ValidationError as error:
        add_validation_faults(faults, error, TaskFile)
        return None


def _find(data: dict[str, Any], faults: Faults, find_domain: FindDomain) -> Domain | None:
    if "domain" in data and faults.sound(("domain",)):
        with faults.collecting(("domain",)):
            return find_domain(data["domain"])
    return None


def _check_planner(data: dict[str, Any], faults: Faults, check_planner: CheckPlanner | None) -> None:
    if check_planner is not None and "planner" in data and faults.sound(("planner",)):
        with faults.collecting(("planner",)):
            check_planner(data["planner"])

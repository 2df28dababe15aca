"""The verb ``check-domain``: find the mistakes in a domain with the tasks beside its file."""

from collections.abc import Callable, Sequence
from pathlib import Path

from hybrid_tamp.errors import InputError, Issue
from hybrid_tamp.model.bindings import enumerate_bindings
from hybrid_tamp.model.disagreement import Disagreement, DomainReport
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.task import Task
from hybrid_tamp.taskfile.domains import find_domain
from hybrid_tamp.taskfile.loader import load_task
from hybrid_tamp.taskfile.yaml.nodes import parse, read_text
from hybrid_tamp.testing import check_domain

Tell = Callable[[float, str], None]
"""Callback that receives the completed fraction of the work and the name of the current activity."""


def check_domain_file(
    name: str,
    tasks: Sequence[str] = (),
    *,
    samples: int = 8,
    seed: int = 0,
    simulate: bool = True,
    tell: Tell = lambda share, what: None,
) -> DomainReport:
    """Check a domain with tasks of its own.

    Args:
        name: path of a Python file, ``package.module:ATTRIBUTE``, or an installed domain.
        tasks: task files or names of bundled tasks. By default, all task files in the folder of the Python file that
            name the domain.
        samples: see `hybrid_tamp.testing.check_domain`.
        seed: see `hybrid_tamp.testing.check_domain`.
        simulate: see `hybrid_tamp.testing.check_domain`.
        tell: called with the progress.

    Raises:
        InputError: the domain cannot be imported, its declarations contradict each other, a task has faults, or there
            is no task.
    """
    domain = find_domain(name)
    sources: list[Path | str] = [*tasks] or [*_tasks_beside(name, domain)]
    if not sources:
        wanted = f"the check needs a task of the domain {domain.name}"
        remedy = "write a task file with this domain into the folder of the domain's file, or name a task with --task"
        raise InputError([Issue(name, wanted, "no task", remedy=remedy)])
    loaded = [load_task(source, lambda _: domain) for source in sources]
    found: list[tuple[Task, list[Disagreement]]] = []
    for number, task in enumerate(loaded):
        tell(number / len(loaded), f"checking {domain.name} with {task.name}")
        found.append((task, check_domain(task, samples=samples, seed=seed, simulate=simulate)))
    return DomainReport(domain.name, tuple(task.name for task in loaded), len(domain.blocks), _merge(found))


def _merge(found: Sequence[tuple[Task, Sequence[Disagreement]]]) -> tuple[tuple[str, Disagreement], ...]:
    """Return the mistakes, each with the first task that shows the mistake.

    A block that cannot be entered in some tasks is no mistake if the block can be entered in another task.
    """
    mistakes: dict[tuple[str, str, str], tuple[str, Disagreement]] = {}
    for task, every in found:
        for each in every:
            if each.kind == "entry" and any(_was_entered(each.block, *other) for other in found):
                continue
            mistakes.setdefault((each.kind, each.block, each.declared), (task.name, each))
    return tuple(mistakes.values())


def _was_entered(name: str, task: Task, every: Sequence[Disagreement]) -> bool:
    """Return whether a block was entered in the check with a task, which must have tokens for the block."""
    block = task.domain.block_by_name[name]
    closed = any(each.kind == "entry" and each.block == name for each in every)
    return not closed and any(enumerate_bindings(task.choices(block)))


def _tasks_beside(name: str, domain: Domain) -> list[Path]:
    """Return the task files in the folder of a domain's Python file that name the domain, sorted by name."""
    if not name.endswith(".py"):
        return []
    files = sorted(Path(name).parent.glob("*.yaml"))
    return [file for file in files if parse(read_text(file), str(file)).data.get("domain") == domain.name]

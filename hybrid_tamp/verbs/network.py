"""The verb ``network``: find the reassignment network of a domain or task, and draw the network."""

from collections.abc import Collection
from dataclasses import replace
from pathlib import Path

from hybrid_tamp.errors import InputError, Issue
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.outcome import PlanOutcome
from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.model.task import Task
from hybrid_tamp.planning.plan import tailor_network
from hybrid_tamp.report.drawing.diagram import Mark, make_diagram
from hybrid_tamp.report.drawing.file import check_drawing, write_drawing
from hybrid_tamp.taskfile.domains import available_domains, find_domain
from hybrid_tamp.verbs.loading import Settings, load
from hybrid_tamp.verbs.plan import plan as plan_task


def network(
    name: str,
    settings: Settings = Settings(),  # noqa: B008
    *,
    file: Path | None = None,
    reduced: bool = False,
    plan: bool = False,
    force: bool = False,
) -> Domain:
    """Return a domain with its network, and draw the network if a file is given.

    Args:
        name: an installed domain, ``package.module:ATTRIBUTE``, a Python file, or a task.
        settings: settings that override the task file.
        file: file for the drawing. Its suffix determines the format: ``.svg``, ``.png``, ``.dot`` or ``.mmd``.
        reduced: whether to omit the blocks that the task does not need. The returned domain then has fewer blocks.
        plan: whether to plan the task and to mark the paths of its tokens in the drawing.
        force: whether to replace the file if the file exists.

    Raises:
        InputError: no domain or task has this name, the domain or task has faults, or the file cannot be written.
        NoPlan: there is no plan whose paths can be marked.
        LimitReached: planning reached a time or memory limit.
    """
    if file is not None:
        check_drawing(file, force=force)
    task = None if _names_domain(name) else load(name, settings, plans=plan)
    if task is None and (reduced or plan):
        wanted = (
            "a domain has no tokens and no goal, so only the network of a task can be reduced or marked with a plan"
        )
        raise InputError([Issue("", wanted, name, remedy="give a task instead of the domain")])
    domain = find_domain(name) if task is None else task.domain
    outcome = plan_task(task, settings) if task is not None and plan else None
    marks = () if task is None or outcome is None else trace_tokens(task, outcome.required())
    if task is not None and reduced:
        domain = _with_blocks(domain, _needed_blocks(task, outcome))
    if file is not None:
        write_drawing(make_diagram(domain, marks), file)
    return domain


def trace_tokens(task: Task, plan: TaskPlan) -> tuple[Mark, ...]:
    """Return the paths of all tokens that leave their first slot during a plan."""
    steps = {
        instance.name: [step.index for step in plan.steps if instance in step.instances] for instance in plan.instances
    }
    marks = []
    for token in task.assigned:
        path = [(each, slot) for each, slot in plan.timeline(token.name) if steps[each.name]]
        if len(path) > 1:
            slots = tuple((instance.block, slot) for instance, slot in path)
            marks.append(Mark(token.name, slots, tuple((min(s), max(s)) for s in (steps[i.name] for i, _ in path))))
    return tuple(marks)


def _names_domain(name: str) -> bool:
    return name in available_domains() or name.endswith(".py") or ":" in name


def _needed_blocks(task: Task, outcome: PlanOutcome | None) -> tuple[str, ...]:
    """Return the names of the blocks in the network with which planning begins or, with an outcome, ended."""
    return (tailor_network(task) if outcome is None else outcome.network).blocks


def _with_blocks(domain: Domain, names: Collection[str]) -> Domain:
    """Return the domain with only some of its blocks. It keeps its classes, so that the colours do not change."""
    blocks = tuple(block for block in domain.blocks if block.name in names)
    return replace(domain, blocks=blocks, network=domain.network.restrict(names), reduced=True)

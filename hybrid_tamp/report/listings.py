"""Tables and documents of the bundled tasks, the planning engines, and the results of several engines."""

from collections.abc import Iterable

from rich.console import RenderableType
from rich.text import Text

from hybrid_tamp.model.listings import BundledTask, EngineResult, InstalledEngine
from hybrid_tamp.report.documents import Json
from hybrid_tamp.report.tables import new_table


def tasks_document(tasks: Iterable[BundledTask]) -> Json:
    """Return a document with the name, domain, description and path of each task."""
    entries = [{**vars(each), "path": str(each.path)} for each in tasks]
    return {"schema": "hybrid-tamp/tasks/1", "tasks": entries}


def tasks_table(tasks: Iterable[BundledTask]) -> RenderableType:
    """Return a table with one row per task."""
    table = new_table("", "|task", "|domain", "description", framed=False)
    for each in tasks:
        table.add_row(*map(Text, (each.name, each.domain, each.description)))
    return table


def planners_document(engines: Iterable[InstalledEngine]) -> Json:
    """Return a document with the properties of each engine."""
    return {"schema": "hybrid-tamp/planners/1", "planners": [vars(each) for each in engines]}


def planners_table(engines: Iterable[InstalledEngine]) -> RenderableType:
    """Return a table with one row per engine."""
    table = new_table("", "|planner", "version", "plans", "no plan", "to install", framed=False)
    for each in engines:
        unsolvable = "proven" if each.proves else "not proven"
        table.add_row(*map(Text, (each.name, each.version or "-", each.length, unsolvable, each.remedy)))
    return table


def comparison_document(task: str, results: Iterable[EngineResult]) -> Json:
    """Return a document with the result of each engine for a task."""
    return {"schema": "hybrid-tamp/compare-planners/1", "task": task, "results": [vars(each) for each in results]}


def comparison_of_planners(task: str, results: Iterable[EngineResult]) -> RenderableType:
    """Return a table with one row per engine."""
    headings = ("|planner", "status", ">actions", ">makespan [s]", ">planning [s]", "")
    table = new_table(f"Plans of {task}", *headings, framed=False)
    for each in results:
        times = ("-" if time is None else f"{time:.2f}" for time in (each.makespan, each.seconds))
        table.add_row(
            *map(Text, (each.planner, each.status or "refused", str(each.actions or "-"), *times, each.message))
        )
    return table

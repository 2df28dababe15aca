"""The command line: arguments, printing, exit codes. Nothing heavy is imported before it is needed."""

import logging
import sys
from collections.abc import Callable
from enum import Enum
from importlib import metadata
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, cast

import typer

from hybrid_tamp.console import explain, output_failed, print_json, report_error, say, show
from hybrid_tamp.errors import HybridTampError, InputError, Issue

if TYPE_CHECKING:
    from hybrid_tamp.model.domain import Domain
    from hybrid_tamp.model.task import Task

app = typer.Typer(
    name="hybrid-tamp",
    help="Plan a manipulation task, export its PDDL, run it in physics, or learn why it cannot be done.",
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)


class Objective(str, Enum):
    """What a plan should be short in."""

    length = "length"
    makespan = "makespan"


TaskArgument = Annotated[str, typer.Argument(metavar="TASK", help="a YAML task file, or the name of a bundled one")]
JsonOption = Annotated[bool, typer.Option("--json", help="print one JSON document and nothing else")]
PlannerOption = Annotated[str | None, typer.Option("--planner", metavar="NAME", help="planning engine")]
SeedOption = Annotated[int | None, typer.Option("--seed", min=0, max=2**32 - 1, help="seed of everything random")]
TimeOption = Annotated[float | None, typer.Option("--time-limit", min=0.001, help="of the planner [s]")]
MemoryOption = Annotated[float | None, typer.Option("--memory-limit", min=1, help="of the planner [MiB]")]
DomainOption = Annotated[
    str | None,
    typer.Option("--domain", metavar="NAME", help="use this domain: a name, package.module:ATTRIBUTE, or a .py file"),
]
ObjectiveOption = Annotated[Objective | None, typer.Option("--objective", help="what a plan should be short in")]
ForceOption = Annotated[bool, typer.Option("--force", help="replace another run in the output folder")]


class Encoding(str, Enum):
    """How blocks become planning actions."""

    classical = "classical"
    temporal = "temporal"


class Document(str, Enum):
    """Documents whose JSON Schema can be printed."""

    task = "task"
    plan = "plan"
    result = "result"


def _version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"hybrid-tamp {metadata.version('hybrid-tamp')}")
        raise typer.Exit


@app.callback()
def _options(
    verbose: Annotated[bool, typer.Option("--verbose", "-v", help="log what is done to standard error")] = False,
    version: Annotated[
        bool, typer.Option("--version", help="print the version", is_eager=True, callback=_version)
    ] = False,
) -> None:
    level = logging.INFO if verbose else logging.WARNING
    logging.basicConfig(level=level, format="%(levelname)s %(name)s: %(message)s", stream=sys.stderr)


@app.command()
def check(task: TaskArgument, as_json: JsonOption = False, domain: DomainOption = None) -> None:
    """Check a task file: every fault at once, each with its place and what would be right."""
    loaded = _load(task, domain, plans=True)
    summary = {
        "schema": "hybrid-tamp/check/1",
        "task": loaded.name,
        "domain": loaded.domain.name,
        "tokens": len(loaded.tokens),
        "goal": [str(atom) for atom in loaded.goal],
        "status": "ok",
    }
    say(summary, as_json, lambda: f"{loaded.source}: ok, {len(loaded.tokens)} tokens of {loaded.domain.name}")


@app.command()
def plan(
    task: TaskArgument,
    as_json: JsonOption = False,
    domain: DomainOption = None,
    planner: PlannerOption = None,
    objective: ObjectiveOption = None,
    output: Annotated[Path | None, typer.Option("-o", "--output", help="folder for plan.json and PDDL")] = None,
    force: ForceOption = False,
    seed: SeedOption = None,
    time_limit: TimeOption = None,
    memory_limit: MemoryOption = None,
) -> None:
    """Plan a task; show the checked plan, or why there is none."""
    from hybrid_tamp.symbolic.planner import PlannerProcess

    # The planner's process warms up while the task file is read.
    with PlannerProcess() as process:
        loaded = _adjusted(_load(task, domain, plans=not planner), planner, objective, seed, time_limit, memory_limit)
        from hybrid_tamp import pipeline
        from hybrid_tamp.report.folder import RunFolder

        folder = RunFolder.create(output, force=force) if output else None
        outcome = pipeline.plan(loaded, process)
    if folder:
        pipeline.save_plan(outcome, folder)
    if as_json:
        print_json(outcome.document.dump())
    elif outcome.plan is not None:
        from hybrid_tamp.report.tables import plan_footer, plan_table, timeline

        show(plan_table(outcome.document))
        show(timeline(outcome.plan, [token.name for token in loaded.assigned]))
        typer.echo(plan_footer(outcome.document))
    if outcome.error is not None:
        explain(outcome.document.explanation, as_json)
        raise typer.Exit(outcome.error.exit_status)


@app.command()
def pddl(
    task: TaskArgument,
    output: Annotated[Path, typer.Option("-o", "--output", help="folder for domain.pddl and problem.pddl")],
    as_json: JsonOption = False,
    domain: DomainOption = None,
    force: ForceOption = False,
    encoding: Annotated[
        Encoding, typer.Option("--encoding", help="slot by slot without time, or one durative action a block")
    ] = Encoding.classical,
    solve: Annotated[bool, typer.Option("--solve", help="plan the task, too, and write plan.pddl")] = False,
) -> None:
    """Write the task as PDDL that any planner reads."""
    loaded = _load(task, domain)
    from hybrid_tamp import pipeline
    from hybrid_tamp.report.folder import RunFolder

    folder = RunFolder.create(output, force=force)
    plan = pipeline.plan(loaded).required() if solve else None
    files = [str(path) for path in pipeline.export(loaded, folder, plan, encoding.value)]
    document = {"schema": "hybrid-tamp/pddl/1", "task": loaded.name, "encoding": encoding.value, "files": files}
    say(document, as_json, lambda: "\n".join(files))


@app.command()
def run(
    task: TaskArgument,
    output: Annotated[Path, typer.Option("-o", "--output", help="folder for the files of the run")],
    as_json: JsonOption = False,
    domain: DomainOption = None,
    planner: PlannerOption = None,
    objective: ObjectiveOption = None,
    backend: Annotated[str, typer.Option("--backend", metavar="NAME", help="physics backend")] = "pybullet",
    video: Annotated[Path | None, typer.Option("--video", metavar="FILE.mp4", help="draw a video")] = None,
    force: ForceOption = False,
    seed: SeedOption = None,
    time_limit: TimeOption = None,
    memory_limit: MemoryOption = None,
) -> None:
    """Plan a task and carry the plan out in physics; record it and judge it."""
    from hybrid_tamp.symbolic.planner import PlannerProcess

    with PlannerProcess() as process:
        loaded = _adjusted(_load(task, domain, plans=not planner), planner, objective, seed, time_limit, memory_limit)
        from hybrid_tamp import pipeline
        from hybrid_tamp.report.folder import RunFolder
        from hybrid_tamp.report.progress import progress_bar

        folder = RunFolder.create(output, force=force)
        with progress_bar() as progress:
            outcome = pipeline.run(loaded, folder, planner=process, backend=backend, video=video, progress=progress)
    document = outcome.document
    if as_json:
        print_json(document.dump())
    else:
        from hybrid_tamp.report.tables import plan_table, result_table

        show(plan_table(outcome.plan.document))
        show(result_table(document))
        if video:
            typer.echo(f"video: {video}")
        typer.echo(f"files: {output}")
    if document.failure is not None:
        typer.echo(f"step {document.failure.step}, {document.failure.instance}: {document.failure.reason}", err=True)
    for breach in document.law:
        typer.echo(f"the recording breaks {breach}", err=True)
    if not document.success or document.law:
        typer.echo("The plan was run and the goal was not reached.", err=True)
        raise typer.Exit(40)
    if not as_json:
        typer.echo(f"The goal was reached after {document.sim_seconds:.2f} s of simulated time.")


@app.command()
def replay(
    directory: Annotated[Path, typer.Argument(metavar="DIR", help="the folder that a run left")],
    as_json: JsonOption = False,
    domain: DomainOption = None,
) -> None:
    """Run the recorded commands again and say whether the same happened, bit for bit."""
    from hybrid_tamp import pipeline

    report = pipeline.replay(directory, _finder(domain))
    difference = report.first_difference
    document = {
        "schema": "hybrid-tamp/replay/1",
        "directory": str(directory),
        "identical": report.identical,
        "steps": report.steps,
        "first_difference": None if difference is None else dict(difference.__dict__),
        "refusal": report.refusal,
    }
    if report.identical:
        said = f"{directory}: {report.steps} steps run again, bit-identical"
    elif difference is not None:
        said = (
            f"{directory}: not identical; first at {difference.time:.4f} s, {difference.property} of "
            f"{difference.token} differs by {difference.size:.3g}"
        )
    else:
        said = f"{directory}: not identical; {report.refusal}"
    say(document, as_json, lambda: said)
    if not report.identical:
        raise typer.Exit(40)


@app.command()
def domains(as_json: JsonOption = False) -> None:
    """List the domains that are installed."""
    from hybrid_tamp.taskfile.domains import available_domains, find_domain

    found = [find_domain(name) for name in available_domains()]
    if as_json:
        print_json(
            {
                "schema": "hybrid-tamp/domains/1",
                "domains": [
                    {
                        "name": domain.name,
                        "description": domain.description,
                        "classes": [c.name for c in domain.classes],
                        "blocks": [b.name for b in domain.blocks],
                        "predicates": [p.name for p in domain.predicates],
                    }
                    for domain in found
                ],
            }
        )
        return
    from hybrid_tamp.report.tables import domains_table

    show(domains_table(found))


@app.command()
def schema(
    document: Annotated[Document, typer.Argument(help="which document")] = Document.task,
    reference: Annotated[bool, typer.Option("--reference", help="a reference page in Markdown instead")] = False,
) -> None:
    """Print the JSON Schema of task files, or of the documents that are printed and written."""
    if document is not Document.task:
        from hybrid_tamp.report.documents import json_schemas

        print_json(json_schemas()[f"{document.value}-1"])
        return
    from hybrid_tamp.taskfile.domains import available_domains, find_domain
    from hybrid_tamp.taskfile.schema import json_schema, reference_page

    found = [find_domain(name) for name in available_domains()]
    if reference:
        typer.echo(reference_page(found), nl=False)
    else:
        print_json(json_schema(found))


def _load(text: str, domain: str | None, *, plans: bool = False) -> "Task":
    """Load a task; code is imported only where the command line, not the file, names it.

    The planner that the file names is checked only where it is the one that plans.
    """
    from hybrid_tamp.symbolic.engines import check_engine
    from hybrid_tamp.taskfile.domains import find_task_file
    from hybrid_tamp.taskfile.loader import load_task

    return load_task(find_task_file(text), _finder(domain), check_engine if plans else None)


def _finder(name: str | None) -> "Callable[[str], Domain]":
    """Return how a task file's domain is found: as the command line says, else among the installed ones."""
    from hybrid_tamp.taskfile.domains import find_domain, installed_domain

    if name is None:
        return installed_domain
    chosen = find_domain(name)
    return lambda _: chosen


def _adjusted(
    task: "Task",
    planner: str | None,
    objective: Objective | None,
    seed: int | None,
    time_limit: float | None,
    memory_limit: float | None,
) -> "Task":
    """Return the task with what the command line says in place of what the file says."""
    from dataclasses import replace

    limits = replace(
        task.limits,
        time=task.limits.time if time_limit is None else time_limit,
        memory=task.limits.memory if memory_limit is None else memory_limit,
    )
    return task.replaced(
        planner=planner or task.planner,
        objective=task.objective if objective is None else objective.value,
        seed=task.seed if seed is None else seed,
        limits=limits,
    )


def main(arguments: list[str] | None = None) -> int:
    """Run the command line and return its exit status."""
    words = sys.argv[1:] if arguments is None else arguments
    # UsageError of whichever click typer brings.
    usage_error = cast(type[Exception], typer.BadParameter.__mro__[1])
    try:
        if not words:
            words = ["--help"]
        status = app(args=words, prog_name="hybrid-tamp", standalone_mode=False)
        if sys.stdout is not None:  # None where it was closed before we began
            sys.stdout.flush()
    except HybridTampError as error:
        report_error(error, "--json" in words)
        return error.exit_status
    except usage_error as error:
        message = error.format_message() if hasattr(error, "format_message") else str(error)
        wrong = InputError([Issue("", message.rstrip("."), remedy="see 'hybrid-tamp --help'")])
        report_error(wrong, "--json" in words)
        return InputError.exit_status
    except (KeyboardInterrupt, typer.Abort):
        typer.echo("interrupted", err=True)
        return 130
    except OSError as error:
        return output_failed(error)
    except SystemExit as end:
        # That is what typer makes of a reader that went away, e.g. `| head`.
        if not isinstance(end.__context__, BrokenPipeError):
            raise
        return output_failed(end.__context__)
    return int(status or 0)


if __name__ == "__main__":
    sys.exit(main())

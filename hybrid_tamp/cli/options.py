"""Arguments and options that several verbs share."""

from collections.abc import Iterator
from typing import Annotated, Literal

import typer

_TASK_FILE = "from the task file"


def complete_task(incomplete: str) -> Iterator[str]:
    """Yield the names of the bundled tasks that begin with the given letters, for completion in the shell."""
    from hybrid_tamp.taskfile.domains import bundled_tasks

    yield from (name for name in bundled_tasks() if name.startswith(incomplete))


def complete_planner(incomplete: str) -> Iterator[str]:
    """Yield the names of the planning engines that begin with the given letters, for completion in the shell."""
    from hybrid_tamp.symbolic.engines.registry import known_engines

    yield from (name for name in known_engines() if name.startswith(incomplete))


Task = Annotated[
    str,
    typer.Argument(
        metavar="TASK", help="a YAML task file, or the name of a bundled task", autocompletion=complete_task
    ),
]
Json = Annotated[bool, typer.Option("--json", help="print one JSON document and nothing else")]
Domain = Annotated[
    str | None,
    typer.Option(
        "--domain",
        metavar="NAME",
        help="domain: a name, package.module:ATTRIBUTE, or a .py file",
        show_default=_TASK_FILE,
    ),
]
Planner = Annotated[
    str | None,
    typer.Option(
        "--planner",
        metavar="NAME",
        help="planning engine (see 'hybrid-tamp planners')",
        autocompletion=complete_planner,
        show_default=_TASK_FILE,
    ),
]
Objective = Annotated[
    Literal["length", "makespan"] | None,
    typer.Option(
        "--objective",
        help="quantity to minimise: the number of actions (length) or the time (makespan)",
        show_default=_TASK_FILE,
    ),
]
Seed = Annotated[
    int | None, typer.Option("--seed", min=0, max=2**32 - 1, help="seed of all random numbers", show_default=_TASK_FILE)
]
Time = Annotated[
    float | None,
    typer.Option("--time-limit", min=0.001, help="time limit of the whole command [s]", show_default=_TASK_FILE),
]
Memory = Annotated[
    float | None,
    typer.Option("--memory-limit", min=1, help="memory limit of the planner [MiB]", show_default=_TASK_FILE),
]
Optimiser = Annotated[
    Literal["cma", "grid"] | None,
    typer.Option("--optimiser", help="optimiser of hyperparameters: CMA-ES or a grid search", show_default=_TASK_FILE),
]
Evaluations = Annotated[
    int | None,
    typer.Option(
        "--evaluations",
        min=1,
        max=10**9,
        metavar="N",
        help="maximum number of rollouts for the optimiser",
        show_default=_TASK_FILE,
    ),
]
Refine = Annotated[
    Literal["none", "physics"] | None,
    typer.Option("--refine", help="physics: continue the optimisation in the physics backend", show_default=_TASK_FILE),
]
Backend = Annotated[str, typer.Option("--backend", metavar="NAME", help="physics backend")]
Force = Annotated[bool, typer.Option("--force", help="replace existing output files")]

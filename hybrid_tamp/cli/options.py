"""Arguments and options that several verbs share."""

from typing import Annotated, Literal

import typer

Task = Annotated[str, typer.Argument(metavar="TASK", help="a YAML task file, or the name of a bundled task")]
Json = Annotated[bool, typer.Option("--json", help="print one JSON document and nothing else")]
Domain = Annotated[
    str | None,
    typer.Option("--domain", metavar="NAME", help="domain: a name, package.module:ATTRIBUTE, or a .py file"),
]
Planner = Annotated[str | None, typer.Option("--planner", metavar="NAME", help="planning engine")]
Objective = Annotated[
    Literal["length", "makespan"] | None,
    typer.Option("--objective", help="quantity to minimise: the number of actions (length) or the time (makespan)"),
]
Seed = Annotated[int | None, typer.Option("--seed", min=0, max=2**32 - 1, help="seed of all random numbers")]
Time = Annotated[float | None, typer.Option("--time-limit", min=0.001, help="time limit of the whole command [s]")]
Memory = Annotated[float | None, typer.Option("--memory-limit", min=1, help="memory limit of the planner [MiB]")]
Optimiser = Annotated[
    Literal["cma", "grid"] | None,
    typer.Option("--optimiser", help="optimiser of hyperparameters: CMA-ES or a grid search"),
]
Evaluations = Annotated[
    int | None,
    typer.Option("--evaluations", min=1, max=10**9, metavar="N", help="maximum number of rollouts for the optimiser"),
]
Refine = Annotated[
    Literal["none", "physics"] | None,
    typer.Option("--refine", help="physics: continue the optimisation in the physics backend"),
]
Backend = Annotated[str, typer.Option("--backend", metavar="NAME", help="physics backend")]
Force = Annotated[bool, typer.Option("--force", help="replace existing output files")]

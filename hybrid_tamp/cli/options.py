"""Arguments and options that verbs share."""

from enum import Enum
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from hybrid_tamp.verbs.loading import Settings


class Objective(str, Enum):
    """What a plan should be short in."""

    length = "length"
    makespan = "makespan"


class Optimiser(str, Enum):
    """How hyperparameters are searched."""

    cma = "cma"
    grid = "grid"


class Refine(str, Enum):
    """Whether the search goes on in the physics backend."""

    none = "none"
    physics = "physics"


class Encoding(str, Enum):
    """How blocks become planning actions."""

    classical = "classical"
    temporal = "temporal"


def read_settings(**options: "Enum | str | float | None") -> "Settings":
    """Return what the options say in place of the task file; see `Settings` for their names."""
    from hybrid_tamp.verbs.loading import Settings

    values = {name: option.value if isinstance(option, Enum) else option for name, option in options.items()}
    return Settings(**values)  # type: ignore[arg-type]


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
OptimiserOption = Annotated[
    Optimiser | None, typer.Option("--optimiser", help="of hyperparameters: CMA-ES, or direct sampling on a grid")
]
EvaluationsOption = Annotated[
    int | None, typer.Option("--evaluations", min=1, max=10**9, metavar="N", help="most rollouts of the optimiser")
]
RefineOption = Annotated[
    Refine | None, typer.Option("--refine", help="physics: go on from the analytic optimum in the physics backend")
]
ForceOption = Annotated[bool, typer.Option("--force", help="replace another run in the output folder")]

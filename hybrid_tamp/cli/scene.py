"""The verb ``scene``."""

from pathlib import Path
from typing import Annotated

import typer

from hybrid_tamp.cli import options


def scene(
    task: options.Task,
    files: Annotated[list[Path], typer.Argument(metavar="FILES...", help="URDF files and mesh files (OBJ)")],
    output: Annotated[Path, typer.Option("-o", "--output", metavar="FILE", help="task file to write")],
    position: Annotated[
        tuple[float, float, float],
        typer.Option("--at", metavar="X Y Z", help="position of the origin of the files [m]"),
    ] = (0.0, 0.0, 0.0),
    force: options.Force = False,
) -> None:
    """Add bodies that nothing can move to a task, e.g. the walls and shelves of a URDF file.

    Example: hybrid-tamp scene roll_cylinder kitchen.urdf -o kitchen.yaml
    """
    from hybrid_tamp.verbs.scene import write_scene

    added = write_scene(task, files, output, position, force=force)
    typer.echo(f"wrote {output}: {len(added)} bodies added ({', '.join(added)})")

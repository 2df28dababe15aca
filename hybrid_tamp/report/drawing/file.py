"""The file of a drawing. The suffix of its name determines the format."""

from collections.abc import Callable
from pathlib import Path

from hybrid_tamp.errors import InputError, Issue
from hybrid_tamp.report.drawing.diagram import Diagram
from hybrid_tamp.report.drawing.dot import dot_text
from hybrid_tamp.report.drawing.layout import lay_out
from hybrid_tamp.report.drawing.mermaid import mermaid_text
from hybrid_tamp.report.drawing.picture import draw_layout
from hybrid_tamp.report.folder import RunFolder, check_new_file, check_parent

_FORMATS: dict[str, Callable[[Diagram], bytes]] = {
    ".svg": lambda diagram: draw_layout(lay_out(diagram), "svg"),
    ".png": lambda diagram: draw_layout(lay_out(diagram), "png"),
    ".dot": lambda diagram: dot_text(diagram).encode(),
    ".mmd": lambda diagram: mermaid_text(diagram).encode(),
}
"""Maps each suffix to the function that returns the content of the file."""


def check_drawing(path: Path, *, force: bool = False) -> None:
    """Check that a drawing can be written to a path.

    Raises:
        InputError: the suffix is unknown, the folder does not exist, or the file exists and `force` is false.
    """
    if path.suffix.lower() not in _FORMATS:
        wanted = "the name of the drawing must end in .svg, .png, .dot (Graphviz) or .mmd (Mermaid)"
        raise InputError([Issue(str(path), wanted, path.suffix or "no suffix")])
    check_parent(path, "the drawing")
    check_new_file(path, "the drawing", force=force)


def write_drawing(diagram: Diagram, path: Path) -> None:
    """Write a drawing of a network.

    Raises:
        InputError: the folder is not writable.
    """
    RunFolder(path.parent).write_bytes(path.name, _FORMATS[path.suffix.lower()](diagram))

"""Colours of a drawing of a network."""

from collections.abc import Sequence

from hybrid_tamp.model.affordance import TOKEN
from hybrid_tamp.report.drawing.diagram import Diagram
from hybrid_tamp.report.drawing.wires import Wire

BOX, TITLE, MODE, PAGE, INK = "#343a43", "#ffffff", "#c9d0d8", "#ffffff", "#1d2127"
"""Colours of boxes, of the two lines of their titles, of the page, and of dark text."""
MIXED = "#6b7480"
"""Colour of wires between slots of different classes."""
_ANY_TOKEN = "#dfe3e8"
_CLASSES = ("#f28e5c", "#7cc36e", "#6db3f2", "#f4cf58", "#c39bea", "#f291b5", "#5fcfc0", "#d0a878")
"""Light colours, on which dark text is readable."""
_DARKER, _PALE = 0.78, 0.65
_TOKENS = ("#d1006c", "#0a5bd3", "#00915f", "#8a2be2", "#c75c00", "#00869e", "#7a5c00", "#5f6b00")
"""Strong colours of marked paths."""


def class_colours(classes: Sequence[str]) -> dict[str, str]:
    """Map the names of classes to colours. A domain with more classes than colours uses colours twice."""
    named = [name for name in classes if name != TOKEN.name]
    return {name: _CLASSES[index % len(_CLASSES)] for index, name in enumerate(named)} | {TOKEN.name: _ANY_TOKEN}


def darker(colour: str) -> str:
    """Return a darker shade of a colour ``#rrggbb``, for lines on a white page."""
    return "#" + "".join(f"{round(_DARKER * int(colour[index : index + 2], 16)):02x}" for index in (1, 3, 5))


def paler(colour: str) -> str:
    """Return a paler shade of a colour ``#rrggbb``, for what a plan does not use."""
    shades = (int(colour[index : index + 2], 16) for index in (1, 3, 5))
    return "#" + "".join(f"{round(_PALE * 255 + (1 - _PALE) * shade):02x}" for shade in shades)


def wire_colour(diagram: Diagram, wire: Wire) -> str:
    """Return the colour of a wire, which is that of the class of its tokens."""
    name = diagram.wire_class(wire)
    return MIXED if name is None else darker(class_colours(diagram.classes)[name])


def token_colours(diagram: Diagram) -> dict[str, str]:
    """Map the names of tokens with marked paths to colours."""
    return {mark.token: _TOKENS[index % len(_TOKENS)] for index, mark in enumerate(diagram.marks)}

"""Colours of a drawing of a network."""

from collections.abc import Sequence

from hybrid_tamp.model.affordance import TOKEN

BOX, TITLE, MODE, PAGE, INK = "#343a43", "#ffffff", "#c9d0d8", "#ffffff", "#1d2127"
"""Colours of boxes, of the two lines of their titles, of the page, and of dark text."""
MIXED = "#6b7480"
"""Colour of wires between slots of different classes."""
_ANY_TOKEN = "#dfe3e8"
_CLASSES = ("#f28e5c", "#7cc36e", "#6db3f2", "#f4cf58", "#c39bea", "#f291b5", "#5fcfc0", "#d0a878")
"""Light colours, on which dark text is readable."""
_DARKER = 0.78


def class_colours(classes: Sequence[str]) -> dict[str, str]:
    """Map the names of classes to colours. A domain with more classes than colours uses colours twice."""
    named = [name for name in classes if name != TOKEN.name]
    return {name: _CLASSES[index % len(_CLASSES)] for index, name in enumerate(named)} | {TOKEN.name: _ANY_TOKEN}


def darker(colour: str) -> str:
    """Return a darker shade of a colour ``#rrggbb``, for lines on a white page."""
    return "#" + "".join(f"{round(_DARKER * int(colour[index : index + 2], 16)):02x}" for index in (1, 3, 5))

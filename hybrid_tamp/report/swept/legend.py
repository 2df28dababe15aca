"""Colours of the movements in a picture of swept paths, and the lines of its legend."""

from hybrid_tamp.model.swept import SweptPath, SweptPlan

_COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9")
"""Colours that people with any kind of colour vision can distinguish (Okabe and Ito 2008)."""
DISTINCT = len(_COLOURS)
"""Number of movements with different colours."""
KEY = "hatched: fixed body; black outline: movable body; dotted: region"
"""What the lines of a view mean that belong to no movement."""


def colour_of(number: int) -> str:
    """Return the colour of a movement with a number from 1."""
    return _COLOURS[(number - 1) % DISTINCT]


def title_of(swept: SweptPlan) -> str:
    """Return the title of a picture: the task, and whether the plan was refused."""
    if swept.refused is not None:
        return f"{swept.task.name}: refused in {swept.refused.where}, because {swept.refused.text}"
    return swept.task.name if swept.paths else f"{swept.task.name}: no plan"


def line_of(path: SweptPath) -> str:
    """Return the line of a movement: the instance, the bodies that move, and the closest pair."""
    pair = path.closest
    if pair is not None:
        return f"{path.instance.name}: {pair.text}"
    return f"{path.instance.name}: {', '.join(body.token for body in path.bodies)}"

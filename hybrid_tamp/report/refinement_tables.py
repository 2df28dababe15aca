"""Tables of the results of the mid-level planner, at most 80 columns wide."""

from collections.abc import Iterable, Mapping, Sequence

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from hybrid_tamp.report.documents import Json
from hybrid_tamp.report.tables import new_table, roles_text

MEANINGS = {
    "performance": "value: weighted sum of the performance measures of all blocks",
    "distance": "value: minus the distance between final state and goal; the performance measures do not count",
}
"""Maps each objective of the mid-level planner to a line that states what the value of a plan is."""
KEPT = "The hyperparameters keep their defaults, which satisfy all conditions."


def refinement_tables(entry: Json, performance: Sequence[Json] | None = None) -> RenderableType:
    """Return tables of the performance measures, the hyperparameters and the gain of planning ahead.

    Args:
        entry: the entry ``refinement`` of a plan document.
        performance: the performance measures of a run, or None before a run.
    """
    measures = entry["performance"] if performance is None else performance
    shown: list[RenderableType] = [Text(exclusion_text(each)) for each in entry["rounds"]]
    if measures:
        shown.append(_performance(measures))
    if entry["optimiser"]:
        numbers = {f"{each['instance']}.{each['measure']}": number for number, each in enumerate(measures, start=1)}
        tables = (_hyperparameters(entry["hyperparameters"], numbers), _values(entry))
        shown += [*tables, Text(MEANINGS[entry["objective"]]), *map(Text, efforts(entry))]
    elif entry["hyperparameters"]:
        shown.append(Text(KEPT))
    return Group(*shown)


def exclusion_text(entry: Json) -> str:
    """Return a line about a binding that was excluded before this plan was found, with the reason."""
    unit = "" if entry["unit"] in ("", "1") else f" {entry['unit']}"
    failure = f"{entry['atom']} fails by {-entry['margin']:.3g}{unit}"
    return f"given up: {entry['block']} with {roles_text(entry['roles'])}, because {failure}"


def efforts(entry: Json) -> Iterable[str]:
    """Yield a line about the optimisation with the forward models, then a line about any optimisation in physics."""
    spent = f"{entry['evaluations']} rollouts in {entry['seconds']:.1f} s ({entry['stopped']})"
    yield f"optimised by {entry['optimiser']}: {spent}"
    if entry["physics"] is not None:
        tried = entry["physics"]
        before, best = ("a failed run" if tried[key] is None else _value(tried[key]) for key in ("before", "best"))
        spent = f"{tried['evaluations']} runs in {tried['seconds']:.1f} s ({tried['stopped']})"
        yield f"value in physics: {before} at the optimum of the forward models, and at best {best} after {spent}"


def values(entry: Json) -> Iterable[tuple[str, str, str]]:
    """Yield rows of (what was optimised, value of the plan, gain of optimising all actions together)."""
    yield "all actions together", _value(entry["best"]), ""
    for name, other in (("each action on its own", entry["apart"]), ("the defaults", entry["defaults"])):
        if other is not None:
            yield name, _value(other), _gain(entry["best"], other)


def comparison(entries: Iterable[Json]) -> Iterable[tuple[str, str, str]]:
    """Yield rows of (choice of hyperparameters, predicted value, measured value), and a row with the gains."""
    found = list(entries)
    for each in found:
        measured = "a failed run" if each["measured"] is None else _value(each["measured"])
        yield each["hyperparameters"], _value(each["predicted"]), measured
    if len(found) > 1:
        best, other = found[:2]
        ran = best["measured"] is not None and other["measured"] is not None
        yield (
            "gain",
            _gain(best["predicted"], other["predicted"]),
            _gain(best["measured"], other["measured"]) if ran else "",
        )


def comparison_table(entries: Iterable[Json]) -> Table:
    """Return a table of the values with optimised hyperparameters and with the defaults, in the same physics."""
    table = _table("Predicted and measured value", "hyperparameters", ">predicted", ">measured")
    for row in comparison(entries):
        table.add_row(*map(Text, row))
    return table


def number(value: float | None) -> str:
    """Return a number as text, or a dash for None."""
    return "-" if value is None else f"{value:.4g}"


def _named(name: str, unit: str) -> str:
    """Return the name of a quantity, followed by its unit in brackets unless the unit is 1."""
    return name if unit in ("", "1") else f"{name} [{unit}]"


def _value(entry: Json) -> str:
    violation, value = entry["violation"], entry["value"]
    if violation is None or value is None:
        return "not finite"
    return f"violates conditions by {violation:.3g} scales" if violation else f"{value:.4g}"


def _gain(best: Json, other: Json) -> str:
    """Return the gain of `best` over `other`, or an empty text if one of the two violates conditions."""
    if best["value"] is None or other["value"] is None or (best["violation"], other["violation"]) != (0, 0):
        return ""
    # Values that differ only by rounding errors are treated as equal.
    gain = best["value"] - other["value"]
    return f"{0.0 if abs(gain) < 1e-9 * (1 + abs(best['value'])) else gain:+.3g}"


def _performance(measures: Iterable[Json]) -> Table:
    table = _table("Performance measures", "#", "measure", ">weight", ">predicted", ">measured")
    for index, each in enumerate(measures, start=1):
        name = _named(f"{each['instance']}.{each['measure']}", each["unit"])
        figures = (f"{each['weight']:g}", number(each["predicted"]), number(each["measured"]))
        # Wrapped in Text, because rich interprets brackets in plain strings as markup.
        table.add_row(*map(Text, (str(index), name, *figures)))
    return table


def _hyperparameters(entries: Iterable[Json], numbers: Mapping[str, int]) -> Table:
    table = _table("Hyperparameters", "", ">value", ">default", ">apart", "bounds", "", "affects #")
    before = ""
    for each in entries:
        if each["instance"] != before:
            table.add_row(Text(each["instance"]))
            before = each["instance"]
        name = f"  {_named(each['name'], each['unit'])}"
        moved = " ".join(str(numbers[name]) for name in each["moves"] if name in numbers)
        bounds = f"{each['lower']:.3g} to {each['upper']:.3g}"
        figures = map(number, (each["value"], each["default"], each["apart"]))
        table.add_row(*map(Text, (name, *figures, bounds, each["status"], moved)))
    return table


def _values(entry: Json) -> Table:
    table = _table("Value of the plan", "optimised", ">value", ">gain by planning ahead")
    for row in values(entry):
        table.add_row(*map(Text, row))
    return table


def _table(title: str, *headings: str) -> Table:
    table = new_table(f"\n{title}", *headings, framed=False)
    table.padding, table.collapse_padding = (0, 1), True
    return table

"""Tables of what the mid-level planner did; they fit into 80 columns."""

from collections.abc import Iterable, Mapping, Sequence

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from hybrid_tamp.report.documents import Json

KEPT = "Hyperparameters are kept at their defaults, which meet every condition."


def refinement_tables(entry: Json, performance: Sequence[Json] | None = None) -> RenderableType:
    """Return the performance measures, the hyperparameters that move them, and what planning ahead gains.

    Args:
        entry: what the mid-level planner did.
        performance: the measures with what a run measured, or None before a run.
    """
    measures = entry["performance"] if performance is None else performance
    shown: list[RenderableType] = [Text(exclusion_text(each)) for each in entry["rounds"]]
    if measures:
        shown.append(_performance(measures))
    if entry["optimiser"]:
        numbers = {f"{each['instance']}.{each['measure']}": number for number, each in enumerate(measures, start=1)}
        shown += [_hyperparameters(entry["hyperparameters"], numbers), _values(entry), *map(Text, efforts(entry))]
    elif entry["hyperparameters"]:
        shown.append(Text(KEPT))
    return Group(*shown)


def exclusion_text(entry: Json) -> str:
    """Say which plan was given up before this one, and why."""
    roles = ", ".join(f"{role}={name}" for role, name in entry["roles"].items())
    figure = with_unit(f"{-entry['margin']:.3g}", entry["unit"])
    return f"given up: {entry['block']} with {roles}: {entry['atom']} fails by {figure}"


def efforts(entry: Json) -> Iterable[str]:
    """Say in one line how the optimum was found, and in another what came of going on in physics."""
    spent = f"{entry['evaluations']} rollouts in {entry['seconds']:.1f} s ({entry['stopped']})"
    yield f"optimised by {entry['optimiser']}: {spent}"
    if entry["physics"] is not None:
        tried = entry["physics"]
        before, best = (_failed_or_value(each) for each in (tried["before"], tried["best"]))
        spent = f"{tried['evaluations']} runs in {tried['seconds']:.1f} s ({tried['stopped']})"
        yield f"in physics: {before} as the forward models say, {best} after {spent}"


def values(entry: Json) -> Iterable[tuple[str, str, str]]:
    """Yield what was optimised, the value of the plan, and what optimising all together gains over it."""
    yield "all actions together", _value(entry["best"]), ""
    for name, other in (("each action on its own", entry["apart"]), ("the defaults", entry["defaults"])):
        if other is not None:
            yield name, _value(other), _gain(entry["best"], other)


def with_unit(number: str, unit: str) -> str:
    """Return a number with its unit, which is left out where it is 1."""
    return number if unit in ("", "1") else f"{number} {unit}"


def named(name: str, unit: str) -> str:
    """Return the name of a quantity with its unit in brackets."""
    return name if unit in ("", "1") else f"{name} [{unit}]"


def number(value: float | None) -> str:
    """Return a figure, or a dash where there is none."""
    return "-" if value is None else f"{value:.4g}"


def _value(entry: Json) -> str:
    if entry["violation"] is None or entry["value"] is None:
        return "not finite"
    return (
        f"{entry['value']:.4g}" if entry["violation"] == 0 else f"misses conditions by {entry['violation']:.3g} scales"
    )


def _failed_or_value(entry: Json | None) -> str:
    return "a failed run" if entry is None else _value(entry)


def _gain(best: Json, other: Json) -> str:
    """Return what the better one gains; nothing where conditions are missed, which no value makes good."""
    if best["value"] is None or other["value"] is None or (best["violation"], other["violation"]) != (0, 0):
        return ""
    # Sums of the same terms in another order differ by rounding.
    gain = best["value"] - other["value"]
    return f"{0.0 if abs(gain) < 1e-9 * (1 + abs(best['value'])) else gain:+.3g}"


def _performance(measures: Iterable[Json]) -> Table:
    table = _table("Performance measures", "#", "measure", right=("weight", "predicted", "measured"))
    for index, each in enumerate(measures, start=1):
        name = named(f"{each['instance']}.{each['measure']}", each["unit"])
        figures = (f"{each['weight']:g}", number(each["predicted"]), number(each["measured"]))
        # Built as Text, because brackets would be markup.
        table.add_row(*map(Text, (str(index), name, *figures)))
    return table


def _hyperparameters(entries: Iterable[Json], numbers: Mapping[str, int]) -> Table:
    table = _table("Hyperparameters", "", right=("value", "default", "apart"), left=("bounds", "", "moves #"))
    before = ""
    for each in entries:
        if each["instance"] != before:
            table.add_row(Text(each["instance"]))
            before = each["instance"]
        name = f"  {named(each['name'], each['unit'])}"
        moved = " ".join(str(numbers[name]) for name in each["moves"] if name in numbers)
        bounds = f"{each['lower']:.3g} to {each['upper']:.3g}"
        figures = map(number, (each["value"], each["default"], each["apart"]))
        table.add_row(*map(Text, (name, *figures, bounds, each["status"], moved)))
    return table


def _values(entry: Json) -> Table:
    table = _table("Value of the plan, optimised", "", right=("value", "planning ahead gains"))
    for row in values(entry):
        table.add_row(*map(Text, row))
    return table


def _table(title: str, *headings: str, right: Iterable[str] = (), left: Iterable[str] = ()) -> Table:
    table = Table(title=f"\n{title}", title_justify="left", box=None, header_style="bold", pad_edge=False)
    table.padding, table.collapse_padding = (0, 1), True
    # Folded, not cut: a name without its end says nothing.
    for heading in headings:
        table.add_column(heading, overflow="fold")
    for heading in right:
        table.add_column(heading, justify="right", overflow="fold")
    for heading in left:
        table.add_column(heading, overflow="fold")
    return table

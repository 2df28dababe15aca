"""The convergence curve of the optimiser: a plot of the best value against the number of rollouts."""

from io import BytesIO
from typing import TYPE_CHECKING

from hybrid_tamp.report.documents import Json

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_BLUE, _RED, _GREY = "#1f5fa8", "#be2823", "#5c6570"


def convergence_picture(entry: Json) -> bytes | None:
    """Return the convergence curve as a PNG, or None if nothing was optimised.

    The curve shows the violation (red, right axis) until all conditions hold. From then on, the curve shows the value
    (blue, left axis).
    """
    if not entry["optimiser"] or not entry["history"]:
        return None
    # pyplot is avoided, because pyplot keeps all figures and needs a window system.
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.2, 3.6), dpi=120, layout="constrained")
    axes = figure.add_subplot(xlabel="rollouts of the optimiser [1]", ylabel="best value of the plan [1]")
    # The optimiser evaluates the defaults first.
    first = {"evaluations": 1, **entry["defaults"]}
    history = [first, *entry["history"]]
    _draw_value(axes, entry, history)
    if first["violation"] != 0:
        _draw_violation(axes, history)
    axes.set_xlim(0, 1.02 * history[-1]["evaluations"])
    axes.grid(color="#e4e7eb")
    axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=4, fontsize="small", frameon=False)
    picture = BytesIO()
    # Leave out matplotlib's version, so that the file depends only on the run.
    figure.savefig(picture, format="png", metadata={"Software": None})
    return picture.getvalue()


def _draw_value(axes: "Axes", entry: Json, history: list[Json]) -> None:
    curve = [(m["evaluations"], m["value"]) for m in history if m["violation"] == 0 and m["value"] is not None]
    axes.plot(*_columns(curve), color=_BLUE, drawstyle="steps-post", marker=".", label=f"by {entry['optimiser']}")
    others = (("each action on its own", entry["apart"], "--"), ("the defaults", entry["defaults"], ":"))
    for name, other, style in others:
        if other is not None and other["violation"] == 0 and other["value"] is not None:
            axes.axhline(other["value"], color=_GREY, linestyle=style, label=name)


def _draw_violation(axes: "Axes", history: list[Json]) -> None:
    end = next((m["evaluations"] for m in history if m["violation"] == 0), history[-1]["evaluations"])
    axes.axvspan(0, end, color=_RED, alpha=0.08, linewidth=0, label="conditions are missed")
    first = [m for m in history if m["violation"] is not None and m["evaluations"] <= end]
    curve = [(m["evaluations"], m["violation"]) for m in first]
    right = axes.twinx()
    right.plot(*_columns(curve), color=_RED, drawstyle="steps-post", marker=".")
    right.set_ylabel("violation [scales of the conditions]", color=_RED)
    right.set_ylim(bottom=0)


def _columns(points: list[tuple[int, float]]) -> tuple[list[int], list[float]]:
    return [x for x, _ in points], [y for _, y in points]

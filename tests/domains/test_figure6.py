"""Fig. 6 with the forward models: the best grasp of a hammer for a push, a strike, and a push followed by a strike."""

import numpy as np
import pytest
from hammer_figures import FILES, LOCATIONS, TABLE, Figure, Scan, closed_form, closed_form_best, figure_task

from hybrid_tamp.midlevel.scores import Scores

EVERY = 0.0025
"""Distance between neighbouring samples of the grasp [m]."""


@pytest.mark.parametrize("kind", FILES)
def test_the_closed_form_is_the_table(kind: str) -> None:
    for x, wanted in list(zip(LOCATIONS, TABLE[kind], strict=True))[kind == "push" :]:
        assert 100 * closed_form_best(figure_task(kind, x), kind, x) == pytest.approx(wanted, abs=0.06)


@pytest.mark.parametrize("kind", FILES)
@pytest.mark.parametrize("x", [0.2, 0.6])
def test_the_forward_models_give_the_table(kind: str, x: float) -> None:
    best = 100 * Figure(figure_task(kind, x), kind).sampled(61).best
    assert best == pytest.approx(TABLE[kind][LOCATIONS.index(x)], abs=0.3)


def test_where_there_is_nothing_to_push_full_contact_is_a_tie_and_the_default_wins() -> None:
    scan = Figure(figure_task("push", 0.1), "push").sampled(61)
    assert scan.tie == pytest.approx((0.03, 0.12))
    assert scan.best == pytest.approx(0.075)


def test_cma_agrees_with_sampling_and_planning_ahead_gains() -> None:
    figure = Figure(figure_task("both", 0.6), "both")
    found, scan = figure.searched(193), figure.sampled(151)
    assert found.point[0] == pytest.approx(scan.best, abs=1e-3)
    grasp, greedy = figure.apart()
    assert grasp == pytest.approx(0.075, abs=1e-3)
    assert found.value >= greedy


def test_another_hammer_has_its_own_optimum() -> None:
    task = figure_task("both", 0.3, long=True)
    figure = Figure(task, "both")
    wanted = closed_form_best(task, "both", 0.3, recoil=True)
    near = wanted + np.linspace(-0.01, 0.01, 101)
    found = Scan(near, figure.evaluate(near[:, None]))
    assert found.best == pytest.approx(wanted, abs=1e-3)
    assert wanted == pytest.approx(closed_form_best(task, "both", 0.3), abs=5e-3)
    assert abs(wanted - closed_form_best(figure_task("both", 0.3), "both", 0.3)) > 0.02


def test_a_moving_hand_shifts_the_best_grasp() -> None:
    grasps = np.linspace(0.03, 0.12, 37)
    shifts = []
    for way in ("closed form", "forward models"):
        best = []
        for weight in (0.0, -4.0):
            task = figure_task("both", 0.4, radius=0.2, hand_weight=weight)
            value = closed_form(task, "both", 0.4, grasps, 0.2)
            scores = Scores(np.zeros(len(grasps)), value)
            scores = scores if way == "closed form" else Figure(task, "both").evaluate(grasps[:, None])
            best.append(Scan(grasps, scores).best)
        shifts.append(best[1] - best[0])
    assert shifts[0] > 0.005
    assert shifts[1] == pytest.approx(shifts[0], abs=EVERY)

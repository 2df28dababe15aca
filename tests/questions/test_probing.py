"""Tests of probes: shapes rank classes, known members provide properties, and trials decide."""

import json
import subprocess
from collections.abc import Callable
from dataclasses import replace
from io import StringIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rich.console import Console
from texts import load_task_text

import hybrid_tamp
from hybrid_tamp.errors import ExecutionFailed, InputError, LimitReached, NoPlan
from hybrid_tamp.geometry.features import (
    resting_poses,
    rolling_likelihood,
    rolling_radius,
    roundest_axis,
    tumbling_likelihood,
)
from hybrid_tamp.geometry.shapes import Box, Cylinder, MeshFile, Shape, Sphere
from hybrid_tamp.geometry.surfaces import outer_surface, volume_of
from hybrid_tamp.geometry.warp import warp
from hybrid_tamp.model.affordance import ObjectClass
from hybrid_tamp.model.deadline import Deadline
from hybrid_tamp.model.membership import MembershipResult, Trial, Verdict, wilson_interval
from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.poses import quaternion_from_rpy, quaternion_of_rotation, rotate
from hybrid_tamp.physics.protocol import open_backend
from hybrid_tamp.questions.probe.membership import Prober
from hybrid_tamp.report.question_tables import membership_table
from hybrid_tamp.symbolic.encoding.problem import compile_task
from hybrid_tamp.taskfile.loader import load_task
from hybrid_tamp.taskfile.meshfile import read_mesh
from hybrid_tamp.verbs.probe import probe, save_members

ROOT = Path(__file__).parents[2]
UNKNOWN = ROOT / "problems" / "unknown_box.yaml"
TO_TUMBLE = ROOT / "problems" / "tumble_unknown_box.yaml"
Command = Callable[..., "subprocess.CompletedProcess[str]"]


def mesh(name: str) -> Shape:
    return read_mesh(ROOT / "problems" / "meshes" / f"{name}.obj", MeshFile(kind="mesh", file=name))


CYLINDER = Cylinder(kind="cylinder", radius=0.08, length=0.4)
BOX = Box(kind="box", half_extents=(0.15, 0.12, 0.18))


@pytest.mark.parametrize(
    ("shape", "rolls", "tumbles"),
    [
        (CYLINDER, (0.97, 1.0), (0.0, 0.2)),
        (Sphere(kind="sphere", radius=0.1), (0.97, 1.0), (0.0, 0.2)),
        (mesh("prism24"), (0.95, 0.98), (0.1, 0.15)),
        # cos(22.5 deg) is 0.924. A side covers tan(22.5 deg) of the distance to the corner of the bounding box.
        (mesh("prism8"), (0.73, 0.75), (0.41, 0.42)),
        (BOX, (0.0, 0.01), (0.99, 1.0)),
        (mesh("p5"), (0.0, 0.01), (0.99, 1.0)),
    ],
)
def test_features_of_known_forms(shape: Shape, rolls: tuple[float, float], tumbles: tuple[float, float]) -> None:
    assert rolls[0] <= rolling_likelihood(shape) <= rolls[1]
    assert tumbles[0] <= tumbling_likelihood(shape) <= tumbles[1]


def test_what_rolls_comes_as_far_as_its_outline_is_long() -> None:
    assert rolling_radius(mesh("prism8"), np.array([0.0, 1.0, 0.0])) == pytest.approx(
        16 * 0.1 * np.sin(np.pi / 8) / (2 * np.pi), rel=1e-4
    )
    assert roundest_axis(mesh("prism8")).tolist() == [0.0, 1.0, 0.0]


def test_a_box_rests_on_six_faces_and_an_octagon_on_ten() -> None:
    poses = resting_poses(BOX)
    assert len(poses) == 6
    assert sum(pose.share for pose in poses) == pytest.approx(1.0)
    assert poses[0].height == pytest.approx(0.12)
    assert np.abs(poses[0].down) == pytest.approx([0.0, 1.0, 0.0])
    assert len(resting_poses(mesh("prism8"))) == 10
    assert resting_poses(mesh("sphere")) == ()


def test_walls_between_parts_are_not_on_the_surface() -> None:
    surface = outer_surface(mesh("p5"))
    assert surface.is_watertight
    assert surface.volume == pytest.approx(0.28 * (0.09 - 4 * (2 / 3) * 0.3 * 0.03), rel=0.01)
    assert volume_of(mesh("p5")) == pytest.approx(surface.volume)


def test_contact_points_of_a_box_are_carried_into_the_hollow() -> None:
    """At 0.44 of the half height, the parabola is 0.03 (1 - 0.44^2) m behind the corners."""
    warped = warp(BOX, mesh("p5"), np.eye(3))
    right, top, front = warped.carry(np.array([[0.15, 0.0, 0.0792], [0.066, 0.0, 0.18], [0.0, -0.12, 0.0]]))
    depth = 0.15 - 0.03 * (1 - 0.44**2)
    assert right == pytest.approx([depth, 0.0, 0.066], abs=0.004)
    assert top == pytest.approx([0.066, 0.0, depth], abs=0.004)
    assert front == pytest.approx([0.0, -0.14, 0.0], abs=0.002)
    assert warped.residual < 0.001


def test_the_ends_of_an_axis_are_carried_to_a_turned_prism() -> None:
    to_y = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
    ends = warp(CYLINDER, mesh("prism24"), to_y).carry(np.array([[0.0, 0.0, 0.2], [0.0, 0.0, -0.2]]))
    assert ends == pytest.approx(np.array([[0.0, 0.15, 0.0], [0.0, -0.15, 0.0]]), abs=0.002)


@pytest.mark.parametrize("rpy", [(0.0, 0.0, 0.0), (0.3, -1.2, 2.0), (np.pi, 0.0, 0.0), (0.0, 0.0, np.pi)])
def test_quaternions_of_rotation_matrices(rpy: tuple[float, float, float]) -> None:
    quaternion = quaternion_from_rpy(np.array(rpy))
    matrix = rotate(quaternion, np.eye(3)).T
    again = quaternion_of_rotation(matrix)
    assert pytest.approx(matrix, abs=1e-12) == rotate(again, np.eye(3)).T


@pytest.mark.parametrize(
    ("successes", "trials", "expected"),
    # Brown, Cai and DasGupta 2001 give closed forms; 0 of n ends at z^2 / (n + z^2).
    [(0, 4, (0.0, 0.4899)), (4, 4, (0.5101, 1.0)), (5, 10, (0.2366, 0.7634)), (0, 0, (0.0, 1.0))],
)
def test_wilson_intervals(successes: int, trials: int, expected: tuple[float, float]) -> None:
    assert wilson_interval(successes, trials) == pytest.approx(expected, abs=1e-4)


def test_a_verdict_needs_an_interval_beyond_one_half() -> None:
    won, lost = Trial(True, "", {}), Trial(False, "", {})
    said = {3: "unsure", 4: "yes"}
    assert all(Verdict("C", 0.5, trials=(won,) * n).verdict == word for n, word in said.items())
    assert Verdict("C", 0.5, trials=(lost,) * 4).verdict == "no"
    assert Verdict("C", 0.5, trials=(won, won, won, lost)).verdict == "unsure"
    assert Verdict("C", 0.5, obstacle="no plan", properties={"mass": 1.0}, impossible=True).verdict == "no"
    assert Verdict("C", 0.5, obstacle="no plan", properties={"mass": 1.0}).verdict == "unknown"
    assert Verdict("C", 0.5, obstacle="nobody knows how").verdict == "not tried"


def shown(verdict: Verdict) -> str:
    """Return the table of one verdict as text."""
    console = Console(width=120, record=True, file=StringIO())
    console.print(membership_table(MembershipResult("t", "P5", 0, (), (verdict,))))
    return console.export_text()


@pytest.fixture(scope="module")
def task() -> Task:
    return load_task(UNKNOWN)


@pytest.fixture(scope="module")
def tumbled(task: Task) -> MembershipResult:
    return probe(task, "P5", ["TUMBLABLE"])


def test_p5_is_tumblable(tumbled: MembershipResult) -> None:
    (verdict,) = tumbled.verdicts
    assert verdict.verdict == "yes", [trial.why for trial in verdict.trials]
    assert verdict.labelled == "P3"
    assert verdict.properties["half_extents"] == pytest.approx((0.15, 0.14, 0.15))
    assert verdict.properties["hollow"] == pytest.approx((0.0242, 0.0, 0.0242), abs=0.002)
    assert verdict.properties["mass"] == 12
    assert verdict.contacts["right upper"] == pytest.approx((0.1258, 0.0, 0.066), abs=0.004)


@pytest.mark.parametrize(
    ("drawn", "verdict", "trials"),
    [("1111", "yes", 4), ("0000", "no", 4), ("11101111", "yes", 8), ("1010101010", "unsure", 10), ("01", "unsure", 10)],
)
def test_it_goes_on_while_the_verdict_is_unsure(
    task: Task, monkeypatch: pytest.MonkeyPatch, drawn: str, verdict: str, trials: int
) -> None:
    won = iter(drawn * 10)
    monkeypatch.setattr(Prober, "run_trial", lambda *_: Trial(next(won) == "1", "", {}))
    (found,) = probe(task, "P5", ["TUMBLABLE"], most_starts=10).verdicts
    assert (found.verdict, len(found.trials)) == (verdict, trials)


def test_trials_without_evidence_do_not_count(task: Task, monkeypatch: pytest.MonkeyPatch) -> None:
    drawn = iter("x1x111")
    monkeypatch.setattr(Prober, "run_trial", lambda *_: Trial((c := next(drawn)) == "1", "", {}, conclusive=c == "1"))
    (found,) = probe(task, "P5", ["TUMBLABLE"], starts=6, most_starts=6).verdicts
    assert (found.verdict, found.successes, found.conclusive, len(found.trials)) == ("yes", 4, 4, 6)
    assert "4 of 4 (2 without evidence)" in shown(found)


def test_a_hand_that_does_not_reach_says_nothing_about_the_class(task: Task) -> None:
    def stop(binding: Any, start: Any, parameters: Any) -> Any:
        hand = binding["hand"].name
        return lambda elapsed, state: {(hand, "force"): -100.0 * state[hand, "velocity"]}

    blocks = [replace(b, policy=stop) if b.action == "REACHING" else b for b in task.domain.blocks]
    lazy = task.replaced(domain=task.domain.with_blocks(blocks))
    (found,) = probe(lazy, "P5", ["TUMBLABLE"], starts=2, most_starts=9, backend="analytic").verdicts
    assert (found.verdict, len(found.trials), found.interval) == ("unknown", 2, (0.0, 1.0))
    assert found.obstacle == "no trial is evidence for or against the class"
    for trial in found.trials:
        assert trial.why.startswith("no evidence on TUMBLABLE, because another block failed: REACHING-")
        assert "must measure" not in trial.why
    assert "0 of 0 (2 without evidence)" in shown(found)


def test_p5_slides_and_does_not_roll(task: Task) -> None:
    (verdict,) = probe(task, "P5", ["ROLLABLE"], starts=1, most_starts=1).verdicts
    assert verdict.successes == 0
    assert verdict.labelled == "P4"
    assert verdict.trials[0].measures["ROLLING-1.roll_ratio"] < 0.1
    assert "roll_ratio" in verdict.trials[0].why


def test_a_cylinder_never_seen_rolls(task: Task) -> None:
    """Its mass is the product of its volume and the density of the known cylinder."""
    drum = Token.make("P5", [], {}, CYLINDER, task.token_by_name["P5"].unknown)
    tokens = tuple(drum if token.name == "P5" else token for token in task.tokens)
    (verdict,) = probe(task.replaced(tokens=tokens), "P5", ["ROLLABLE"], starts=1, most_starts=1).verdicts
    assert verdict.successes == 1, verdict.trials[0].why
    density = 5.0 / volume_of(Cylinder(kind="cylinder", radius=0.1, length=0.3))
    assert verdict.properties["mass"] == pytest.approx(density * volume_of(CYLINDER), rel=1e-3)
    assert np.abs(verdict.properties["axis_of_rotation"]) == pytest.approx([0.0, 0.0, 1.0], abs=1e-3)
    assert verdict.properties["radius_of_rotation"] == pytest.approx(0.08, rel=0.005)


def test_the_written_task_plans_and_runs(task: Task, tumbled: MembershipResult, tmp_path: Path) -> None:
    target = tmp_path / "known.yaml"
    assert save_members(task, tumbled, target) == ("TUMBLABLE",)
    text = target.read_text(encoding="utf-8")
    assert "# P5 is an unknown object" in text
    assert "unknown: [ROLLABLE]" in text
    assert [file.name for file in tmp_path.iterdir()] == ["known.yaml"]
    # The same box in the task whose goal names the box.
    wanted = load_task(TO_TUMBLE)
    save_members(wanted, tumbled, target, force=True)
    known = load_task(target)
    tumblable = known.domain.class_by_name["TUMBLABLE"]
    assert (wanted.unsettled, known.unsettled) == (((*wanted.goal, wanted.token_by_name["P5"], tumblable),), ())
    assert [member.name for member in known.token_by_name["P5"].classes] == ["TOKEN", "TUMBLABLE"]
    assert known.token_by_name["P5"].unknown == ()
    found = hybrid_tamp.plan(known).required()
    from hybrid_tamp.execution.execute import execute

    with open_backend("pybullet") as physics:
        assert execute(known, found, physics).success


def test_a_goal_that_speaks_of_it_waits_for_a_probe(command: Command, tmp_path: Path) -> None:
    done = command("plan", TO_TUMBLE, "--json")
    assert done.returncode == 11
    document = json.loads(done.stdout)
    assert (document["status"], document["explanation"]["kind"]) == ("unknown", "class_unknown")
    (reason,) = document["explanation"]["reasons"]
    assert (reason["goal"], reason["lacks"]) == ("posture(P5, flat right)", "TUMBLABLE")
    assert "hybrid-tamp probe" in reason["message"]
    done = command("run", TO_TUMBLE, "-o", tmp_path / "out")
    assert (done.returncode, "--token P5" in done.stderr) == (11, True)
    assert sorted(file.name for file in (tmp_path / "out").iterdir()) == [
        "mesh-01.obj",
        "plan.json",
        "report.html",
        "task.yaml",
    ]
    with pytest.raises(InputError, match="unknown whether P5 is a member"):
        compile_task(load_task(TO_TUMBLE))


def test_what_is_there_is_not_written_over(task: Task, tumbled: MembershipResult, tmp_path: Path) -> None:
    (tmp_path / "t.yaml").write_text("mine", encoding="utf-8")
    with pytest.raises(InputError, match="force=True"):
        save_members(task, tumbled, tmp_path / "t.yaml")
    nothing = replace(tumbled, verdicts=(replace(tumbled.verdicts[0], trials=()),))
    with pytest.raises(ExecutionFailed, match="TUMBLABLE: unsure"):
        save_members(task, nothing, tmp_path / "new.yaml")


def no_plan(task: Task) -> TaskPlan:
    raise NoPlan("nothing can", proven=True, kind="unsolvable")


def test_without_a_plan_it_is_no_member(task: Task) -> None:
    with open_backend("analytic") as physics:
        (verdict,) = Prober(no_plan, physics).probe(task, "P5", ["TUMBLABLE"]).verdicts
    assert (verdict.verdict, verdict.obstacle) == ("no", "nothing can")


def test_without_a_labelled_member_it_is_not_tried(task: Task) -> None:
    alone = task.replaced(tokens=tuple(token for token in task.tokens if token.name != "P3"))
    with open_backend("analytic") as physics:
        (verdict,) = Prober(no_plan, physics).probe(alone, "P5", ["TUMBLABLE"]).verdicts
    assert verdict.verdict == "not tried"
    assert "no labelled member of this class" in verdict.obstacle


def test_a_trial_that_never_settles_ends_and_says_so(task: Task) -> None:
    with open_backend("pybullet") as physics:
        prober = Prober(lambda each: hybrid_tamp.plan(each).required(), physics, starts=1, most_seconds=1.0)
        (verdict,) = prober.probe(task, "P5", ["TUMBLABLE"]).verdicts
        assert verdict.trials[0].why == "the trial did not end within 1 s of simulated time"
        late = replace(prober, deadline=Deadline.after(0.0))
        with pytest.raises(LimitReached, match="time limit of 0 s"):
            late.probe(task, "P5", ["TUMBLABLE"])


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--token", "P6"), "'P6'"),
        (("--token", "P5", "--class", "ROLLING"), "'ROLLING'"),
        (("--token", "P3"), "expected a token with unknown classes"),
        (("--token", "P3", "--class", "TUMBLABLE"), "P3 is already known to be a member of TUMBLABLE"),
        (("--token", "goal", "--class", "ROLLABLE"), "a token with a shape"),
    ],
)
def test_wrong_questions_are_refused(command: Command, words: tuple[str, ...], said: str) -> None:
    done = command("probe", UNKNOWN, *words, "--json")
    assert done.returncode == 30
    assert said in json.loads(done.stdout)["message"]


def test_the_command_prints_one_document(command: Command) -> None:
    done = command("probe", UNKNOWN, "--token", "P5", "--class", "TUMBLABLE", "--seeds=1", "--most-seeds=1", "--json")
    assert done.returncode == 0, done.stderr
    document = json.loads(done.stdout)
    assert document["schema"] == "hybrid-tamp/probe/1"
    (entry,) = document["classes"]
    assert (entry["class"], entry["verdict"], entry["successes"]) == ("TUMBLABLE", "unsure", 1)
    assert len(document["resting_faces"]) == 6


def test_unknown_classes_are_checked_as_classes_are() -> None:
    text = UNKNOWN.read_text(encoding="utf-8").replace("meshes/", f"{UNKNOWN.parent}/meshes/")
    token = load_task_text(text, "t").token_by_name["P5"]
    assert [each.name for each in token.unknown] == ["ROLLABLE", "TUMBLABLE"]
    assert dict(token.properties) == {"mass": 12.0, "friction": 0.6}
    for wrong, said in (
        ("[ROLABLE]", "did you mean 'ROLLABLE'"),
        ("[STATIC END-EFFECTOR, ROLLABLE]", "no token can be a member of both"),
        ("[TOKEN]", "a class must not be listed twice"),
    ):
        with pytest.raises(InputError, match=said):
            load_task_text(text.replace("[ROLLABLE, TUMBLABLE]", wrong), "t")
    with pytest.raises(InputError, match="length"):
        load_task_text(text.replace("{mass: 12, ", "{mass: 12, length: 3, "), "t")


def test_features_are_asked_of_the_class() -> None:
    assert ObjectClass.features(BOX) == 0.5

"""Primitives are learnt from tables and recorded runs, and used in other runs."""

import json
import shutil
import subprocess
from collections.abc import Callable
from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest
from hybrid_tamp_domains.rolling_tumbling import DOMAIN

import hybrid_tamp
from hybrid_tamp.errors import InputError
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.control import Parameters
from hybrid_tamp.motion.dmp import DMP
from hybrid_tamp.motion.minimum_jerk import minimum_jerk
from hybrid_tamp.motion.poses import quaternion_from_axis_angle, quaternion_multiply
from hybrid_tamp.motion.profile import Profile
from hybrid_tamp.skills import demonstrated_reach
from hybrid_tamp.taskfile.loader import load_task
from hybrid_tamp.taskfile.primitives import read_primitive

ROLL = Path(__file__).resolve().parents[2] / "problems" / "roll_cylinder.yaml"
PHASE = np.linspace(0.0, 1.0, 121)
Command = Callable[..., "subprocess.CompletedProcess[str]"]


def table(path: Path, *columns: np.ndarray, names: str = "time [s],x [m],y [m],z [m]") -> Path:
    rows = np.column_stack(columns)
    path.write_text(names + "\n" + "".join(",".join(map(repr, row)) + "\n" for row in rows.tolist()))
    return path


def low_reach(path: Path) -> Path:
    """Write a demonstration of a reach that is much lower than that of the package."""
    height = 0.2 * (minimum_jerk(PHASE / 0.5) - minimum_jerk((PHASE - 0.4) / 0.6))
    return table(path, 2.0 * PHASE, 0.5 * minimum_jerk(PHASE), 0.0 * PHASE, height)


def reaches(primitive: DMP, start: np.ndarray, goal: np.ndarray) -> None:
    """Assert that the primitive connects new starts and goals within a millimetre, and ends slowly."""
    starts, goals = np.random.default_rng(3000).uniform(-0.3, 0.3, (2, 50, 3)) + np.array([[start], [goal]])
    movement = primitive.trajectory(starts, goals, 1.5)
    position, velocity, _ = movement.at(1.5)
    assert np.max(np.linalg.norm(position - goals, axis=-1)) < 1e-3
    assert np.max(np.linalg.norm(velocity, axis=-1)) < 0.02
    settled, _, _ = movement.at(np.nextafter(movement.end, 0.0))
    assert np.max(np.linalg.norm(settled - goals, axis=-1)) < 1e-4


def distances(task: hybrid_tamp.Task, primitive: DMP) -> np.ndarray:
    """Return the distances of hands from their places [m] after REACHING from 20 starts to 20 places of the drum."""
    block = task.domain.block_by_name["REACHING:behind"]
    assert block.taught is not None
    block = block.taught(primitive)
    assert block.policy is not None
    assert block.outcome is not None
    binding = {"hand": task.token_by_name["hand"], "object": task.token_by_name["drum"]}
    binding |= {"region": task.token_by_name["goal"]}
    shifts = np.random.default_rng(3001).uniform(-0.3, 0.3, (2, 20, 3)) * np.array([[[1, 1, 0.5]], [[1, 1, 0]]])
    state = task.state.repeated(20)
    moved = {("hand", "position"): state["hand", "position"] + shifts[0]}
    state = state.replace({**moved, ("drum", "position"): state["drum", "position"] + shifts[1]})
    place = block.outcome(binding, state)["hand", "position"]
    initial = block.initial_values(binding, state)
    policy = block.policy(binding, state, Parameters(initial))
    system = block.system_maker(binding, state)
    for step in range(int(240 * 1.2 * np.max(initial["duration"]))):
        state = system(state, policy(np.array(step / 240), state), 1 / 240)
    return np.asarray(np.linalg.norm(state["hand", "position"] - place, axis=-1))


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a run of the drum's task, in the blocks' own forward models."""
    folder = tmp_path_factory.mktemp("recorded") / "first"
    hybrid_tamp.run(ROLL, folder, backend="analytic")
    return folder


def test_a_recorded_reach_reaches_new_goals(recorded: Path, tmp_path: Path) -> None:
    learnt = hybrid_tamp.learn("REACHING:behind", [recorded])
    assert (learnt.dimensions, learnt.sources, learnt.unit) == (3, ["first/REACHING-1"], "m")
    assert 0.0 < learnt.rms < 2e-3
    start, goal = np.array([0.25, -0.45, 0.3]), np.array([-0.15, 0.0, 0.1])
    reaches(learnt.primitive, start, goal)
    assert np.max(distances(load_task(ROLL), learnt.primitive)) < 1e-3
    hybrid_tamp.save_primitive(learnt, tmp_path / "reach.json")
    assert read_primitive(tmp_path / "reach.json") == learnt
    # With the demonstrated start and goal, the primitive reproduces the demonstration, i.e. the reach that a servo
    # follows.
    ours, default = (p.trajectory(start, goal, 2.0).at(0.8)[0] for p in (learnt.primitive, demonstrated_reach()))
    assert 1e-4 < np.linalg.norm(ours - default) < 0.05


def test_a_table_and_a_run_together(recorded: Path, tmp_path: Path) -> None:
    both = hybrid_tamp.learn("REACHING:behind", [low_reach(tmp_path / "low.csv"), recorded], token="hand", weights=12)
    assert both.sources == ["low.csv", "first/REACHING-1"]
    assert len(both.weights) == 12
    assert both.rms > 0.02
    with pytest.raises(InputError, match="an instance of REACHING:behind that moves foot; available: hand"):
        hybrid_tamp.learn("REACHING:behind", [recorded], token="foot")


def test_poses_teach_a_position_too(tmp_path: Path) -> None:
    plain = hybrid_tamp.learn("REACHING:behind", [low_reach(tmp_path / "low.csv")])
    positions = np.loadtxt(tmp_path / "low.csv", delimiter=",", skiprows=1)
    turns = quaternion_from_axis_angle(np.array([0.0, 0.0, 1.0]), PHASE)
    names = "time,x,y,z,qx,qy,qz,qw"
    posed = hybrid_tamp.learn("REACHING:behind", [table(tmp_path / "posed.csv", positions, turns, names=names)])
    assert posed.weights == plain.weights


@pytest.mark.parametrize("block", ["TIPPING", "TIPPING:lower"])
def test_poses_teach_the_course_of_a_tilt(tmp_path: Path, block: str) -> None:
    course = minimum_jerk(PHASE) ** 2
    first = quaternion_from_axis_angle(np.array([0.6, 0.0, 0.8]), 0.7)
    turns = quaternion_multiply(quaternion_from_axis_angle(np.array([0.0, 1.0, 0.0]), 1.2 * course), first)
    shown = table(tmp_path / "tilt.csv", PHASE, np.zeros((121, 3)), turns, names="time,x,y,z,qx,qy,qz,qw")
    learnt = hybrid_tamp.learn(block, [shown])
    assert (learnt.dimensions, learnt.unit) == (1, "rad")
    assert learnt.rms < 2e-3
    np.testing.assert_allclose(Profile(learnt.primitive).share(PHASE), course, atol=3e-3)
    low_reach(tmp_path / "low.csv")
    with pytest.raises(InputError, match=r"low.csv cannot teach TIPPING.*orientations .* are required"):
        hybrid_tamp.learn(block, [tmp_path / "low.csv"])


def test_a_path_teaches_the_course_along_a_curve(tmp_path: Path) -> None:
    angle = 2.0 * minimum_jerk(PHASE) ** 2
    shown = table(tmp_path / "arc.csv", PHASE, np.cos(angle), np.sin(angle), 0.0 * PHASE)
    learnt = hybrid_tamp.learn("REACHING:beside", [shown])
    np.testing.assert_allclose(Profile(learnt.primitive).share(PHASE), angle / 2.0, atol=3e-3)
    still = table(tmp_path / "still.csv", PHASE, np.zeros((121, 3)))
    with pytest.raises(InputError, match=r"still.csv: .* must cover at least 0.001 m, got 0 m"):
        hybrid_tamp.learn("REACHING:beside", [still])


def test_taught_blocks_differ_in_nothing_else() -> None:
    taught = [block for block in DOMAIN.blocks if block.taught and block.movement]
    assert {block.action for block in taught} == {"REACHING", "TIPPING"}
    for block in taught:
        assert block.taught is not None
        assert block.movement is not None
        other = block.taught(DMP(np.zeros((7, block.movement.dimensions))))
        changed = {f.name for f in fields(block) if getattr(block, f.name) != getattr(other, f.name)}
        made = {"policy", "system", "duration", "taught", "outcome", "hyperparameters", "sweep", "key_poses"}
        assert changed <= made, block
        assert [h.name for h in block.hyperparameters] == [h.name for h in other.hyperparameters]
        assert (block.duration.minimum, block.duration.maximum) == (other.duration.minimum, other.duration.maximum)


@pytest.fixture(scope="module")
def taught_run(command: Command, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a run whose task file names a primitive in another folder."""
    work = tmp_path_factory.mktemp("taught")
    (work / "tasks").mkdir()
    done = command("learn", "REACHING:behind", low_reach(work / "low.csv"), "-o", work / "low.json", "--json")
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["sources"] == ["low.csv"]
    named = ROLL.read_text() + "\n# taught\nprimitives:\n  REACHING:   '../low.json' # a low one\n"
    (work / "tasks" / "roll.yaml").write_text(named)
    done = command("run", work / "tasks" / "roll.yaml", "-o", work / "out", "--json")
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["success"]
    # The folder is complete: it does not depend on files elsewhere.
    (work / "low.json").unlink()
    return work / "out"


def test_a_run_uses_what_its_task_file_names(taught_run: Path, recorded: Path) -> None:
    from hybrid_tamp.execution.storage import load_recording

    runs = [load_recording(folder / "recording.npz") for folder in (taught_run, recorded)]
    highest = [run.trajectory["hand", "position"][:, 2].max() for run in runs]
    assert highest[0] < highest[1] - 0.1


def test_the_folder_of_such_a_run_can_be_replayed(command: Command, taught_run: Path, tmp_path: Path) -> None:
    assert "  REACHING:   primitive-01.json # a low one\n" in (taught_run / "task.yaml").read_text()
    shutil.copytree(taught_run, tmp_path / "moved")
    done = command("replay", tmp_path / "moved", "--json")
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["identical"] is True
    # The new run replaces the run whose task file it uses.
    again = command("plan", tmp_path / "moved" / "task.yaml", "-o", tmp_path / "moved", "--force")
    assert again.returncode == 0, again.stderr
    assert (tmp_path / "moved" / "primitive-01.json").exists()
    assert not (tmp_path / "moved" / "recording.npz").exists()


def test_a_mode_counts_more_than_its_action(tmp_path: Path) -> None:
    for name, weights in (("one", np.zeros((4, 3))), ("other", np.ones((4, 3)))):
        write(tmp_path / f"{name}.json", weights)
    named = ROLL.read_text() + "\nprimitives: {'REACHING:behind': other.json, REACHING: one.json}\n"
    (tmp_path / "task.yaml").write_text(named)
    task = load_task(tmp_path / "task.yaml")
    hand, drum, goal = (task.token_by_name[name] for name in ("hand", "drum", "goal"))
    binding = {"hand": hand, "object": drum, "region": goal}

    def early(block: Block) -> np.ndarray:
        assert block.policy is not None
        policy = block.policy(binding, task.state, Parameters(block.initial_values(binding, task.state)))
        return policy(np.array(0.3), task.state)["hand", "force"]

    block = DOMAIN.block_by_name["REACHING:behind"]
    assert block.taught is not None
    one, other = (early(block.taught(DMP(weights))) for weights in (np.zeros((4, 3)), np.ones((4, 3))))
    np.testing.assert_array_equal(early(task.domain.block_by_name["REACHING:behind"]), other)
    assert not np.allclose(one, other)
    # A primitive in three dimensions does not fit the other modes.
    assert task.domain.block_by_name["REACHING:beside"] is DOMAIN.block_by_name["REACHING:beside"]


def write(path: Path, weights: np.ndarray) -> Path:
    from hybrid_tamp.taskfile.primitives import PrimitiveFile

    hybrid_tamp.save_primitive(PrimitiveFile.of(DMP(weights), "REACHING", ["x"], 0.0, "m"), path)
    return path


@pytest.mark.parametrize(
    ("entry", "words"),
    [
        ("REACHNG: p3.json", ("40:3", "must be a block", "'REACHNG'", "did you mean 'REACHING'")),
        ("ROLLING: p3.json", ("40:3", "with a motor primitive", "'ROLLING'")),
        ("TIPPING: p3.json", ("40:12", "the primitive of TIPPING must have dimension 1", "got 3")),
        ("REACHING:behind: p1.json", ("40:", "primitive of REACHING:behind must have dimension 3", "got 1")),
        ("REACHING: no.json", ("40:13", "no.json: must be a primitive file", "no file of this name")),
        ("REACHING: ''", ("40:13", "must not be empty")),
        ("REACHING: 3", ("40:13", "must be text", "got 3")),
        ("REACHING: bad.json", ("40:13", "bad.json:2:12: alpha must be more than 0", "got -1")),
    ],
)
def test_faults_of_what_a_task_file_names(tmp_path: Path, entry: str, words: tuple[str, ...]) -> None:
    write(tmp_path / "p3.json", np.zeros((4, 3)))
    write(tmp_path / "p1.json", np.zeros((4, 1)))
    good = json.loads((tmp_path / "p3.json").read_text())
    (tmp_path / "bad.json").write_text(json.dumps({"schema": good["schema"]})[:-1] + ',\n  "alpha": -1\n}')
    text = "".join(line for line in ROLL.read_text().splitlines(keepends=True) if not line.startswith("seed"))
    lines = text.rstrip("\n").count("\n") + 1
    padded = text.rstrip("\n") + "\n" * (39 - lines) + "primitives:\n  " + entry + "\n"
    (tmp_path / "task.yaml").write_text(padded)
    with pytest.raises(InputError) as refused:
        load_task(tmp_path / "task.yaml")
    for word in words:
        assert word in str(refused.value), str(refused.value)

"""A saved task is loaded unchanged, and a task that is built in Python is checked like a file."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hybrid_tamp.errors import InputError
from hybrid_tamp.geometry.shapes import Cylinder
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.task import Limits, MidLevel, Range, Task
from hybrid_tamp.motion.dmp import DMP
from hybrid_tamp.taskfile.domains import bundled_tasks
from hybrid_tamp.taskfile.loader import load_task
from hybrid_tamp.taskfile.making import make_task
from hybrid_tamp.taskfile.primitives import PrimitiveFile
from hybrid_tamp.taskfile.saving import differences, save_task

HAND = {"classes": ["HAND"], "properties": {"force": 300}, "pose": {"position": [0, 0, 0.3]}}
DRUM = {
    "classes": ["ROLLABLE"],
    "properties": {"axis": (0.0, 0.0, 2.0), "mass": 5.0},
    "shape": Cylinder(kind="cylinder", radius=0.1, length=0.3),
    "pose": {"position": np.array([0.0, 0.0, 0.15])},
}
GOAL = {"classes": ["REGION"], "properties": {"radius": 0.02}, "pose": {"position": [0.8, 0, 0]}}
TOKENS = {"hand": HAND, "drum": DRUM, "goal": GOAL}
WITHIN = Atom("within", ("drum", "goal"))


@pytest.mark.parametrize("name", bundled_tasks())
def test_a_bundled_task_that_is_saved_loads_as_it_was(name: str, tmp_path: Path) -> None:
    task = load_task(name)
    save_task(task, tmp_path / "saved.yaml")
    again = load_task(tmp_path / "saved.yaml")
    assert differences(task, again) == []
    assert again.state.layout == task.state.layout
    np.testing.assert_array_equal(again.state.values, task.state.values)
    for block, same in zip(task.domain.blocks, again.domain.blocks, strict=True):
        assert [(h.name, h.lower, h.upper) for h in block.hyperparameters] == [
            (h.name, h.lower, h.upper) for h in same.hyperparameters
        ]
        assert [(m.name, m.weight) for m in block.performance] == [(m.name, m.weight) for m in same.performance]
    save_task(again, tmp_path / "again.yaml")
    first, second = (tmp_path / "saved.yaml").read_text(), (tmp_path / "again.yaml").read_text()
    assert second.replace("name: saved\n", "") == first


def test_a_task_built_in_python_is_the_one_that_its_file_says(
    load: Callable[[str], Task], text: str, toy: Domain
) -> None:
    built = make_task(
        toy,
        {**TOKENS, "drum": {**DRUM, "pose": {"position": (0, 0, 0.1), "rpy": [1.5707963267948966, 0, 0]}}},
        [WITHIN],
        agents={"robot": ["hand"]},
        assignment={"hand": "GUARDING"},
        limits=Limits(30.0, 1024.0, 2),
        seed=7,
        name="t.yaml",
    )
    assert differences(built, load(text)) == []
    assert np.array_equal(built.state.values, load(text).state.values)


@pytest.mark.parametrize("name", ["x" * 3000, "☃" * 1100, "\N{GRINNING FACE}" * 90], ids=["ascii", "snowman", "face"])
def test_a_name_longer_than_a_simple_key_of_yaml_is_saved(name: str, toy: Domain, tmp_path: Path) -> None:
    task = make_task(toy, {"hand": HAND, "goal": GOAL, name: DRUM}, [{"within": [name, "goal"]}])
    save_task(task, tmp_path / "t.yaml")
    assert differences(task, load_task(tmp_path / "t.yaml", lambda _: toy)) == []


def test_a_task_without_an_assignment_starts_in_the_resting_block(toy: Domain, tmp_path: Path) -> None:
    task = make_task(toy, TOKENS, [WITHIN]).replaced(assignment={})
    save_task(task, tmp_path / "t.yaml")
    assert load_task(tmp_path / "t.yaml", lambda _: toy).assignment == {"hand": "RESTING", "drum": "RESTING"}


names = st.text(st.characters(codec="utf-8"), min_size=1, max_size=4) | st.sampled_from(
    [
        "no",
        "null",
        "0o17",
        "1e3",
        "=",
        "<<",
        "- a",
        "a: b",
        "#",
        "'",
        '"',
        "[",
        "*a",
        "&a",
        "!a",
        "%",
        "? a",
        " a ",
        ".5",
    ]
)
coordinates = st.floats(-100, 100)


@settings(max_examples=40, deadline=None)
@given(
    name=names,
    x=coordinates,
    turn=st.tuples(*[st.floats(-1, 1)] * 4),
    mass=st.floats(1e-6, 1e6),
    seed=st.integers(0, 9),
)
def test_any_task_that_can_be_built_loads_as_it_was_saved(
    tmp_path_factory: pytest.TempPathFactory,
    toy: Domain,
    name: str,
    x: float,
    turn: tuple[float, float, float, float],
    mass: float,
    seed: int,
) -> None:
    pose = {"position": [x, 0.0, 1.0], "quaternion": turn}
    tokens = {"hand": HAND, "goal": GOAL, name: {**DRUM, "properties": {"axis": [1, 2, 3], "mass": mass}, "pose": pose}}
    try:
        task = make_task(toy, tokens, [{"within": [name, "goal"]}], seed=seed, name=name)
    except InputError:
        return
    path = tmp_path_factory.mktemp("saved") / "t.yaml"
    save_task(task, path)
    again = load_task(path, lambda _: toy)
    assert differences(task, again) == []
    np.testing.assert_array_equal(again.state.values, task.state.values)
    assert again.token_by_name[name].properties == task.token_by_name[name].properties


def test_bounds_weights_and_files_are_saved_too(tmp_path: Path) -> None:
    task = load_task("hammer_push")
    mesh = load_task("unknown_box")
    midlevel = MidLevel(
        evaluations=7,
        weights={"PUSHING.torque_work": -2.0},
        hyperparameters={"REACHING.duration": Range(1.0, 3.0, 2.0)},
    )
    built = make_task(
        "tool_use",
        {token.name: _entry(task, token.name) for token in task.tokens},
        task.goal,
        agents=task.agents,
        midlevel=midlevel,
    )
    save_task(built, tmp_path / "t.yaml")
    assert load_task(tmp_path / "t.yaml").midlevel == midlevel
    (tmp_path / "p5.obj").write_text("somebody's own")
    save_task(mesh, tmp_path / "mesh.yaml")
    assert (tmp_path / "p5.obj").read_text() == "somebody's own"
    assert differences(mesh, load_task(tmp_path / "mesh.yaml")) == []


def _entry(task: Task, name: str) -> dict[str, object]:
    token = task.token_by_name[name]
    entry = {
        "classes": list(token.classes),
        "properties": dict(token.properties),
        "pose": {"position": task.state[name, "position"], "quaternion": task.state[name, "orientation"]},
    }
    return entry if token.shape is None else {**entry, "shape": token.shape}


@pytest.mark.parametrize(
    ("tokens", "goal", "where", "wanted"),
    [
        ({**TOKENS, "drum": {**DRUM, "pose": {"position": [0, 0, 0.05]}}}, [WITHIN], "tokens.drum.pose.position",
         "must place the token above the floor"),
        ({**TOKENS, "twin": DRUM}, [WITHIN], "tokens.twin.pose.position", "must not overlap other tokens"),
        ({**TOKENS, "drum": {k: v for k, v in DRUM.items() if k != "shape"}}, [WITHIN], "tokens.drum",
         "is inconsistent: a rolling token has no shape"),
        ({**TOKENS, "drum": {**DRUM, "properties": {"mass": 5}}}, [WITHIN], "tokens.drum.properties.axis",
         "missing key 'axis'"),
        (TOKENS, [Atom("within", ("drum", "gaol"))], "goal[0].within[1]", "unknown token in the goal"),
        (TOKENS, [Atom("within", ("drum", "goal"), False)], "goal[0].not", "a goal atom must not be negated"),
    ],
)  # fmt: skip
def test_a_fault_of_a_task_built_in_python_is_named_by_its_keys(
    toy: Domain, tokens: dict[str, dict[str, object]], goal: list[Atom], where: str, wanted: str
) -> None:
    with pytest.raises(InputError) as caught:
        make_task(toy, tokens, goal)
    (issue,) = caught.value.issues
    assert issue.where == where
    assert wanted in issue.wanted
    assert "line" not in str(issue)


def test_what_a_task_file_cannot_say_is_not_saved(tmp_path: Path, toy: Domain) -> None:
    task = make_task(toy, TOKENS, [WITHIN])
    moving = task.replaced(state=task.state.replace({("drum", "velocity"): [1.0, 0.0, 0.0]}))
    with pytest.raises(InputError, match="velocity of token drum differs"):
        save_task(moving, tmp_path / "t.yaml")
    inside = task.replaced(state=task.state.replace({("drum", "position"): [0.0, 0.0, -1.0]}))
    with pytest.raises(InputError, match="above the floor"):
        save_task(inside, tmp_path / "t.yaml")
    with pytest.raises(InputError, match="not within"):
        save_task(replace(task, goal=(Atom("within", ("drum", "goal"), False),)), tmp_path / "t.yaml")
    with pytest.raises(InputError, match="cannot write the file"):
        save_task(task, tmp_path / "nowhere" / "t.yaml")
    assert list(tmp_path.iterdir()) == []


def test_primitives_are_saved_beside_the_task_file(tmp_path: Path) -> None:
    primitive = PrimitiveFile.of(DMP(np.full((5, 3), 0.25)), "REACHING:behind", ["by hand"], 0.0, "m")
    (tmp_path / "reach.json").write_text(primitive.text, encoding="utf-8")
    task = load_task("roll_cylinder")
    taught = make_task(
        "rolling_tumbling",
        {token.name: _entry(task, token.name) for token in task.tokens},
        task.goal,
        primitives={"REACHING:behind": tmp_path / "reach.json"},
    )
    assert taught.domain.block_by_name["REACHING:behind"] is not task.domain.block_by_name["REACHING:behind"]
    (tmp_path / "elsewhere").mkdir()
    save_task(taught, tmp_path / "elsewhere" / "t.yaml")
    again = load_task(tmp_path / "elsewhere" / "t.yaml")
    assert again.primitives == {"REACHING:behind": tmp_path / "elsewhere" / "reach.json"}
    assert differences(taught, again) == []
    (tmp_path / "reach.json").unlink()
    with pytest.raises(InputError, match=r"reach\.json: must be a primitive file; got no file of this name"):
        save_task(taught, tmp_path / "t.yaml")


def test_a_mesh_file_that_has_changed_is_not_saved(tmp_path: Path) -> None:
    save_task(load_task("unknown_box"), tmp_path / "t.yaml")
    task = load_task(tmp_path / "t.yaml")
    with (tmp_path / "p5.obj").open("a") as file:
        file.write("# changed\n")
    with pytest.raises(InputError, match="the mesh file has changed since the task was made"):
        save_task(task, tmp_path / "again.yaml")

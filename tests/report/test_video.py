"""Tests of videos, step pictures and captions, with pictures that are drawn without physics."""

import re
import subprocess
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import imageio_ffmpeg
import numpy as np
import pytest
from PIL import Image

from hybrid_tamp.errors import InputError
from hybrid_tamp.geometry.shapes import Sphere
from hybrid_tamp.model.affordance import TOKEN
from hybrid_tamp.model.block import Block, Duration, Slot
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.network import ReassignmentNetwork
from hybrid_tamp.model.plan import BlockInstance
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.recording import AtomMargin, Failure, Recording
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.report.caption import Captions, allocation
from hybrid_tamp.report.video import frame_times, step_pictures, write_video

TIMESTEP = 1 / 240
WIDTH, HEIGHT = 161, 90  # odd sizes, which a video cannot have


def block(name: str) -> Block:
    always = Duration(0.1, 9.0, lambda binding, state, hyperparameters: 1.0)
    return Block(name, (Slot("token", TOKEN),), "token", always, hold=True)


@pytest.fixture
def task() -> Task:
    edges = [("RESTING.token", "WAITING.token"), ("WAITING.token", "RESTING.token")]
    domain = Domain("toy", (), (), (block("RESTING"), block("WAITING")), ReassignmentNetwork(edges))
    tokens = tuple(Token.make(name, [], {}, Sphere(kind="sphere", radius=0.1)) for name in ("ball", "Würfel"))
    return Task("toy", domain, tokens, State.of(tokens, {}), ())


def instance(name: str, block_name: str, token: str, start: float, end: float) -> BlockInstance:
    return BlockInstance(name, block_name, {"token": token}, start, end)


@pytest.fixture
def recording(task: Task) -> Recording:
    rows = 241
    states = np.tile(task.state.values, (rows, 1))
    states[:, 0] = np.linspace(0, 1, rows)  # the ball's x
    return Recording(
        layout=task.state.layout,
        commands_layout=(),
        times=np.arange(rows) * TIMESTEP,
        states=states,
        commands=np.zeros((rows - 1, 0)),
        instances=(
            instance("WAITING-1", "WAITING", "ball", 0.0, 0.4),
            instance("RESTING-1", "RESTING", "Würfel", 0.0, 1.0),
            instance("RESTING-2", "RESTING", "ball", 0.4, 1.0),
        ),
        exits={},
        goal=(),
        backend="analytic",
        timestep=TIMESTEP,
    )


def draw(state: State) -> Any:
    """Draw a dark column that moves from left to right with the ball."""
    picture = np.full((HEIGHT, WIDTH, 3), 240, dtype=np.uint8)
    column = int(state["ball", "position"][0] * (WIDTH - 10))
    picture[:, column : column + 10] = (200, 40, 40)
    return picture


def read(path: Path, width: int) -> tuple[str, list[Any]]:
    """Return the messages of ffmpeg about a video, and its frames."""
    command = [imageio_ffmpeg.get_ffmpeg_exe(), "-i", str(path), "-f", "rawvideo", "-pix_fmt", "rgb24", "-"]
    done = subprocess.run(command, capture_output=True, check=True)
    said = done.stderr.decode()
    height = int(re.search(rf" {width}x(\d+)", said)[1])  # type: ignore[index]
    return said, list(np.frombuffer(done.stdout, dtype=np.uint8).reshape(-1, height, width, 3))


def test_video_shows_the_run_from_its_start_to_its_end(task: Task, recording: Recording, tmp_path: Path) -> None:
    path = tmp_path / "video.mp4"
    told: list[tuple[int, int]] = []
    count = write_video(path, task, recording, draw, lambda done, of: told.append((done, of)))
    assert count == 21
    assert told == [(done, 21) for done in range(1, 22)]
    said, frames = read(path, WIDTH + 1)
    assert len(frames) == 21
    assert all(word in said for word in ("Video: h264", "yuv420p", "20 fps"))
    columns = [int(np.argmin(frame[:HEIGHT, :WIDTH, 1].mean(axis=0))) for frame in frames]
    assert columns == sorted(columns)
    assert columns[0] < 15
    assert columns[-1] > WIDTH - 15
    assert [file.name for file in tmp_path.iterdir()] == ["video.mp4"]


@pytest.mark.parametrize(("duration", "count"), [(0.0, 1), (0.05, 2), (1.0, 21), (1.01, 22), (5.9166667, 120)])
def test_frames_come_at_the_frame_rate_and_the_last_at_the_end(
    recording: Recording, duration: float, count: int
) -> None:
    times = frame_times(replace(recording, times=np.array([0.0, duration])))
    assert len(times) == count
    assert times[0] == 0.0
    assert times[-1] == duration
    assert np.all(np.diff(times) <= 0.05 + 1e-9)
    assert np.all(np.diff(times) > 0)


def test_one_picture_a_step(task: Task, recording: Recording, tmp_path: Path) -> None:
    paths = step_pictures(tmp_path, task, recording, draw)
    assert [path.name for path in paths] == ["step-01.png", "step-02.png"]
    assert sorted(tmp_path.iterdir()) == sorted(paths)
    first, second = (np.asarray(Image.open(path)) for path in paths)
    assert first.shape == second.shape
    assert not np.array_equal(first[:HEIGHT], second[:HEIGHT])
    assert not np.array_equal(first[HEIGHT:], second[HEIGHT:])
    # Each picture shows the end of its step: the ball at 0.4 of the path, and at the end of the path.
    columns = [int(np.argmin(picture[:HEIGHT, :WIDTH, 1].mean(axis=0))) for picture in (first, second)]
    assert columns[0] == pytest.approx(0.4 * (WIDTH - 10), abs=2)
    assert columns[1] == WIDTH - 10


def test_nothing_is_left_where_drawing_fails(task: Task, recording: Recording, tmp_path: Path) -> None:
    calls = []

    def fails(state: State) -> Any:
        calls.append(state)
        if len(calls) > 3:
            raise RuntimeError("out of paint")
        return draw(state)

    with pytest.raises(RuntimeError, match="out of paint"):
        write_video(tmp_path / "video.mp4", task, recording, fails)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("write", [write_video, step_pictures])
def test_folder_that_is_not_there_is_an_input_error(
    task: Task, recording: Recording, tmp_path: Path, write: Callable[..., Any]
) -> None:
    with pytest.raises(InputError, match="nowhere"):
        write(tmp_path / "nowhere" / "video.mp4", task, recording, draw)


def test_allocation_reads_as_under_the_papers_pictures() -> None:
    rolling = BlockInstance("ROLLING-1", "ROLLING", {"hand": "hand", "object": "drum"}, 0, 1, {"region": "goal"})
    assert allocation(rolling) == "ROLLING-1: hand=hand object=drum -> goal"
    assert allocation(instance("RESTING-1", "RESTING", "drum", 0, 1)) == "RESTING-1: token=drum"


def test_caption_names_the_step_that_runs(task: Task, recording: Recording) -> None:
    captions = Captions(task, recording, WIDTH)
    assert [captions.index_at(time) for time in (0.0, 0.39, 0.4, 0.41, 1.0)] == [0, 0, 1, 1, 1]


def caption(task: Task, recording: Recording, time: float, width: int = 480) -> Any:
    picture = np.full((40, width, 3), 240, dtype=np.uint8)
    return Captions(task, recording, width).under(picture, time)[40:]


def coloured(pixels: Any) -> set[str]:
    """Return which of green and red occur in the pixels."""
    red, green, blue = (pixels[..., i].astype(int) for i in range(3))
    found = {"green"} if ((green - red > 60) & (green - blue > 40)).any() else set()
    return found | ({"red"} if ((red - green > 80) & (red - blue > 80)).any() else set())


def test_caption_ends_with_the_verdict(task: Task, recording: Recording) -> None:
    missed = replace(recording, goal=(AtomMargin(Atom("near", ("ball", "spot")), -0.1),))
    stopped = replace(recording, failure=Failure(1, "WAITING-1", "nothing came"))
    assert coloured(caption(task, recording, 0.3)) == set()
    assert coloured(caption(task, recording, 1.0)) == {"green"}
    assert coloured(caption(task, missed, 1.0)) == {"red"}
    assert coloured(caption(task, stopped, 1.0)) == {"red"}


def test_long_captions_stay_inside_the_picture(task: Task, recording: Recording) -> None:
    long = BlockInstance(
        "WAITING-1", "WAITING", {f"slot{i}": f"token{i}" for i in range(12)} | {"last": "x" * 200}, 0.0, 1.0
    )
    crowded = replace(recording, instances=(long,))
    plain, high = (caption(task, r, 0.2, 320) for r in (recording, crowded))
    assert high.shape[0] > plain.shape[0]
    # The right margin is empty.
    assert high[20:, -10:].min() == 255


def test_run_that_never_began_still_gets_a_caption(task: Task, recording: Recording) -> None:
    nothing = replace(recording, instances=(), times=np.zeros(1), states=recording.states[:1])
    assert caption(task, nothing, 0.0).min() < 100

"""Tests of videos, GIFs, step pictures and captions, with pictures that are drawn without physics."""

import re
import subprocess
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import imageio_ffmpeg
import numpy as np
import pytest
from PIL import Image, ImageSequence

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
from hybrid_tamp.physics.pictures.appearance import legend
from hybrid_tamp.physics.pictures.view import Rectangle, View
from hybrid_tamp.report import gif
from hybrid_tamp.report.caption import Captions, allocation
from hybrid_tamp.report.frames import Frames
from hybrid_tamp.report.gif import LARGEST_FILE, PAUSE, fit_size, gif_times, write_gif
from hybrid_tamp.report.layout import Layout, Panel, Strips
from hybrid_tamp.report.video import frame_times, step_pictures, write_video

TIMESTEP = 1 / 240
SIZE = (480, 270)


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


class Columns:
    """A scene in which a dark column moves from left to right with the ball."""

    def __init__(self, size: tuple[int, int]) -> None:
        self.width, self.height = size

    def aim(self, view: View) -> None:
        """The scene has no camera."""

    def picture(self, state: State) -> Any:
        picture = np.full((self.height, self.width, 3), 240, dtype=np.uint8)
        left, _, right, _ = self.bounds(state)["ball"]
        picture[:, left:right] = (200, 40, 40)
        return picture

    def bounds(self, state: State) -> dict[str, Rectangle]:
        column = int(state["ball", "position"][0] * (self.width - 10))
        return {"ball": (column, 0, column + 10, self.height)}


class Noise(Columns):
    """A scene whose pixels are random, which no GIF can compress."""

    def picture(self, state: State) -> Any:
        seed = round(1e6 * float(state["ball", "position"][0]))
        return 36 * np.random.default_rng(seed).integers(0, 8, (self.height, self.width, 3), dtype=np.uint8)


def layout_of(task: Task, recording: Recording, kind: type[Layout] = Strips, size: tuple[int, int] = SIZE) -> Layout:
    return kind(Captions(recording, task.domain.resting), legend(task), size)


def frames_of(task: Task, recording: Recording, scene: type[Columns] = Columns) -> Frames:
    layout = layout_of(task, recording)
    return Frames(task, recording, layout, scene(layout.scene))


def columns_in(frames: Any, task: Task, recording: Recording) -> list[int]:
    """Return the place of the column in each frame."""
    layout = layout_of(task, recording)
    # The label covers a part of the upper half.
    lower = slice(layout.corner[1] + layout.scene[1] // 2, layout.corner[1] + layout.scene[1] - 2)
    return [int(np.argmin(frame[lower, :, 1].mean(axis=0))) for frame in frames]


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
    count = write_video(path, frames_of(task, recording), lambda done, of: told.append((done, of)))
    assert count == 31
    assert told == [(done, 31) for done in range(1, 32)]
    said, frames = read(path, SIZE[0])
    assert len(frames) == 31
    assert frames[0].shape == (SIZE[1], SIZE[0], 3)
    assert all(word in said for word in ("Video: h264", "yuv420p", "30 fps"))
    columns = columns_in(frames, task, recording)
    assert columns == sorted(columns)
    assert columns[0] < 15
    assert columns[-1] > SIZE[0] - 15
    assert [file.name for file in tmp_path.iterdir()] == ["video.mp4"]


def test_gif_shows_the_run_and_lasts_as_long(task: Task, recording: Recording, tmp_path: Path) -> None:
    path = tmp_path / "run.gif"
    told: list[tuple[int, int]] = []
    count = write_gif(path, frames_of(task, recording), lambda done, of: told.append((done, of)))
    assert told[-1] == (count, count)
    durations, frames = read_gif(path)
    assert len(frames) == count > 1
    assert sum(durations) == pytest.approx(1000 * (recording.duration + PAUSE), abs=10)
    assert path.stat().st_size < LARGEST_FILE
    columns = columns_in(frames, task, recording)
    assert columns == sorted(columns)
    assert columns[0] < 15
    assert columns[-1] > SIZE[0] - 15
    assert [file.name for file in tmp_path.iterdir()] == ["run.gif"]


def test_gif_of_incompressible_frames_is_kept_small(
    task: Task, recording: Recording, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(gif, "LARGEST_FILE", 150_000)
    path = tmp_path / "run.gif"
    count = write_gif(path, frames_of(task, recording, Noise))
    assert 20_000 < path.stat().st_size <= 150_000
    durations, frames = read_gif(path)
    assert 1 < len(frames) == count
    assert sum(durations) == pytest.approx(1000 * (recording.duration + PAUSE), abs=10)


def test_gif_has_a_bounded_number_of_frames() -> None:
    assert gif_times(0.0) == [0.0]
    for duration in (0.02, 0.5, 6.15, 100.0, 5000.0):
        times = gif_times(duration)
        assert times[0] == 0.0
        assert times[-1] == duration
        assert np.all(np.diff(times) > 0)
        assert 1 < len(times) <= 152


@pytest.mark.parametrize(
    ("size", "fitted"), [((1280, 720), (960, 540)), ((800, 450), (800, 450)), ((720, 1280), (304, 540))]
)
def test_gif_keeps_the_ratio_of_the_size(size: tuple[int, int], fitted: tuple[int, int]) -> None:
    assert fit_size(size) == fitted


def read_gif(path: Path) -> tuple[list[int], list[Any]]:
    """Return the duration of each frame [ms], and the frames."""
    durations, frames = [], []
    with Image.open(path) as picture:
        for frame in ImageSequence.Iterator(picture):
            frames.append(np.asarray(frame.convert("RGB")))
            durations.append(frame.info["duration"])
    return durations, frames


@pytest.mark.parametrize("name", ["video.mp4", "run.gif", "step-01.png"])
def test_same_recording_gives_the_same_bytes(task: Task, recording: Recording, tmp_path: Path, name: str) -> None:
    contents = []
    for folder in (tmp_path / "one", tmp_path / "other"):
        folder.mkdir()
        frames = frames_of(task, recording)
        # Files that are written before do not change a file.
        if folder.name == "other" or name.startswith("step"):
            step_pictures(folder, frames)
        if not name.startswith("step"):
            (write_gif if name.endswith("gif") else write_video)(folder / name, frames)
        contents.append((folder / name).read_bytes())
    assert contents[0] == contents[1]


@pytest.mark.parametrize(("duration", "count"), [(0.0, 1), (0.05, 3), (1.0, 31), (1.01, 32), (5.9166667, 179)])
def test_frames_come_at_the_frame_rate_and_the_last_at_the_end(
    recording: Recording, duration: float, count: int
) -> None:
    times = frame_times(replace(recording, times=np.array([0.0, duration])))
    assert len(times) == count
    assert times[0] == 0.0
    assert times[-1] == duration
    assert np.all(np.diff(times) <= 1 / 30 + 1e-9)
    assert np.all(np.diff(times) > 0)


def test_one_picture_a_step(task: Task, recording: Recording, tmp_path: Path) -> None:
    paths = step_pictures(tmp_path, frames_of(task, recording))
    assert [path.name for path in paths] == ["step-01.png", "step-02.png"]
    assert sorted(tmp_path.iterdir()) == sorted(paths)
    first, second = (np.asarray(Image.open(path)) for path in paths)
    assert first.shape == second.shape == (SIZE[1], SIZE[0], 3)
    # Each picture shows the end of its step: the ball at 0.4 of the path, and at the end of the path.
    columns = columns_in((first, second), task, recording)
    assert columns[0] == pytest.approx(0.4 * (SIZE[0] - 10), abs=2)
    assert columns[1] == SIZE[0] - 10
    assert not np.array_equal(first[-30:], second[-30:]), "the captions differ"


@pytest.mark.parametrize("write", [write_video, write_gif])
def test_nothing_is_left_where_drawing_fails(
    task: Task, recording: Recording, tmp_path: Path, write: Callable[..., Any]
) -> None:
    class Fails(Columns):
        calls = 0

        def picture(self, state: State) -> Any:
            self.calls += 1
            if self.calls > 3:
                raise RuntimeError("out of paint")
            return super().picture(state)

    with pytest.raises(RuntimeError, match="out of paint"):
        write(tmp_path / "run.mp4", frames_of(task, recording, Fails))
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("write", [write_video, write_gif, step_pictures])
def test_folder_that_is_not_there_is_an_input_error(
    task: Task, recording: Recording, tmp_path: Path, write: Callable[..., Any]
) -> None:
    with pytest.raises(InputError, match="nowhere"):
        write(tmp_path / "nowhere" / "video.mp4", frames_of(task, recording))


def test_allocation_names_the_roles() -> None:
    rolling = BlockInstance("ROLLING-1", "ROLLING", {"hand": "hand", "object": "drum"}, 0, 1, {"region": "goal"})
    assert allocation(rolling) == "ROLLING: hand=hand, object=drum -> region=goal"
    assert allocation(replace(rolling, block="ROLLING:fast")).startswith("ROLLING (fast): hand=hand")
    assert allocation(instance("RESTING-1", "RESTING", "drum", 0, 1)) == "RESTING: token=drum"


def test_caption_names_the_step_that_runs(recording: Recording) -> None:
    captions = Captions(recording, "RESTING")
    assert [captions.index_at(time) for time in (0.0, 0.39, 0.4, 0.41, 1.0)] == [0, 0, 1, 1, 1]
    assert captions.headline(0.41).split() == ["step", "2", "of", "2", "t", "=", "0.41", "s"]
    assert [each.text for each in captions.paragraphs[0]] == ["WAITING: token=ball", "RESTING: Würfel"]


def test_verdict_comes_at_the_end(recording: Recording) -> None:
    missed = replace(recording, goal=(AtomMargin(Atom("near", ("ball", "spot")), -0.1),))
    stopped = replace(recording, failure=Failure(1, "WAITING-1", "nothing came"))
    texts = {}
    for run in (recording, missed, stopped):
        captions = Captions(run, "RESTING")
        assert captions.verdict(0.3) is None
        verdict = captions.verdict(1.0)
        assert verdict is not None
        texts[verdict.text] = verdict.good
    assert texts == {"goal reached": True, "goal missed": False, "stopped": False}


@pytest.mark.parametrize("kind", [Strips, Panel])
def test_verdict_is_in_the_corner_of_the_scene(task: Task, recording: Recording, kind: type[Layout]) -> None:
    layout = layout_of(task, recording, kind)
    plain = Image.new("RGB", layout.scene, (240, 240, 240))
    right, top = layout.corner[0] + layout.scene[0], layout.corner[1]
    before, after = (layout.frame(plain, time)[top : top + 40, right - 160 : right] for time in (0.3, 1.0))
    assert before.min() == 240
    green = (after[..., 1].astype(int) - after[..., 0] > 60).mean()
    assert green > 0.1


@pytest.mark.parametrize("kind", [Strips, Panel])
@pytest.mark.parametrize("size", [(320, 240), (640, 360), (1280, 720), (400, 1200)])
def test_long_captions_stay_outside_the_scene_and_inside_the_frame(
    task: Task, recording: Recording, kind: type[Layout], size: tuple[int, int]
) -> None:
    slots = {f"slot{i}": f"token{i}" for i in range(12)} | {"last": "x" * 200}
    crowded = replace(recording, instances=tuple(BlockInstance(f"W-{i}", "WAITING", slots, 0.0, 1.0) for i in range(9)))
    for run in (recording, crowded):
        layout = layout_of(task, run, kind, size)
        (left, top), (width, height) = layout.corner, layout.scene
        assert width >= size[0] / 2
        assert height >= size[1] / 3
        assert left + width <= size[0]
        assert top + height <= size[1]
        frame = layout.frame(Image.new("RGB", layout.scene, (240, 240, 240)), 0.2)
        assert frame.shape == (size[1], size[0], 3)
        # The scene and the margin of the frame contain no text.
        assert (frame[top + 1 : top + height - 1, left + 1 : left + width - 1] == 240).all()
        assert frame[:2].min() >= 200
        assert frame[-2:].min() >= 200


def test_run_that_never_began_still_gets_a_caption(task: Task, recording: Recording) -> None:
    nothing = replace(recording, instances=(), times=np.zeros(1), states=recording.states[:1])
    layout = layout_of(task, nothing)
    assert layout.frame(Image.new("RGB", layout.scene, (255, 255, 255)), 0.0).min() < 100

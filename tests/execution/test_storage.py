"""Recordings do not change when they are written and read. Files with other contents are refused with a message."""

import io
import json
import zipfile
from collections.abc import Callable, Mapping
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from predicted_runs import predict

from hybrid_tamp.errors import InputError
from hybrid_tamp.execution import storage
from hybrid_tamp.execution.storage import load_recording, save
from hybrid_tamp.model.contacts import Contact
from hybrid_tamp.model.plan import BlockInstance
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.recording import AtomMargin, Failure, Recording
from hybrid_tamp.model.state import StateLayout

TIMESTEP = 1 / 240
Change = Callable[[dict[str, bytes]], Mapping[str, bytes]]

names = st.text(min_size=1, max_size=8)
numbers = st.floats(allow_nan=False, allow_infinity=False, width=64)
words = names.filter(lambda name: not set("(,") & set(name))
atoms = st.builds(Atom, words, st.lists(words, max_size=3).map(tuple), st.booleans())
margins = st.builds(AtomMargin, atoms, st.none() | st.floats(allow_nan=False), st.none() | st.floats(allow_nan=False))
pairs = st.tuples(names, names)
contacts = st.builds(Contact, pairs, pairs, numbers, numbers)
entries = st.lists(st.tuples(names, names, st.integers(1, 4)), max_size=3).map(tuple)


@st.composite
def recordings(draw: Any) -> Recording:
    layout, commands_layout = StateLayout(draw(entries)), draw(entries)
    rows = draw(st.integers(1, 4))
    width = sum(size for _, _, size in commands_layout)

    def array(*shape: int) -> Any:
        count = int(np.prod(shape))
        return np.array(draw(st.lists(numbers, min_size=count, max_size=count)), dtype=float).reshape(shape)

    instances = tuple(
        BlockInstance(
            name,
            draw(names),
            draw(st.dictionaries(names, names, max_size=2)),
            0.0,
            (rows - 1) * TIMESTEP,
            draw(st.dictionaries(names, names, max_size=2)),
            draw(st.dictionaries(names, numbers, max_size=2)),
            draw(st.none() | numbers),
        )
        for name in draw(st.lists(names, unique=True, max_size=3))
    )
    several = st.lists(margins, max_size=2).map(tuple)
    return Recording(
        layout=layout,
        commands_layout=commands_layout,
        times=np.arange(rows) * TIMESTEP,
        states=array(rows, layout.size),
        commands=array(rows - 1, width),
        instances=instances,
        exits={instance.name: draw(several) for instance in instances},
        goal=draw(several),
        backend=draw(names),
        timestep=TIMESTEP,
        failure=draw(st.none() | st.builds(Failure, st.integers(1, 9), names, names, several)),
        warnings=draw(st.lists(names, max_size=2).map(tuple)),
        contacts=draw(st.lists(contacts, max_size=2).map(tuple)),
    )


def same(one: Recording, other: Recording) -> bool:
    for field in fields(Recording):
        mine, theirs = getattr(one, field.name), getattr(other, field.name)
        if isinstance(mine, np.ndarray):
            if mine.tobytes() != theirs.tobytes() or mine.shape != theirs.shape or mine.dtype != theirs.dtype:
                return False
        elif mine != theirs:
            return False
    return True


@settings(deadline=None, max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(recording=recordings())
def test_what_is_saved_is_loaded(tmp_path: Path, recording: Recording) -> None:
    path = tmp_path / "recording.npz"
    save(recording, path)
    assert same(load_recording(path), recording)
    assert [file.name for file in tmp_path.iterdir()] == ["recording.npz"]


@pytest.fixture
def good(tmp_path: Path, toys: Any) -> Path:
    path = tmp_path / "recording.npz"
    save(predict(toys.one_move_task(), toys.one_move()), path)
    return path


@pytest.fixture
def whole(good: Path) -> bytes:
    return good.read_bytes()


def members(path: Path) -> dict[str, bytes]:
    with zipfile.ZipFile(path) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def written(path: Path, contents: Mapping[str, bytes]) -> None:
    with zipfile.ZipFile(path, "w") as archive:
        for name, data in contents.items():
            archive.writestr(name, data)


def npy(array: Any, **options: Any) -> bytes:
    file = io.BytesIO()
    np.lib.format.write_array(file, np.asarray(array), **options)
    return file.getvalue()


def array(name: str, change: Callable[[Any], Any], **options: Any) -> Change:
    """Return a change of one array of the archive."""

    def changed(contents: dict[str, bytes]) -> Mapping[str, bytes]:
        old = np.load(io.BytesIO(contents[f"{name}.npy"]))
        return contents | {f"{name}.npy": npy(change(old.copy()), **options)}

    return changed


def document(change: Callable[[dict[str, Any]], Any]) -> Change:
    """Return a change of the JSON document."""

    def changed(contents: dict[str, bytes]) -> Mapping[str, bytes]:
        old = json.loads(np.load(io.BytesIO(contents["document.npy"])).tobytes())
        new = change(old)
        text = new if isinstance(new, bytes) else json.dumps(old if new is None else new).encode()
        return contents | {"document.npy": npy(np.frombuffer(text, dtype=np.uint8))}

    return changed


def holed(values: Any) -> Any:
    values[3, 0] = np.nan
    return values


def header(text: str, size: int = 0) -> bytes:
    body = (text + "\n").encode()
    return b"\x93NUMPY\x01\x00" + len(body).to_bytes(2, "little") + body + bytes(size)


def set_in(key: str, value: Any) -> Change:
    return document(lambda old: old | {key: value})


def twice(old: dict[str, Any]) -> dict[str, Any]:
    return old | {"instances": [old["instances"][0], *old["instances"]]}


def ends_late(old: dict[str, Any]) -> None:
    old["instances"][-1]["end"] = 1e6


def endless(old: dict[str, Any]) -> None:
    old["instances"][-1]["start"] = float("-inf")


def no_number(old: dict[str, Any]) -> None:
    old["goal"][0]["measured"] = float("nan")


def no_atom(old: dict[str, Any]) -> None:
    old["goal"][0]["atom"] = "near"


def endless_force(old: dict[str, Any]) -> None:
    old["contacts"] = [{"tokens": ["one", "other"], "instances": ["A", "B"], "force": float("inf"), "time": 0.0}]


def test_a_recording_from_before_contacts_were_measured_is_read(good: Path) -> None:
    written(good, document(lambda old: {name: old[name] for name in old if name != "contacts"})(members(good)))
    assert load_recording(good).contacts == ()


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda c: {name: data for name, data in c.items() if name != "states.npy"}, "missing: .*states.npy"),
        (lambda c: c | {"more.npy": c["times.npy"]}, "unexpected members: .*more.npy"),
        (array("states", lambda a: a[:, :-1]), r"states must have the shape .*, got"),
        (array("states", lambda a: a[:-1]), "states must have the shape"),
        (array("states", np.ravel), "states must have 2 dimensions"),
        (array("commands", lambda a: a[:-1]), "commands must have the shape"),
        (array("commands", lambda a: np.hstack([a, a])), "commands must have the shape"),
        (array("states", lambda a: a.astype(np.float32)), "states must have type float64"),
        (array("states", lambda a: a.astype(">f8")), "states must have type float64"),
        (array("states", np.asfortranarray), "got type <f8 in Fortran order"),
        (array("states", lambda a: a.astype(object), allow_pickle=True), "must have type float64"),
        (array("states", holed), "states must be finite"),
        (array("commands", holed), "commands must be finite"),
        (array("times", lambda a: a[:0]), "at least one row"),
        (array("times", lambda a: a * 1.001), "successive multiples of the control period"),
        (array("times", lambda a: a, version=(3, 0)), "must begin with the header"),
        (lambda c: c | {"times.npy": b""}, "must begin with the header"),
        (lambda c: c | {"times.npy": c["times.npy"][:-9]}, "got shape"),
        (
            lambda c: c | {"times.npy": header("{'descr': '<f8', 'fortran_order': False, 'shape': (10**12,), }")},
            "must begin with the header",
        ),
        (
            lambda c: c | {"times.npy": header("{'descr': '<f8', 'fortran_order': False, 'shape': (999999999999,), }")},
            "got shape",
        ),
        (
            lambda c: c | {"times.npy": header("{'descr': '<f8', 'fortran_order': False, 'shape': (-1,), }", 8)},
            "must begin with the header",
        ),
        (lambda c: c | {"times.npy": header("{[]: 1}")}, "must begin with the header"),
        (lambda c: c | {"times.npy": header("(" * 9000)}, "must begin with the header"),
        (
            lambda c: c | {"times.npy": header("{'descr': '<f8', 'fortran_order': False, 'shape': (3L,), }")},
            "must begin with the header",
        ),
        (document(lambda old: b"{"), "invalid JSON document"),
        (document(lambda old: b"\xff\xfe"), "invalid JSON document"),
        (document(lambda old: b"[" * 100_000), "invalid JSON document"),
        (document(lambda old: []), "invalid JSON document"),
        (set_in("version", "hybrid-tamp/recording/0"), "invalid JSON document at version"),
        (set_in("surprise", 1), "invalid JSON document at surprise"),
        (set_in("timestep", 0), "invalid JSON document at timestep"),
        (set_in("timestep", float("inf")), "invalid JSON document at timestep"),
        (set_in("backend", 3), "invalid JSON document at backend"),
        (set_in("layout", [["hand", "position", -3]]), "invalid JSON document at layout.0"),
        (set_in("exits", {"NOBODY-1": []}), "must belong to recorded instances, got NOBODY-1"),
        (document(twice), "names of instances must be unique"),
        (document(ends_late), "must run within the recording"),
        (document(endless), "must be finite"),
        (document(no_number), "must be a number, got NaN"),
        (document(no_atom), "invalid JSON document at goal.0.atom"),
        (document(endless_force), "contact between one and other must be finite"),
    ],
)
def test_broken_recording_is_refused_with_words(good: Path, change: Change, said: str) -> None:
    written(good, change(members(good)))
    with pytest.raises(InputError, match=said) as refused:
        load_recording(good)
    assert str(good) in str(refused.value)


def test_what_is_no_archive_is_refused(tmp_path: Path, good: Path, whole: bytes) -> None:
    for contents in (b"", b"states: [1, 2]", whole[: len(whole) // 2], whole[:-30], whole[50:]):
        good.write_bytes(contents)
        with pytest.raises(InputError, match=r"recording\.npz"):
            load_recording(good)
    for path in (tmp_path / "nowhere.npz", tmp_path):
        with pytest.raises(InputError):
            load_recording(path)


def test_claimed_size_is_refused_before_it_is_read(good: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(storage, "MAXIMAL_SIZE", 100)
    with pytest.raises(InputError, match=r"must not exceed 100 bytes, got \d+"):
        load_recording(good)


@settings(deadline=None, max_examples=200, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_flipped_bytes_never_raise_anything_else(good: Path, whole: bytes, data: Any) -> None:
    broken = bytearray(whole)
    # An archive is most sensitive to damage at its ends and in the headers of its members.
    places = [*range(60), *range(len(whole) - 400, len(whole)), *range(0, len(whole), 97)]
    for _ in range(data.draw(st.integers(1, 3))):
        broken[data.draw(st.sampled_from(places))] = data.draw(st.integers(0, 255))
    good.write_bytes(bytes(broken))
    try:
        recording = load_recording(good)
    except InputError:
        return
    assert np.isfinite(recording.states).all()


def test_a_failed_save_leaves_the_old_file_and_nothing_else(good: Path, toys: Any) -> None:
    before = good.read_bytes()
    recording = load_recording(good)
    with pytest.raises(TypeError):
        save(replace(recording, states=np.array([object()])), good)
    assert good.read_bytes() == before
    assert [file.name for file in good.parent.iterdir()] == [good.name]

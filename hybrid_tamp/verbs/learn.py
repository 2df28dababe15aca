"""Learning a block's motor primitive from what was shown: files of time and position, or the folders of runs."""

import json
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

import numpy as np

from hybrid_tamp.errors import InputError, Issue
from hybrid_tamp.model.block import Block, Movement
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.plan import TIME_TOLERANCE, BlockInstance
from hybrid_tamp.model.state import State
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.demonstration import ShownMovement, learnt
from hybrid_tamp.report.folder import RunFolder
from hybrid_tamp.taskfile.demonstrations import read_demonstration
from hybrid_tamp.taskfile.domains import available_domains, find_domain
from hybrid_tamp.taskfile.primitives import PrimitiveFile

WEIGHTS = 20
"""Number of basis functions, unless said otherwise."""


def learn(
    block: str,
    demonstrations: Iterable[Path | str],
    *,
    domain: Domain | str | None = None,
    token: str | None = None,
    weights: int = WEIGHTS,
) -> PrimitiveFile:
    """Fit a block's motor primitive to demonstrations.

    Args:
        block: name of a block, or of an action whose modes all move alike, e.g. ``"REACHING:behind"``.
        demonstrations: CSV files of time and position or pose; or folders of runs, of which every instance of the
            block is a demonstration, from its beginning until its exit conditions held.
        domain: the domain or its name; by default the installed one that has the block.
        token: which token is to be seen in a run, where several are.
        weights: number of basis functions.

    Returns:
        The primitive with its sources and its distance from them; `save_primitive` writes it.

    Raises:
        InputError: a demonstration, the block, the domain or the number of weights is wrong; with the place.
    """
    paths = [Path(path) for path in demonstrations]
    if not paths or weights < 1:
        raise InputError([Issue("learn", "at least one demonstration and one weight", f"{len(paths)} and {weights}")])
    blocks, movement = _taught(block, domain)
    shown = [one for path in paths for one in _shown(path, blocks, movement, token)]
    return _fitted(block, shown, movement, weights)


def _fitted(block: str, shown: Sequence[ShownMovement], movement: Movement, weights: int) -> PrimitiveFile:
    try:
        primitive, rms = learnt(shown, movement.moves, movement.dimensions, weights)
    except ValueError as error:
        raise InputError([Issue(block, f"cannot be learnt: {error}")]) from error
    unit = "rad" if movement.dimensions == 1 and movement.moves == "orientation" else "m"
    return PrimitiveFile.of(primitive, block, [one.source for one in shown], rms, unit)


def save_primitive(primitive: PrimitiveFile, path: Path, *, force: bool = False) -> None:
    """Write a primitive as JSON, at once as a whole.

    Raises:
        InputError: there is a file already and `force` is not given, or it cannot be written.
    """
    if path.is_dir() or (path.exists() and not force):
        came = "a folder" if path.is_dir() else "a file that is there already"
        raise InputError([Issue(str(path), "a new file for the primitive", came, remedy="--force replaces a file")])
    text = json.dumps(primitive.dump(), indent=1, ensure_ascii=False, allow_nan=False)
    RunFolder(path.parent).write_text(path.name, text + "\n")


def _taught(name: str, domain: Domain | str | None) -> tuple[list[Block], Movement]:
    """Return the blocks of a name and what their primitive moves."""
    if domain is None:
        domains = [find_domain(installed) for installed in available_domains()]
    else:
        domains = [find_domain(domain) if isinstance(domain, str) else domain]
    blocks = [block for one in domains for block in one.blocks]
    able = [block for block in blocks if block.taught and block.movement]
    found = [block for block in able if name in (block.name, block.action)]
    if not found:
        known = sorted({word for block in able for word in (block.name, block.action)})
        said = "has no motor primitive" if any(name in (b.name, b.action) for b in blocks) else "is no block"
        raise InputError([Issue("BLOCK", f"{name} {said}", repr(name), tuple(known))])
    movements = {block.movement for block in found if block.movement}
    if len(movements) > 1:
        modes = tuple(block.name for block in found)
        raise InputError([Issue("BLOCK", f"the modes of {name} move differently: name one", available=modes)])
    return found, movements.pop()


def _shown(path: Path, blocks: Sequence[Block], movement: Movement, token: str | None) -> list[ShownMovement]:
    if not path.is_dir():
        shown = [read_demonstration(path)]
    else:
        from hybrid_tamp.execution.storage import load

        recording = load(path / "recording.npz")
        names = [block.name for block in blocks]
        instances = [one for one in recording.instances if one.block in names]
        there = sorted({one.slots[movement.slot] for one in instances})
        chosen = [one for one in instances if token in (None, one.slots[movement.slot])]
        if not chosen:
            wanted = f"a run with an instance of {' or '.join(names)}" + (f" with {token}" if token and there else "")
            raise InputError([Issue(str(path), wanted, available=tuple(there))])
        shown = list(movements(path.name, recording.times, recording.trajectory, chosen, movement))
    for one in shown:
        try:
            one.way(movement.moves, movement.dimensions)
        except ValueError as error:
            raise InputError([Issue(str(path), f"{one.source} does not show {blocks[0].name}: {error}")]) from error
    return shown


def learn_from(
    block: Block,
    source: str,
    times: FloatArray,
    trajectory: State,
    instances: Iterable[BlockInstance],
    weights: int = WEIGHTS,
) -> PrimitiveFile:
    """Fit a block's motor primitive to instances of it that were seen.

    Args:
        block: the block, which has a motor primitive.
        source: what the instances were seen in.
        times: instants [s], shape ``(t,)``.
        trajectory: states at the instants, batch shape ``(t,)``.
        instances: the instances.
        weights: number of basis functions.

    Raises:
        InputError: they show no movement that the block could be taught.
    """
    movement = block.movement
    assert movement is not None, "a block that is taught says what its primitive moves"
    return _fitted(block.name, list(movements(source, times, trajectory, instances, movement)), movement, weights)


def movements(
    source: str, times: FloatArray, trajectory: State, instances: Iterable[BlockInstance], movement: Movement
) -> Iterator[ShownMovement]:
    """Yield what each instance shows: from its beginning until its exit conditions held.

    Args:
        source: what the instances were seen in.
        times: instants [s], shape ``(t,)``.
        trajectory: states at the instants, batch shape ``(t,)``.
        instances: the instances.
        movement: what of them is wanted.
    """
    for instance in instances:
        end = instance.active.end + TIME_TOLERANCE
        rows = np.flatnonzero((times >= instance.start - TIME_TOLERANCE) & (times <= end))
        token = instance.slots[movement.slot]
        turns = (token, "orientation") in trajectory.layout.slices
        yield ShownMovement(
            f"{source}/{instance.name}",
            times[rows],
            trajectory[token, "position"][rows],
            trajectory[token, "orientation"][rows] if turns else None,
        )

"""The verb ``learn``: fit a motor primitive to demonstrations, which are files of poses or folders of runs."""

from collections.abc import Iterable, Sequence
from pathlib import Path

from hybrid_tamp.errors import InputError, Issue
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.movement import Movement
from hybrid_tamp.model.recording import demonstrated_movements
from hybrid_tamp.motion.demonstration import ShownMovement, learnt
from hybrid_tamp.report.folder import write_new_file
from hybrid_tamp.taskfile.demonstrations import read_demonstration
from hybrid_tamp.taskfile.domains import available_domains, find_domain
from hybrid_tamp.taskfile.primitives import PrimitiveFile

WEIGHTS = 20
"""Default number of basis functions."""


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
        block: name of a block, e.g. ``"REACHING:behind"``, or of an action whose modes share one kind of movement.
        demonstrations: folders of runs, or CSV files of timed positions or poses. Every instance of the block in a
            run is a demonstration that ends as soon as the exit conditions of the instance hold.
        domain: the domain or its name; by default the installed domain that has the block.
        token: name of a token. Only instances of the block that move this token are used; by default all instances.
        weights: number of basis functions.

    Returns:
        The primitive, its error and the names of its demonstrations. `save_primitive` writes the result to a file.

    Raises:
        InputError: a demonstration, the block, the domain or the number of weights is wrong.
    """
    paths = [Path(path) for path in demonstrations]
    if not paths or weights < 1:
        given = f"{len(paths)} demonstrations and {weights} weights"
        raise InputError([Issue("learn", "the input must contain at least one demonstration and one weight", given)])
    blocks, movement = _find_blocks(block, domain)
    shown = []
    for path in paths:
        found = _read_run(path, blocks, movement, token) if path.is_dir() else [read_demonstration(path)]
        _check_movements(path, found, blocks[0], movement)
        shown += found
    return fit_primitive(block, shown, movement, weights)


def fit_primitive(
    block: str, shown: Sequence[ShownMovement], movement: Movement, weights: int = WEIGHTS
) -> PrimitiveFile:
    """Fit a primitive to demonstrated movements.

    Args:
        block: name of the block or action.
        shown: the demonstrated movements.
        movement: the kind of movement that the primitive generates.
        weights: number of basis functions.

    Raises:
        InputError: no primitive can be fitted to the movements.
    """
    try:
        primitive, rms = learnt(shown, movement.moves, movement.dimensions, weights)
    except ValueError as error:
        raise InputError([Issue(block, f"cannot fit a motor primitive: {error}")]) from error
    unit = "rad" if movement.dimensions == 1 and movement.moves == "orientation" else "m"
    return PrimitiveFile.of(primitive, block, [one.source for one in shown], rms, unit)


def save_primitive(primitive: PrimitiveFile, path: Path, *, force: bool = False) -> None:
    """Write a primitive as JSON. The file has a temporary name until all of the text is written.

    Raises:
        InputError: the file exists and `force` is false, or the file cannot be written.
    """
    write_new_file(path, primitive.text, "the primitive", force=force)


def _find_blocks(name: str, domain: Domain | str | None) -> tuple[list[Block], Movement]:
    """Return the blocks with this name or action, and the kind of movement that their primitive generates."""
    domains = available_domains() if domain is None else (domain,)
    blocks = [block for one in domains for block in (find_domain(one) if isinstance(one, str) else one).blocks]
    able = [block for block in blocks if block.taught and block.movement]
    found = [block for block in able if name in (block.name, block.action)]
    if not found:
        known = sorted({word for block in able for word in (block.name, block.action)})
        exists = any(name in (block.name, block.action) for block in blocks)
        wanted = "the block must have a motor primitive" if exists else "must be the name of a block or action"
        raise InputError([Issue("block", wanted, repr(name), tuple(known))])
    movements = {block.movement for block in found if block.movement}
    if len(movements) > 1:
        modes = tuple(block.name for block in found)
        wanted = f"the modes of {name} have different kinds of movement; specify which mode to use"
        raise InputError([Issue("block", wanted, available=modes)])
    return found, movements.pop()


def _read_run(path: Path, blocks: Sequence[Block], movement: Movement, token: str | None) -> list[ShownMovement]:
    """Return the movements of all instances of the blocks in a recorded run."""
    from hybrid_tamp.execution.storage import load_recording

    recording = load_recording(path / "recording.npz")
    names = [block.name for block in blocks]
    instances = [one for one in recording.instances if one.block in names]
    there = sorted({one.slots[movement.slot] for one in instances})
    chosen = [one for one in instances if token in (None, one.slots[movement.slot])]
    if not chosen:
        moving = f" that moves {token}" if token and there else ""
        wanted = f"the run must contain an instance of {' or '.join(names)}{moving}"
        raise InputError([Issue(str(path), wanted, available=tuple(there))])
    return list(demonstrated_movements(path.name, recording.times, recording.trajectory, chosen, movement))


def _check_movements(path: Path, shown: Iterable[ShownMovement], block: Block, movement: Movement) -> None:
    """Raise `InputError` if a movement is not of the kind that the block's primitive generates."""
    for one in shown:
        try:
            one.way(movement.moves, movement.dimensions)
        except ValueError as error:
            raise InputError([Issue(str(path), f"{one.source} cannot teach {block.name}: {error}")]) from error

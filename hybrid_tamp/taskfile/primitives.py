"""Read files of motor primitives and replace the primitives of a domain's blocks.

A primitive file is JSON. It is parsed like a task file, so every fault has a line and a column. No code in the
file is ever run.
"""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from hybrid_tamp.model.affordance import Number
from hybrid_tamp.model.authored import authored
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.motion.dmp import DMP
from hybrid_tamp.taskfile.places import Faults, KeyPath, shown
from hybrid_tamp.taskfile.wording import add_validation_faults
from hybrid_tamp.taskfile.yaml.nodes import parse, read_text

PRIMITIVE = "hybrid-tamp/primitive/1"
_FILE = "a primitive file must be a JSON object that 'hybrid-tamp learn' wrote"
Weight = Annotated[Number, Field(ge=-1e9, le=1e9)]
Rate = Annotated[Number, Field(gt=0, le=1e4)]
"""A positive rate per unit of normalised time."""


class PrimitiveFile(BaseModel):
    """A file with a motor primitive and the names of its demonstrations."""

    model_config = ConfigDict(extra="forbid", frozen=True, populate_by_name=True)

    schema_: Literal["hybrid-tamp/primitive/1"] = Field(alias="schema", description="name and version of the format")
    block: str = Field(description="the demonstrated block or action", min_length=1)
    dimensions: Literal[1, 3] = Field(description="3 for a position, 1 for a fraction of a path")
    weights: list[list[Weight]] = Field(
        description="one row per basis function [m, or fraction of the path]", min_length=1
    )
    alpha: Rate = Field(description="damping of the spring")
    beta: Rate = Field(description="ratio of stiffness to damping")
    alpha_phase: Rate = Field(description="decay rate of the phase")
    soft_start: bool = Field(description="whether the attraction to the goal starts at zero and grows")
    sources: list[str] = Field(description="names of the demonstrations")
    rms: Annotated[Number, Field(ge=0)] = Field(description="root mean square error over the demonstrations [unit]")
    unit: Literal["m", "rad"] = Field(description="unit of rms")

    @classmethod
    def of(cls, primitive: DMP, block: str, sources: Sequence[str], rms: float, unit: str) -> "PrimitiveFile":
        """Return a file for a primitive, with the names of the demonstrations and the error over the demonstrations."""
        return cls.model_validate(
            {
                "schema": PRIMITIVE,
                "block": block,
                "dimensions": primitive.weights.shape[1],
                "weights": primitive.weights.tolist(),
                "alpha": primitive.alpha,
                "beta": primitive.beta,
                "alpha_phase": primitive.alpha_phase,
                "soft_start": primitive.soft_start,
                "sources": list(sources),
                "rms": rms,
                "unit": unit,
            }
        )

    @property
    def primitive(self) -> DMP:
        """The primitive in the file."""
        return DMP(np.array(self.weights), self.alpha, self.beta, self.alpha_phase, self.soft_start)

    @property
    def text(self) -> str:
        """The content of the file as JSON."""
        return json.dumps(self.model_dump(by_alias=True), indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def read_primitive(path: Path | str) -> PrimitiveFile:
    """Read a primitive file.

    Raises:
        InputError: the file has faults; the issues list all faults with their lines and columns.
    """
    document = parse(read_text(Path(path), "a primitive file"), str(path), _FILE)
    faults = document.faults
    try:
        file = PrimitiveFile.model_validate(document.data)
    except ValidationError as error:
        add_validation_faults(faults, error, PrimitiveFile, whole="the primitive file")
        faults.raise_all()
    for index, row in enumerate(file.weights):
        if len(row) != file.dimensions:
            wanted = f"a row of weights must have one number per dimension ({file.dimensions})"
            faults.at(("weights", index), wanted, f"{len(row)}")
    faults.raise_if_any()
    return file


def teach(data: dict[str, Any], faults: Faults, domain: Domain | None, folder: Path) -> Domain | None:
    """Return the domain with the primitives that a task file names, and record faults of the primitives.

    Args:
        data: the data of the task file.
        faults: the places and faults of the task file.
        domain: the domain, or None if the domain was not found.
        folder: folder to which relative paths in the task file refer.
    """
    entries = data.get("primitives", {})
    if domain is None or not isinstance(entries, dict):
        return domain
    taught: dict[str, Block] = {}
    # Entries for modes are read last, so that they replace entries for whole actions.
    for key in sorted(entries, key=lambda name: name in domain.block_by_name):
        path: KeyPath = ("primitives", key)
        if faults.sound(path) and isinstance(entries[key], str):
            taught |= {block.name: block for block in _taught(key, folder / entries[key], path, faults, domain)}
    return domain.with_blocks(taught.values()) if taught else domain


def teach_block(block: Block, primitive: DMP) -> Block:
    """Return a copy of a block with another motor primitive."""
    assert block.taught is not None, f"the block {block.name} has no motor primitive"
    with authored(f"{block.name}.taught", {}):
        return block.taught(primitive)


def _taught(key: str, file: Path, path: KeyPath, faults: Faults, domain: Domain) -> list[Block]:
    named = [block for block in domain.blocks if key in (block.name, block.action)]
    able = [block for block in domain.blocks if block.taught and block.movement]
    if not any(block in able for block in named):
        names = sorted({name for block in able for name in (block.name, block.action)})
        wanted = f"must be a block of the domain {domain.name} with a motor primitive"
        faults.at(path, wanted, shown(key), names, key=True)
        return []
    primitive = None
    with faults.collecting(path):
        primitive = read_primitive(file)
    if primitive is None:
        return []
    fitting = [
        teach_block(block, primitive.primitive)
        for block in named
        if block.taught and block.movement and block.movement.dimensions == primitive.dimensions
    ]
    if not fitting:
        needed = " or ".join(sorted({str(block.movement.dimensions) for block in named if block.movement}))
        faults.at(path, f"the primitive of {key} must have dimension {needed}", str(primitive.dimensions))
    return fitting

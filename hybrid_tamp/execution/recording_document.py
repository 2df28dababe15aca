"""JSON document of a recording. The document contains everything but the arrays, and stores atoms as text."""

import math
from collections.abc import Mapping
from typing import Annotated, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, FiniteFloat, PositiveInt

from hybrid_tamp.model.contacts import Contact
from hybrid_tamp.model.plan import TIME_TOLERANCE, BlockInstance
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.recording import AtomMargin, Failure, Recording
from hybrid_tamp.model.state import StateLayout
from hybrid_tamp.motion.arrays import FloatArray

_STRICT = ConfigDict(extra="forbid", strict=True, ser_json_inf_nan="constants")
_Entry = tuple[str, str, PositiveInt]
_COMMON = ("commands_layout", "instances", "backend", "timestep", "warnings", "contacts")
"""Names of the attributes that a recording and its document share without conversion."""


class _Margin(BaseModel):
    """A margin with its atom as text."""

    model_config = _STRICT

    atom: str = Field(pattern=r"(?s)^[^(]+\(.*\)$")
    measured: float | None
    predicted: float | None = None

    @classmethod
    def of(cls, margin: AtomMargin) -> "_Margin":
        return cls(atom=margin.atom.text, measured=margin.measured, predicted=margin.predicted)

    def read(self) -> AtomMargin:
        predicate, _, rest = self.atom.removeprefix("not ").partition("(")
        arguments = tuple(rest[:-1].split(", ")) if rest != ")" else ()
        atom = Atom(predicate, arguments, positive=not self.atom.startswith("not "))
        return AtomMargin(atom, self.measured, self.predicted)


class _Failure(BaseModel):
    """A failure with its atoms as text."""

    model_config = _STRICT

    step: int
    instance: str
    reason: str
    margins: tuple[_Margin, ...] = ()
    contact: Contact | None = None

    @classmethod
    def of(cls, failure: Failure) -> "_Failure":
        same = {name: getattr(failure, name) for name in ("step", "instance", "reason", "contact")}
        return cls(margins=tuple(map(_Margin.of, failure.margins)), **same)

    def read(self) -> Failure:
        margins = tuple(margin.read() for margin in self.margins)
        return Failure(self.step, self.instance, self.reason, margins, self.contact)


class RecordingDocument(BaseModel):
    """JSON document of a recording, without the arrays."""

    model_config = _STRICT

    version: Literal["hybrid-tamp/recording/1"]
    layout: tuple[_Entry, ...]
    commands_layout: tuple[_Entry, ...]
    instances: tuple[BlockInstance, ...]
    exits: dict[str, tuple[_Margin, ...]]
    goal: tuple[_Margin, ...]
    backend: str
    timestep: Annotated[FiniteFloat, Field(gt=0)]
    failure: _Failure | None
    warnings: tuple[str, ...]
    contacts: tuple[Contact, ...] = ()

    @classmethod
    def of(cls, recording: Recording) -> "RecordingDocument":
        """Return the document of a recording."""
        return cls(
            version="hybrid-tamp/recording/1",
            layout=recording.layout.entries,
            exits={instance: tuple(map(_Margin.of, margins)) for instance, margins in recording.exits.items()},
            goal=tuple(map(_Margin.of, recording.goal)),
            failure=None if recording.failure is None else _Failure.of(recording.failure),
            **{name: getattr(recording, name) for name in _COMMON},
        )

    def read(self, arrays: Mapping[str, FloatArray]) -> Recording:
        """Return the recording with the arrays "times" ``(t,)``, "states" ``(t, n)`` and "commands" ``(t - 1, m)``."""
        return Recording(
            layout=StateLayout(self.layout),
            times=arrays["times"],
            states=arrays["states"],
            commands=arrays["commands"],
            exits={instance: tuple(each.read() for each in margins) for instance, margins in self.exits.items()},
            goal=tuple(margin.read() for margin in self.goal),
            failure=None if self.failure is None else self.failure.read(),
            **{name: getattr(self, name) for name in _COMMON},
        )


def find_fault(recording: Recording) -> str:
    """Return a description of the first inconsistency in a recording, or an empty string."""
    rows = len(recording.times)
    width = sum(size for _, _, size in recording.commands_layout)
    shapes = {
        "states": (recording.states.shape, (rows, recording.layout.size)),
        "commands": (recording.commands.shape, (rows - 1, width)),
    }
    if rows == 0:
        return "the recording must have at least one row, got none"
    for name, (shape, wanted) in shapes.items():
        if shape != wanted:
            return f"{name} must have the shape {wanted}, got {shape}"
    for name in ("times", "states", "commands"):
        if not np.isfinite(getattr(recording, name)).all():
            return f"{name} must be finite"
    if not np.allclose(recording.times, np.arange(rows) * recording.timestep, rtol=1e-9, atol=TIME_TOLERANCE):
        return f"times must be successive multiples of the control period of {recording.timestep:g} s"
    return _find_instances_fault(recording)


def _find_instances_fault(recording: Recording) -> str:
    names = [instance.name for instance in recording.instances]
    if len(set(names)) < len(names):
        return "names of instances must be unique"
    strange = sorted(set(recording.exits) - set(names))
    if strange:
        return f"exit conditions must belong to recorded instances, got {', '.join(strange)}"
    for contact in recording.contacts:
        if not (math.isfinite(contact.force) and math.isfinite(contact.time)):
            return f"force and time of the contact between {contact.pair} must be finite"
    for instance in recording.instances:
        numbers = (instance.start, instance.end, *instance.hyperparameters.values())
        if not all(map(math.isfinite, numbers)):
            return f"times and hyperparameters of {instance.name} must be finite"
        if not -TIME_TOLERANCE <= instance.start <= instance.end <= recording.duration + TIME_TOLERANCE:
            return f"{instance.name} must run within the recording, got {instance.start} s to {instance.end} s"
    failure = () if recording.failure is None else recording.failure.margins
    for margin in (*recording.goal, *failure, *(m for ms in recording.exits.values() for m in ms)):
        if any(value is not None and math.isnan(value) for value in (margin.measured, margin.predicted)):
            return f"the margin of {margin.atom.text} must be a number, got NaN"
    return ""

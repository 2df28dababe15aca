"""Captions for pictures of a run: the step, the time and the tokens in each block (as in the paper's Fig. 3)."""

from collections.abc import Iterator
from dataclasses import dataclass

from hybrid_tamp.model.plan import TIME_TOLERANCE, BlockInstance, Step
from hybrid_tamp.model.recording import Recording
from hybrid_tamp.report.tables import RESTING, name_some, roles_text

_VERDICT_TIME = 0.5


def allocation(instance: BlockInstance) -> str:
    """Return the tokens in the roles of a block, e.g. ``ROLLING: hand=hand, object=drum -> region=goal``."""
    mode = f" ({instance.mode})" if instance.mode else ""
    targets = f" -> {roles_text(instance.targets)}" if instance.targets else ""
    return f"{instance.action}{mode}: {roles_text(instance.slots)}{targets}"


@dataclass(frozen=True)
class Paragraph:
    """A paragraph of a caption. The paragraph with all resting tokens is pale."""

    text: str
    pale: bool = False


@dataclass(frozen=True)
class Verdict:
    """What a run has shown at its end."""

    text: str
    good: bool


class Captions:
    """The captions of one recording.

    Args:
        recording: the recording of the run.
        resting: name of the block in which tokens rest.
    """

    def __init__(self, recording: Recording, resting: str) -> None:
        self._recording = recording
        self._resting = resting
        self._steps = tuple(recording.plan.steps)
        self.paragraphs = tuple(tuple(self._describe(step)) for step in self._steps) or ((),)
        """Paragraphs of each step: one per busy instance, and one for all resting tokens."""

    def index_at(self, time: float) -> int:
        """Return the index (from 0) of the step at a time [s]. At a reassignment, return the later step's index."""
        return max(0, sum(step.start <= time + TIME_TOLERANCE for step in self._steps) - 1)

    def headline(self, time: float) -> str:
        """Return the step and the time as text. The time is in seconds."""
        return f"step {self.index_at(time) + 1} of {len(self.paragraphs)}    t = {time:.2f} s"

    @property
    def last_headline(self) -> str:
        """Headline at the end of the run, which is the widest."""
        return self.headline(self._recording.duration)

    def verdict(self, time: float) -> Verdict | None:
        """Return the verdict during the last half second of the run, and None before."""
        if time < self._recording.duration - _VERDICT_TIME:
            return None
        if self._recording.failure is not None:
            return Verdict("stopped", False)
        return Verdict("goal reached", True) if self._recording.success else Verdict("goal missed", False)

    def _describe(self, step: Step) -> Iterator[Paragraph]:
        busy = sorted((i for i in step.instances if i.block != self._resting), key=lambda i: (i.start, i.name))
        yield from (Paragraph(allocation(instance)) for instance in busy)
        resting = sorted(t for i in step.instances if i.block == self._resting for t in i.slots.values())
        if resting:
            yield Paragraph(f"{self._resting}: {name_some(resting, RESTING)}", pale=True)

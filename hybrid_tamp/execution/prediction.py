"""What the blocks' own forward models expect of a plan, beside what was measured."""

from collections.abc import Mapping
from dataclasses import replace

from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.recording import AtomMargin, Recording
from hybrid_tamp.model.refined import GOAL


def add_predictions(measured: Recording, expected: Mapping[tuple[str, Atom], float | None]) -> Recording:
    """Return the measured recording with what was predicted beside its margins.

    Args:
        measured: the recording.
        expected: (instance or `GOAL`, atom) to the margin; a condition without one stays without a prediction.
    """

    def add(where: str, margins: tuple[AtomMargin, ...]) -> tuple[AtomMargin, ...]:
        return tuple(replace(margin, predicted=expected.get((where, margin.atom))) for margin in margins)

    exits = {instance: add(instance, margins) for instance, margins in measured.exits.items()}
    return replace(measured, exits=exits, goal=add(GOAL, measured.goal))

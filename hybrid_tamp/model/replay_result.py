"""The result of a replay: whether the recorded commands gave the recorded states again, bit for bit."""

from dataclasses import dataclass

from hybrid_tamp.model.tables import Rows, Tabular


@dataclass(frozen=True)
class StateDifference:
    """Where the two runs part.

    Attributes:
        time: first instant at which a state differs [s].
        token: a token that differs there.
        property: its property that differs most.
        size: largest absolute difference of its components, in the property's unit.
    """

    time: float
    token: str
    property: str
    size: float


@dataclass(frozen=True)
class ReplayResult(Tabular):
    """The result of a replay.

    Attributes:
        identical: whether every state is the same to the last bit.
        steps: control periods that were simulated.
        first_difference: where the runs part, or None.
        refusal: why the backend refused a logged command; empty if it did not.
    """

    identical: bool
    steps: int
    first_difference: StateDifference | None = None
    refusal: str = ""

    @property
    def rows(self) -> Rows:
        """The comparison as a table."""
        first = self.first_difference
        where = first and f"{first.property} of {first.token} by {first.size:.3g} at {first.time:.3f} s"
        return [
            ("identical", self.identical),
            ("steps", self.steps),
            ("first difference", where),
            ("refusal", self.refusal),
        ]

"""The form of a task file: every key with its type, unit, bounds and description, as pydantic models.

The checks, the JSON Schema and the reference page are all derived from these models.
"""

import math
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BaseModel, ConfigDict, Discriminator, Field, Strict, Tag, model_validator

from hybrid_tamp.geometry.shapes import WrittenShape
from hybrid_tamp.model.affordance import Number, quantity
from hybrid_tamp.model.task import DEFAULT_PLANNER, Limits, MidLevel

Text = Annotated[str, Strict(), Field(min_length=1)]
Whole = Annotated[int, Strict()]
Bounded = Annotated[Number, Field(ge=-1000, le=1000)]
"""A coordinate, angle or component, bounded so that its square cannot overflow."""


def _has_length(quaternion: tuple[float, ...]) -> tuple[float, ...]:
    if math.hypot(*quaternion) < 1e-9:
        raise ValueError("a quaternion must not have length zero")
    return quaternion


Quaternion = Annotated[tuple[Bounded, Bounded, Bounded, Bounded], AfterValidator(_has_length)]


class _Entry(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class Pose(_Entry):
    """Where a token is at the beginning, in the world."""

    position: tuple[Bounded, Bounded, Bounded] = quantity("m", "of the body frame's origin: x, y, z")
    rpy: tuple[Bounded, Bounded, Bounded] | None = quantity(
        "rad", "roll, pitch and yaw about the world's fixed axes x, y, z in this order", default=None
    )
    quaternion: Quaternion | None = quantity("1", "rotation as x, y, z, w instead of rpy; is normalised", default=None)

    @model_validator(mode="after")
    def _one_rotation(self) -> "Pose":
        if self.rpy is not None and self.quaternion is not None:
            raise ValueError("a pose has rpy or quaternion, not both")
        return self


class TokenEntry(_Entry):
    """One object token: a thing, a part of a robot, or a place."""

    classes: list[Text] = Field(description="names of the domain's classes that it is a member of")
    unknown: list[Text] = Field(
        default_factory=list,
        description="names of classes of which it may or may not be a member; 'hybrid-tamp probe' finds out",
    )
    properties: dict[str, Any] = Field(
        default_factory=dict,
        description="fixed properties, the union of those of its classes; those of unknown classes may be missing",
    )
    shape: WrittenShape | None = Field(
        default=None, description="its geometry; default: what its classes imply, if anything"
    )
    pose: Pose | None = Field(default=None, description="where it is at the beginning; required if it has a position")


class LimitsEntry(_Entry):
    """Bounds on the work for the task."""

    time: Number = quantity("s", "wall-clock time of the planner", default=Limits.time, gt=0, le=1e6)
    memory: Number = quantity(
        "MiB", "memory of the planner and its children together", default=Limits.memory, gt=0, le=1e8
    )
    refinements: Whole = quantity(
        "1", "how many times to replan after a refused plan", default=Limits.refinements, ge=0, le=1000
    )


class RangeEntry(_Entry):
    """Bounds and default of a hyperparameter, in its own unit; a key that is left out keeps the block's value."""

    lower: Number | None = Field(default=None, description="lower bound, not below the block's own")
    upper: Number | None = Field(default=None, description="upper bound, not above the block's own")
    default: Number | None = Field(default=None, description="its value if nothing optimises it, within the bounds")


def _form_of_range(value: Any) -> str:
    return RangeEntry.__name__ if isinstance(value, dict | RangeEntry) else float.__name__


NumberOrRange = Annotated[
    Annotated[Number, Tag(float.__name__)] | Annotated[RangeEntry, Tag(RangeEntry.__name__)],
    Discriminator(_form_of_range),
]
"""The tags are the names of the types, by which `wording` finds the type of a value."""


class MidLevelEntry(_Entry):
    """How the hyperparameters of a plan are optimised."""

    optimiser: Literal["cma", "grid"] = Field(default="cma", description="CMA-ES, or direct sampling on a grid")
    evaluations: Whole = quantity(
        "1", "budget of candidates that are rolled out", default=MidLevel.evaluations, gt=0, le=10**9
    )
    seconds: Number = quantity("s", "budget of time", default=MidLevel.seconds, gt=0, le=1e6)
    refine: Literal["none", "physics"] = Field(
        default="none", description="physics: continue from the analytic optimum in the physics backend"
    )
    weights: dict[str, Number] = Field(
        default_factory=dict, description="BLOCK.measure to its weight in the value of a plan, negative for a cost"
    )
    hyperparameters: dict[str, NumberOrRange] = Field(
        default_factory=dict, description="BLOCK.name to narrower bounds and a default, or to the value that it has"
    )


class TaskFile(_Entry):
    """A task of hybrid_tamp, in SI units."""

    domain: Text = Field(description="name of an installed domain")
    tokens: dict[str, TokenEntry] = Field(description="every object and place by its name", min_length=1)
    goal: list[Any] = Field(
        description="atoms that hold at the end: 'predicate: [tokens]'; '*' stands for any token or symbol",
        min_length=1,
    )
    agents: dict[str, Annotated[list[Text], Field(min_length=1)]] = Field(
        default_factory=dict, description="named groups of capability tokens"
    )
    assignment: dict[str, Text] = Field(
        default_factory=dict, description="token to the block in which it starts; default: the domain's resting block"
    )
    primitives: dict[str, Text] = Field(
        default_factory=dict,
        description="block, or action for all its modes, to the file of the motor primitive that it is taught, as "
        "'hybrid-tamp learn' writes it; relative to the task file",
    )
    planner: Annotated[Text, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9_.\[\]-]*$")] = Field(
        default=DEFAULT_PLANNER, description="name of the planning engine"
    )
    objective: Literal["length", "makespan"] = Field(
        default="length", description="what a plan should be short in: its actions, or its time"
    )
    limits: LimitsEntry = Field(default=LimitsEntry(), description="bounds on the work")
    midlevel: MidLevelEntry = Field(
        default=MidLevelEntry(), description="how the hyperparameters of a plan are optimised"
    )
    seed: Whole = quantity("1", "seed of everything random", default=0, ge=0, le=2**32 - 1)
    name: Text | None = Field(default=None, description="name of the task; default: the file's name without its ending")

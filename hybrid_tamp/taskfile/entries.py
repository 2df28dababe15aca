"""The keys of a task file with their types, units, bounds and descriptions, as pydantic models.

The checks, the JSON Schema and the reference page are derived from these models.
"""

import math
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BaseModel, ConfigDict, Discriminator, Field, Strict, Tag, model_validator

from hybrid_tamp.geometry.shapes import Angle, WrittenShape
from hybrid_tamp.model.affordance import Number, quantity
from hybrid_tamp.model.task import DEFAULT_PLANNER, Limits, MidLevel

Text = Annotated[str, Strict(), Field(min_length=1)]
Whole = Annotated[int, Strict()]
Bounded = Annotated[Number, Field(ge=-1000, le=1000)]
"""A coordinate or a component. The bounds prevent an overflow when the number is squared."""
Factor = Annotated[Number, Field(ge=1, le=1000)]


def _has_length(quaternion: tuple[float, ...]) -> tuple[float, ...]:
    if math.hypot(*quaternion) < 1e-9:
        raise ValueError("a quaternion must not have length zero")
    return quaternion


Quaternion = Annotated[tuple[Bounded, Bounded, Bounded, Bounded], AfterValidator(_has_length)]


class _Entry(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class Pose(_Entry):
    """Initial pose of a token in the world frame."""

    position: tuple[Bounded, Bounded, Bounded] = quantity("m", "x, y, z of the body frame's origin")
    rpy: tuple[Angle, Angle, Angle] | None = quantity(
        "rad", "roll, pitch and yaw: rotations about the fixed world axes x, y, z, applied in this order", default=None
    )
    quaternion: Quaternion | None = quantity(
        "1", "rotation as a quaternion x, y, z, w; an alternative to rpy; normalised after reading", default=None
    )

    @model_validator(mode="after")
    def _one_rotation(self) -> "Pose":
        if self.rpy is not None and self.quaternion is not None:
            raise ValueError("a pose must not have both rpy and quaternion")
        return self


class TokenEntry(_Entry):
    """An object token: a thing, a part of a robot, or a place."""

    classes: list[Text] = Field(description="names of the classes of which the token is a member")
    unknown: list[Text] = Field(
        default_factory=list,
        description="names of classes of which the token may be a member; 'hybrid-tamp probe' tests the membership",
    )
    properties: dict[str, Any] = Field(
        default_factory=dict,
        description="properties that the token's classes declare; properties of unknown classes may be missing",
    )
    shape: WrittenShape | None = Field(
        default=None, description="geometry of the token; default: the shape that the token's classes imply, if any"
    )
    fixed: bool = Field(
        default=False,
        description="whether nothing can move the token, e.g. a wall; only for tokens whose only class is TOKEN",
    )
    pose: Pose | None = Field(default=None, description="initial pose; required if the token has a position")


class LimitsEntry(_Entry):
    """Limits of the command, the planner and the run."""

    time: Number = quantity("s", "wall-clock time of the whole command", default=Limits.time, gt=0, le=1e6)
    memory: Number = quantity(
        "MiB", "limit of the memory of the planner and its child processes", default=Limits.memory, gt=0, le=1e8
    )
    refinements: Whole = quantity(
        "1", "maximum number of times to replan after a refused plan", default=Limits.refinements, ge=0, le=1000
    )
    contact: Number = quantity(
        "N", "largest force of a forbidden contact; a larger force ends the run", default=Limits.contact, ge=0, le=1e6
    )
    clearance: Number = quantity(
        "m",
        "distance that planned movements keep from bodies at rest, as an allowance for the errors of servos",
        default=Limits.clearance,
        ge=0,
        le=1,
    )


class RangeEntry(_Entry):
    """Bounds and default of a hyperparameter, in the hyperparameter's unit. A missing key keeps the block's value."""

    lower: Number | None = Field(default=None, description="lower bound, not below the block's lower bound")
    upper: Number | None = Field(default=None, description="upper bound, not above the block's upper bound")
    default: Number | None = Field(default=None, description="value without optimisation, within the bounds")


def _form_of_range(value: Any) -> str:
    return RangeEntry.__name__ if isinstance(value, dict | RangeEntry) else float.__name__


NumberOrRange = Annotated[
    Annotated[Number, Tag(float.__name__)] | Annotated[RangeEntry, Tag(RangeEntry.__name__)],
    Discriminator(_form_of_range),
]
"""A number or a range. Each tag is the name of a type, because `wording` finds the type by the tag."""


class MidLevelEntry(_Entry):
    """Settings for the optimisation of a plan's hyperparameters."""

    optimiser: Literal["cma", "grid"] = Field(default="cma", description="CMA-ES or direct sampling on a grid")
    evaluations: Whole = quantity(
        "1", "maximum number of candidates to roll out", default=MidLevel.evaluations, gt=0, le=10**9
    )
    refine: Literal["none", "physics"] = Field(
        default="none", description="physics: continue the optimisation in the physics backend"
    )
    objective: Literal["performance", "distance"] = Field(
        default="performance",
        description="quantity to optimise if all conditions hold: the weighted performance measures, or the distance "
        "between the final state and the goal",
    )
    weights: dict[str, Number] = Field(
        default_factory=dict,
        description="maps each BLOCK.measure to its weight in the value of a plan; costs have negative weights",
    )
    hyperparameters: dict[str, NumberOrRange] = Field(
        default_factory=dict, description="maps each BLOCK.name to a fixed value, or to narrower bounds and a default"
    )


class TaskFile(_Entry):
    """A task of hybrid_tamp, in SI units."""

    domain: Text = Field(description="name of an installed domain")
    tokens: dict[str, TokenEntry] = Field(description="maps the name of each token to its entry", min_length=1)
    goal: list[Any] = Field(
        description="atoms that must hold at the end, as 'predicate: [tokens]'; '*' stands for any token or symbol; "
        "'{all: CLASS}' in place of a token stands for one atom per token of the class",
        min_length=1,
    )
    agents: dict[str, Annotated[list[Text], Field(min_length=1)]] = Field(
        default_factory=dict, description="maps the name of each agent to the names of its capability tokens"
    )
    assignment: dict[str, Text] = Field(
        default_factory=dict,
        description="maps each token to the block in which it starts; default: the domain's resting block",
    )
    primitives: dict[str, Text] = Field(
        default_factory=dict,
        description="maps each block or action to the file of its motor primitive, which 'hybrid-tamp learn' writes; "
        "an entry for an action applies to all its modes; paths are relative to the task file",
    )
    planner: Annotated[Text, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9_.\[\]-]*$")] = Field(
        default=DEFAULT_PLANNER, description="name of the planning engine"
    )
    objective: Literal["length", "makespan"] = Field(
        default="length", description="quantity to minimise: the number of actions (length) or the time (makespan)"
    )
    limits: LimitsEntry = Field(default=LimitsEntry(), description="limits of the command, the planner and the run")
    midlevel: MidLevelEntry = Field(
        default=MidLevelEntry(), description="settings for the optimisation of a plan's hyperparameters"
    )
    safety: dict[str, Factor] = Field(
        default_factory=dict,
        description="maps each predicate to its safety factor; the factor 1 leaves no safety margin",
    )
    seed: Whole = quantity("1", "seed of all random numbers", default=0, ge=0, le=2**32 - 1)
    name: Text | None = Field(default=None, description="name of the task; default: the file's name without its ending")

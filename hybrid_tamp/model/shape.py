"""Shapes of tokens, for physics, pictures and geometric margins. All lengths in metres."""

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, Strict

_Length = Annotated[float, Strict(), Field(gt=0, le=100, allow_inf_nan=False)]


class _Shape(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class Cylinder(_Shape):
    """A solid cylinder about the z axis of the body frame, centred at its origin."""

    kind: Literal["cylinder"] = Field(description="which shape")
    radius: _Length = Field(description="radius", json_schema_extra={"unit": "m"})
    length: _Length = Field(description="length along z", json_schema_extra={"unit": "m"})


class Box(_Shape):
    """A solid box along the axes of the body frame, centred at its origin."""

    kind: Literal["box"] = Field(description="which shape")
    half_extents: tuple[_Length, _Length, _Length] = Field(
        description="half of the edge lengths along x, y, z", json_schema_extra={"unit": "m"}
    )


class Sphere(_Shape):
    """A solid sphere centred at the body frame's origin."""

    kind: Literal["sphere"] = Field(description="which shape")
    radius: _Length = Field(description="radius", json_schema_extra={"unit": "m"})


Shape = Annotated[Cylinder | Box | Sphere, Field(discriminator="kind")]

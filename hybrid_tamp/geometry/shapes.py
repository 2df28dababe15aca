"""Shapes of tokens, for physics, pictures and geometric margins. All lengths are in metres."""

from typing import Annotated, Literal

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, Strict

from hybrid_tamp.geometry.meshes import Hull, MeshShape

_Length = Annotated[float, Strict(), Field(gt=0, le=100, allow_inf_nan=False)]
_Coordinate = Annotated[float, Strict(), Field(ge=-100, le=100, allow_inf_nan=False)]
_Angle = Annotated[float, Strict(), Field(ge=-100, le=100, allow_inf_nan=False)]


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


class Placement(BaseModel):
    """The pose of a part in the body; a part has the keys of its shape, too."""

    position: tuple[_Coordinate, _Coordinate, _Coordinate] = Field(
        description="of the part's centre in the body frame", json_schema_extra={"unit": "m"}
    )
    rpy: tuple[_Angle, _Angle, _Angle] = Field(
        default=(0.0, 0.0, 0.0),
        description="roll, pitch and yaw of the part about the body's axes x, y, z in this order",
        json_schema_extra={"unit": "rad"},
    )


class CylinderPart(Cylinder, Placement):
    """A cylinder as a part of a compound."""


class BoxPart(Box, Placement):
    """A box as a part of a compound."""


class SpherePart(Sphere, Placement):
    """A sphere as a part of a compound."""


Part = Annotated[CylinderPart | BoxPart | SpherePart, Field(discriminator="kind")]


def _not_empty(solids: tuple[Part, ...]) -> tuple[Part, ...]:
    # pydantic's own bound on the length would also complain if a part is wrong.
    if not solids:
        raise ValueError("a compound needs at least one part")
    return solids


class Compound(_Shape):
    """Several solids joined in one rigid body, whose centre of mass is the body frame's origin."""

    kind: Literal["compound"] = Field(description="which shape")
    parts: Annotated[tuple[Part, ...], AfterValidator(_not_empty)] = Field(
        description="what it is made of", json_schema_extra={"minItems": 1}
    )


class MeshFile(_Shape):
    """A solid whose surface is read from a Wavefront OBJ file, each of its objects a convex part.

    The body frame's origin is its centre of mass, its axes are those of the file and taken for the principal ones.
    """

    kind: Literal["mesh"] = Field(description="which shape")
    file: Annotated[str, Strict(), Field(min_length=1)] = Field(
        description="the OBJ file, relative to the task file; one object ('o' or 'g') a convex part"
    )
    scale: Annotated[float, Strict(), Field(gt=0, le=1000, allow_inf_nan=False)] = Field(
        default=1.0, description="length of the file's unit", json_schema_extra={"unit": "m"}
    )


Solid = Cylinder | Box | Sphere
"""A convex shape; a compound consists of such shapes."""
WrittenShape = Annotated[Solid | Compound | MeshFile, Field(discriminator="kind")]
"""A shape as a task file gives it."""
Shape = Solid | Compound | MeshShape

_CENTRE = (0.0, 0.0, 0.0)


def solids_of(shape: Shape) -> tuple[CylinderPart | BoxPart | SpherePart | Hull, ...]:
    """Return the convex solids of a shape; a box, cylinder or sphere is its own only solid, at the origin."""
    if isinstance(shape, Compound | MeshShape):
        return shape.parts
    if isinstance(shape, Box):
        return (BoxPart(kind="box", half_extents=shape.half_extents, position=_CENTRE),)
    if isinstance(shape, Cylinder):
        return (CylinderPart(kind="cylinder", radius=shape.radius, length=shape.length, position=_CENTRE),)
    return (SpherePart(kind="sphere", radius=shape.radius, position=_CENTRE),)

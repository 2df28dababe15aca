"""Shapes of tokens for physics, pictures and geometric margins. All lengths are in metres."""

from typing import Annotated, Literal

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, Strict

from hybrid_tamp.geometry.meshes import Hull, MeshShape

_Length = Annotated[float, Strict(), Field(gt=0, le=100, allow_inf_nan=False)]
_Coordinate = Annotated[float, Strict(), Field(ge=-100, le=100, allow_inf_nan=False)]
LARGEST_ANGLE = 6.3
"""Largest angle of a pose [rad], a little more than one turn. A larger number is probably an angle in degrees."""
Angle = Annotated[float, Strict(), Field(ge=-LARGEST_ANGLE, le=LARGEST_ANGLE, allow_inf_nan=False)]


class _Shape(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class Cylinder(_Shape):
    """A solid cylinder about the z axis of the body frame, centred at the origin."""

    kind: Literal["cylinder"] = Field(description="kind of the shape")
    radius: _Length = Field(description="radius", json_schema_extra={"unit": "m"})
    length: _Length = Field(description="length along the z axis", json_schema_extra={"unit": "m"})


class Box(_Shape):
    """A solid box along the axes of the body frame, centred at the origin."""

    kind: Literal["box"] = Field(description="kind of the shape")
    half_extents: tuple[_Length, _Length, _Length] = Field(
        description="half of the edge lengths along the x, y and z axes", json_schema_extra={"unit": "m"}
    )


class Sphere(_Shape):
    """A solid sphere, centred at the origin of the body frame."""

    kind: Literal["sphere"] = Field(description="kind of the shape")
    radius: _Length = Field(description="radius", json_schema_extra={"unit": "m"})


class Placement(BaseModel):
    """The pose of a part in a compound. A part also has the keys of its shape."""

    position: tuple[_Coordinate, _Coordinate, _Coordinate] = Field(
        description="position of the part's centre in the body frame", json_schema_extra={"unit": "m"}
    )
    rpy: tuple[Angle, Angle, Angle] = Field(
        default=(0.0, 0.0, 0.0),
        description="roll, pitch and yaw of the part about the fixed x, y and z axes of the body, in this order",
        json_schema_extra={"unit": "rad"},
    )


class CylinderPart(Cylinder, Placement):
    """A cylinder as a part of a compound."""


class BoxPart(Box, Placement):
    """A box as a part of a compound."""


class SpherePart(Sphere, Placement):
    """A sphere as a part of a compound."""


Part = Annotated[CylinderPart | BoxPart | SpherePart, Field(discriminator="kind")]
"""Solid of a compound, with its pose in the body frame."""


def _not_empty(solids: tuple[Part, ...]) -> tuple[Part, ...]:
    # The length constraint of pydantic would report a second error if a part is invalid.
    if not solids:
        raise ValueError("a compound must have at least one part")
    return solids


class Compound(_Shape):
    """A rigid body of several solids. The origin of the body frame is the centre of mass of the body."""

    kind: Literal["compound"] = Field(description="kind of the shape")
    parts: Annotated[tuple[Part, ...], AfterValidator(_not_empty)] = Field(
        description="solids of the compound", json_schema_extra={"minItems": 1}
    )


class MeshFile(_Shape):
    """A solid whose surface is read from a Wavefront OBJ file. Each object in the file is a convex part.

    The origin of the body frame is the centre of mass. The axes are the axes of the file and must be principal axes.
    """

    kind: Literal["mesh"] = Field(description="kind of the shape")
    file: Annotated[str, Strict(), Field(min_length=1)] = Field(
        description="path of the OBJ file, relative to the task file; each object ('o' or 'g') must be a convex part"
    )
    scale: Annotated[float, Strict(), Field(gt=0, le=1000, allow_inf_nan=False)] = Field(
        default=1.0, description="length of one coordinate unit of the OBJ file", json_schema_extra={"unit": "m"}
    )


Solid = Cylinder | Box | Sphere
"""Convex shape that can be a part of a compound."""
WrittenShape = Annotated[Solid | Compound | MeshFile, Field(discriminator="kind")]
"""Shape as written in a task file."""
Shape = Solid | Compound | MeshShape
"""Shape of a token. Lengths are in metres."""

_CENTRE = (0.0, 0.0, 0.0)


def solids_of(shape: Shape) -> tuple[CylinderPart | BoxPart | SpherePart | Hull, ...]:
    """Return the convex solids of a shape. A box, cylinder or sphere is a single solid at the origin."""
    if isinstance(shape, Compound | MeshShape):
        return shape.parts
    if isinstance(shape, Box):
        return (BoxPart(kind="box", half_extents=shape.half_extents, position=_CENTRE),)
    if isinstance(shape, Cylinder):
        return (CylinderPart(kind="cylinder", radius=shape.radius, length=shape.length, position=_CENTRE),)
    return (SpherePart(kind="sphere", radius=shape.radius, position=_CENTRE),)

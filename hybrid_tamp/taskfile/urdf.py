"""Read the bodies of a scene from a file in the Unified Robot Description Format (URDF).

Every collision geometry becomes a body. The joints of a scene must be fixed. Visual geometries, masses and materials
are ignored. The format measures in metres and radians.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from hybrid_tamp.errors import InputError, Issue
from hybrid_tamp.geometry.shapes import Box, Cylinder, MeshFile, Shape, Sphere
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.poses import quaternion_from_rpy, quaternion_multiply, rotate
from hybrid_tamp.taskfile.meshfile import read_mesh
from hybrid_tamp.taskfile.yaml.nodes import read_text

_MOST_BYTES = 10_000_000
_UPRIGHT = np.array([0.0, 0.0, 0.0, 1.0])


@dataclass(frozen=True)
class SceneBody:
    """A body of a scene.

    Attributes:
        name: name of the link, with a number if the link has several collision geometries.
        shape: shape of the body.
        position: position in the frame of the root link [m], shape ``(3,)``.
        orientation: orientation in the frame of the root link as a unit quaternion, shape ``(4,)``.
    """

    name: str
    shape: Shape
    position: FloatArray
    orientation: FloatArray


_Pose = tuple[FloatArray, FloatArray]
_Element = ElementTree.Element


def read_urdf(path: Path) -> list[SceneBody]:
    """Read the bodies of a scene, in the order of the file.

    Raises:
        InputError: the file cannot be read or is not URDF, a joint can move, a link has several parents or is its own
            ancestor, or a geometry is not a box, cylinder, sphere or mesh.
    """
    root = _parse(path)
    links = {_name(link, path): link for link in root.iter("link")}
    parents = _read_parents(root, links, path)
    bodies = []
    for name, link in links.items():
        frame = _frame_of(name, parents, path)
        found = [each for each in link.findall("collision") if each.find("geometry") is not None]
        for number, collision in enumerate(found, start=1):
            label = name if len(found) == 1 else f"{name}-{number}"
            position, orientation = _joined(frame, _origin(collision, f"{path}: link {name!r}"))
            bodies.append(SceneBody(label, _read_shape(collision, path, name), position, orientation))
    if not bodies:
        raise InputError(
            [Issue(str(path), "a scene must have a link with a collision geometry", f"{len(links)} links")]
        )
    return bodies


def _parse(path: Path) -> _Element:
    text = read_text(path, "a URDF file", _MOST_BYTES)
    try:
        root = ElementTree.fromstring(text)
    except ElementTree.ParseError as error:
        raise InputError([Issue(str(path), "a URDF file must be well-formed XML", str(error))]) from error
    if root.tag != "robot":
        raise InputError([Issue(str(path), "the root element of a URDF file must be 'robot'", repr(root.tag))])
    return root


def _read_parents(root: _Element, links: Mapping[str, _Element], path: Path) -> dict[str, tuple[str, _Pose]]:
    """Return a mapping from each link with a parent to the parent and to the pose in the frame of the parent."""
    parents: dict[str, tuple[str, _Pose]] = {}
    for joint in root.iter("joint"):
        name = _name(joint, path)
        where = f"{path}: joint {name!r}"
        if joint.get("type") != "fixed":
            remedy = "make the joint fixed, because the bodies of a scene cannot move"
            raise InputError(
                [Issue(where, "the joints of a scene must be fixed", repr(joint.get("type")), remedy=remedy)]
            )
        ends = [each.get("link", "") if (each := joint.find(end)) is not None else "" for end in ("parent", "child")]
        for end in ends:
            if end not in links:
                raise InputError([Issue(where, "a joint must connect two links", repr(end), tuple(links))])
        if ends[1] in parents:
            raise InputError([Issue(where, "a link must have at most one parent", repr(ends[1]))])
        parents[ends[1]] = ends[0], _origin(joint, where)
    return parents


def _frame_of(name: str, parents: Mapping[str, tuple[str, _Pose]], path: Path) -> _Pose:
    """Return the pose of a link in the frame of the root link."""
    poses, seen = [], {name}
    while name in parents:
        name, pose = parents[name]
        if name in seen:
            raise InputError([Issue(f"{path}: link {name!r}", "a link must not be its own ancestor", repr(name))])
        seen.add(name)
        poses.append(pose)
    frame: _Pose = (np.zeros(3), _UPRIGHT)
    for pose in reversed(poses):
        frame = _joined(frame, pose)
    return frame


def _joined(outer: _Pose, inner: _Pose) -> _Pose:
    """Return a pose that is given in the frame of another pose."""
    return outer[0] + rotate(outer[1], inner[0]), quaternion_multiply(outer[1], inner[1])


def _origin(element: _Element, where: str) -> _Pose:
    origin = element.find("origin")
    if origin is None:
        return np.zeros(3), _UPRIGHT
    position, rpy = (_numbers(origin, name, where, 3, "0 0 0") for name in ("xyz", "rpy"))
    return position, quaternion_from_rpy(rpy)


def _read_shape(collision: _Element, path: Path, link: str) -> Shape:
    where = f"{path}: link {link!r}"
    geometry = collision.find("geometry")
    assert geometry is not None
    kinds = [each for each in geometry if each.tag in ("box", "cylinder", "sphere", "mesh")]
    if len(kinds) != 1:
        came = ", ".join(each.tag for each in geometry) or "none"
        raise InputError([Issue(where, "a geometry must be one box, cylinder, sphere or mesh", came)])
    (given,) = kinds
    if given.tag == "mesh":
        return _read_mesh(given, path, where)
    if given.tag == "box":
        x, y, z = _positive(given, "size", where, 3) / 2.0
        return Box(kind="box", half_extents=(float(x), float(y), float(z)))
    (radius,) = _positive(given, "radius", where, 1)
    if given.tag == "sphere":
        return Sphere(kind="sphere", radius=float(radius))
    (length,) = _positive(given, "length", where, 1)
    return Cylinder(kind="cylinder", radius=float(radius), length=float(length))


def _read_mesh(given: _Element, path: Path, where: str) -> Shape:
    scale = _positive(given, "scale", where, 3, "1 1 1")
    if np.ptp(scale) > 0:
        raise InputError([Issue(where, "the scale of a mesh must be equal along all axes", given.get("scale", ""))])
    name = given.get("filename", "")
    if not name or "://" in name:
        wanted = "the name of a mesh file must be a path relative to the URDF file"
        raise InputError([Issue(where, wanted, repr(name), remedy="replace the prefix of a package by the path")])
    return read_mesh(path.parent / name, MeshFile(kind="mesh", file=name, scale=float(scale[0])))


def _name(element: _Element, path: Path) -> str:
    name = element.get("name", "")
    if not name:
        raise InputError([Issue(str(path), f"each {element.tag} must have a name", "none")])
    return name


def _positive(element: _Element, name: str, where: str, count: int, usual: str = "") -> FloatArray:
    found = _numbers(element, name, where, count, usual)
    if (found <= 0.0).any():
        raise InputError([Issue(where, f"the {name} of a {element.tag} must be positive", repr(element.get(name)))])
    return found


def _numbers(element: _Element, name: str, where: str, count: int, usual: str = "") -> FloatArray:
    """Return the numbers of an attribute, shape ``(count,)``."""
    text = element.get(name, usual)
    wanted = f"the {name} of {element.tag} must be {count} finite number{'s' if count > 1 else ''}"
    try:
        found = np.array([float(word) for word in text.split()])
    except ValueError as error:
        raise InputError([Issue(where, wanted, repr(text))]) from error
    if len(found) != count or not np.isfinite(found).all():
        raise InputError([Issue(where, wanted, repr(text))])
    return found

"""Read the tokens of a task file: their classes, properties, shapes and poses."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from pydantic import BaseModel, TypeAdapter, ValidationError

from hybrid_tamp.geometry.shapes import LARGEST_ANGLE, MeshFile, Shape, WrittenShape
from hybrid_tamp.model.affordance import TOKEN, BystanderProperties, ObjectClass, is_place
from hybrid_tamp.model.agreement import find_disagreements, find_shape_fault
from hybrid_tamp.model.authored import authored
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.token import Token
from hybrid_tamp.model.union import PropertyConflictError, union_of
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.taskfile.meshfile import read_mesh
from hybrid_tamp.taskfile.names import check_name
from hybrid_tamp.taskfile.places import Faults, KeyPath, shown
from hybrid_tamp.taskfile.poses import read_pose
from hybrid_tamp.taskfile.wording import add_validation_faults, advise_radians, subject

_SHAPE: TypeAdapter[WrittenShape | None] = TypeAdapter(WrittenShape | None)


@dataclass
class Scene:
    """The tokens of a task file that have no faults.

    Attributes:
        names: maps the name of each token to its entry in the file; None if the entries cannot be read.
        outlines: maps the name of each token with valid classes to a token with the same classes and no properties.
        tokens: the tokens without faults.
        given: maps each pair of (token, varying property) to its initial value.
    """

    names: Mapping[str, Any] | None = None
    outlines: dict[str, Token] = field(default_factory=dict)
    tokens: list[Token] = field(default_factory=list)
    given: dict[tuple[str, str], FloatArray] = field(default_factory=dict)


def read_scene(data: dict[str, Any], faults: Faults, domain: Domain | None, folder: Path = Path()) -> Scene:
    """Read the tokens and record their faults.

    Args:
        data: the plain data of the file.
        faults: the faults found so far.
        domain: the domain. If None, only the names of tokens are read.
        folder: folder to which relative paths of mesh files refer.
    """
    entries = data.get("tokens")
    if not isinstance(entries, dict):
        return Scene()
    scene = Scene(names=entries)
    for name in entries:
        check_name(name, faults, domain)
    if domain is not None:
        for name, entry in entries.items():
            if isinstance(entry, dict):
                _read_token(name, entry, faults, domain, scene, folder)
    return scene


def known_classes(domain: Domain) -> Mapping[str, type[ObjectClass]]:
    """Return a mapping from names to the domain's classes, including the root class."""
    return {TOKEN.name: TOKEN, **domain.class_by_name}


def declared_properties(object_class: type[ObjectClass]) -> type[BaseModel]:
    """Return the model with the fixed properties of a class, or of a token whose only class is the root class."""
    return BystanderProperties if object_class is TOKEN else object_class


def _read_token(name: str, entry: dict[str, Any], faults: Faults, domain: Domain, scene: Scene, folder: Path) -> None:
    path = ("tokens", name)
    classes = _classes(entry, path, faults, domain)
    if classes is None:
        return
    here = (*path, "unknown")
    unknown = _named(entry.get("unknown", []), here, classes, faults, domain) if faults.sound(here) else None
    members = classes if any(map(is_place, classes)) else tuple({TOKEN: None, **dict.fromkeys(classes)})
    outline = scene.outlines[name] = Token(name, members, {}, unknown=unknown or ())
    token = _make(outline, entry, path, faults, folder)
    scene.given |= {(name, key): value for key, value in read_pose(outline, entry, path, faults).items()}
    if token is not None:
        scene.tokens.append(token)


def _classes(
    entry: dict[str, Any], path: KeyPath, faults: Faults, domain: Domain
) -> tuple[type[ObjectClass], ...] | None:
    """Return the classes of a token, or None if a class is wrong."""
    path = (*path, "classes")
    if "classes" not in entry or not faults.sound(path):
        return None
    if not entry["classes"]:
        remedy = f"write [{TOKEN.name}] for a thing without affordances"
        faults.at(path, "a token must have at least one class", "[]", sorted(domain.class_by_name), remedy)
        return None
    return _named(entry["classes"], path, (), faults, domain)


def _named(
    names: list[str], path: KeyPath, others: tuple[type[ObjectClass], ...], faults: Faults, domain: Domain
) -> tuple[type[ObjectClass], ...] | None:
    """Return the named classes, or None if a name is wrong or no token can have all these classes and `others`."""
    known = known_classes(domain)
    found: list[type[ObjectClass]] = [*others]
    for index, class_name in enumerate(names):
        here = (*path, index)
        if class_name not in known:
            wanted = f"unknown class in the domain {domain.name}"
            faults.at(here, wanted, shown(class_name), sorted(domain.class_by_name))
        elif known[class_name] in found:
            faults.at(here, "a class must not be listed twice", shown(class_name), remedy="remove one")
        else:
            _check_company(known[class_name], found, here, faults, domain)
            found.append(known[class_name])
    if not faults.sound(path):
        return None
    try:
        union_of(found)
    except PropertyConflictError as error:
        for issue in error.issues:
            wanted = f"{issue.where} are in conflict: {issue.wanted}"
            faults.at(
                path, wanted, issue.came, remedy=f"use only one of the two classes, or correct the domain {domain.name}"
            )
        return None
    return tuple(found[len(others) :])


def _check_company(
    one: type[ObjectClass], others: list[type[ObjectClass]], path: KeyPath, faults: Faults, domain: Domain
) -> None:
    """Record a fault if a class excludes one of the other classes of the token."""
    for other in others:
        if is_place(one) != is_place(other):
            place, thing = (one, other) if is_place(one) else (other, one)
            came = f"the place {place.name} and the thing {thing.name}"
            faults.at(path, "a token must not be both a place and a thing", came, remedy="use two tokens")
        elif not domain.relations.can_share_token(one, other):
            wanted = f"no token can be a member of both {other.name} and {one.name}"
            faults.at(path, wanted, shown(one.name), remedy=f"the domain {domain.name} declares these classes disjoint")


def _make(outline: Token, entry: dict[str, Any], path: KeyPath, faults: Faults, folder: Path) -> Token | None:
    """Return the token with its properties and shape. If they have faults, record the faults and return None."""
    properties, base = entry.get("properties", {}), (*path, "properties")
    if not isinstance(properties, dict) or not faults.sound(base):
        return None
    shape = _shape(entry, (*path, "shape"), faults, folder)
    has_shape = faults.sound((*path, "shape"))
    union: type[BaseModel] = union_of(outline.classes, outline.unknown)
    fixed = bool(entry.get("fixed", False))
    if fixed and not outline.bystander:
        wanted = f"a fixed token must be a member of {TOKEN.name} only"
        came = ", ".join(member.name for member in (*outline.classes, *outline.unknown) if member is not TOKEN)
        faults.at((*path, "fixed"), wanted, came, remedy="remove the key fixed, or remove the other classes")
    try:
        token = Token.make(outline.name, outline.classes, properties, shape, outline.unknown, fixed)
    except ValidationError as error:
        add_validation_faults(faults, error, union, base, lambda key: _needed_by(outline, key))
        return None
    except ArithmeticError:
        faults.at(base, f"the properties of token {shown(outline.name)} must have realistic magnitudes in SI units")
        return None
    if not has_shape:
        return None
    _check_angles(token, properties, union, base, faults)
    complaints = dict.fromkeys(_complaints(token))
    for complaint in complaints:
        faults.at(path, f"token {shown(token.name)} is inconsistent: {complaint}", key=True, sound=True)
    if not complaints:
        _check_shape(token, path, faults)
    return token


def _check_shape(token: Token, path: KeyPath, faults: Faults) -> None:
    """Record a fault if the shape is not a rigid body, and for each property that disagrees with the shape."""
    fault = find_shape_fault(token)
    if fault is not None:
        faults.at((*path, "shape"), f"the shape of token {shown(token.name)} {fault.wanted}", fault.came)
        return
    for name, each in find_disagreements(token):
        here = (*path, "properties", name)
        faults.at(here, f"{subject(here)} {each.wanted}", each.came)


def _check_angles(
    token: Token, given: Mapping[str, Any], union: type[BaseModel], base: KeyPath, faults: Faults
) -> None:
    """Record a fault for each angle that is probably in degrees. An angle with declared bounds may have any value."""
    for key in given:
        field = union.model_fields[key]
        extra = field.json_schema_extra
        unit = str(extra.get("unit")) if isinstance(extra, dict) else ""
        bounded = any(hasattr(each, bound) for each in field.metadata for bound in ("ge", "gt", "le", "lt"))
        values = token[key] if isinstance(token[key], tuple) else (token[key],)
        advice = "" if bounded else next(filter(None, (advise_radians(unit, value) for value in values)), "")
        if advice:
            path = (*base, key)
            wanted = f"{subject(path)} must be between {-LARGEST_ANGLE:g} and {LARGEST_ANGLE:g} [rad]"
            faults.at(path, wanted, faults.shown(path, given[key]), remedy=advice)


def _shape(entry: dict[str, Any], path: KeyPath, faults: Faults, folder: Path) -> Shape | None:
    """Return the shape in a token's entry, with the content of the shape's mesh file."""
    written = _SHAPE.validate_python(entry.get("shape")) if faults.sound(path) else None
    if not isinstance(written, MeshFile):
        return written
    with faults.collecting((*path, "file")):
        return read_mesh(folder / written.file, written)
    return None


def _needed_by(outline: Token, key: str) -> str:
    return "; required by " + ", ".join(member.name for member in outline.classes if key in member.model_fields)


def _complaints(token: Token) -> list[str]:
    found = []
    for member in token.classes:
        with authored(f"{member.name}.consistent", {"token": token}):
            found.append(member.consistent(token))
    return [complaint for complaint in found if complaint is not None]

"""Goals that put two bodies into one place that is too small for both bodies.

A predicate can declare the disc in which the centre of its first argument is if the predicate holds
(`Predicate.confines`). Two bodies that do not overlap keep the distance of the largest balls within them. If two goal
atoms allow only smaller distances, no plan can make both atoms true.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from hybrid_tamp.geometry.common_volume import face_planes
from hybrid_tamp.geometry.convex import CONTACT, placed
from hybrid_tamp.geometry.gaps import distance_to_point
from hybrid_tamp.geometry.shapes import Box, Cylinder, Shape, Sphere
from hybrid_tamp.geometry.surfaces import hulls_of
from hybrid_tamp.model.authored import authored
from hybrid_tamp.model.declarations import Declarations
from hybrid_tamp.model.disc import Disc
from hybrid_tamp.model.predicate import Atom, Predicate, Value
from hybrid_tamp.model.state import State
from hybrid_tamp.model.token import Token

_SAMPLES = 64
"""Number of points on the edge of a disc at which distances are computed."""


@dataclass(frozen=True)
class Crowding:
    """A place that is too small for two bodies.

    Attributes:
        atom: goal atom that confines the first body.
        other: goal atom that confines the second body, or the name of a body that no block moves.
        room: upper bound of the distance between the first body's centre and the second body's centre or surface [m].
        needed: smallest distance at which the bodies do not overlap [m].
    """

    atom: Atom
    other: Atom | str
    room: float
    needed: float

    @property
    def text(self) -> str:
        """Sentence with both figures."""
        figures = f"at most {self.room:.3g} m, but must be at least {self.needed:.3g} m"
        if isinstance(self.other, str):
            return (
                f"{self.atom.text} is impossible, because {self.other} stands there and no block moves it: the "
                f"distance between the centre of {self.atom.arguments[0]} and {self.other} would be {figures}"
            )
        return (
            f"{self.other.text} and {self.atom.text} cannot both hold: the distance between the centres of "
            f"{self.other.arguments[0]} and {self.atom.arguments[0]} would be {figures}"
        )


@dataclass(frozen=True)
class _Confined:
    """A body whose centre is within a disc if a goal atom holds."""

    atom: Atom
    token: Token
    disc: Disc
    inner: float


def find_crowding(
    domain: Declarations, tokens: Mapping[str, Token], state: State, goal: Sequence[Atom]
) -> Crowding | None:
    """Return a place that is too small for two bodies that the goal puts there, or None.

    Atoms that hold in the initial state are compared only with atoms that do not hold.

    Args:
        domain: the declarations of the domain.
        tokens: maps names to tokens.
        state: initial state.
        goal: ground atoms.
    """
    predicates = {predicate.name: predicate for predicate in domain.predicates}
    confined = list(_confined(predicates, tokens, state, goal))
    new = {each.atom for each in confined if not _holds(predicates[each.atom.predicate], tokens, state, each.atom)}
    for one, other in combinations(confined, 2):
        if one.token is not other.token and not new.isdisjoint((one.atom, other.atom)):
            found = _compare(one, other)
            if found is not None:
                return found
    for each in confined:
        for body in tokens.values():
            if each.atom in new and body is not each.token and body.shape is not None and not _movable(domain, body):
                found = _compare_with_body(each, body, state)
                if found is not None:
                    return found
    return None


def _values(predicate: Predicate, tokens: Mapping[str, Token], atom: Atom) -> tuple[Value, ...]:
    return tuple(tokens.get(argument, argument) for argument in atom.arguments)


def _confined(
    predicates: Mapping[str, Predicate], tokens: Mapping[str, Token], state: State, goal: Sequence[Atom]
) -> Iterator[_Confined]:
    for atom in goal:
        predicate = predicates[atom.predicate]
        token = tokens.get(atom.arguments[0]) if atom.arguments else None
        if predicate.confines is None or not atom.positive or token is None or token.shape is None:
            continue
        values = _values(predicate, tokens, atom)
        roles = {parameter.name: value for parameter, value in zip(predicate.parameters, values, strict=True)}
        with authored(f"predicate {predicate.name}, confines", roles):
            disc: Disc = predicate.confines(state, *values)
        yield _Confined(atom, token, disc, inner_radius(token.shape))


def _holds(predicate: Predicate, tokens: Mapping[str, Token], state: State, atom: Atom) -> bool:
    return float(predicate.evaluate(state, *_values(predicate, tokens, atom))) >= 0


def _movable(domain: Declarations, token: Token) -> bool:
    """Return whether a block moves the token, or the token is a place."""
    return token.place or any(
        "position" in block.writes.get(slot.name, ())
        for block in domain.blocks
        for slot in block.slots
        if token.is_member(slot.object_class) or token.may_be_member(slot.object_class)
    )


def inner_radius(shape: Shape) -> float:
    """Return the radius [m] of a ball within a shape, centred at the origin of the body frame.

    The ball is the largest for a box, cylinder or sphere. For other shapes it is the largest within a single part.
    """
    if isinstance(shape, Sphere):
        return shape.radius
    if isinstance(shape, Cylinder):
        return min(shape.radius, shape.length / 2)
    if isinstance(shape, Box):
        return min(shape.half_extents)
    return max(0.0, *(float(-face_planes(hull)[:, 3].max()) for hull in hulls_of(shape)))


def _compare(one: _Confined, other: _Confined) -> Crowding | None:
    high = max(one.disc.highest - other.disc.lowest, other.disc.highest - one.disc.lowest)
    between = float(np.hypot(*(np.subtract(one.disc.centre, other.disc.centre))))
    room = between + one.disc.radius + other.disc.radius
    apart = one.inner + other.inner - CONTACT
    needed = float(np.sqrt(max(apart**2 - high**2, 0.0)))
    return Crowding(other.atom, one.atom, room, needed) if room < needed else None


def _compare_with_body(each: _Confined, body: Token, state: State) -> Crowding | None:
    """Compare a disc with a body that stays. The distance from a convex body is largest on the edge of the disc."""
    disc, angles = each.disc, np.linspace(0.0, 2.0 * np.pi, _SAMPLES, endpoint=False)
    edge = np.asarray(disc.centre) + disc.radius * np.column_stack([np.cos(angles), np.sin(angles)])
    points = [np.array([x, y, z]) for x, y in edge for z in (disc.lowest, disc.highest)]
    slack = disc.radius * np.pi / _SAMPLES
    for part in placed(body.solid, state[body, "position"], state[body, "orientation"]):
        if float(np.linalg.norm(part.position - points[0])) > part.reach + each.inner:
            continue
        room = max(distance_to_point(part, point) for point in points) + slack
        if room < each.inner - CONTACT:
            return Crowding(each.atom, body.name, room, each.inner)
    return None

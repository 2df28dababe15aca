from typing import ClassVar

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from hybrid_tamp.model.affordance import TOKEN, AffordanceClass, Direction, ObjectClass, PlaceClass, quantity
from hybrid_tamp.model.token import Token
from hybrid_tamp.model.union import PropertyConflictError, conflicts, union_of


class Heavy(AffordanceClass):
    name: ClassVar[str] = "HEAVY"
    mass: float = quantity("kg", "mass", gt=0)


class Slippery(AffordanceClass):
    name: ClassVar[str] = "SLIPPERY"
    mass: float = quantity("kg", "mass of the thing", gt=0)
    friction: float = quantity("1", "friction", default=0.1, ge=0)


class Turning(AffordanceClass):
    name: ClassVar[str] = "TURNING"
    axis: Direction = quantity("1", "axis")


class Spot(PlaceClass):
    name: ClassVar[str] = "SPOT"


CLASSES: list[type[ObjectClass]] = [Heavy, Slippery, Turning, TOKEN]


@given(st.permutations(CLASSES))
def test_union_does_not_depend_on_the_order(order: list[type[ObjectClass]]) -> None:
    assert union_of(order) is union_of(CLASSES)
    assert list(union_of(order).model_fields) == ["axis", "friction", "mass"]


def test_a_shared_property_is_one_instance() -> None:
    token = Token.make("crate", [Heavy, Slippery], {"mass": 3.0})
    assert dict(token.properties) == {"mass": 3.0, "friction": 0.1}
    assert token.is_member(TOKEN)
    assert token.is_member(Heavy)


def _variant(kind: str) -> type[ObjectClass]:
    declared = {
        "unit": (float, quantity("g", "mass", gt=0)),
        "bounds": (float, quantity("kg", "mass", gt=1)),
        "default": (float, quantity("kg", "mass", gt=0, default=1.0)),
        "type": (int, quantity("kg", "mass", gt=0)),
    }[kind]
    namespace = {"__annotations__": {"name": ClassVar[str], "mass": declared[0]}, "mass": declared[1]}
    return type("Other", (AffordanceClass,), {"__module__": __name__, **namespace, "name": "OTHER"})


@pytest.mark.parametrize("kind", ["unit", "bounds", "default", "type"])
def test_a_conflict_is_refused_with_both_names(kind: str) -> None:
    other = _variant(kind)
    with pytest.raises(PropertyConflictError) as caught:
        union_of([Heavy, other])
    assert "HEAVY and OTHER" in str(caught.value)
    assert f"declare the same {kind} for property 'mass'" in str(caught.value)
    assert "declare the classes disjoint in the domain: disjoint=((Heavy, Other),)" in str(caught.value)
    assert conflicts([other, Heavy]) == conflicts([Heavy, other])


def test_a_subclass_that_redeclares_a_property_cannot_be_disjoint() -> None:
    namespace = {"__annotations__": {"name": ClassVar[str], "mass": float}, "mass": quantity("kg", "mass", gt=2)}
    narrower = type("Heavier", (Heavy,), {"__module__": __name__, **namespace, "name": "HEAVIER"})
    (issue,) = conflicts([Heavy, narrower])
    assert issue.remedy == "rename property 'mass' in one of the classes"


@pytest.mark.parametrize(
    "properties", [{}, {"mass": -1.0}, {"mass": 0.0}, {"mass": 1.0, "colour": 3}, {"mass": "1"}][:4]
)
def test_wrong_properties_are_refused(properties: dict[str, object]) -> None:
    with pytest.raises(ValidationError):
        Token.make("crate", [Heavy], properties)


def test_directions_are_normalised_and_never_zero() -> None:
    assert Token.make("wheel", [Turning], {"axis": (0.0, 0.0, 2.0)})["axis"] == (0.0, 0.0, 1.0)
    with pytest.raises(ValidationError, match="length zero"):
        Token.make("wheel", [Turning], {"axis": (0.0, 0.0, 0.0)})


def test_places_are_not_tokens_of_the_root_class() -> None:
    spot = Token.make("here", [Spot], {})
    assert spot.place
    assert not spot.is_member(TOKEN)

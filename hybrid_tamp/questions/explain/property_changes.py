"""Smallest changes of a property or a safety factor that make a feasibility fact hold, e.g. a stronger hand."""

from collections.abc import Iterator
from dataclasses import replace
from math import floor, isfinite, log10
from typing import Any

from pydantic import AfterValidator, ValidationError

from hybrid_tamp.model.agreement import find_disagreements
from hybrid_tamp.model.authored import authored
from hybrid_tamp.model.change import SetFactor, SetProperty
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.safety import with_factor
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.questions.changes import task_root

_STEPS = (0.001, 0.01, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99, 2.0, 5.0, 10.0, 100.0, 1000.0)
"""Sizes of the tested changes, relative to the old value, or in the property's unit if the old value is 0."""
_HALVINGS = 40
_DIGITS = 3


def find_property_changes(task: Task, atom: Atom) -> Iterator[SetProperty]:
    """Yield, for each property of the tokens in a feasibility fact, the smallest change that makes the fact hold."""
    for name in atom.arguments:
        token = task.token_by_name.get(name)
        for key in sorted(token.properties) if token else ():
            assert token is not None
            for component in _components(token, key):
                found = _least(task, token, key, component, atom)
                if found is not None:
                    yield _change(token, key, component, found, atom)


def find_factor_changes(task: Task, atom: Atom) -> Iterator[SetFactor]:
    """Yield the smallest reduction of a safety factor that makes a feasibility fact hold, if any reduction does.

    The new factor is rounded down to `_DIGITS` digits.
    """
    predicate = task.domain.predicate_by_name[atom.predicate]
    if predicate.safety is None or not atom.positive:
        return
    values = [task.value(name) for name in atom.arguments]

    def holds(factor: float) -> bool:
        return float(with_factor(predicate, factor).evaluate(task.state, *values)) >= 0

    enough, strict = 1.0, predicate.safety.factor
    if holds(strict) or not holds(enough):
        return
    for _ in range(_HALVINGS):
        middle = (enough + strict) / 2.0
        enough, strict = (middle, strict) if holds(middle) else (enough, middle)
    unit = 10.0 ** (floor(log10(enough)) + 1 - _DIGITS)
    rounded = float(f"{floor(enough / unit) * unit:.{_DIGITS}g}")
    yield SetFactor(predicate.name, max(rounded, 1.0), predicate.safety.factor, atom)


def _change(token: Token, key: str, component: int | None, changed: Token, atom: Atom) -> SetProperty:
    before, after = (_value(each, key, component) for each in (token, changed))
    label = key if component is None else f"{key}.{'xyz'[component]}"
    return SetProperty(token.name, label, after, before, _unit(token, key), changed, atom)


def _unit(token: Token, key: str) -> str:
    for member in token.classes:
        field = member.model_fields.get(key)
        if field is not None and isinstance(field.json_schema_extra, dict):
            return str(field.json_schema_extra.get("unit", "1"))
    return "1"


def _components(token: Token, key: str) -> tuple[int | None, ...]:
    """Return ``(None,)`` for a number, ``(0, 1, 2)`` for a vector without a validator, and ``()`` otherwise."""
    value = token[key]
    if isinstance(value, float):
        return (None,)
    fields = [member.model_fields[key] for member in token.classes if key in member.model_fields]
    bound = any(isinstance(each, AfterValidator) for field in fields for each in field.metadata)
    is_vector = isinstance(value, tuple) and len(value) == 3 and all(isinstance(each, float) for each in value)
    return (0, 1, 2) if is_vector and not bound else ()


def _value(token: Token, key: str, component: int | None) -> float:
    return float(token[key] if component is None else token[key][component])


def _least(task: Task, token: Token, key: str, component: int | None, atom: Atom) -> Token | None:
    """Return the token with the smallest change of one number that makes the fact hold, or None if no change does."""
    value = _value(token, key, component)
    size = abs(value) or 1.0
    for step in _STEPS:
        for sign in (1.0, -1.0):
            far = value + sign * step * size
            if _meets(task, token, key, component, far, atom) is not None:
                return _meets(task, token, key, component, _nearest(task, token, key, component, far, atom), atom)
    return None


def _nearest(task: Task, token: Token, key: str, component: int | None, far: float, atom: Atom) -> float:
    """Return a value close to the smallest sufficient change, rounded to three digits if the rounded value suffices."""
    near = _value(token, key, component)
    enough = far
    for _ in range(_HALVINGS):
        middle = (near + enough) / 2.0
        if _meets(task, token, key, component, middle, atom) is None:
            near = middle
        else:
            enough = middle
    unit = 10.0 ** (floor(log10(abs(enough))) + 1 - _DIGITS) if enough else 1.0
    rounded = round(enough / unit) * unit
    for candidate in (rounded, rounded + unit, rounded - unit):
        tidy = float(f"{candidate:.{_DIGITS}g}")
        if _meets(task, token, key, component, tidy, atom) is not None:
            return tidy
    return enough


def _meets(task: Task, token: Token, key: str, component: int | None, value: float, atom: Atom) -> Token | None:
    """Return the token with a new value if the value is valid and makes the fact hold, else None."""
    changed = _with(task, token, key, component, value)
    if changed is None:
        return None
    values = (changed if name == token.name else task.value(name) for name in atom.arguments)
    margin = float(task.domain.predicate_by_name[atom.predicate].evaluate(task.state, *values))
    margin = margin if atom.positive else -margin
    return changed if isfinite(margin) and margin >= 0 else None


def _with(task: Task, token: Token, key: str, component: int | None, value: float) -> Token | None:
    number: Any = value
    if component is not None:
        number = tuple(value if place == component else each for place, each in enumerate(token[key]))
    own = [member for member in token.classes if member is not task_root(task)]
    try:
        made = Token.make(token.name, own, {**token.properties, key: number}, token.shape, token.unknown)
        made = replace(made, ground=token.ground, burden=token.burden)
    except ValidationError:
        return None
    with authored(f"the function consistent of a class of {token.name}", {"token": made}):
        if any(member.consistent(made) for member in made.classes):
            return None
    if any(find_disagreements(made)):
        return None
    return replace(made, classes=token.classes)

"""PDDL 2.1 text of a temporal problem: durative actions, types, numbers for durations and counts.

PDDL has no fluents with objects for values: such a fluent is a predicate that names its value last. What takes its
place is deleted by name, so an action that gives a value names the old one (`named`).
"""

from collections.abc import Iterable, Iterator
from dataclasses import replace

from hybrid_tamp.symbolic.pddl.operators import Fact, Typed
from hybrid_tamp.symbolic.temporal.problem import (
    Condition,
    DurativeAction,
    Effect,
    Fluent,
    TemporalDomain,
    TemporalProblem,
    TimedAction,
    Value,
)

_WHEN = {"start": ("at start",), "end": ("at end",), "over all": ("over all",), "throughout": ("at start", "over all")}


def temporal_domain_text(domain: TemporalDomain) -> str:
    """Return the domain file."""
    domain = named(domain)
    numbers = [fluent for fluent in domain.fluents if fluent.kind == "number"]
    others = [fluent for fluent in domain.fluents if fluent.kind != "number"]
    sections = [
        "(:requirements :strips :typing :fluents :durative-actions)",
        _section(":types", _grouped(domain.types)),
        _section(":constants", _grouped(domain.constants)),
        _section(":predicates", map(_declared, others)),
        _section(":functions", map(_declared, numbers)),
        *map(_action_text, domain.actions),
    ]
    return _comments(domain.comments) + _definition(f"(domain {domain.name})", sections)


def temporal_problem_text(problem: TemporalProblem) -> str:
    """Return the problem file."""
    lasting = {action.duration[0] for action in problem.domain.actions}
    init = [_stated(fact, value, fact[0] in lasting) for fact, value in problem.init]
    goal = [_stated(fact, value) for fact, value in problem.goal]
    sections = [
        f"(:domain {problem.domain.name})",
        _section(":objects", _grouped(problem.objects)),
        _section(":init", init) or "(:init)",
        _section(":goal", [_section("and", goal) or "(and)"]),
        "(:metric minimize (total-time))",
    ]
    return _comments(problem.comments) + _definition(f"(problem {problem.name})", sections)


def temporal_plan_text(actions: Iterable[TimedAction]) -> str:
    """Return the plan file: ``time: (action objects) [duration]`` a line, times in seconds, as VAL takes it."""
    lines = [f"{a.start:.3f}: ({' '.join((a.name, *a.arguments))}) [{a.duration:.3f}]\n" for a in actions]
    return "".join(lines)


# -- old values by name ---------------------------------------------------------------------------------------------


def named(domain: TemporalDomain) -> TemporalDomain:
    """Return the domain with actions that ask for the old value of everything that they give a new one."""
    fluents = {fluent.name: fluent for fluent in domain.fluents}
    return replace(domain, actions=tuple(_named(action, fluents) for action in domain.actions))


def _named(action: DurativeAction, fluents: dict[str, Fluent]) -> DurativeAction:
    parameters, conditions = list(action.parameters), list(action.conditions)
    for effect in action.effects:
        if isinstance(effect.value, tuple) and _old(action.conditions, action.effects, effect) is None:
            kinds = fluents[effect.fact[0]].values
            fresh = [(f"?old-{len(parameters) + i - len(action.parameters) + 1}", k) for i, k in enumerate(kinds)]
            parameters += fresh
            conditions.append(Condition(effect.when, effect.fact, tuple(name for name, _ in fresh)))
    return replace(action, parameters=tuple(parameters), conditions=tuple(conditions))


def _old(conditions: Iterable[Condition], effects: Iterable[Effect], effect: Effect) -> tuple[str, ...] | None:
    """Return the value that an effect replaces, where the action says it."""
    for other in effects:
        if effect.when == "end" and other.when == "start" and other.fact == effect.fact:
            return other.value if isinstance(other.value, tuple) else None
    # What holds at the start is still so at the end: the tokens are in this block only, and nothing else changes them.
    for condition in conditions:
        if condition.fact == effect.fact and isinstance(condition.value, tuple):
            return condition.value
    return None


# -- text -----------------------------------------------------------------------------------------------------------


def _action_text(action: DurativeAction) -> str:
    conditions = [
        f"({when} {_stated(condition.fact, condition.value)})"
        for condition in action.conditions
        for when in _WHEN[condition.when]
    ]
    effects = [text for effect in action.effects for text in _effect_texts(action, effect)]
    parts = [
        f":parameters ({_typed(action.parameters)})",
        f":duration (= ?duration ({' '.join(action.duration)}))",
        f":condition {_section('and', conditions) or '(and)'}",
        f":effect {_section('and', effects) or '(and)'}",
    ]
    return f"(:durative-action {action.name}\n" + "\n".join(map(_indented, parts)) + "\n)"


def _effect_texts(action: DurativeAction, effect: Effect) -> Iterator[str]:
    when, fact = f"at {effect.when}", " ".join(effect.fact)
    if effect.add:
        assert isinstance(effect.value, int)
        yield f"({when} ({'increase' if effect.value > 0 else 'decrease'} ({fact}) {abs(effect.value)}))"
    elif effect.value is False:
        yield f"({when} (not ({fact})))"
    else:
        if isinstance(effect.value, tuple):
            old = _old(action.conditions, action.effects, effect)
            if old is not None and old != effect.value:
                yield f"({when} (not {_stated(effect.fact, old)}))"
        yield f"({when} {_stated(effect.fact, effect.value)})"


def _stated(fact: Fact, value: Value, milliseconds: bool = False) -> str:
    if value is True:
        return f"({' '.join(fact)})"
    if isinstance(value, tuple):
        return f"({' '.join((*fact, *value))})"
    return f"(= ({' '.join(fact)}) {value / 1e3:.3f})" if milliseconds else f"(= ({' '.join(fact)}) {value})"


def _declared(fluent: Fluent) -> str:
    values = tuple((f"?value-{number}", kind) for number, kind in enumerate(fluent.values, 1))
    return f"({' '.join(filter(None, [fluent.name, _typed((*fluent.parameters, *values))]))})"


def _typed(names: Iterable[Typed]) -> str:
    return " ".join(f"{name} - {kind}" for name, kind in names)


def _grouped(names: Iterable[Typed]) -> list[str]:
    """Return a line ``a b - type`` for each type, in the order in which types first appear."""
    groups: dict[str, list[str]] = {}
    for name, kind in names:
        groups.setdefault(kind, []).append(name)
    return [f"{' '.join(members)} - {kind}" for kind, members in groups.items()]


def _section(keyword: str, lines: Iterable[str]) -> str:
    body = "\n".join(map(_indented, lines))
    return f"({keyword}\n{body}\n)" if body else ""


def _definition(head: str, sections: Iterable[str]) -> str:
    body = "\n".join(_indented(section) for section in sections if section)
    return f"(define {head}\n{body}\n)\n"


def _indented(text: str) -> str:
    return "\n".join("  " + line for line in text.splitlines())


def _comments(comments: Iterable[tuple[str, str]]) -> str:
    lines = [f";   {name} is {own!r}" for name, own in comments if name != own]
    return "\n".join(["; Names here and in the task:", *lines, ""]) if lines else ""

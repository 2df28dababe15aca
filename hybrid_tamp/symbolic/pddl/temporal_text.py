"""PDDL 2.1 text of a temporal problem: durative actions, types, numbers for durations and counts.

PDDL has no fluents with objects for values: such a fluent is a predicate that names its value last. What takes its
place is deleted by name, so an action that gives a value names the old one (`ask_for_old_values`).
"""

from collections.abc import Iterable, Iterator
from dataclasses import replace

from hybrid_tamp.symbolic.pddl.operators import Fact
from hybrid_tamp.symbolic.pddl.text import (
    group_by_type,
    indent,
    lay_out_conjunction,
    lay_out_definition,
    lay_out_section,
    lay_out_term,
    lay_out_typed,
)
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
    domain = ask_for_old_values(domain)
    numbers = [fluent for fluent in domain.fluents if fluent.kind == "number"]
    others = [fluent for fluent in domain.fluents if fluent.kind != "number"]
    sections = [
        "(:requirements :strips :typing :fluents :durative-actions)",
        lay_out_section(":types", group_by_type(domain.types)),
        lay_out_section(":constants", group_by_type(domain.constants)),
        lay_out_section(":predicates", map(_declare, others)),
        lay_out_section(":functions", map(_declare, numbers)),
        *map(_action_text, domain.actions),
    ]
    return lay_out_definition(f"(domain {domain.name})", sections, domain.comments)


def temporal_problem_text(problem: TemporalProblem) -> str:
    """Return the problem file."""
    lasting = {action.duration[0] for action in problem.domain.actions}
    init = [_state(fact, value, fact[0] in lasting) for fact, value in problem.init]
    goal = [_state(fact, value) for fact, value in problem.goal]
    sections = [
        f"(:domain {problem.domain.name})",
        lay_out_section(":objects", group_by_type(problem.objects)),
        lay_out_section(":init", init) or "(:init)",
        lay_out_section(":goal", [lay_out_conjunction(goal)]),
        "(:metric minimize (total-time))",
    ]
    return lay_out_definition(f"(problem {problem.name})", sections, problem.comments)


def temporal_plan_text(actions: Iterable[TimedAction]) -> str:
    """Return the plan file: ``time: (action objects) [duration]`` a line, times in seconds, as VAL takes it."""
    lines = [f"{a.start:.3f}: ({' '.join((a.name, *a.arguments))}) [{a.duration:.3f}]\n" for a in actions]
    return "".join(lines)


# -- old values by name ---------------------------------------------------------------------------------------------


def ask_for_old_values(domain: TemporalDomain) -> TemporalDomain:
    """Return the domain with actions that ask for the old value of everything that they give a new one."""
    fluents = {fluent.name: fluent for fluent in domain.fluents}
    return replace(domain, actions=tuple(_ask_for_old_values(action, fluents) for action in domain.actions))


def _ask_for_old_values(action: DurativeAction, fluents: dict[str, Fluent]) -> DurativeAction:
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
        f"({when} {_state(condition.fact, condition.value)})"
        for condition in action.conditions
        for when in _WHEN[condition.when]
    ]
    effects = [text for effect in action.effects for text in _effect_texts(action, effect)]
    lines = [
        f":parameters ({lay_out_typed(action.parameters)})",
        f":duration (= ?duration ({' '.join(action.duration)}))",
        f":condition {lay_out_conjunction(conditions)}",
        f":effect {lay_out_conjunction(effects)}",
    ]
    return f"(:durative-action {action.name}\n" + "\n".join(map(indent, lines)) + "\n)"


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
                yield f"({when} (not {_state(effect.fact, old)}))"
        yield f"({when} {_state(effect.fact, effect.value)})"


def _state(fact: Fact, value: Value, milliseconds: bool = False) -> str:
    if value is True:
        return lay_out_term(fact)
    if isinstance(value, tuple):
        return lay_out_term((*fact, *value))
    return f"(= ({' '.join(fact)}) {value / 1e3:.3f})" if milliseconds else f"(= ({' '.join(fact)}) {value})"


def _declare(fluent: Fluent) -> str:
    values = tuple((f"?value-{number}", kind) for number, kind in enumerate(fluent.values, 1))
    return lay_out_term([fluent.name, lay_out_typed((*fluent.parameters, *values))])

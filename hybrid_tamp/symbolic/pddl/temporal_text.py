"""PDDL 2.1 text of a temporal problem, with durative actions, types and numeric fluents.

PDDL 2.1 has no fluents with objects as values. So such a fluent becomes a predicate, whose last arguments are the
fluent's value. An action that sets a new value must delete the old value by name. So the old value becomes a parameter
of the action (`require_old_values`).
"""

from collections.abc import Iterable, Iterator
from dataclasses import replace

from hybrid_tamp.symbolic.pddl import text as pddl
from hybrid_tamp.symbolic.pddl.operators import Fact
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
    """Return the text of the domain file."""
    domain = require_old_values(domain)
    numbers = [fluent for fluent in domain.fluents if fluent.kind == "number"]
    others = [fluent for fluent in domain.fluents if fluent.kind != "number"]
    sections = [
        "(:requirements :strips :typing :fluents :durative-actions)",
        pddl.lay_out_section(":types", pddl.group_by_type(domain.types)),
        pddl.lay_out_section(":constants", pddl.group_by_type(domain.constants)),
        pddl.lay_out_section(":predicates", map(_declare, others)),
        pddl.lay_out_section(":functions", map(_declare, numbers)),
        *map(_action_text, domain.actions),
    ]
    return pddl.lay_out_definition(f"(domain {domain.name})", sections, domain.comments)


def temporal_problem_text(problem: TemporalProblem) -> str:
    """Return the text of the problem file."""
    lasting = {action.duration[0] for action in problem.domain.actions}
    init = [_state(fact, value, fact[0] in lasting) for fact, value in problem.init]
    goal = [_state(fact, value) for fact, value in problem.goal]
    sections = [
        f"(:domain {problem.domain.name})",
        pddl.lay_out_section(":objects", pddl.group_by_type(problem.objects)),
        pddl.lay_out_section(":init", init) or "(:init)",
        pddl.lay_out_section(":goal", [pddl.lay_out_conjunction(goal)]),
        "(:metric minimize (total-time))",
    ]
    return pddl.lay_out_definition(f"(problem {problem.name})", sections, problem.comments)


def temporal_plan_text(actions: Iterable[TimedAction]) -> str:
    """Return the text of the plan file for VAL. Each line is ``start: (action objects) [duration]``, in seconds."""
    lines = [f"{a.start:.3f}: ({' '.join((a.name, *a.arguments))}) [{a.duration:.3f}]\n" for a in actions]
    return "".join(lines)


# -- old values as parameters -----------------------------------------------------------------------------------------


def require_old_values(domain: TemporalDomain) -> TemporalDomain:
    """Return the domain with extra action parameters, for old values that an action replaces but does not name."""
    fluents = {fluent.name: fluent for fluent in domain.fluents}
    return replace(domain, actions=tuple(_require_old_values(action, fluents) for action in domain.actions))


def _require_old_values(action: DurativeAction, fluents: dict[str, Fluent]) -> DurativeAction:
    parameters, conditions = list(action.parameters), list(action.conditions)
    for effect in action.effects:
        if isinstance(effect.value, tuple) and _old(action.conditions, action.effects, effect) is None:
            kinds = fluents[effect.fact[0]].values
            fresh = [(f"?old-{len(parameters) + i - len(action.parameters) + 1}", k) for i, k in enumerate(kinds)]
            parameters += fresh
            conditions.append(Condition(effect.when, effect.fact, tuple(name for name, _ in fresh)))
    return replace(action, parameters=tuple(parameters), conditions=tuple(conditions))


def _old(conditions: Iterable[Condition], effects: Iterable[Effect], effect: Effect) -> tuple[str, ...] | None:
    """Return the old value that an effect replaces, or None if the action does not name the old value."""
    for other in effects:
        if effect.when == "end" and other.when == "start" and other.fact == effect.fact:
            return other.value if isinstance(other.value, tuple) else None
    # The fluent still has its start value at the end, because no other block changes the tokens of this block.
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
        f":parameters ({pddl.lay_out_typed(action.parameters)})",
        f":duration (= ?duration ({' '.join(action.duration)}))",
        f":condition {pddl.lay_out_conjunction(conditions)}",
        f":effect {pddl.lay_out_conjunction(effects)}",
    ]
    return f"(:durative-action {action.name}\n" + "\n".join(map(pddl.indent, lines)) + "\n)"


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
        return pddl.lay_out_term(fact)
    if isinstance(value, tuple):
        return pddl.lay_out_term((*fact, *value))
    return f"(= ({' '.join(fact)}) {value / 1e3:.3f})" if milliseconds else f"(= ({' '.join(fact)}) {value})"


def _declare(fluent: Fluent) -> str:
    values = tuple((f"?value-{number}", kind) for number, kind in enumerate(fluent.values, 1))
    return pddl.lay_out_term([fluent.name, pddl.lay_out_typed((*fluent.parameters, *values))])

"""PDDL text of a planning problem, for people and for any other planner.

The text needs ``:strips`` and ``:typing`` only. Everything keeps the order in which the encoder gave it,
so that equal problems give equal files. Names that differ from the user's are listed in comments.
"""

from collections.abc import Iterable

from hybrid_tamp.model.plan import PlannedAction
from hybrid_tamp.symbolic.pddl.layout import (
    group_by_type,
    indent,
    lay_out_conjunction,
    lay_out_definition,
    lay_out_section,
    lay_out_term,
    lay_out_typed,
)
from hybrid_tamp.symbolic.pddl.operators import Operator, PlanningDomain, PlanningProblem


def domain_text(domain: PlanningDomain) -> str:
    """Return the domain file."""
    predicates = [lay_out_term([name, lay_out_typed(parameters)]) for name, parameters in domain.predicates]
    sections = [
        "(:requirements :strips :typing)",
        lay_out_section(":types", group_by_type(domain.types)),
        lay_out_section(":constants", group_by_type(domain.constants)),
        lay_out_section(":predicates", predicates),
        *map(_operator_text, domain.operators),
    ]
    return lay_out_definition(f"(domain {domain.name})", sections, domain.comments)


def problem_text(problem: PlanningProblem) -> str:
    """Return the problem file."""
    sections = [
        f"(:domain {problem.domain.name})",
        lay_out_section(":objects", group_by_type(problem.objects)),
        lay_out_section(":init", map(lay_out_term, problem.init)) or "(:init)",
        lay_out_section(":goal", [lay_out_conjunction(map(lay_out_term, problem.goal))]),
    ]
    return lay_out_definition(f"(problem {problem.name})", sections, problem.comments)


def plan_text(actions: Iterable[PlannedAction]) -> str:
    """Return the plan file: one action a line, as VAL takes it."""
    return "".join(f"{action.text}\n" for action in actions)


def _operator_text(operator: Operator) -> str:
    """Return one action; effects delete before they add, and what is added back is not deleted."""
    deleted = [f"(not {lay_out_term(fact)})" for fact in operator.delete if fact not in operator.add]
    added = list(map(lay_out_term, operator.add))
    lines = [
        f":parameters ({lay_out_typed(operator.parameters)})",
        f":precondition {lay_out_conjunction(map(lay_out_term, operator.precondition))}",
        f":effect {lay_out_conjunction(deleted + added)}",
    ]
    body = "\n".join(map(indent, lines))
    return f"(:action {operator.name}\n{body}\n)"

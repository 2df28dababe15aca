"""PDDL text of a planning problem, for people and for any other planner.

The text needs ``:strips`` and ``:typing`` only. Everything keeps the order in which the encoder gave it,
so that equal problems give equal files. Names that differ from the user's are listed in comments.
"""

from collections.abc import Iterable, Sequence

from hybrid_tamp.model.plan import PlannedAction
from hybrid_tamp.symbolic.pddl.operators import Fact, Operator, PlanningDomain, PlanningProblem, Typed

_INDENT = "  "


def domain_text(domain: PlanningDomain) -> str:
    """Return the domain file."""
    sections = [
        "(:requirements :strips :typing)",
        _section(":types", _grouped(domain.types)),
        _section(":constants", _grouped(domain.constants)),
        _section(":predicates", [_predicate_text(*predicate) for predicate in domain.predicates]),
        *map(_operator_text, domain.operators),
    ]
    return _comment_lines(domain.comments) + _definition(f"(domain {domain.name})", sections)


def problem_text(problem: PlanningProblem) -> str:
    """Return the problem file."""
    sections = [
        f"(:domain {problem.domain.name})",
        _section(":objects", _grouped(problem.objects)),
        _section(":init", map(_fact_text, problem.init)) or "(:init)",
        _section(":goal", [_conjunction(map(_fact_text, problem.goal))]),
    ]
    return _comment_lines(problem.comments) + _definition(f"(problem {problem.name})", sections)


def plan_text(actions: Iterable[PlannedAction]) -> str:
    """Return the plan file: one action a line, as VAL takes it."""
    return "".join(f"{action.text}\n" for action in actions)


def _definition(head: str, sections: Sequence[str]) -> str:
    """Return a whole file from its sections, leaving out the empty ones."""
    body = "\n".join(_indented(section) for section in sections if section)
    return f"(define {head}\n{body}\n)\n"


def _section(keyword: str, lines: Iterable[str]) -> str:
    """Return ``(keyword line...)`` with a line each, or an empty text where there are no lines."""
    body = "\n".join(_indented(line) for line in lines)
    return f"({keyword}\n{body}\n)" if body else ""


def _operator_text(operator: Operator) -> str:
    """Return one action; effects delete before they add, and what is added back is not deleted."""
    deleted = [f"(not {_fact_text(fact)})" for fact in operator.delete if fact not in operator.add]
    added = [_fact_text(fact) for fact in operator.add]
    lines = [
        f":parameters ({_typed_text(operator.parameters)})",
        f":precondition {_conjunction(map(_fact_text, operator.precondition))}",
        f":effect {_conjunction(deleted + added)}",
    ]
    body = "\n".join(map(_indented, lines))
    return f"(:action {operator.name}\n{body}\n)"


def _conjunction(terms: Iterable[str]) -> str:
    """Return ``(and term...)`` with a line each; an empty conjunction is true."""
    body = "\n".join(map(_indented, terms))
    return f"(and\n{body}\n)" if body else "(and)"


def _predicate_text(name: str, parameters: Sequence[Typed]) -> str:
    return f"({' '.join([name, *filter(None, [_typed_text(parameters)])])})"


def _typed_text(names: Iterable[Typed]) -> str:
    """Return ``?a - t ?b - u`` on one line."""
    return " ".join(f"{name} - {kind}" for name, kind in names)


def _grouped(names: Iterable[Typed]) -> list[str]:
    """Return a line ``a b - type`` for each type, in the order in which types first appear."""
    groups: dict[str, list[str]] = {}
    for name, kind in names:
        groups.setdefault(kind, []).append(name)
    return [f"{' '.join(members)} - {kind}" for kind, members in groups.items()]


def _fact_text(fact: Fact) -> str:
    return f"({' '.join(fact)})"


def _indented(text: str) -> str:
    """Return the text one level deeper."""
    return "\n".join(_INDENT + line for line in text.splitlines())


def _comment_lines(comments: Iterable[tuple[str, str]]) -> str:
    """Return a comment line for each name that differs; quoted, so that no name can end its line."""
    lines = [f";   {name} is {own!r}" for name, own in comments if name != own]
    return "\n".join(["; Names here and in the task:", *lines, ""]) if lines else ""

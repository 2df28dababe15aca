"""PDDL text of a planning problem, for users and for other planners.

The text requires only ``:strips`` and ``:typing``. Items are in the encoder's order, so equal problems have
equal text. Comments list the PDDL names that differ from the user's names.
"""

from collections.abc import Iterable

from hybrid_tamp.model.plan import PlannedAction
from hybrid_tamp.symbolic.pddl.operators import Operator, PlanningDomain, PlanningProblem, Typed


def domain_text(domain: PlanningDomain) -> str:
    """Return the text of the domain file."""
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
    """Return the text of the problem file."""
    sections = [
        f"(:domain {problem.domain.name})",
        lay_out_section(":objects", group_by_type(problem.objects)),
        lay_out_section(":init", map(lay_out_term, problem.init)) or "(:init)",
        lay_out_section(":goal", [lay_out_conjunction(map(lay_out_term, problem.goal))]),
    ]
    return lay_out_definition(f"(problem {problem.name})", sections, problem.comments)


def plan_text(actions: Iterable[PlannedAction]) -> str:
    """Return the text of the plan file for VAL, with one action per line."""
    return "".join(f"{action.text}\n" for action in actions)


def _operator_text(operator: Operator) -> str:
    """Return the text of one action. Deletes precede adds, so a fact in both sets is left out of the deletes."""
    deleted = [f"(not {lay_out_term(fact)})" for fact in operator.delete if fact not in operator.add]
    added = list(map(lay_out_term, operator.add))
    lines = [
        f":parameters ({lay_out_typed(operator.parameters)})",
        f":precondition {lay_out_conjunction(map(lay_out_term, operator.precondition))}",
        f":effect {lay_out_conjunction(deleted + added)}",
    ]
    body = "\n".join(map(indent, lines))
    return f"(:action {operator.name}\n{body}\n)"


# -- layout of classical and temporal problems -------------------------------------------------------------------------


def lay_out_definition(head: str, sections: Iterable[str], comments: Iterable[tuple[str, str]]) -> str:
    """Return the text of a file with comments on names, a definition with this head, and the non-empty sections."""
    body = "\n".join(indent(section) for section in sections if section)
    return f"{_lay_out_comments(comments)}(define {head}\n{body}\n)\n"


def lay_out_section(keyword: str, lines: Iterable[str]) -> str:
    """Return ``(keyword line...)`` with one item per line, or an empty string if there are no items."""
    body = "\n".join(map(indent, lines))
    return f"({keyword}\n{body}\n)" if body else ""


def lay_out_conjunction(terms: Iterable[str]) -> str:
    """Return ``(and term...)`` with one term per line. An empty conjunction is true."""
    return lay_out_section("and", terms) or "(and)"


def lay_out_term(words: Iterable[str]) -> str:
    """Return ``(first second ...)`` on one line, without empty words."""
    return f"({' '.join(filter(None, words))})"


def lay_out_typed(names: Iterable[Typed]) -> str:
    """Return ``?a - t ?b - u`` on one line."""
    return " ".join(f"{name} - {kind}" for name, kind in names)


def group_by_type(names: Iterable[Typed]) -> list[str]:
    """Return a line ``a b - type`` for each type, in the order in which types first appear."""
    groups: dict[str, list[str]] = {}
    for name, kind in names:
        groups.setdefault(kind, []).append(name)
    return [f"{' '.join(members)} - {kind}" for kind, members in groups.items()]


def indent(text: str) -> str:
    """Indent each line of a text by two spaces."""
    return "\n".join("  " + line for line in text.splitlines())


def _lay_out_comments(comments: Iterable[tuple[str, str]]) -> str:
    """Return comment lines for names that differ. A quoted name cannot end its line, even with a line break in it."""
    lines = [f";   {name} is {own!r}" for name, own in comments if name != own]
    return "\n".join(["; Names here and in the task:", *lines, ""]) if lines else ""

"""Tables of the answers to questions about a task."""

from collections.abc import Iterable, Mapping

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from hybrid_tamp.model.affordances import Affordance, AffordanceResult, Implication
from hybrid_tamp.model.explanation import Cause, TaskExplanation
from hybrid_tamp.model.membership import MembershipResult, Verdict
from hybrid_tamp.report.documents import document
from hybrid_tamp.report.tables import explanation_text, new_table, roles_text


def explanation_table(result: TaskExplanation) -> RenderableType:
    """Return the reasons why there is no plan, or a table of the tokens with the reasons why the plan uses them."""
    if result.explanation is not None:
        return explanation_text(document(result)["explanation"])
    table = new_table(f"Tokens in the plan of {result.task.name}", "token", "in the plan", "why")
    for cause in result.tokens:
        table.add_row(Text(cause.token), "yes" if cause.used else "no", Text("\n".join(_reasons_of(cause))))
    return Group(table, *(Text(f"excluded: {binding}") for binding in result.excluded))


def _reasons_of(cause: Cause) -> list[str]:
    """Return one line for each link between an instance and the nearest instance that needs its effect."""
    others = {link.instance: link for link in reversed(cause.links)}
    others.pop(cause.links[0].instance if cause.links else "", None)
    more = [f"{link.instance} for {link.needed_by_text}: {link.atom.text}" for link in reversed(others.values())]
    return [f"{cause.why}.", *more]


def affordances_table(result: AffordanceResult) -> RenderableType:
    """Return tables of the objects and the blocks that they afford, and of the effect of each proposed change."""
    title = f"{result.task.name}, {result.view} view"
    shown: list[RenderableType] = [Text(f"{title}: no object affords a block.")]
    if result.affordances:
        shown = [_affordances(title, result.affordances)]
    if result.implied:
        shown.append(_implied(result.implied))
    for answer in result.what_if:
        changed = [("gained", answer.gained), ("lost", answer.lost)]
        if not answer.gained and not answer.lost:
            shown.append(Text(f"{answer.question}: no affordance changes."))
        shown += [_affordances(f"{answer.question}: affordances {what}", found) for what, found in changed if found]
    return Group(*shown)


def _affordances(title: str, affordances: Iterable[Affordance]) -> Table:
    table = new_table(title, "object", "affords", "as", "to", "e.g. with")
    for each in affordances:
        to = ", ".join(each.agents) or "-"
        table.add_row(*map(Text, (each.object, each.block, each.slot, to, _witness(each.witness, each.slot))))
    return table


def _implied(implications: Iterable[Implication]) -> Table:
    title = "Affordances for other agents with the same capability classes"
    table = new_table(title, "observed agent", "object", "block", "observer", "observer can?", "e.g. with")
    for each in implications:
        answer = "yes" if each.holds else "no: the classes match, but a feasibility fact fails"
        seen = each.affordance
        witness = _witness(each.witness, seen.slot)
        table.add_row(*map(Text, (each.seen, seen.object, seen.block, each.observer, answer, witness)))
    return table


def _witness(witness: Mapping[str, str], slot: str) -> str:
    return roles_text({role: value for role, value in witness.items() if role != slot}) or "-"


def resting_text(result: MembershipResult) -> str:
    """Return the number of faces on which a token can rest, as a sentence."""
    return f"{result.token} can rest on {len(result.resting) or 'none'} of its faces."


def membership_table(result: MembershipResult) -> RenderableType:
    """Return a table with a row for each class of which the token may be a member."""
    table = new_table("", "class", "likelihood", "like", "verdict", "trials", "95 % interval")
    for verdict in result.verdicts:
        low, high = verdict.interval
        table.add_row(
            verdict.object_class,
            f"{verdict.likelihood:.2f}",
            verdict.labelled or "",
            verdict.verdict,
            f"{verdict.successes} of {verdict.conclusive}{_without_evidence(verdict)}",
            f"{low:.2f} to {high:.2f}" if verdict.conclusive else "",
        )
    return table


def _without_evidence(verdict: Verdict) -> str:
    count = len(verdict.trials) - verdict.conclusive
    return f" ({count} without evidence)" if count else ""


def membership_lines(result: MembershipResult) -> list[str]:
    """Return lines about the properties that the token has in each class, and about the failed trials."""
    lines = []
    for verdict in result.verdicts:
        known = ", ".join(f"{name} {_number(value)}" for name, value in verdict.properties.items())
        lines += [f"{verdict.object_class} with {known}"] if known else []
        obstacles = dict.fromkeys([verdict.obstacle, *(trial.why for trial in verdict.trials)])
        lines += [f"{verdict.object_class}: {obstacle}" for obstacle in obstacles if obstacle]
    return lines


def _number(value: object) -> str:
    return f"[{', '.join(f'{part:g}' for part in value)}]" if isinstance(value, tuple) else f"{value:g}"

"""Tables of plans, results and domains for people. Programs read the JSON documents instead."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from rich.console import Group, JustifyMethod, RenderableType
from rich.table import Table
from rich.text import Text

from hybrid_tamp.model.disagreement import DomainReport
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.explanation import suggest
from hybrid_tamp.model.plan import BlockInstance, TaskPlan
from hybrid_tamp.report.documents import Json

_WIDTH = 60
"""Width of a timeline in characters."""
_NAMED = 8
RESTING = 12
"""Largest number of resting tokens that are named, and largest number of rows for tokens that always rest."""
"""Maximum number of names that are printed in a list. The document has all names."""

_NO_SINGLE_CHANGE = "No single change of a token, class, edge, fact or property makes the task solvable."
_NONE_FOUND = "No single change was found; try more changes with 'hybrid-tamp explain --trials N'."


_LONG = 30
"""Number of characters from which a word may be broken, if the table is too wide."""


class WordTable(Table):
    """A table whose columns are not narrower than their words, unless the words are long."""

    def add_row(self, *cells: RenderableType | None, **options: Any) -> None:
        """Add a row, and widen the columns to its words."""
        super().add_row(*cells, **options)
        for column, cell in zip(self.columns, cells, strict=False):
            longest = max(map(len, str(cell).split()), default=0)
            column.min_width = max(column.min_width or 0, min(longest, _LONG))


def new_table(title: str, *headings: str, framed: bool = True) -> Table:
    """Return an empty table.

    Args:
        title: the title, or an empty string.
        headings: the headings of the columns. The prefix ``>`` aligns a column to the right. The prefix ``|`` prevents
            line breaks in a column.
        framed: whether the table has lines around its cells.
    """
    table = WordTable(title=title, title_justify="left", header_style="bold")
    if not framed:
        table.box, table.pad_edge = None, False
    for heading in headings:
        # Fold long names, because a truncated name is useless.
        at_right, whole = heading.startswith(">"), heading.startswith("|")
        justify: JustifyMethod = "right" if at_right else "left"
        table.add_column(heading.lstrip(">|"), justify=justify, overflow="fold", no_wrap=whole)
    return table


def plan_table(document: Json, resting: str) -> RenderableType:
    """Return a table of a plan's steps with the blocks and tokens of each step, as in the paper's Fig. 3.

    Args:
        document: the document of a plan.
        resting: name of the block in which tokens rest.
    """
    table = new_table(f"Plan of {document['task']}", ">step", ">from [s]", ">to [s]", "blocks and their tokens")
    for step in document["steps"]:
        lines = Text("\n".join(allocations(step, resting)))
        table.add_row(str(step["index"]), f"{step['start']:.2f}", f"{step['end']:.2f}", lines)
    return table


def allocations(step: Json, resting: str) -> list[str]:
    """Return a line with the tokens of each busy instance, and a line with all resting tokens."""
    busy = [allocation(entry) for entry in step["blocks"] if entry["block"] != resting]
    idle = [token for entry in step["blocks"] if entry["block"] == resting for token in entry["slots"].values()]
    return [*busy, f"{resting}: {name_some(sorted(idle), RESTING)}"] if idle else busy


def name_some(names: Sequence[str], most: int) -> str:
    """Return the first names, separated by commas, and the number of further names, e.g. ``a, b and 3 more``."""
    more = f" and {len(names) - most} more" if len(names) > most else ""
    return f"{', '.join(names[:most])}{more}"


def plan_footer(document: Json) -> str:
    """Return one line with the length of a plan and the way in which the plan was found."""
    planner = document["planner"]
    known = "" if planner.get("fewest") is None else f" ({planner['fewest']})"
    text = f"{len(document['actions'])} actions{known}, {document['makespan']:.2f} s"
    text += f", planned in {planner['seconds']:.2f} s"
    if document["objective"] == "makespan":
        text += f" ({planner['way']}; not proven the shortest in time)"
    return text


def clearance_text(pairs: Sequence[Json]) -> str:
    """Return one line about the closest approach of a plan, planned and, after a run, measured. Empty without pairs."""
    if not pairs:
        return ""
    least = min(pairs, key=lambda pair: float(pair["distance"]))
    measured = least.get("measured")
    also = "" if measured is None else f", {1e3 * measured:.0f} mm in the run"
    distance = f"{1e3 * least['distance']:.0f} mm"
    return f"closest approach: {least['moving']} and {least['other']} in {least['instance']}, {distance}{also}"


def network_text(network: Json) -> str:
    """Return lines about blocks and tokens that the network leaves out, and about tokens that were added as tools."""
    whole, expanded = network["reduced_from"], network["expanded_with"]
    lines = []
    if whole is not None:
        blocks = f"{len(network['blocks'])} of {whole['blocks']} blocks"
        tokens = f"{len(network['tokens'])} of {whole['tokens']} tokens"
        left_out = [*whole["blocks_left_out"], *whole["tokens_left_out"]]
        lines.append(f"reduced network: {blocks}, {tokens}; left out: {name_some(left_out, _NAMED)}")
    for added in expanded[:_NAMED]:
        fills = f" for {', '.join(added['blocks'])}" if added["blocks"] else ""
        lines.append(f"brought in {added['token']} ({', '.join(added['classes'])}){fills}: {added['why']}")
    if len(expanded) > _NAMED:
        lines.append(f"brought in {len(expanded) - _NAMED} more tokens")
    return "\n".join(lines)


def roles_text(roles: Mapping[str, str]) -> str:
    """Return roles with their tokens or symbols, e.g. ``hand=h, object=drum``."""
    return ", ".join(f"{role}={name}" for role, name in roles.items())


def allocation(entry: Json) -> str:
    """Return an instance with its tokens and targets, e.g. ``ROLLING-1: hand=h, object=drum -> region=goal``."""
    targets = f" -> {roles_text(entry['targets'])}" if entry["targets"] else ""
    return f"{entry['instance']}: {roles_text(entry['slots'])}{targets}"


def timetable(title: str, plan: TaskPlan) -> RenderableType:
    """Return a table with one row per instance: its time, its block and its tokens."""
    table = new_table(title, ">from [s]", ">to [s]", "block", "tokens and targets")
    for instance in sorted(plan.instances, key=lambda i: (i.start, i.end, i.name)):
        roles = Text(roles_text(instance.roles))
        table.add_row(f"{instance.start:.2f}", f"{instance.end:.2f}", Text(instance.block), roles)
    return table


def timeline(plan: TaskPlan, tokens: Iterable[str], resting: str) -> RenderableType:
    """Return a table in which each row shows the blocks of a token over time, to scale. Dots stand for rest.

    If there are many tokens, tokens that always rest have no row.
    """
    table = Table(box=None, show_header=False, pad_edge=False)
    table.add_column(no_wrap=True)
    table.add_column(no_wrap=True)
    names = list(tokens)
    if len(names) > RESTING:
        names = [name for name in names if any(each.block != resting for each, _ in plan.timeline(name))]
    for token in names:
        row = Text()
        for instance, _ in plan.timeline(token):
            begin, end = (round(time / plan.makespan * _WIDTH) for time in (instance.start, instance.end))
            row.append(_bar(instance, end - begin, resting))
        table.add_row(Text(token), row)
    table.add_row("", Text("0" + f"{plan.makespan:.1f} s".rjust(_WIDTH - 1), style="dim"))
    return table


def _bar(instance: BlockInstance, width: int, resting: str) -> Text:
    if instance.block == resting or width == 0:
        return Text("." * width, style="dim")
    label = instance.name if len(instance.name) <= width - 2 else ""
    return Text(f"[{label:-^{width - 2}}]" if width > 1 else "|")


def explanation_text(explanation: Json) -> RenderableType:
    """Return the reasons why there is no plan."""
    return Group(Text(explanation["message"], style="bold red"), *(Text(f"  {line}") for line in reasons(explanation)))


def reasons(explanation: Json) -> list[str]:
    """Return a line for each reason why there is no plan, and for each change that makes the task solvable."""
    found = explanation["suggestions"]
    lines = [f"{reason['goal']}: {reason['message']}" for reason in explanation["reasons"]]
    lines += [suggest(each["length"], each["what"]) for each in found]
    if explanation["kind"] in ("unsolvable", "safety") and not found:
        lines.append(_NO_SINGLE_CHANGE if explanation["all_looked_at"] else _NONE_FOUND)
    if explanation["together"]:
        lines.append(f"There is a plan with all of these changes together: {'; '.join(explanation['together'])}.")
    return lines


def result_table(document: Json) -> RenderableType:
    """Return tables of a run's result: predicted and measured exit margins, the goal and the domain's measures."""
    title = f"\nRun of {document['task']} in {document['backend']}"
    table = new_table(title, "exit conditions", ">predicted", ">measured", "", framed=False)
    for run in (each for each in document["blocks"] if each["exit"]):
        table.add_row(Text(f"{run['instance']}, {run['start']:.2f} to {run['end']:.2f} s"))
        for condition in run["exit"]:
            numbers = (margin(condition["predicted"]), margin(condition["measured"]))
            table.add_row(Text(f"  {condition['atom']}"), *numbers, "holds" if condition["holds"] else "FAILS")
    goal = Table(box=None, show_header=False, pad_edge=False)
    for atom in document["goal"]:
        goal.add_row("goal", Text(atom["atom"]), margin(atom["margin"]), "holds" if atom["holds"] else "FAILS")
    for name, value in document["metrics"].items():
        goal.add_row("measured", Text(name), f"{value:.4g}", "")
    return Group(table, goal)


def margin(value: float | None) -> str:
    """Return a signed margin as text, or a dash for None."""
    return "-" if value is None else f"{value:+.4f}"


def domains_table(domains: Iterable[Domain]) -> RenderableType:
    """Return a table with one row per domain."""
    table = new_table("", "|domain", "description", "classes", "blocks", framed=False)
    for domain in domains:
        classes = ", ".join(c.name for c in domain.classes)
        table.add_row(domain.name, domain.description, classes, ", ".join(b.name for b in domain.blocks))
    return table


def network_table(domain: Domain) -> RenderableType:
    """Return a table with one row per slot: its class, and the slots that a token may enter next."""
    title = f"{domain.name}: {len(domain.blocks)} blocks, {len(domain.network.edges)} edges"
    table = new_table(title, "slot", "class", "next slots", framed=False)
    for block in domain.blocks:
        table.add_row(Text(block.name))
        for slot in block.slots:
            onward = ", ".join(map(".".join, domain.network.destinations((block.name, slot.name))))
            table.add_row(*map(Text, (f"  {slot.name}", slot.object_class.name, onward or "-")))
    return table


def mistakes_table(report: DomainReport) -> RenderableType:
    """Return a table of the mistakes in a domain, or a line which says that there are none."""
    tasks = f"the task{'s' * (len(report.tasks) > 1)} {', '.join(report.tasks)}"
    if not report.mistakes:
        return Text(f"{report.domain}: no mistakes in {report.blocks} blocks, checked with {tasks}")
    table = new_table(
        f"Mistakes in {report.domain}, checked with {tasks}", "kind", "block", "role", "mistake and remedy"
    )
    for task, each in report.mistakes:
        bound = f" ({task}: {roles_text(dict(each.binding))})" if each.binding else ""
        lines = f"{each.declared}\nbut {each.measured}{bound}\nRemedy: {each.remedy}."
        table.add_row(*map(Text, (each.kind, each.block, each.role, lines)))
    return table

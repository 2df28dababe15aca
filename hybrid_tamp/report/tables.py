"""Tables for people: plans, results, domains. Programs read the JSON documents instead."""

from collections.abc import Iterable

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.plan import BlockInstance, TaskPlan
from hybrid_tamp.report.documents import Json

_WIDTH = 60
"""Characters of a timeline."""
_NAMED = 8
"""So many of the names that were left out are said; programs are told all."""

_NO_SINGLE_CHANGE = "No single change gives it a plan: no token, class, edge, fact or property."
_NONE_FOUND = (
    "No single change was found in time that gives it a plan; 'hybrid-tamp explain --seconds N' searches longer."
)


def plan_table(document: Json, resting: str) -> RenderableType:
    """Return the table of steps and allocations, as under the pictures of the paper's Fig. 3.

    Args:
        document: the document of a plan.
        resting: name of the block in which tokens rest.
    """
    table = Table(title=f"Plan of {document['task']}", title_justify="left", header_style="bold")
    table.add_column("step", justify="right")
    table.add_column("from [s]", justify="right")
    table.add_column("to [s]", justify="right")
    table.add_column("which tokens are in which blocks")
    for step in document["steps"]:
        lines = Text("\n".join(allocations(step, resting)))
        table.add_row(str(step["index"]), f"{step['start']:.2f}", f"{step['end']:.2f}", lines)
    return table


def allocations(step: Json, resting: str) -> list[str]:
    """Return which tokens are in which blocks: a line for each busy instance, and one for all that rests."""
    busy = [allocation(entry) for entry in step["blocks"] if entry["block"] != resting]
    idle = [token for entry in step["blocks"] if entry["block"] == resting for token in entry["slots"].values()]
    return [*busy, f"{resting}: {', '.join(sorted(idle))}"] if idle else busy


def plan_footer(document: Json) -> str:
    """Return in one line how long a plan is, and how it was found."""
    planner = document["planner"]
    said = f"{len(document['actions'])} actions, {document['makespan']:.2f} s, planned in {planner['seconds']:.2f} s"
    if document["objective"] == "makespan":
        said += f" ({planner['way']}; {'' if planner['proven_shortest'] else 'not '}proven the shortest in time)"
    return said


def network_text(network: Json) -> str:
    """Return what part of the network was planned on, and what was brought in and why; empty if it was the whole."""
    whole = network["reduced_from"]
    lines = []
    if whole is not None:
        blocks = f"{len(network['blocks'])} of {whole['blocks']} blocks"
        tokens = f"{len(network['tokens'])} of {whole['tokens']} tokens"
        left_out = [*whole["blocks_left_out"], *whole["tokens_left_out"]]
        more = f" and {len(left_out) - _NAMED} more" if len(left_out) > _NAMED else ""
        lines.append(f"reduced network: {blocks}, {tokens}; left out: {', '.join(left_out[:_NAMED])}{more}")
    for added in network["expanded_with"][:_NAMED]:
        fills = f" for {', '.join(added['blocks'])}" if added["blocks"] else ""
        lines.append(f"brought in {added['token']} ({', '.join(added['classes'])}){fills}: {added['why']}")
    if len(network["expanded_with"]) > _NAMED:
        lines.append(f"brought in {len(network['expanded_with']) - _NAMED} more")
    return "\n".join(lines)


def allocation(entry: Json) -> str:
    """Return one instance with its tokens and targets, e.g. ``ROLLING-1: hand=h, object=drum -> region=goal``."""
    slots = ", ".join(f"{slot}={token}" for slot, token in entry["slots"].items())
    targets = ", ".join(f"{target}={value}" for target, value in entry["targets"].items())
    return f"{entry['instance']}: {slots}" + (f" -> {targets}" if targets else "")


def timetable(title: str, plan: TaskPlan) -> RenderableType:
    """Return one row an instance: from when to when which tokens are in which block."""
    table = Table(title=title, title_justify="left", header_style="bold")
    for heading in ("from [s]", "to [s]"):
        table.add_column(heading, justify="right")
    for heading in ("block", "tokens and targets"):
        table.add_column(heading, overflow="fold")
    for instance in sorted(plan.instances, key=lambda i: (i.start, i.end, i.name)):
        roles = ", ".join(f"{role}={name}" for role, name in instance.roles.items())
        table.add_row(f"{instance.start:.2f}", f"{instance.end:.2f}", Text(instance.block), Text(roles))
    return table


def timeline(plan: TaskPlan, tokens: Iterable[str], resting: str) -> RenderableType:
    """Return one row a token: its blocks over time, to scale; dots where it rests."""
    table = Table(box=None, show_header=False, pad_edge=False)
    table.add_column(no_wrap=True)
    table.add_column(no_wrap=True)
    for token in tokens:
        row = Text()
        for instance, _ in plan.timeline(token):
            begin, end = (round(time / plan.makespan * _WIDTH) for time in (instance.start, instance.end))
            row.append(_bar(instance, end - begin, resting))
        table.add_row(Text(token), row)
    end_mark = f"{plan.makespan:.1f} s"
    table.add_row("", Text("0" + end_mark.rjust(_WIDTH - 1), style="dim"))
    return table


def _bar(instance: BlockInstance, width: int, resting: str) -> Text:
    if instance.block == resting or width == 0:
        return Text("." * width, style="dim")
    label = instance.name if len(instance.name) <= width - 2 else ""
    return Text(f"[{label:-^{width - 2}}]" if width > 1 else "|")


def explanation_text(explanation: Json) -> RenderableType:
    """Return why there is no plan."""
    return Group(Text(explanation["message"], style="bold red"), *(Text(f"  {line}") for line in reasons(explanation)))


def reasons(explanation: Json) -> list[str]:
    """Return the reasons why there is no plan, and what would do, a line each."""
    lines = [f"{reason['goal']}: {reason['message']}" for reason in explanation["reasons"]]
    lines += [
        f"There is a plan of {each['length']} actions with {each['what']}." for each in explanation["suggestions"]
    ]
    if explanation["kind"] == "unsolvable" and not explanation["suggestions"]:
        lines.append(_NO_SINGLE_CHANGE if explanation["all_looked_at"] else _NONE_FOUND)
    if explanation["together"]:
        lines.append(f"There is a plan with all of these changes together: {'; '.join(explanation['together'])}.")
    return lines


def result_table(document: Json) -> RenderableType:
    """Return what a run did: predicted against measured exit margins, the goal, the domain's measures."""
    table = Table(
        title=f"\nRun of {document['task']} in {document['backend']}", title_justify="left", header_style="bold"
    )
    table.box, table.pad_edge = None, False
    # Folded, not cut: a condition without its last argument says nothing.
    table.add_column("exit conditions", overflow="fold")
    table.add_column("predicted", justify="right")
    table.add_column("measured", justify="right")
    table.add_column("")
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
    """Return a signed margin, or a dash where there is none."""
    return "-" if value is None else f"{value:+.4f}"


def domains_table(domains: Iterable[Domain]) -> RenderableType:
    """Return one row a domain."""
    table = Table(header_style="bold")
    for heading in ("domain", "what it is about", "classes", "blocks"):
        table.add_column(heading)
    for domain in domains:
        classes = ", ".join(c.name for c in domain.classes)
        table.add_row(domain.name, domain.description, classes, ", ".join(b.name for b in domain.blocks))
    return table


def network_table(domain: Domain) -> RenderableType:
    """Return one row a slot: what it takes, and to which slots a token may go from there."""
    title = f"{domain.name}: {len(domain.blocks)} blocks, {len(domain.network.edges)} edges"
    table = Table(title=title, title_justify="left", header_style="bold", box=None, pad_edge=False)
    for heading in ("slot", "class", "goes on to"):
        table.add_column(heading, overflow="fold")
    for block in domain.blocks:
        table.add_row(Text(block.name))
        for slot in block.slots:
            onward = ", ".join(map(".".join, domain.network.destinations((block.name, slot.name))))
            table.add_row(*map(Text, (f"  {slot.name}", slot.object_class.name, onward or "-")))
    return table

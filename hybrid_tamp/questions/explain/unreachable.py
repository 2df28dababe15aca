"""Reasons for unreachable atoms that depend on themselves: every way to achieve the atom needs the atom first.

For example, a hand must hold a hammer to set the hammer upright, but the hand can grasp only an upright hammer. No
block is impossible, so the reason is an atom of the initial state: the hammer does not stand.
"""

from collections.abc import Mapping

import networkx as nx

from hybrid_tamp.feasibility.backward_search import BackwardSearch
from hybrid_tamp.feasibility.safety_figures import with_unit
from hybrid_tamp.model.explanation import Reason
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.task import Task

_SHOWN = 4


def explain_cycle(search: BackwardSearch, goal: Atom) -> list[Reason]:
    """Return a reason for each group of atoms on which the goal atom depends and which depend on each other.

    Args:
        search: search that has explored the goal atom and has not reached the atom.
        goal: the goal atom.
    """
    graph = _dependencies(search)
    depth: Mapping[Atom, int] = nx.single_source_shortest_path_length(graph, goal)
    groups = sorted(nx.strongly_connected_components(graph.subgraph(depth)), key=min)
    last = [group for group in groups if _is_last(graph, group)]
    found = []
    for group in last:
        # An atom that holds only while a block runs cannot hold initially, so the reason is another atom if possible.
        atoms = [a for a in group if not search.task.domain.predicate_by_name[a.predicate].maintained] or list(group)
        # A plan would achieve the atom that is farthest from the goal first.
        root = max(atoms, key=lambda atom: (depth[atom], atom))
        if search.ways[root].waits:
            found.append(_reason(search, graph, root, group))
    return found


def name_atom(task: Task, atom: Atom, reasons: list[Reason]) -> list[Reason]:
    """Return the reasons why no block achieves a precondition.

    If no block has the precondition as an effect on these tokens, the only reason is the precondition itself.
    """
    if not reasons or not all(each.kind == "no_block" or _is_other_class(task, atom, each) for each in reasons):
        return reasons
    margin, unit, message = _describe(task, atom)
    if all(each.kind == "no_block" for each in reasons):
        message += f", and {reasons[0].message}"
    else:
        message += f", and no block that achieves {atom.predicate} has a role for {' and '.join(atom.arguments)}"
    return [Reason((), reasons[0].block, "unreachable", message, atom, margin, unit)]


def _is_other_class(task: Task, atom: Atom, reason: Reason) -> bool:
    """Say whether the reason is that a token of the atom does not belong to the class that a block requires."""
    block = task.domain.block_by_name.get(reason.block)
    effects = () if block is None else (each for each in block.exit if each.predicate.name == atom.predicate)
    return any(
        block is not None and block.roles.get(role) is reason.lacks and not task.token_by_name[name].is_member(sort)
        for effect in effects
        for role, name in zip(effect.arguments, atom.arguments, strict=True)
        if isinstance(sort := reason.lacks, type) and name in task.token_by_name
    )


def _dependencies(search: BackwardSearch) -> "nx.DiGraph[Atom]":
    """Return the graph of the unreached atoms. An edge leads from an atom to an atom that must be achieved before."""
    reached = search.find_reached()
    graph: nx.DiGraph[Atom] = nx.DiGraph()
    for atom, ways in search.ways.items():
        if atom not in reached:
            graph.add_node(atom)
            graph.add_edges_from((atom, wait) for waits in ways.waits for wait in waits if wait not in reached)
    return graph


def _is_last(graph: "nx.DiGraph[Atom]", group: set[Atom]) -> bool:
    return all(after in group for atom in group for after in graph.successors(atom))


def _reason(search: BackwardSearch, graph: "nx.DiGraph[Atom]", root: Atom, group: set[Atom]) -> Reason:
    margin, unit, message = _describe(search.task, root)
    needs: dict[str, None] = {}
    open_atoms, seen = [root], {root}
    while open_atoms:
        atom = open_atoms.pop(0)
        for waits, block in search.ways[atom].waits.items():
            wait = next((each for each in waits if each in group), None)
            if wait is None:
                continue
            needs[f"{block}, which achieves {atom.text}, needs {wait.text}"] = None
            if wait not in seen:
                seen.add(wait)
                open_atoms.append(wait)
    shown = "; ".join(list(needs)[:_SHOWN]) + ("; ..." if len(needs) > _SHOWN else "")
    message += f", and no plan can achieve {root.text} first: {shown}"
    return Reason((), "", "unreachable", message, root, margin, unit)


def _describe(task: Task, atom: Atom) -> tuple[float, str, str]:
    """Return the margin of an atom in the initial state, its unit, and a sentence that the atom does not hold."""
    predicate, margin = task.domain.predicate_by_name[atom.predicate], task.margin(atom)
    sentence = predicate.sentence(atom.arguments, positive=False)
    if predicate.maintained:
        return margin, predicate.unit, sentence
    return margin, predicate.unit, f"{sentence} (off by {with_unit(-margin, predicate.unit)})"

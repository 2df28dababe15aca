"""Write the network of a diagram in the language of Graphviz (DOT)."""

from html import escape

from hybrid_tamp.report.drawing.diagram import Box, Diagram
from hybrid_tamp.report.drawing.links import Link, links_of
from hybrid_tamp.report.drawing.palette import BOX, INK, TITLE, class_colours, token_colours


def dot_text(diagram: Diagram) -> str:
    """Return a directed graph with a table per block. Edges in both directions are one edge with two heads."""
    boxes = (*diagram.boxes, diagram.bar)
    names = {(box.block, slot): f"b{i}:s{j}" for i, box in enumerate(boxes) for j, slot in enumerate(box.slots)}
    colours = class_colours(diagram.classes)
    lines = [
        f"digraph {_quoted(diagram.title)} {{",
        "  rankdir=LR; nodesep=0.4; ranksep=0.9;",
        '  node [shape=plain, fontname="Helvetica"];',
        '  edge [fontname="Helvetica", fontsize=10];',
        *(f"  b{index} [label={_table(diagram, box, colours)}];" for index, box in enumerate(boxes)),
        *(f"  {names[link.source]} -> {names[link.target]} {_style(diagram, link)};" for link in links_of(diagram)),
        f"  legend [label={_legend(diagram, colours)}];",
        "}",
    ]
    return "\n".join(lines) + "\n"


def _table(diagram: Diagram, box: Box, colours: dict[str, str]) -> str:
    title = f'<tr><td><font color="{TITLE}"><b>{escape(box.block)}</b></font></td></tr>'
    slots = "".join(
        f'<tr><td port="s{index}" bgcolor="{colours[diagram.class_of[box.block, slot]]}">{escape(slot)}</td></tr>'
        for index, slot in enumerate(box.slots)
    )
    return f'<<table border="0" cellborder="0" cellspacing="6" cellpadding="5" bgcolor="{BOX}">{title}{slots}</table>>'


def _style(diagram: Diagram, link: Link) -> str:
    colours = token_colours(diagram)
    shades = ":".join(colours[token] for token in link.tokens) or link.colour
    found = [f'color="{shades}"', *(["dir=both"] if link.both_ways else [])]
    if link.tokens:
        found += ["penwidth=2.5", f"label={_quoted(', '.join(link.tokens))}"]
    return f"[{', '.join(found)}]"


def _legend(diagram: Diagram, colours: dict[str, str]) -> str:
    rows = "".join(
        f'<tr><td bgcolor="{colours[name]}" width="18"></td>'
        f'<td align="left"><font color="{INK}">{escape(name)}</font></td></tr>'
        for name in diagram.shown_classes
    )
    return f'<<table border="0" cellborder="0" cellspacing="4">{rows}</table>>'


def _quoted(text: str) -> str:
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'

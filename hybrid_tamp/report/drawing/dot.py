"""Write the network of a diagram in the language of Graphviz (DOT)."""

from hybrid_tamp.report.drawing.diagram import Diagram
from hybrid_tamp.report.drawing.links import Link, links_of
from hybrid_tamp.report.drawing.palette import BOX, INK, PAGE, TITLE, class_colours, token_colours


def dot_text(diagram: Diagram) -> str:
    """Return a directed graph with a cluster per block. Edges in both directions are one edge with two heads."""
    boxes = (*diagram.boxes, diagram.bar)
    names = {(box.block, slot): f"b{i}s{j}" for i, box in enumerate(boxes) for j, slot in enumerate(box.slots)}
    colours = class_colours(diagram.classes)
    lines = [
        f"digraph {_quoted(diagram.title)} {{",
        "  rankdir=LR; nodesep=0.15; ranksep=0.8;",
        '  graph [fontname="Helvetica-Bold", style="filled,rounded"];',
        f'  node [fontname="Helvetica", shape=box, style="filled,rounded", color="{BOX}", fontcolor="{INK}"];',
        '  edge [fontname="Helvetica", fontsize=10];',
    ]
    for index, box in enumerate(boxes):
        slots = {names[box.block, slot]: (slot, colours[diagram.class_of[box.block, slot]]) for slot in box.slots}
        lines += _cluster(f"b{index}", box.block, (BOX, TITLE), slots)
    lines += [f"  {names[link.source]} -> {names[link.target]} {_style(diagram, link)};" for link in links_of(diagram)]
    legend = {f"c{index}": (name, colours[name]) for index, name in enumerate(diagram.shown_classes)}
    return "\n".join([*lines, *_cluster("legend", "classes", (PAGE, INK), legend), "}"]) + "\n"


def _cluster(name: str, title: str, colours: tuple[str, str], nodes: dict[str, tuple[str, str]]) -> list[str]:
    """Return the lines of a cluster. `colours`: of the box and its title. `nodes` maps names to labels and colours."""
    fill, ink = colours
    return [
        f"  subgraph cluster_{name} {{",
        f'    label={_quoted(title)}; fillcolor="{fill}"; fontcolor="{ink}";',
        *(f'    {node} [label={_quoted(text)}, fillcolor="{colour}"];' for node, (text, colour) in nodes.items()),
        f"    {{ rank=same; {'; '.join(nodes)}; }}",
        "  }",
    ]


def _style(diagram: Diagram, link: Link) -> str:
    colours = token_colours(diagram)
    shades = ":".join(colours[token] for token in link.tokens) or link.colour
    found = [f'color="{shades}"', *(["dir=both"] if link.both_ways else [])]
    if link.tokens:
        found += ["penwidth=2.5", f"label={_quoted(', '.join(link.tokens))}"]
    return f"[{', '.join(found)}]"


def _quoted(text: str) -> str:
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'

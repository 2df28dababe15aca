"""Write the network of a diagram as a flowchart in the language Mermaid, which Markdown pages can contain."""

from hybrid_tamp.report.drawing.diagram import Diagram
from hybrid_tamp.report.drawing.links import links_of
from hybrid_tamp.report.drawing.palette import BOX, INK, PAGE, TITLE, class_colours, token_colours


def mermaid_text(diagram: Diagram) -> str:
    """Return a flowchart with a subgraph per block. Edges in both directions are one edge with two heads."""
    boxes = (*diagram.boxes, diagram.bar)
    names = {(box.block, slot): f"b{i}s{j}" for i, box in enumerate(boxes) for j, slot in enumerate(box.slots)}
    number = {name: f"c{index}" for index, name in enumerate(diagram.classes)}
    colours, shades = class_colours(diagram.classes), token_colours(diagram)
    lines = ["flowchart LR"]
    for index, box in enumerate(boxes):
        slots = [
            f"    {names[box.block, s]}[{_quoted(s)}]:::{number[diagram.class_of[box.block, s]]}" for s in box.slots
        ]
        lines += [f"  subgraph b{index}[{_quoted(box.block)}]", *slots, "  end"]
    legend = [f"    l{number[name]}[{_quoted(name)}]:::{number[name]}" for name in diagram.shown_classes]
    lines += ['  subgraph legend["classes"]', *legend, "  end"]
    styles = []
    for index, link in enumerate(links_of(diagram)):
        arrow = "<-->" if link.both_ways else "-->"
        label = f"|{_quoted(', '.join(link.tokens))}|" if link.tokens else ""
        lines.append(f"  {names[link.source]} {arrow}{label} {names[link.target]}")
        colour, width = (shades[link.tokens[0]], 4) if link.tokens else (link.colour, 2)
        styles.append(f"  linkStyle {index} stroke:{colour},stroke-width:{width}px")
    lines += styles
    lines += [
        f"  classDef {number[name]} fill:{colours[name]},stroke:{BOX},color:{INK}" for name in diagram.shown_classes
    ]
    lines += [f"  style b{index} fill:{BOX},stroke:{BOX},color:{TITLE}" for index, _ in enumerate(boxes)]
    lines += [f"  style legend fill:{PAGE},stroke:{BOX},color:{INK}"]
    return "\n".join(lines) + "\n"


def _quoted(text: str) -> str:
    # Mermaid has no escape characters. It writes a character as #number;.
    escaped = "".join(each if each.isalnum() or each in " _-,.:" else f"#{ord(each)};" for each in text)
    return f'"{escaped}"'

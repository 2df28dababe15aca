"""Generate the reference page of task files in Markdown, from the same declarations as the checks and JSON Schema."""

from collections.abc import Iterable, Sequence

from pydantic import BaseModel

from hybrid_tamp.geometry.shapes import Box, Compound, Cylinder, MeshFile, Placement, Sphere
from hybrid_tamp.model.affordance import AffordanceClass, CapabilityClass, ObjectClass, is_place
from hybrid_tamp.model.block import FLOOR, Block
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.predicate import Literal, Predicate
from hybrid_tamp.taskfile.entries import LimitsEntry, MidLevelEntry, Pose, RangeEntry, TaskFile, TokenEntry
from hybrid_tamp.taskfile.forms import JsonObject, bounds_in_words, form_of, number_in_words, type_in_words
from hybrid_tamp.taskfile.roles import can_start
from hybrid_tamp.taskfile.tokens import declared_properties, known_classes

_INTRODUCTION = """# Task files

A task file is one YAML 1.2 document in UTF-8. In YAML 1.2, `no` is text and `010` is ten. Aliases and tags are not
allowed. All numbers are in SI units. All vectors are in the world frame unless stated otherwise. This page is generated
from the declarations that also check task files.
"""
_BLOCKS = """The name of a block is `ACTION` or, if the action has several modes, `ACTION:mode`. If a block has several
slots, one slot is marked as anchor. The token in this slot identifies the running block.
"""
_COLUMNS = ("key", "type", "unit", "bounds", "default", "meaning")


def reference_page(domains: Sequence[Domain]) -> str:
    """Return the reference page with all keys of a task file and the classes, predicates and blocks of the domains."""
    sections = [_INTRODUCTION]
    sections += [_model("The file", TaskFile), _model("`TokenEntry`: a token", TokenEntry), _model("`Pose`", Pose)]
    sections += [_model(f"`{shape.__name__}`: a shape", shape) for shape in (Cylinder, Box, Sphere, Compound, MeshFile)]
    sections += [_model("`CylinderPart`, `BoxPart`, `SpherePart`: a part", Placement)]
    sections += [_model("`LimitsEntry`: limits", LimitsEntry)]
    sections += [_model("`MidLevelEntry`: the mid-level planner", MidLevelEntry), _model("`RangeEntry`", RangeEntry)]
    sections += [section for domain in domains for section in _domain(domain)]
    return "\n".join(sections)


def _model(title: str, model: type[BaseModel]) -> str:
    return f"## {title}\n\n{(model.__doc__ or '').strip().splitlines()[0]}\n\n{_keys(model)}"


def _keys(model: type[BaseModel]) -> str:
    form = form_of(model)
    return _table(_COLUMNS, (_row(key, schema, key in form.required) for key, schema in form.keys.items()))


def _row(key: str, schema: JsonObject, required: bool) -> tuple[str, ...]:
    unit = str(schema.get("unit", "1"))
    meaning = str(schema.get("description", "")).removesuffix(f" [{unit}]")
    default = "required" if required else _default(schema.get("default"))
    return (f"`{key}`", type_in_words(schema), "" if unit == "1" else unit, bounds_in_words(schema), default, meaning)


def _default(value: object) -> str:
    if value is None or isinstance(value, dict):
        return ""
    return f"`{number_in_words(value) if isinstance(value, float) else value}`"


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "".join("| " + " | ".join(cell.replace("|", "\\|") for cell in line) + " |\n" for line in lines)


def _domain(domain: Domain) -> list[str]:
    sections = [f"## Domain `{domain.name}`\n\n{domain.description}\n"]
    sections += [f"### Classes of `{domain.name}`\n"]
    sections += [_class(object_class) for object_class in known_classes(domain).values()]
    sections += [f"### Predicates of `{domain.name}`\n", _predicates(domain.predicates)]
    sections += [f"### Blocks of `{domain.name}`\n\n{_BLOCKS}"]
    sections += [_block(block) for block in domain.blocks]
    return sections


def _class(object_class: type[ObjectClass]) -> str:
    kind = "affordance class" if issubclass(object_class, AffordanceClass) else "root class"
    if is_place(object_class):
        kind = "place"
    elif issubclass(object_class, CapabilityClass):
        kind = "capability class"
    text = f"#### `{object_class.name}` ({kind})\n\n{object_class.describe()}\n"
    properties = declared_properties(object_class)
    if properties is not object_class:
        text += f"\n{(properties.__doc__ or '').strip()}\n"
    if properties.model_fields:
        text += f"\n{_keys(properties)}"
    for action in object_class.basic_actions:
        limit = f"; its norm must not exceed `{action.limit}`" if action.limit else ""
        vector = f"vector of size {action.size} [{action.unit}]{limit}"
        text += f"\nBasic action `{action.name}`: {action.description} ({vector})\n"
    return text


def _predicates(predicates: Iterable[Predicate]) -> str:
    rows = []
    for predicate in predicates:
        names = tuple(f"`{parameter.name}`" for parameter in predicate.parameters)
        signature = ", ".join(f"{parameter.name}: {parameter.sort.name}" for parameter in predicate.parameters)
        rows.append((f"`{predicate.name}({signature})`", predicate.sentence(names), predicate.unit, _notes(predicate)))
    return _table(("predicate", "meaning", "unit of the margin", "notes"), rows)


def _notes(predicate: Predicate) -> str:
    notes = []
    if predicate.static:
        notes.append(_static_note(predicate))
    if predicate.safety is not None:
        notes.append(f"safety factor {predicate.safety.factor:g} (key `safety`): {predicate.safety.description}")
    if predicate.value_of is not None:
        notes.append(f"at most one {predicate.value_of} at a time")
    if predicate.maintained:
        notes.append("holds until the block that made it true ends")
    return "; ".join(notes)


def _static_note(predicate: Predicate) -> str:
    if predicate.at_start:
        return "static: describes the initial state of a task"
    if any(predicate.reads.values()):
        return "static: evaluated in the initial state, and again after blocks have moved the tokens"
    return "static: never changes during a task"


def _block(block: Block) -> str:
    after = "; then the block maintains its exit conditions until its tokens leave the block" if block.hold else ""
    lines = [
        f"#### `{block.name}`\n",
        f"{block.description}\n" if block.description else "",
        *(f"- slot `{slot.name}`: {slot.object_class.name}{_anchor(block, slot.name)}" for slot in block.slots),
        *(f"- target `{target.name}`: {target.sort.name}" for target in block.targets),
        f"- entry: {_conditions(block.entry)}",
        f"- preferred: {_conditions(block.preferences)}" if block.preferences else "",
        f"- exit: {_conditions(block.exit)}",
        f"- invariants: {_conditions(block.invariants)}" if block.invariants else "",
        f"- may touch: {_contacts(block)}" if block.allowed_contacts else "",
        f"- duration: {block.duration.minimum:g} s to {block.duration.maximum:g} s{after}",
        *(
            f"- hyperparameter `{h.name}`: {h.lower:g} to {h.upper:g} [{h.unit}]. {h.description}".rstrip()
            for h in block.hyperparameters
        ),
        *(f"- measure `{m.name}` [{m.unit}]: weight {m.weight:g}. {m.description}".rstrip() for m in block.performance),
        "- tokens may start in this block (key `assignment`)" if can_start(block) else "",
    ]
    return "\n".join(line for line in lines if line) + "\n"


def _anchor(block: Block, slot: str) -> str:
    return " (anchor)" if slot == block.anchor and len(block.slots) > 1 else ""


def _contacts(block: Block) -> str:
    names = {FLOOR: "the floor"} | {role: f"`{role}`" for role in block.roles}

    def second(one: str, other: str | Literal) -> str:
        if isinstance(other, Literal):
            return f"every token `*` with `{other.text}`"
        return f"{names[one]} of another instance" if one == other else names[other]

    return ", ".join(f"{names[one]} and {second(one, other)}" for one, other in block.allowed_contacts)


def _conditions(literals: Iterable[Literal]) -> str:
    return ", ".join(f"`{literal.text}`" for literal in literals) or "none"

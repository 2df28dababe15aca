"""Checks of the declarations of a domain."""

from collections.abc import Iterator

from hybrid_tamp.errors import Issue
from hybrid_tamp.model.affordance import TOKEN, ObjectClass, is_place
from hybrid_tamp.model.block import FLOOR, Block
from hybrid_tamp.model.declarations import Declarations
from hybrid_tamp.model.frame import find_frame_faults
from hybrid_tamp.model.predicate import ANY, Literal, Parameter, SymbolSort
from hybrid_tamp.model.union import conflicts


def faults_of(domain: Declarations) -> list[Issue]:
    """Return every fault of the domain. Missing effects are reported only if there are no other faults."""
    faults = [
        *_twice(domain),
        *_one_namespace(domain),
        *_classes(domain),
        *_blocks(domain),
        *_edges(domain),
        *_conditions(domain),
    ]
    return faults or list(find_frame_faults(domain))


def _twice(domain: Declarations) -> Iterator[Issue]:
    kinds: dict[str, list[str]] = {
        "block": [block.name for block in domain.blocks],
        "predicate": [predicate.name for predicate in domain.predicates],
        "class": [object_class.name for object_class in domain.classes],
    }
    for kind, names in kinds.items():
        for name in sorted({name for name in names if names.count(name) > 1}):
            wanted = f"every {kind} must have a unique name"
            yield Issue(domain.name, wanted, f"the name {name!r} more than once", remedy=f"rename one {kind}")


def _one_namespace(domain: Declarations) -> Iterator[Issue]:
    """Yield a fault for each predicate with the name of a class or sort, because PDDL has one namespace for names."""
    mentioned = [*domain.sorts, *(p.sort for q in domain.predicates for p in q.parameters)]
    sorts = {sort.name for sort in mentioned if isinstance(sort, SymbolSort)}
    types = sorts | {object_class.name for object_class in domain.classes}
    for name in sorted(types & {predicate.name for predicate in domain.predicates}):
        wanted = f"a predicate must not have the name of a class or sort ({name!r})"
        yield Issue(domain.name, wanted, remedy="rename the predicate")


def _classes(domain: Declarations) -> Iterator[Issue]:
    for object_class in domain.classes:
        actions = object_class.basic_actions
        for action in actions:
            if action.limit is not None and action.limit not in object_class.model_fields:
                yield Issue(
                    f"{object_class.name}.{action.name}",
                    "the limit of a basic action must be a property of its class",
                    repr(action.limit),
                    tuple(sorted(object_class.model_fields)),
                )
        for name in sorted(set(object_class.of_shape) - set(object_class.model_fields)):
            wanted = "of_shape must map properties of its class"
            yield Issue(f"{object_class.name}.of_shape", wanted, repr(name), tuple(sorted(object_class.model_fields)))
    things = [object_class for object_class in domain.classes if not is_place(object_class)]
    for index, one in enumerate(things):
        for other in things[index + 1 :]:
            if domain.relations.can_share_token(one, other):
                yield from conflicts((one, other))


def _blocks(domain: Declarations) -> Iterator[Issue]:
    if domain.resting not in {block.name for block in domain.blocks}:
        wanted = f"a domain must have the block {domain.resting} for tokens that no other block uses"
        yield Issue(domain.name, wanted, remedy="add this block, or name another block with 'resting'")
    for block in domain.blocks:
        names = [slot.name for slot in block.slots] + [target.name for target in block.targets]
        for name in sorted({name for name in names if names.count(name) > 1}):
            yield Issue(f"{block.name}.{name}", "slots and targets of a block must have different names")
        if block.anchor not in {slot.name for slot in block.slots}:
            yield Issue(block.name, "the anchor must be a slot of the block", repr(block.anchor), tuple(names))
        for slot in block.slots:
            if is_place(slot.object_class):
                wanted = f"a slot must not have a class of places, got {slot.object_class.name}"
                yield Issue(f"{block.name}.{slot.name}", wanted, remedy="declare a target instead of the slot")
            yield from _ways(domain, block, slot.name)
        if not 0 < block.duration.minimum <= block.duration.maximum:
            came = f"the minimum {block.duration.minimum:g} s and the maximum {block.duration.maximum:g} s"
            wanted, remedy = "a duration must satisfy 0 < minimum <= maximum", "exchange or correct the bounds"
            yield Issue(f"{block.name}.duration", wanted, came, remedy=remedy)
        for h in block.hyperparameters:
            if not h.lower <= h.upper:
                wanted = "the lower bound must not exceed the upper bound"
                came, remedy = f"[{h.lower}, {h.upper}] {h.unit}", "exchange the bounds"
                yield Issue(f"{block.name}.{h.name}", wanted, came, remedy=remedy)
        roles = {role for pair in block.allowed_contacts for role in pair if not isinstance(role, Literal)}
        for role in sorted(roles - {*names, FLOOR}):
            wanted = "allowed_contacts must name slots, targets or FLOOR"
            yield Issue(f"{block.name}.allowed_contacts", wanted, repr(role), (*names, FLOOR))
        slots = {slot.name for slot in block.slots}
        for role in sorted({*block.attached, *block.attached.values()} - slots):
            yield Issue(f"{block.name}.attached", "attached must map slots to slots", repr(role), tuple(sorted(slots)))
        if block.attached and block.system is not None:
            wanted = "attached has an effect only in the default system"
            yield Issue(f"{block.name}.attached", wanted, remedy="leave out 'system' or 'attached'")
        yield from _measures(block)


def _measures(block: Block) -> Iterator[Issue]:
    names = [measure.name for measure in block.performance]
    for name in sorted({name for name in names if names.count(name) > 1}):
        yield Issue(f"{block.name}.{name}", "the measures of a block must have different names")
    for measure in block.performance:
        if sum(how is not None for how in (measure.end, measure.peak, measure.rate)) != 1:
            yield Issue(f"{block.name}.{measure.name}", "a measure must have exactly one of 'end', 'peak' and 'rate'")
        if not measure.scale > 0:
            yield Issue(f"{block.name}.{measure.name}", "the scale of a measure must be positive", str(measure.scale))


def _ways(domain: Declarations, block: Block, slot: str) -> Iterator[Issue]:
    where = f"{block.name}.{slot}"
    if not domain.network.sources((block.name, slot)):
        yield Issue(where, "an edge must lead into this slot", remedy=f"add an edge, e.g. from {domain.resting}")
    if not domain.network.destinations((block.name, slot)):
        yield Issue(where, "an edge must lead out of this slot", remedy=f"add an edge, e.g. to {domain.resting}")


def _edges(domain: Declarations) -> Iterator[Issue]:
    slots = {(block.name, slot.name): slot.object_class for block in domain.blocks for slot in block.slots}
    available = tuple(f"{block}.{slot}" for block, slot in sorted(slots))
    for source, target in domain.network.edges:
        where = f"edge {'.'.join(source)} -> {'.'.join(target)}"
        unknown = [end for end in (source, target) if end not in slots]
        for end in unknown:
            yield Issue(where, "an edge must connect slots of the domain's blocks", repr(".".join(end)), available)
        if not unknown and not domain.relations.can_share_token(slots[source], slots[target]):
            wanted = f"no token can be a member of both {slots[source].name} and {slots[target].name}"
            yield Issue(where, wanted, remedy="remove the edge or change the class of a slot")


def _conditions(domain: Declarations) -> Iterator[Issue]:
    known = set(map(id, domain.predicates))
    for block in domain.blocks:
        for literal in block.conditions:
            where = f"{block.name}: {literal.text}"
            if id(literal.predicate) not in known:
                names = tuple(sorted(predicate.name for predicate in domain.predicates))
                yield Issue(where, "a condition must use a predicate of the domain", literal.predicate.name, names)
            yield from _arguments(block, literal, where)
        for literal in block.entry:
            if not literal.positive and not literal.predicate.static:
                wanted = "a negative entry condition must use a static predicate"
                remedy = "declare a predicate with the opposite meaning and use that predicate instead"
                yield Issue(f"{block.name}: {literal.text}", wanted, remedy=remedy)
        for literal in block.preferences:
            if not literal.predicate.static or ANY in literal.arguments:
                wanted = "a preference must use a static predicate and must not have wildcards"
                yield Issue(f"{block.name}: {literal.text}", wanted, remedy="declare an entry condition instead")
        for literal in block.invariants:
            if literal.predicate.static or ANY in literal.arguments:
                wanted = "an invariant must not have wildcards and must not use a static predicate"
                yield Issue(f"{block.name}: {literal.text}", wanted, remedy="declare an entry condition instead")
        for literal, reason in block.waived.items():
            if literal not in block.entry or literal in block.invariants or not reason:
                wanted = "'waived' must map entry conditions to reasons, and must not contain invariants"
                yield Issue(f"{block.name}: {literal.text}", wanted, remedy="remove the condition from 'waived'")
        for literal in block.exit:
            yield from _exit(block, literal)
        for literal in block.contact_conditions:
            yield from _contact_condition(block, literal)


def _contact_condition(block: Block, literal: Literal) -> Iterator[Issue]:
    wild = [p for p, a in zip(literal.predicate.parameters, literal.arguments, strict=False) if a == ANY]
    if not literal.positive or len(wild) != 1 or isinstance(wild[0].sort, SymbolSort) or literal.predicate.static:
        wanted = "a condition in allowed_contacts must be positive, not static, and have one wildcard, for a token"
        remedy = 'write e.g. INSIDE(ANY, "tray") for everything inside the tray'
        yield Issue(f"{block.name}.allowed_contacts", wanted, literal.text, remedy=remedy)


def _arguments(block: Block, literal: Literal, where: str) -> Iterator[Issue]:
    parameters = literal.predicate.parameters
    if len(parameters) != len(literal.arguments):
        wanted = f"{literal.predicate.name} must have {len(parameters)} arguments"
        yield Issue(where, wanted, str(len(literal.arguments)))
        return
    for parameter, argument in zip(parameters, literal.arguments, strict=True):
        if argument == ANY:
            continue
        if argument in block.roles:
            if not fits(block.roles[argument], parameter):
                yield Issue(
                    where,
                    f"{parameter.name} of {literal.predicate.name} must have class or sort {sort_name(parameter.sort)}",
                    f"{argument} with class or sort {sort_name(block.roles[argument])}",
                    remedy=f"change the class or sort of {argument}, or change the condition",
                )
        elif not (isinstance(parameter.sort, SymbolSort) and argument in parameter.sort.symbols):
            yield Issue(where, "an argument must be a slot, a target or a symbol", repr(argument), tuple(block.roles))


def _exit(block: Block, literal: Literal) -> Iterator[Issue]:
    predicate = literal.predicate
    where = f"{block.name}: {literal.text}"
    if predicate.static:
        remedy = "change the kind of the predicate or remove the condition"
        yield Issue(where, "an exit condition must not use a static predicate", remedy=remedy)
    wild = [i for i, argument in enumerate(literal.arguments) if argument == ANY]
    if literal.positive and wild:
        yield Issue(where, "a positive exit condition must not have wildcards")
    if not literal.positive and wild and not predicate.maintained and wild != [predicate.functional_index]:
        remedy = "declare the predicate as functional in this parameter, or as maintained"
        yield Issue(where, "a wildcard must stand for the functional parameter of the predicate", remedy=remedy)


def fits(sort: type[ObjectClass] | SymbolSort, parameter: Parameter) -> bool:
    """Return whether every value of a role's class or sort is also a value of the parameter's class or sort."""
    wanted = parameter.sort
    if isinstance(sort, SymbolSort) or isinstance(wanted, SymbolSort):
        return sort is wanted
    return issubclass(sort, wanted) or (wanted is TOKEN and not is_place(sort))


def sort_name(sort: type[ObjectClass] | SymbolSort) -> str:
    """Return the name of a class or sort."""
    return sort.name

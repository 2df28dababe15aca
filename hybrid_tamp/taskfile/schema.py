"""The JSON Schema of task files (draft 2020-12). Editors use the schema to complete and check task files.

The generic schema is derived from `entries` and is part of the package. ``hybrid-tamp schema`` adds the classes,
properties, predicates and blocks of every installed domain. A condition on the key ``domain`` selects the domain.
"""

from collections.abc import Callable, Iterable, Sequence

from hybrid_tamp.model.affordance import ObjectClass
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.predicate import ANY, Parameter, Predicate, SymbolSort
from hybrid_tamp.taskfile.all_members import ALL
from hybrid_tamp.taskfile.entries import TaskFile
from hybrid_tamp.taskfile.forms import JsonObject, form_of
from hybrid_tamp.taskfile.midlevel import Declared, names_of
from hybrid_tamp.taskfile.roles import can_start
from hybrid_tamp.taskfile.tokens import declared_properties, known_classes

DIALECT = "https://json-schema.org/draft/2020-12/schema"


def json_schema(domains: Sequence[Domain] = ()) -> JsonObject:
    """Return the JSON Schema of task files.

    Args:
        domains: the domains that the schema describes. For files of other domains, only the generic schema applies.
    """
    form = form_of(TaskFile)
    keys, definitions = dict(form.keys), dict(form.definitions)
    keys["goal"] = {**keys["goal"], "items": {"type": "object", "minProperties": 1, "maxProperties": 1}}
    keys["tokens"] = {**keys["tokens"], "propertyNames": {"minLength": 1}}
    conditions = []
    for number, domain in enumerate(domains):
        then = _of_domain(domain, f"domain{number}.", definitions)
        conditions.append({"if": _equals("domain", domain.name), "then": then})
    schema = {
        "$schema": DIALECT,
        "title": "A task of hybrid_tamp",
        "description": "Tokens of a domain, their initial poses and the goal. All numbers are in SI units.",
        "type": "object",
        "properties": keys,
        "required": list(form.required),
        "additionalProperties": False,
        "$defs": dict(sorted(definitions.items())),
    }
    if domains:
        keys["domain"] = {**keys["domain"], "examples": [domain.name for domain in domains]}
        schema["allOf"] = conditions
    return schema


def _equals(key: str, value: str) -> JsonObject:
    return {"properties": {key: {"const": value}}, "required": [key]}


def _of_domain(domain: Domain, prefix: str, definitions: dict[str, JsonObject]) -> JsonObject:
    """Return the part of a task file's schema that depends on the domain."""
    weights = _section(domain, "weights", "default: ", _weight)
    ranges = _section(domain, "hyperparameters", "", _range)
    starts = [_choice(block.name, block.description) for block in domain.blocks if can_start(block)]
    return {
        "properties": {
            "tokens": {"additionalProperties": _token(domain, prefix, definitions)},
            "goal": {"items": _atom(domain, negatable=True)},
            "assignment": {"additionalProperties": {"anyOf": starts}},
            "safety": _safety(domain),
            "midlevel": {"properties": {"weights": weights, "hyperparameters": ranges}},
        }
    }


def _section(domain: Domain, kind: Declared, prefix: str, words: Callable[[Block, str], str]) -> JsonObject:
    keys = {
        key: {"description": prefix + "; ".join(dict.fromkeys(words(block, name) for block, name in meant))}
        for key, meant in names_of(domain, kind).items()
    }
    return {"properties": keys, "additionalProperties": False}


def _safety(domain: Domain) -> JsonObject:
    keys = {
        each.name: {"description": f"default: {each.safety.factor:g}. {each.safety.description}"}
        for each in domain.predicates
        if each.safety is not None
    }
    return {"properties": keys, "additionalProperties": False}


def _weight(block: Block, name: str) -> str:
    return next(f"{m.weight:g}. {m.description}" for m in block.performance if m.name == name)


def _range(block: Block, name: str) -> str:
    h = next(h for h in block.hyperparameters if h.name == name)
    return f"{h.lower:g} to {h.upper:g} [{h.unit}]. {h.description}".rstrip()


def _choice(value: str, description: str) -> JsonObject:
    return {"const": value, "description": description} if description else {"const": value}


def _token(domain: Domain, prefix: str, definitions: dict[str, JsonObject]) -> JsonObject:
    """Return the schema of a token, which requires the properties that the token's classes require."""
    known: dict[str, list[JsonObject]] = {}
    needs = []
    for number, object_class in enumerate(known_classes(domain).values()):
        form = form_of(declared_properties(object_class), f"{prefix}class{number}.")
        definitions.update(form.definitions)
        for key, schema in form.keys.items():
            if schema not in known.setdefault(key, []):
                known[key].append(schema)
        if form.keys:
            needs.append(_need(object_class, form.keys, form.required))
    properties = {key: ones[0] if len(ones) == 1 else {"anyOf": ones} for key, ones in sorted(known.items())}
    names = [_choice(name, one.describe()) for name, one in known_classes(domain).items()]
    return {
        "properties": {
            "classes": {"items": {"anyOf": names}, "uniqueItems": True},
            "unknown": {"items": {"anyOf": names}, "uniqueItems": True},
            "properties": {"properties": properties, "additionalProperties": False},
        },
        "allOf": needs,
    }


def _need(object_class: type[ObjectClass], keys: dict[str, JsonObject], required: Iterable[str]) -> JsonObject:
    contains = {"properties": {"classes": {"contains": {"const": object_class.name}}}, "required": ["classes"]}
    needed = list(required)
    then: JsonObject = {"properties": {"properties": {"properties": keys, "required": needed}}}
    return {"if": contains, "then": then | ({"required": ["properties"]} if needed else {})}


def _atom(domain: Domain, *, negatable: bool) -> JsonObject:
    classes = tuple(known_classes(domain))
    keys: dict[str, JsonObject] = {each.name: _arguments(each, classes) for each in domain.predicates}
    if negatable:
        keys["not"] = {"description": "an atom that must not hold", **_atom(domain, negatable=False)}
    return {"type": "object", "minProperties": 1, "maxProperties": 1, "properties": keys, "additionalProperties": False}


def _arguments(predicate: Predicate, classes: Sequence[str]) -> JsonObject:
    count = len(predicate.parameters)
    return {
        "description": predicate.sentence(tuple(parameter.name for parameter in predicate.parameters)),
        "type": "array",
        "prefixItems": [_argument(parameter, classes) for parameter in predicate.parameters],
        "minItems": count,
        "maxItems": count,
    }


def _argument(parameter: Parameter, classes: Sequence[str]) -> JsonObject:
    if isinstance(parameter.sort, SymbolSort):
        symbols = [*parameter.sort.symbols, ANY]
        return {"enum": symbols, "description": f"{parameter.name}: a {parameter.sort.name}, or {ANY} for any"}
    description = f"{parameter.name}: a token of the class {parameter.sort.name}, or {ANY} for any"
    members = {
        "type": "object",
        "description": "one atom for each token of a class",
        "properties": {ALL: {"enum": list(classes)}},
        "required": [ALL],
        "additionalProperties": False,
    }
    return {"anyOf": [{"type": "string"}, members], "description": description}

"""The JSON Schema and the reference page agree with the checks."""

import copy
import json
from collections.abc import Callable
from importlib.resources import files
from typing import Any

import jsonschema
import pytest

from hybrid_tamp.model.domain import Domain
from hybrid_tamp.taskfile.domains import available_domains, bundled_tasks, find_domain, find_task_file
from hybrid_tamp.taskfile.reference import reference_page
from hybrid_tamp.taskfile.schema import json_schema
from hybrid_tamp.taskfile.yaml.nodes import parse, read_text


@pytest.fixture(scope="module")
def validator(toy: Domain) -> jsonschema.Draft202012Validator:
    schema = json_schema([toy])
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)


@pytest.fixture
def data(text: str) -> dict[str, Any]:
    return parse(text, "f").data


def test_it_takes_the_file_that_is_right(validator: jsonschema.Draft202012Validator, data: dict[str, Any]) -> None:
    validator.validate(data)
    data["goal"] += [{"not": {"shows": ["drum", "front"]}}]
    data["tokens"]["drum"]["classes"] += ["HEAVY", "TOKEN"]
    data["tokens"]["drum"]["properties"]["center"] = [0, 0, 0.1]
    validator.validate(data)


EDITS: dict[str, tuple[Callable[[Any], Any], str]] = {
    "missing key": (lambda d: d.pop("domain"), "'domain' is a required property"),
    "unknown key": (lambda d: d.update(sede=1), "'sede' was unexpected"),
    "unknown class": (lambda d: d["tokens"]["drum"]["classes"].append("ROLABLE"), "'ROLABLE' is not valid"),
    "missing property": (lambda d: d["tokens"]["drum"]["properties"].pop("mass"), "'mass' is a required property"),
    "no properties": (lambda d: d["tokens"]["goal"].pop("properties"), "'properties' is a required property"),
    "unknown property": (lambda d: d["tokens"]["drum"]["properties"].update(masss=1), "'masss' was unexpected"),
    "negative mass": (lambda d: d["tokens"]["drum"]["properties"].update(mass=-1), "-1 is less than or equal"),
    "text for a number": (lambda d: d["tokens"]["drum"]["properties"].update(mass="5"), "'5' is not of type 'number'"),
    "short axis": (lambda d: d["tokens"]["drum"]["properties"]["axis"].pop(), "[0, 0] is too short"),
    "unknown shape": (lambda d: d["tokens"]["drum"]["shape"].update(kind="disc"), "is not valid under any"),
    "pose far away": (lambda d: d["tokens"]["drum"]["pose"].update(position=[0, 0, 1e9]), "is not valid under any"),
    "unknown predicate": (lambda d: d["goal"].append({"witin": ["drum", "goal"]}), "'witin' was unexpected"),
    "arity": (lambda d: d["goal"][0]["within"].pop(), "['drum'] is too short"),
    "unknown symbol": (lambda d: d["goal"].append({"shows": ["drum", "top"]}), "'top' is not one of"),
    "two atoms": (lambda d: d["goal"][0].update(beside=["drum", "hand"]), "has too many properties"),
    "start in a block of two": (lambda d: d["assignment"].update(drum="ROLLING"), "'ROLLING' is not valid"),
    "no goal": (lambda d: d.update(goal=[]), "[] should be non-empty"),
    "no time": (lambda d: d["limits"].update(time=0), "0 is less than or equal"),
}


@pytest.mark.parametrize("name", EDITS)
def test_it_refuses_a_broken_file(validator: jsonschema.Draft202012Validator, data: dict[str, Any], name: str) -> None:
    edit, words = EDITS[name]
    broken = copy.deepcopy(data)
    edit(broken)
    assert any(words in error.message for error in validator.iter_errors(broken)), list(validator.iter_errors(broken))


def test_a_file_of_another_domain_is_checked_in_its_form_only(
    validator: jsonschema.Draft202012Validator, data: dict[str, Any]
) -> None:
    data["domain"] = "other"
    data["goal"] = [{"anything": ["x"]}]
    validator.validate(data)
    data["goal"] = [[]]
    assert not validator.is_valid(data)


def test_editors_are_shown_units_and_bounds(toy: Domain) -> None:
    schema = json_schema([toy])
    then = schema["allOf"][0]["then"]["properties"]
    properties = then["tokens"]["additionalProperties"]["properties"]["properties"]["properties"]
    # The mass of a token without affordances has another description.
    assert properties["mass"]["anyOf"][1] == {
        "title": "Mass",
        "description": "mass of the body [kg]",
        "type": "number",
        "exclusiveMinimum": 0,
        "unit": "kg",
    }
    assert [one["unit"] for one in properties["radius"]["anyOf"]] == ["m", "mm"]
    assert schema["$defs"]["LimitsEntry"]["properties"]["time"]["description"].endswith("[s]")
    json.dumps(schema, allow_nan=False)


def test_all_that_is_installed_fits_together() -> None:
    schema = json_schema([find_domain(name) for name in available_domains()])
    jsonschema.Draft202012Validator.check_schema(schema)
    for name in bundled_tasks():
        data = parse(read_text(find_task_file(name)), name).data
        jsonschema.validate(data, schema, cls=jsonschema.Draft202012Validator)


def test_the_packaged_schema_is_that_of_any_domain(text: str) -> None:
    packaged = json.loads(files("hybrid_tamp.report.schemas").joinpath("task-1.json").read_text(encoding="utf-8"))
    assert packaged == json_schema()
    jsonschema.Draft202012Validator.check_schema(packaged)
    for domain in map(find_domain, available_domains()):
        assert domain.name not in json.dumps(packaged)
    for name in bundled_tasks():
        data = parse(read_text(find_task_file(name)), name).data
        jsonschema.validate(data, packaged, cls=jsonschema.Draft202012Validator)


def test_the_reference_page_names_everything(toy: Domain) -> None:
    page = reference_page([toy])
    for words in (
        "| `time` | number | s | > 0, ≤ 1000000 | `600` | wall-clock time of the whole command |",
        "| `seed` | whole number |  | ≥ 0, ≤ 4294967295 | `0` | seed of all random numbers |",
        "| `axis` | list of 3 numbers |  |  | required | axis of rotation |",
        "| `friction` | number |  | ≥ 0, ≤ 5 | `0.5` | friction coefficient |",
        "#### `HAND` (capability class)",
        "#### `REGION` (place)",
        "(vector of size 3 [N]; its norm must not exceed `force`)",
        "| `within(object: ROLLABLE, region: REGION)` | `object` is within `region` | m | at most one region at a time",
        "- slot `object`: ROLLABLE (anchor)",
        "- target `region`: REGION",
        "- exit: `not within(object, *)`, `within(object, region)`",
        "tokens may start in this block",
    ):
        assert words in page
    assert page == reference_page([toy])

"""Messages about faults of a task file: the place, the expected value, the given value and the available values.

In the edits below, ``«`` marks the place that the message must name. The mark is removed before loading.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import pytest
from texts import load_task_text

from hybrid_tamp.errors import DomainError, InputError, Issue
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.task import Task

Issues = Callable[[str], tuple[Issue, ...]]


@dataclass
class Fault:
    """An edit of the faultless file, and words that one message must contain."""

    name: str
    old: str
    new: str
    words: tuple[str, ...]


def fault(name: str, old: str, new: str, *words: str) -> Any:
    return pytest.param(Fault(name, old, new, words), id=name)


CYLINDER = "{kind: cylinder, radius: 0.1, length: 0.3}"
FAULTS = [
    # The form of the file.
    fault("unknown key", "seed: 7", "«sede: 7", "unknown key", "'sede'", "did you mean 'seed'"),
    fault("unknown key of a token", "    shape:", "    «shap:", "token 'drum'", "did you mean 'shape'"),
    fault("unknown key of a pose", "rpy: [1.57", "«rpi: [1.57", "pose of token 'drum'", "available: position, rpy"),
    fault("missing key", "domain: toy\n", "", "missing key 'domain'", "installed domain"),
    fault("key that is no text", "seed: 7", "seed: 7\n«12: 3", "a key must be text", "got 12", "in quotes"),
    fault("duplicate key", "seed: 7", "seed: 7\n«seed: 8", "only once", "'seed'", "first on line 24"),
    fault("two tokens of one name", "  drum:", "  «hand:", "second token named 'hand'", "first on line 6"),
    fault("no tokens", "", "", "tokens must have at least 1 entry"),
    fault("no goal", "\n  - within: [drum, goal]", " «[]", "goal must have at least 1 entry"),
    fault("text for a number", "mass: 5", "mass: «'5'", "mass of token 'drum' must be a number [kg]", "got '5'"),
    fault("number with a unit", "mass: 5", "mass: «5 kg", "must be a number [kg]", "got '5 kg'"),
    fault("truth value for a number", "mass: 5", "mass: «true", "must be a number", "got true"),
    fault("nothing for a number", "mass: 5", "«mass: ", "must be a number", "got nothing"),
    fault("negative mass", "mass: 5", "mass: «-5", "mass of token 'drum' must be more than 0 [kg]", "got -5"),
    fault("not a number", "mass: 5", "mass: «.nan", "must be a finite number", "got .nan"),
    fault("infinity", "mass: 5", "mass: «-.inf", "must be a finite number", "got -.inf"),
    fault("beyond all numbers", "mass: 5", "mass: «1e999", "must be a finite number", "got 1e999"),
    fault("very long integer", "mass: 5", "mass: «" + "9" * 6000, "must be a finite number", "got 9999"),
    fault("very long limit", "seed: 7", "seed: «" + "9" * 200, "seed must be at most 4294967295", "got 9999"),
    fault("axis of length zero", "[0, 0, 2]", "«[0, 0, 0]", "axis of token 'drum'", "length zero", "got [0, 0, 0]"),
    fault("axis of two", "[0, 0, 2]", "«[0, 2]", "axis of token 'drum' must be a list of 3", "got [0, 2]"),
    fault("axis of four", "[0, 0, 2]", "«[0, 0, 0, 2]", "axis of token 'drum' must be a list of 3"),
    fault("zero radius of a shape", "radius: 0.1", "radius: «0", "shape.radius of token 'drum'", "more than 0 [m]"),
    fault("unknown shape", "kind: cylinder", "kind: «cilinder", "shape.kind of token", "did you mean 'cylinder'"),
    fault("shape without a kind", "{kind: cylinder, ", "«{", "shape of token 'drum' must have the key 'kind'"),
    fault("shape without a length", "    shape: {kind: cylinder, radius: 0.1, length: 0.3}",
          "    «shape: {kind: cylinder, radius: 0.1}", "missing key 'length' [m] in shape of token 'drum'"),
    fault("compound without parts", CYLINDER, "{kind: compound, parts: «[]}", "a compound must have at least one part"),
    fault("part without a place", CYLINDER, "{kind: compound, parts: [«{kind: sphere, radius: 1}]}",
          "missing key 'position' [m] in shape.parts[0] of token 'drum'"),
    fault("part of a flat box", CYLINDER,
          "{kind: compound, parts: [{kind: box, half_extents: [1, 1, «0], position: [0, 0, 0]}]}",
          "shape.parts[0].half_extents[2] of token 'drum' must be more than 0 [m]"),
    fault("part of no kind", CYLINDER, "{kind: compound, parts: [{kind: «bx, position: [0, 0, 0]}]}",
          "shape.parts[0].kind of token 'drum'", "did you mean 'box'"),
    fault("compound in a compound", CYLINDER, "{kind: compound, parts: [{kind: «compound, position: [0, 0, 0]}]}",
          "available: cylinder, box, sphere"),
    fault("pose with NaN", "[0, 0, 0.1]", "[0, 0, «.nan]", "pose.position[2] of token 'drum'", "finite number [m]"),
    fault("pose far away", "[0, 0, 0.1]", "[0, 0, «1e30]", "pose.position[2] of token 'drum' must be at most 1000"),
    fault("pose of two", "[0, 0, 0.1]", "«[0, 0]", "pose.position of token 'drum' must be a list of 3"),
    fault("two rotations", "{position: [0, 0, 0.1]", "«{quaternion: [0, 0, 0, 1], position: [0, 0, 0.1]",
          "must not have both rpy and quaternion"),
    fault("quaternion of length zero", "rpy: [1.5707963267948966, 0, 0]", "quaternion: «[0, 0, 0, 0]", "length zero"),
    fault("degrees in a pose", "[1.5707963267948966, 0, 0]", "[«90, 0, 0]", "pose.rpy[0] of token 'drum'",
          "[rad]", "got 90", "angles are in radians: 90 degrees are 1.5707963267948966 rad"),
    fault("negative degrees in a pose", "[1.5707963267948966, 0, 0]", "[0, 0, «-7.5]", "pose.rpy[2] of token 'drum'",
          "got -7.5", "-7.5 degrees are -0.1308996938995747 rad"),
    fault("degrees in a part", CYLINDER,
          "{kind: compound, parts: [{kind: sphere, radius: 1, position: [0, 0, 0], rpy: [0, «45, 0]}]}",
          "shape.parts[0].rpy[1] of token 'drum'", "45 degrees are 0.7853981633974483 rad"),
    fault("degrees in a property", "[ROLLABLE]\n    properties: {",
          "[ROLLABLE, HEAVY]\n    properties: {tilts: «[0, 180, 0], ",
          "tilts of token 'drum' must be between -6.3 and 6.3 [rad]", "got [0, 180, 0]", "180 degrees are 3.14"),
    fault("no pose", "  hand:\n    classes: [HAND]\n    properties: {force: 300}\n    pose: {position: [0, 0, 0.3]}",
          "  «hand:\n    classes: [HAND]\n    properties: {force: 300}", "missing key 'pose' in token 'hand'"),
    fault("time limit of zero", "time: 30", "time: «0", "limits.time must be more than 0 [s]", "got 0"),
    fault("negative memory", "memory: 1024", "memory: «-1", "limits.memory must be more than 0 [MiB]"),
    fault("half a refinement", "refinements: 2", "refinements: «2.5", "must be a whole number", "got 2.5"),
    fault("planner that is no name", "fast-downward", "«fast downward", "planner must consist of letters"),
    fault("classes that are no list", "classes: [HAND]", "classes: «HAND", "classes of token 'hand' must be a list"),
    # What the file names.
    fault("unknown domain", "domain: toy", "domain: «tyo", "unknown domain", "'tyo'", "available: toy"),
    fault("unknown planner", "fast-downward", "«fast-dawnward", "unknown planner", "did you mean 'fast-downward'"),
    fault("unknown class", "[ROLLABLE]", "[«ROLABLE]", "unknown class in the domain toy", "did you mean 'ROLLABLE'"),
    fault("class named twice", "[ROLLABLE]", "[ROLLABLE, «ROLLABLE]", "must not be listed twice"),
    fault("place and thing", "[ROLLABLE]", "[ROLLABLE, «REGION]", "both a place and a thing", "REGION", "ROLLABLE"),
    fault("disjoint classes", "[ROLLABLE]", "[ROLLABLE, «LIQUID]", "both ROLLABLE and LIQUID", "disjoint"),
    fault("classes in conflict", "[REGION]", "«[REGION, HOLE]", "HOLE and REGION", "unit for property 'radius'",
          "mm in HOLE and m in REGION"),
    fault("missing property", "    properties: {axis: [0, 0, 2], mass: 5}", "    «properties: {axis: [0, 0, 2]}",
          "missing key 'mass' [kg] in properties of token 'drum'", "mass of the body", "required by ROLLABLE"),
    fault("no properties at all", "  goal:\n    classes: [REGION]\n    properties: {radius: 0.02}",
          "  «goal:\n    classes: [REGION]", "missing key 'radius' [m]", "required by REGION"),
    fault("unknown property", "mass: 5", "mass: 5, «frition: 1", "unknown key in properties of token 'drum'",
          "did you mean 'friction'"),
    fault("zero radius of a place", "{radius: 0.02}", "{radius: «0}", "radius of token 'goal' must be more than 0 [m]"),
    fault("class that finds its token inconsistent", "  drum:", "  «drum:", "is inconsistent", "no shape"),
    fault("name that means everything", "  goal:", "  «'*':", "must not be '*'"),
    fault("name that is a symbol", "  goal:", "  «back:", "must not be the name of a face", "'back'"),
    fault("name that is empty", "  goal:", "  «'':", "must not be empty"),
    # The goal.
    fault("unknown predicate", "- within: [drum, goal]", "- «witin: [drum, goal]", "unknown predicate",
          "did you mean 'within'"),
    fault("goal about no token", "[drum, goal]", "[«durm, goal]", "unknown token in the goal", "did you mean 'drum'"),
    fault("goal about a wrong class", "[drum, goal]", "[«hand, goal]", "object of within must be a member of ROLLABLE",
          "token 'hand', a member of TOKEN, HAND", "available: drum"),
    fault("goal of one argument", "[drum, goal]", "«[drum]", "within must be object (ROLLABLE), region (REGION)",
          "1 argument"),
    fault("goal about no symbol", "within: [drum, goal]", "shows: [drum, «bakc]", "must be a face",
          "did you mean 'back'"),
    fault("goal that names a token twice", "within: [drum, goal]", "beside: [drum, «drum]", "different tokens"),
    fault("goal without brackets", "[drum, goal]", "«drum", "'predicate: [tokens]'", "'drum'", "in brackets"),
    fault("goal that is no mapping", "within: [drum, goal]", "«within", "'predicate: [tokens]'", "'within'"),
    fault("two atoms in one entry", "- within: [drum, goal]", "- «within: [drum, goal]\n    beside: [drum, hand]",
          "one atom per entry"),
    fault("goal with a number", "[drum, goal]", "[drum, «1]", "an argument must be a name", "got 1", "in quotes"),
    fault("goal over an unknown class", "[drum, goal]", "[{all: «ROLABLE}, goal]", "unknown class in the domain toy",
          "'ROLABLE'", "did you mean 'ROLLABLE'"),
    fault("goal over a class without members", "[drum, goal]", "[{all: «HEAVY}, goal]",
          "the class after 'all' must have members", "got HEAVY without members", "HAND, REGION, ROLLABLE, TOKEN",
          "add a token of class HEAVY"),
    fault("goal over a wrong class", "[drum, goal]", "[«{all: HAND}, goal]", "object of within must be a member of",
          "token 'hand', a member of TOKEN, HAND"),
    fault("goal over all tokens but themselves", "within: [drum, goal]", "beside: «[{all: ROLLABLE}, drum]",
          "'all' must leave at least one atom in which no token occurs twice", "another class or another token"),
    fault("goal over two classes at once", "[drum, goal]", "[{all: «[HAND, ROLLABLE]}, goal]",
          "'all' must name one class", "got ['HAND', 'ROLLABLE']"),
    fault("goal with an unknown mapping", "[drum, goal]", "[«{any: ROLLABLE}, goal]", "exactly the key 'all'",
          "got the keys 'any'"),
    fault("goal that something be not so", "- within: [drum, goal]", "- «not: {within: [drum, goal]}",
          "a goal atom must not be negated", "got 'not'"),
    fault("two values of a function", "- within: [drum, goal]",
          "- within: [drum, goal]\n  - within: «[drum, other]", "must have only one region for each object", "line 25"),
    # Agents and starts.
    fault("agent with no token", "[hand]", "[«hnad]", "agent 'robot'", "unknown token", "did you mean 'hand'"),
    fault("agent with a thing", "[hand]", "[hand, «drum]", "must be members of a capability class", "'drum'",
          "available: hand"),
    fault("agent with nothing", "[hand]", "«[]", "agents.robot must have at least 1 entry"),
    fault("hand of two agents", "robot: [hand]", "robot: [hand]\n  other: [«hand]", "belong to only one agent",
          "already belongs to agent 'robot'"),
    fault("hand that stands twice", "[hand]", "[hand, «hand]", "belong to only one agent"),
    fault("start of no token", "{hand: GUARDING}", "{«hadn: GUARDING}", "the assignment names an unknown token",
          "did you mean 'hand'"),
    fault("start of a place", "{hand: GUARDING}", "{«goal: RESTING}", "a place cannot be assigned"),
    fault("start in no block", "{hand: GUARDING}", "{hand: «GARDING}", "unknown block", "did you mean 'GUARDING'"),
    fault("start in a block of two", "{hand: GUARDING}", "{hand: «ROLLING}", "one slot and no targets",
          "hand, object, region", "available: RESTING, GUARDING"),
    fault("start in a block of another class", "{hand: GUARDING}", "{drum: «GUARDING}", "only a member of HAND",
          "token 'drum'", "available: RESTING"),
]  # fmt: skip

_EXTRA = {
    "two values of a function": (
        "assignment:",
        "  other:\n    classes: [REGION]\n    properties: {radius: 1}\n    pose: {position: [0, 0, 0]}\nassignment:",
    ),
    "class that finds its token inconsistent": ("    shape: {kind: cylinder, radius: 0.1, length: 0.3}\n", ""),
    "name that means everything": ("[drum, goal]", '[drum, "*"]'),
    "name that is a symbol": ("[drum, goal]", "[drum, back]"),
    "name that is empty": ("[drum, goal]", '[drum, ""]'),
}


def edited(text: str, fault: Fault) -> tuple[str, str | None]:
    """Return the text with the fault, and the place that it marks."""
    if fault.name == "no tokens":
        text = "domain: toy\ntokens: «{}\ngoal:\n  - within: []\n"
    if fault.name in _EXTRA:
        text = text.replace(*_EXTRA[fault.name])
    assert fault.old in text
    text = text.replace(fault.old, fault.new, 1) if fault.old else text
    if "«" not in text:
        return text, None
    before, _, _ = text.partition("«")
    line, column = before.count("\n") + 1, len(before) - before.rfind("\n")
    return text.replace("«", ""), f"t.yaml:{line}:{column}"


@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_is_named_with_its_place(issues: Issues, text: str, fault: Fault) -> None:
    wrong, place = edited(text, fault)
    found = {str(issue): issue.where for issue in issues(wrong)}
    message = next((message for message in found if all(word in message for word in fault.words)), None)
    assert message is not None, "\n".join(found)
    if place is not None:
        assert found[message] == place


def test_an_angle_may_be_a_whole_turn_or_what_its_class_allows(load: Callable[[str], Task], text: str) -> None:
    turned = text.replace("rpy: [1.5707963267948966, 0, 0]", "rpy: [1.5707963267948966, 6.2832, -6.2832]")
    assert load(turned).token_by_name["drum"]
    turning = text.replace(
        "[ROLLABLE]\n    properties: {", "[ROLLABLE, HEAVY]\n    properties: {turns: 900, tilts: [0, 6, 0], "
    )
    assert load(turning).token_by_name["drum"]["turns"] == 900.0


# Edits that cause more than one fault.
_SEVERAL = {"no tokens", "unknown key of a pose", "two tokens of one name", "unknown domain"}
_SEVERAL |= {"unknown key of a token", "key that is no text", "goal that names a token twice"}


@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_is_not_reported_again_by_what_depends_on_it(issues: Issues, text: str, fault: Fault) -> None:
    found = issues(edited(text, fault)[0])
    assert fault.name in _SEVERAL or len(found) == 1, "\n".join(map(str, found))


def test_all_faults_come_at_once_in_the_order_of_the_file(issues: Issues, text: str) -> None:
    edits = (
        ("robot: [hand]", "robot: [«drum]"),
        ("force: 300", "force: «-1"),
        ("position: [0, 0, 0.3]", "position: [0, 0, «.inf]"),
        ("{axis: [0, 0, 2], mass", "{axis: «[0, 0, 0], «mas"),
        ("classes: [REGION]", "classes: [«REGOIN]"),
        ("hand: GUARDING", "hand: «NOWHERE"),
        ("[drum, goal]", "[drum, «gaol]"),
        ("seed: 7", "seed: «x\n«seed: 1\n«colour: red"),
    )
    for old, new in edits:
        text = text.replace(old, new)
    text = text.replace("    properties: {axis", "    «properties: {axis")  # for the mass that is missing
    places = []
    while "«" in text:
        before, _, after = text.partition("«")
        places.append(f"t.yaml:{before.count(chr(10)) + 1}:{len(before) - before.rfind(chr(10))}")
        text = before + after
    assert [issue.where for issue in issues(text)] == places


def test_one_token_with_faults_in_every_part_has_them_all_told(issues: Issues, text: str) -> None:
    text = text.replace("[ROLLABLE]\n", "[ROLLABLE, ROLABLE]\n").replace("radius: 0.1", "radius: -1")
    text = text.replace("[0, 0, 0.1]", "[0, 0, x]")
    said = "\n".join(map(str, issues(text)))
    assert "ROLABLE" in said
    assert "shape.radius" in said
    assert "pose.position[2]" in said


def test_a_generator_that_is_broken_gets_the_first_faults_and_the_number(issues: Issues, text: str) -> None:
    wrong = text.replace("[drum, goal]", "[" + ", ".join(str(number) for number in range(1000)) + "]")
    found = issues(wrong)
    assert len(found) == 101
    assert "900 more faults" in str(found[-1])


def test_no_message_disturbs_a_terminal(issues: Issues, text: str) -> None:
    escape = r'"\e[31m"'
    for old in ("hand", "drum", "within", "robot", "toy", "ROLLABLE", "cylinder", "mass", "seed", "GUARDING"):
        for new in (text.replace(old, escape), text.replace(old, escape, 1)):
            assert all(str(issue).isprintable() for issue in issues(new))


def test_the_planner_is_left_to_others_where_none_are_named(text: str, toy: Domain) -> None:
    assert load_task_text(text.replace("fast-downward", "nobody"), "t", lambda name: toy).planner == "nobody"


def test_faults_of_a_domain_stand_at_its_name(text: str) -> None:
    def broken(name: str) -> Domain:
        raise DomainError([Issue("ROLLING.hand", "an edge must lead into this slot", remedy="add one")])

    with pytest.raises(InputError, match=r"t:2:9: ROLLING.hand: an edge must lead into this slot; add one"):
        load_task_text(text, "t", broken)

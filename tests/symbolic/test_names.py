"""Plans do not depend on the names of slots, targets, tokens and symbols."""

from collections.abc import Mapping
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest
from exhaustive import shortest_plan
from hypothesis import Phase, assume, example, given, settings
from hypothesis import strategies as st
from serial import Part, Station, Tool, block, changing, predicate
from serial import domain as made_of
from validation import val_accepts, val_accepts_temporal

from hybrid_tamp.model.kind import Kind
from hybrid_tamp.model.law import check_law
from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.model.predicate import Atom, SymbolSort
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.symbolic.decode import decode
from hybrid_tamp.symbolic.encoding.problem import compile_task
from hybrid_tamp.symbolic.engines.planner_process import PlannerProcess
from hybrid_tamp.symbolic.find_plan import find_plan
from hybrid_tamp.symbolic.reencode import NO_ACTION, reencode
from hybrid_tamp.symbolic.schedule import schedule
from hybrid_tamp.symbolic.temporal.compilation import compile_durative
from hybrid_tamp.symbolic.temporal.reencoding import reencode_durative

ROLES = ("thing", "left", "right", "goal", "shade")
OTHERS = ("box", "one", "other", "here", "there", "pale", "dark", "at", "tinted")
PLAIN = {key: key for key in (*ROLES, *OTHERS)}
NASTY = ["First", "first", "first hand", "first-hand", "held-with-first", "with", "with-first", "old-first", "2nd hand"]
NASTY += ["begin-carry-from-hold", "begin", "fill", "leaving", "in-HOLD", "HOLD", "hold-First", "idle", "n1", "readers"]
NASTY += ["and", "not", "object", "over all", "define", "how many", "none reading", "distinct", "slot", "nobody", "-"]
NASTY += ["?x", "Ünder☃", "", " ", "TOKEN", "PART", "token", "from-x1", "no x1 of at", "place", "place-2"]


def carrying(names: Mapping[str, str]) -> Task:
    """Return a task with a single plan, in which two tools hold a part, carry it and colour it."""
    thing, left, right, goal, shade = (names[key] for key in ROLES)
    colours = SymbolSort("colour", (names["pale"], names["dark"]))
    fit = predicate("fit", Tool, holds=lambda name: name == names["one"], kind=Kind.STATIC)
    held = changing("held", Part, Tool, kind=Kind.MAINTAINED)
    at = changing(names["at"], Part, Station, kind=Kind.FUNCTIONAL, value_of="x1")
    is_pale = predicate(
        names["tinted"], Part, colours, holds=lambda _, v: v == names["pale"], kind=Kind.FUNCTIONAL, value_of="x1"
    )
    slots = {thing: Part, left: Tool, right: Tool}
    blocks = [
        block("HOLD", slots, [fit(left)], [held(thing, right)], hold=True),
        block("CARRY", slots, [held(thing, right)], [at(thing, goal)], {goal: Station}, hold=True),
        block(
            "TINT",
            slots,
            [at(thing, goal), is_pale(thing, shade)],
            [is_pale(thing, names["dark"])],
            {goal: Station, shade: colours},
        ),
    ]
    ways = [("HOLD", "CARRY"), ("CARRY", "TINT")]
    edges = [("RESTING.token", f"HOLD.{slot}") for slot in slots]
    edges += [(f"{one}.{slot}", f"{other}.{slot}") for one, other in ways for slot in slots]
    edges += [(f"{each.name}.{slot}", "RESTING.token") for each in blocks for slot in slots]
    kinds = {"box": Part, "one": Tool, "other": Tool, "here": Station, "there": Station}
    tokens = tuple(Token.make(names[key], [kind], {}) for key, kind in kinds.items())
    wanted = (Atom(names["at"], (names["box"], names["there"])), Atom(names["tinted"], (names["box"], names["dark"])))
    return Task("names", made_of(blocks, [at, held, fit, is_pale], edges), tokens, State.of(tokens, {}), wanted)


def renamed(plan: TaskPlan, names: Mapping[str, str]) -> set[tuple[object, ...]]:
    """Return the content of a plan with the original names."""
    own = {name: key for key, name in names.items()}
    said = set()
    for each in plan.instances:
        # The slot of RESTING keeps its name.
        roles = {role if each.block == "RESTING" else own[role]: own[name] for role, name in each.roles.items()}
        said.add((each.block, each.start, each.end, frozenset(roles.items())))
    return said


def judge(folder: Path, names: Mapping[str, str]) -> set[tuple[object, ...]]:
    """Plan, decode, re-encode and export the task with the given names, and return the content of the plan."""
    task = carrying(names)
    compilation = compile_task(task)
    actions = shortest_plan(compilation.problem)
    assert actions is not None
    plan = schedule(task, decode(compilation, actions))
    assert check_law(task, plan) == []
    again = reencode(compilation, plan)
    assert not any(action == NO_ACTION for action in again), again
    assert schedule(task, decode(compilation, again)) == plan
    assert val_accepts(folder, compilation.problem, again)
    assert val_accepts(folder, compilation.problem, actions)
    assert val_accepts_temporal(folder, *reencode_durative(compile_durative(task), plan))
    return renamed(plan, names)


@cache
def plain() -> frozenset[tuple[object, ...]]:
    """Return the content of the plan with the original names."""
    with TemporaryDirectory() as folder:
        return frozenset(judge(Path(folder), PLAIN))


@st.composite
def some_names(draw: st.DrawFn) -> dict[str, str]:
    """Return distinct names for all items. The names contain no dots, because dots separate block and slot in edges."""
    characters = st.characters(codec="utf-8", exclude_characters=".*\n", exclude_categories=("C", "Z"))
    name = st.sampled_from(NASTY) | st.text(characters | st.sampled_from(" -"), min_size=1, max_size=12)
    keys = (*ROLES, *OTHERS)
    chosen = draw(st.lists(name.filter(bool), min_size=len(keys), max_size=len(keys), unique=True))
    # Domains refuse a predicate with the name of a class or of another predicate.
    assume({"PART", "TOOL", "STATION", "TOKEN", "colour", "held", "fit"}.isdisjoint(chosen[-2:]))
    return dict(zip(keys, chosen, strict=True))


THREE = PLAIN | {"left": "First", "right": "first hand", "thing": "held-with-first"}


@settings(max_examples=20, deadline=None, phases=[Phase.explicit, Phase.generate])
@given(some_names())
@example(THREE)
@example(PLAIN | {"left": "First", "right": "first", "thing": "FIRST"})
@example(PLAIN | {"thing": "with-left", "left": "with", "right": "left-with-with"})
@example(PLAIN | {"left": "and", "right": "define", "box": "object", "at": "over all", "dark": "at-2"})
def test_names_make_no_difference(tmp_path_factory: pytest.TempPathFactory, names: dict[str, str]) -> None:
    folder = tmp_path_factory.mktemp("names")
    assert judge(folder, names) == plain()


@pytest.mark.parametrize("names", [PLAIN, THREE], ids=["plain", "nasty"])
def test_an_engine_plans_whatever_the_slots_are_called(names: dict[str, str]) -> None:
    with PlannerProcess() as planner:
        found = find_plan(carrying(names), planner).plan
    assert found is not None
    assert renamed(found, names) == plain()

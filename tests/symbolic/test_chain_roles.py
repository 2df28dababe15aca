"""Tests of chains with targets and several slots, and of the expansion of chains into blocks."""

from pathlib import Path

import pytest
from chain_judges import chains, lawful, solved, timeline
from exhaustive import shortest_plan
from hypothesis import example, given, settings
from hypothesis import strategies as st
from random_series import RandomSeries
from serial import COLOURS, Part, Station, Tool, block, changing, domain, effort, in_series, predicate, stages, task
from validation import val_accepts

from hybrid_tamp.model.block import Block
from hybrid_tamp.model.kind import Kind
from hybrid_tamp.model.law import check_law
from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.model.predicate import Predicate
from hybrid_tamp.model.task import Task
from hybrid_tamp.symbolic.encoding.problem import compile_task
from hybrid_tamp.symbolic.pddl.text import domain_text
from hybrid_tamp.symbolic.reencode import reencode
from hybrid_tamp.symbolic.schedule import InfeasibleScheduleError

# -- targets and slots --------------------------------------------------------------------------------------------


def fetching(at: Predicate, done: Predicate) -> list[Block]:
    """Return blocks in which a tool goes to a station, works there and packs up."""
    return [
        block("GO", {"tool": Tool}, [], [at("tool", "station")], {"station": Station}, hold=True),
        block("WORK", {"tool": Tool}, [at("tool", "bench")], [done("tool", "bench")], {"bench": Station}, hold=True),
        block("PACK", {"tool": Tool}, [], [], hold=True),
    ]


@pytest.mark.parametrize(
    ("kind", "wanted"),
    [
        ({"kind": Kind.FUNCTIONAL, "value_of": "x1"}, ["GO > WORK > PACK"]),
        ({"kind": Kind.MAINTAINED}, ["GO > WORK > PACK"]),
        ({}, ["WORK > PACK"]),
    ],
    ids=["functional", "maintained", "neither"],
)
def test_a_target_is_carried_on_where_it_can_be_but_one(
    kind: dict[str, object], wanted: list[str], tmp_path: Path
) -> None:
    at, done = changing("at", Tool, Station, **kind), changing("done", Tool, Station)
    blocks = fetching(at, done)
    of = task(domain(blocks, [at, done], in_series(blocks)), [("done", "tool 0", "station 1")], tools=1, stations=3)
    assert chains(of) == wanted
    plan = solved(tmp_path, of)
    told = {i.block: dict(i.targets) for i in plan.instances}
    assert (told["GO"], told["WORK"]) == ({"station": "station 1"}, {"bench": "station 1"})


def test_a_symbol_that_a_target_must_be(tmp_path: Path) -> None:
    colour = predicate(
        "colour-of", Part, COLOURS, holds=lambda _, value: value == "red", kind=Kind.FUNCTIONAL, value_of="x1"
    )
    done = changing("done", Part, COLOURS)
    blocks = [
        block("DIP", {"part": Part}, [colour("part", "red")], [colour("part", "blue")]),
        block("DRY", {"part": Part}, [colour("part", "seen")], [done("part", "seen")], {"seen": COLOURS}),
    ]
    of = task(domain(blocks, [colour, done], in_series(blocks)), [("done", "part 0", "blue")])
    assert chains(of) == ["DIP > DRY"]
    (dry,) = [i for i in solved(tmp_path, of).instances if i.block == "DRY"]
    assert dry.targets == {"seen": "blue"}


def two_slots(anchors: tuple[str, str, str]) -> Task:
    held, bent, done = changing("held", Tool, Part), changing("bent", Part), changing("done", Part)
    slots = {"tool": Tool, "part": Part}
    blocks = [
        block("GRIP:left", slots, [], [held("tool", "part")], anchor=anchors[0], hold=True),
        block("BEND", slots, [held("tool", "part")], [bent("part")], anchor=anchors[1]),
        block("LET-GO", slots, [bent("part")], [~held("tool", "part"), done("part")], anchor=anchors[2]),
    ]
    goal = [("done", f"part {i}") for i in range(3)]
    return task(domain(blocks, [held, bent, done], in_series(blocks)), goal, parts=3, tools=2)


@pytest.mark.parametrize("anchors", [("tool", "tool", "tool"), ("tool", "part", "part"), ("part", "part", "tool")])
def test_two_slots(anchors: tuple[str, str, str], tmp_path: Path) -> None:
    of = two_slots(anchors)
    assert chains(of) == ["GRIP:left > BEND > LET-GO"]
    compilation = compile_task(of)
    actions = effort(tmp_path, compilation.problem).actions
    assert actions is not None
    plan = lawful(tmp_path, compilation, actions)
    for i in range(3):
        assert timeline(plan, f"part {i}") == ["RESTING", "GRIP:left", "BEND", "LET-GO", "RESTING"]
    text = domain_text(compilation.problem.domain)
    assert "grip-left-to-let-go is 'GRIP:left > BEND > LET-GO'" in text
    assert "bend-" not in text.replace("grip-left-to-let-go", "")


def test_what_is_held_for_the_next_block_alone_is_no_effect(tmp_path: Path) -> None:
    by, done = changing("by", Tool, Part, kind=Kind.MAINTAINED), changing("done", Part)
    blocks = [
        block("REACH", {"tool": Tool}, [], [by("tool", "part")], {"part": Part}, hold=True),
        block("TAP", {"tool": Tool}, [by("tool", "thing")], [done("thing")], {"thing": Part}, hold=True),
    ]
    of = task(domain(blocks, [by, done], in_series(blocks)), [("done", "part 0"), ("done", "part 1")], parts=2, tools=1)
    assert chains(of) == ["REACH > TAP"]
    operators = compile_task(of).problem.domain.operators
    assert not any(fact[0] == "by" for operator in operators for fact in (*operator.add, *operator.precondition))
    solved(tmp_path, of)
    both = of.replaced(goal=(*of.goal, *task(of.domain, [("by", "tool 0", "part 0")]).goal))
    assert chains(both) == []


# -- the way back -------------------------------------------------------------------------------------------------


def test_a_timeline_that_stops_inside_is_no_plan_of_the_chain(tmp_path: Path) -> None:
    of = task(stages(2, hold=True), [("stage-2", "part 0")])
    plan = solved(tmp_path, of)
    cut = TaskPlan(plan.instances[:-1], plan.instances[-2].end)
    assert not val_accepts(tmp_path, compile_task(of).problem, reencode(compile_task(of), cut))
    once = of.replaced(goal=task(of.domain, [("stage-1", "part 0")]).goal)
    whole = compile_task(once, chains=False)
    assert check_law(once, cut) == []
    assert val_accepts(tmp_path, whole.problem, reencode(whole, cut))


def test_names_of_chains_are_told_from_those_of_blocks(tmp_path: Path) -> None:
    of = stages(3)
    extra = block("b1-to-b3", {"part": Part})
    edges = [(".".join(one), ".".join(other)) for one, other in of.network.edges]
    of = domain([*of.blocks[1:], extra], of.predicates, edges + in_series([extra]))
    wanted = task(of, [("stage-3", "part 0")])
    assert chains(wanted) == ["B1 > B2 > B3"]
    operators = [operator.name for operator in compile_task(wanted).problem.domain.operators]
    assert len(set(operators)) == len(operators)
    solved(tmp_path, wanted)


@settings(max_examples=80)
@example(390)  # A token starts in a block without a hold.
@given(st.integers(0, 10**6))
def test_chains_lose_no_plan_and_make_none_up(tmp_path_factory: pytest.TempPathFactory, seed: int) -> None:
    """Exhaustive search finds a plan with chains if and only if one exists without chains. Every plan is lawful."""
    of = RandomSeries(seed).task()
    compilation = compile_task(of)
    if not compilation.encoded.chains.links:
        return
    try:
        actions = shortest_plan(compilation.problem)
        assert actions is not None or shortest_plan(compile_task(of, chains=False).problem) is None
    except OverflowError:
        return
    try:
        # A token that starts in a block has not yet met the exit conditions, but operators do not contain this
        # condition.
        if actions and not of.assignment:
            lawful(tmp_path_factory.mktemp("random"), compilation, actions)
    except InfeasibleScheduleError:
        pass  # blocks without `hold` that meet again, as without chains

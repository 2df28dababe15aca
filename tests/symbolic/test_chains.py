"""Blocks in series cost no more than one block, and a chain is split where a plan may need this."""

from dataclasses import replace
from pathlib import Path

import pytest
from chain_judges import chains, lawful, solved, timeline
from exhaustive import shortest_plan
from serial import (
    Effort,
    Part,
    Tool,
    block,
    changing,
    domain,
    effort,
    in_series,
    predicate,
    stages,
    task,
)

from hybrid_tamp.model.kind import Kind
from hybrid_tamp.model.task import Task
from hybrid_tamp.symbolic.encoding.problem import compile_task
from hybrid_tamp.symbolic.engines.planner_process import PlannerProcess
from hybrid_tamp.symbolic.find_plan import find_plan

# -- what a chain costs -------------------------------------------------------------------------------------------


def of_twenty(count: int, hold: bool) -> Task:
    return task(stages(count, hold), [(f"stage-{count}", f"part {i}") for i in range(20)], parts=20)


@pytest.fixture(scope="module", params=[False, True], ids=["passing", "holding"])
def single(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> tuple[bool, Effort]:
    """Return the cost of one block, without or with a hold."""
    problem = compile_task(of_twenty(1, request.param)).problem
    return request.param, effort(tmp_path_factory.mktemp("single"), problem)


@pytest.mark.parametrize("count", [1, 3, 10, 30])
def test_a_chain_costs_no_more_than_a_single_block(count: int, single: tuple[bool, Effort], tmp_path: Path) -> None:
    """Figures of Fast Downward: ground operators of its translator, and states that its search expands."""
    hold, one = single
    of = of_twenty(count, hold)
    compilation = compile_task(of)
    found = effort(tmp_path, compilation.problem)
    assert found.actions is not None
    assert (found.operators, found.expanded, len(found.actions)) == (one.operators, one.expanded, 20 if hold else 40)
    plan = lawful(tmp_path, compilation, found.actions)
    through = ["RESTING", *(f"B{i}" for i in range(1, count + 1)), *([] if hold else ["RESTING"])]
    assert all(timeline(plan, token.name) == through for token in of.tokens)


def test_a_longer_chain_has_no_more_effects() -> None:
    """A chain omits facts that only its own blocks require, because planners search for invariants of every fact."""
    sizes = [
        [
            (len(o.parameters), len(o.precondition), len(o.add), len(o.delete))
            for o in compile_task(of).problem.domain.operators
        ]
        for of in (of_twenty(3, hold=False), of_twenty(30, hold=False))
    ]
    assert sizes[0] == sizes[1]


def test_without_chains_every_block_costs(tmp_path: Path) -> None:
    found = effort(tmp_path, compile_task(of_twenty(10, hold=True), chains=False).problem)
    assert (found.operators, found.expanded) == (220, 200)


# -- where a chain is cut -----------------------------------------------------------------------------------------


def test_a_goal_that_is_true_only_after_block_2_of_3() -> None:
    of = task(stages(3, hold=True), [("stage-2", "part 0"), ("stage-3", "part 1")], parts=20)
    assert chains(of) == ["B1 > B2"]
    with PlannerProcess() as planner:
        plan = find_plan(of, planner).plan
    assert plan is not None
    assert timeline(plan, "part 0") == ["RESTING", "B1", "B2"]
    assert timeline(plan, "part 1") == ["RESTING", "B1", "B2", "B3"]


@pytest.mark.parametrize(("stage", "wanted"), [(1, ["B2 > B3"]), (2, ["B1 > B2"]), (3, ["B1 > B2 > B3"])])
def test_a_chain_ends_where_its_goal_holds(stage: int, wanted: list[str], tmp_path: Path) -> None:
    of = task(stages(3, hold=True), [(f"stage-{stage}", "part 0")], parts=2)
    assert chains(of) == wanted
    assert timeline(solved(tmp_path, of), "part 0")[1:] == [f"B{i}" for i in range(1, stage + 1)]


def test_where_nobody_can_stay_the_goal_does_not_cut() -> None:
    of = task(stages(3), [("stage-2", "part 0")])
    assert chains(of) == ["B1 > B2 > B3"]
    assert shortest_plan(compile_task(of).problem) is None
    assert shortest_plan(compile_task(of, chains=False).problem) is None


def test_a_goal_that_outlives_the_chain_does_not_cut(tmp_path: Path) -> None:
    done = [changing(f"done-{i}", Part) for i in range(3)]
    blocks = [
        block(f"B{i}", {"part": Part}, done[i - 1 : i] and [done[i - 1]("part")], [done[i]("part")]) for i in (0, 1, 2)
    ]
    of = task(domain(blocks, done, in_series(blocks)), [("done-0", "part 0"), ("done-2", "part 0")])
    assert chains(of) == ["B0 > B1 > B2"]
    solved(tmp_path, of)


def test_a_fact_that_another_block_needs_of_its_target_cuts(tmp_path: Path) -> None:
    of = stages(3, hold=True)
    stage_2, seen = of.predicate_by_name["stage-2"], changing("seen", Tool)
    look = block("LOOK", {"tool": Tool}, [stage_2("part")], [seen("tool")], {"part": Part})
    edges = in_series([look]) + in_series([of.block_by_name[f"B{i}"] for i in (1, 2, 3)])
    looked = domain([*of.blocks[1:], look], [*of.predicates, seen], edges)
    wanted = task(looked, [("seen", "tool 0"), ("stage-3", "part 0")], parts=1, tools=1)
    assert chains(wanted) == ["B1 > B2"]
    plan = solved(tmp_path, wanted)
    assert timeline(plan, "part 0") == ["RESTING", "B1", "B2", "B3"]
    assert "LOOK" in timeline(plan, "tool 0")


def test_an_entry_that_the_block_before_does_not_bring_about_cuts(tmp_path: Path) -> None:
    ready, dry, done = changing("ready", Part), changing("dry", Part), changing("done", Part)
    wet = [
        block("WASH", {"part": Part}, [], [ready("part")], hold=True),
        block("PAINT", {"part": Part}, [ready("part"), dry("part")], [done("part")]),
    ]
    fan = block("FAN", {"tool": Tool}, [ready("part")], [dry("part")], {"part": Part})
    of = task(domain([*wet, fan], [ready, dry, done], in_series(wet) + in_series([fan])), [("done", "part 0")], tools=1)
    assert chains(of) == []
    solved(tmp_path, of)


def test_a_branch_or_a_second_way_in_cuts() -> None:
    of = stages(3)
    for edge in (("B1.part", "RESTING.token"), ("RESTING.token", "B2.part")):
        edges = [(".".join(one), ".".join(other)) for one, other in of.network.edges]
        branched = domain(of.blocks[1:], of.predicates, [*edges, edge])
        assert chains(task(branched, [("stage-3", "part 0")])) == ["B2 > B3"]


def test_a_token_that_starts_inside_cuts(tmp_path: Path) -> None:
    of = stages(4, hold=True)
    wanted = task(of, [("stage-4", "part 0")], parts=2, assignment={"part 1": "B2"})
    assert chains(wanted) == ["B3 > B4"]
    plan = solved(tmp_path, wanted)
    assert timeline(plan, "part 0") == ["RESTING", "B1", "B2", "B3", "B4"]


def test_who_can_stay_must_be_able_to_go_on(tmp_path: Path) -> None:
    done, more = changing("done", Part), changing("more", Part)
    fit = predicate("fit", Part, holds=lambda part: part == "part 1", kind=Kind.STATIC)
    blocks = [
        block("FIRST", {"part": Part}, [], [done("part")], hold=True),
        block("SECOND", {"part": Part}, [done("part"), fit("part")], [more("part")], hold=True),
    ]
    of = task(domain(blocks, [done, more, fit], in_series(blocks)), [("done", "part 0")], parts=2)
    assert chains(of) == []
    assert timeline(solved(tmp_path, of), "part 0") == ["RESTING", "FIRST"]
    passing = [replace(blocks[0], hold=False), blocks[1]]
    of = task(domain(passing, [done, more, fit], in_series(passing)), [("done", "part 1")], parts=2)
    assert chains(of) == ["FIRST > SECOND"]
    solved(tmp_path, of)

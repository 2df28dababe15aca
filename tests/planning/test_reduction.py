"""Tests of tailored networks: omitted blocks, added objects, and that no plan is lost."""

import dataclasses
import random
from collections.abc import Sequence

import pytest
import serial
from exhaustive import shortest_plan
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from random_series import RandomSeries
from scenes import rolling_task
from serial import Part, Tool, block, changing
from tools import CROWBAR, HAMMER, Ball, Graspable, Hand, Lever, Lid, Nail, Striker, domain, task

import hybrid_tamp
from hybrid_tamp.errors import LimitReached
from hybrid_tamp.model.law import check_law
from hybrid_tamp.model.network import ReassignmentNetwork
from hybrid_tamp.model.outcome import PlanOutcome
from hybrid_tamp.model.predicate import ANY, Atom
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Limits, Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.planning.plan import plan_task
from hybrid_tamp.planning.reduction import Reducer, Reduction
from hybrid_tamp.report.documents import document
from hybrid_tamp.report.tables import network_text
from hybrid_tamp.symbolic.encoding.problem import compile_task
from hybrid_tamp.symbolic.engines.planner_process import PlannerAnswer
from hybrid_tamp.symbolic.find_plan import find_plan
from hybrid_tamp.symbolic.pddl.operators import PlanningProblem
from hybrid_tamp.symbolic.reencode import plan_actions
from hybrid_tamp.taskfile.roles import can_start


class Exhaustive:
    """A planner with an exhaustive search, which counts its requests."""

    def __init__(self) -> None:
        self.asked: list[PlanningProblem] = []

    def solve(self, problem: PlanningProblem, engine: str, limits: Limits) -> PlannerAnswer:
        self.asked.append(problem)
        actions = shortest_plan(problem)
        return PlannerAnswer("unsolvable" if actions is None else "solved", tuple(actions or ()), 0.0, engine)


def blocks(of: Task) -> set[str]:
    return {block.name for block in of.domain.blocks}


def brought(outcome: PlanOutcome) -> list[str]:
    return [each.token for each in outcome.network.expanded_with]


def reduce_task(of: Task, tools: Sequence[str] = ()) -> Reduction:
    return Reducer(of).reduce(tools)


def shuffled(of: Task, seed: int) -> Task:
    tokens = list(of.tokens)
    random.Random(seed).shuffle(tokens)
    return of.replaced(tokens=tuple(tokens))


# -- reduction ---------------------------------------------------------------------------------------------------


def test_blocks_that_no_token_fills_are_left_out_with_what_only_they_mention() -> None:
    reduction = reduce_task(task({"hammer": HAMMER, "ball": [Ball]}), ["hammer"])
    assert blocks(reduction.task) == {"RESTING", "GRASPING", "DRIVING"}
    assert reduction.tokens_left_out == ("ball",)
    assert reduction.whole.domain.block_by_name.keys() - reduction.names == {"LEVERING", "PUSHING"}
    assert {predicate.name for predicate in reduction.task.domain.predicates} == {
        "driven",
        "bare",
        "heavy_enough",
        "held",
    }
    assert {"BALL", "LEVER", "LID"}.isdisjoint(each.name for each in reduction.task.domain.classes)
    assert reduction.task.domain.network.edges == tuple(
        edge for edge in task({}).domain.network.edges if {edge[0][0], edge[1][0]} <= {"RESTING", "GRASPING", "DRIVING"}
    )


def test_agents_that_have_nothing_to_do_with_the_goal_are_left_out_with_their_blocks() -> None:
    drums = rolling_task(hands=1)
    of = drums.domain
    made = type("Gripper", (Hand,), {"name": "GRIPPER", "__module__": "tools"})
    moving = block("MOVING", {"gripper": made}, (), [changing("moved", made)("gripper")])
    edges = [(".".join(one), ".".join(other)) for one, other in of.network.edges]
    wider = dataclasses.replace(
        of,
        classes=(*of.classes, made),
        blocks=(*of.blocks, moving),
        predicates=(*of.predicates, moving.exit[0].predicate),
        disjoint=(*of.disjoint, (made, of.class_by_name["STATIC END-EFFECTOR"])),
        network=ReassignmentNetwork([*edges, ("RESTING.token", "MOVING.gripper"), ("MOVING.gripper", "RESTING.token")]),
    )
    gripper = Token.make("gripper", [made], {})
    tokens = (*drums.tokens, gripper)
    given = {(t.name, v.name): drums.state[t, v.name] for t in drums.tokens for v in t.varying}
    reduction = reduce_task(drums.replaced(domain=wider, tokens=tokens, state=State.of(tokens, given)))
    assert reduction.tokens_left_out == ("gripper",)
    assert blocks(reduction.task) == {"RESTING", "REACHING:behind", "ROLLING"}


def test_a_block_needs_a_different_token_for_each_slot_and_target() -> None:
    # A single token cannot be the striker, the lever and the lid at the same time.
    both = reduce_task(task({"thing": [Graspable, Lever, Lid]}), ["thing"])
    assert "LEVERING" not in blocks(both.task)
    assert "LEVERING" in blocks(reduce_task(task({"lid": [Lid], "bar": CROWBAR}), ["lid", "bar"]).task)


def test_blocks_that_nothing_can_come_to_are_left_out() -> None:
    # A hammer that cannot be grasped does not drive a nail, although it can fill the slot.
    assert "DRIVING" not in blocks(reduce_task(task({"hammer": [Striker]}), ["hammer"]).task)


@pytest.mark.parametrize(("hold", "kept"), [(False, {"RESTING"}), (True, {"RESTING", "A"})])
def test_blocks_that_one_must_leave_and_cannot_are_left_out(hold: bool, kept: set[str]) -> None:
    done = changing("done", Part)
    first, second = block("A", {"part": Part}, (), [done("part")], hold=hold), block("B", {"part": Part, "tool": Tool})
    edges = [("RESTING.token", "A.part"), ("A.part", "B.part"), ("RESTING.token", "B.tool")]
    of = serial.domain([first, second], [done], [*edges, ("B.part", "RESTING.token"), ("B.tool", "RESTING.token")])
    whole = serial.task(of, [("done", "part 0")], parts=1, tools=1)
    assert blocks(reduce_task(whole).task) == kept
    assert blocks(reduce_task(whole, ["tool 0"]).task) == {"RESTING", "A", "B"}


def test_what_starts_in_a_block_is_kept_with_it() -> None:
    started = task({"hammer": HAMMER}).replaced(assignment={"hammer": "GRASPING"})
    reduction = reduce_task(started)
    assert reduction.task.assignment == {"hammer": "GRASPING"}
    assert "GRASPING" in blocks(reduction.task)


def test_rolling_leaves_tumbling_out_and_places_that_no_block_asks_for() -> None:
    reduction = reduce_task(rolling_task(regions=[(0.7, 0.0), (5.0, 0.0)]))
    assert blocks(reduction.task) == {"RESTING", "REACHING:behind", "ROLLING"}
    assert reduction.tokens_left_out == ()  # any region can be rolled to


def test_what_was_left_out_rests_in_the_plan_of_the_whole() -> None:
    wide = task({"hammer": HAMMER, "ball": [Ball], "a bar": CROWBAR, "lid": [Lid]})
    planned = plan_task(wide, Exhaustive())
    assert planned.plan is not None
    assert check_law(wide, planned.plan) == []
    for name in ("ball", "a bar", "lid"):
        ((instance, _),) = planned.plan.timeline(name)
        assert (instance.block, instance.start, instance.end) == ("RESTING", 0.0, planned.plan.makespan)


# -- tools -------------------------------------------------------------------------------------------------------


def test_the_hammer_is_brought_in_and_grasped_and_distractors_are_not() -> None:
    places = {"hammer": (9.0, 0.0, 0.0), "ball": (0.1, 0.0, 0.0)}
    planner = Exhaustive()
    things = {"ball": [Ball], "a bar": CROWBAR, "lid": [Lid], "hammer": HAMMER}
    outcome = plan_task(task(things, places=places), planner)
    (entry,) = outcome.network.expanded_with
    assert (entry.token, entry.classes) == ("hammer", ("GRASPABLE", "STRIKER"))
    assert entry.blocks == ("DRIVING", "GRASPING")
    assert "no block achieves driven(nail)" in entry.why
    assert [i.block for i, _ in outcome.required().timeline("hammer")] == ["RESTING", "GRASPING", "DRIVING", "RESTING"]
    assert len(planner.asked) == 1
    whole = outcome.network.reduced_from
    assert whole is not None
    assert (whole.blocks, whole.tokens, whole.tokens_left_out) == (5, 6, ("a bar", "ball", "lid"))


def test_of_two_tools_the_suitable_one_is_brought_in() -> None:
    tools = {"a light hammer": HAMMER, "mallet": HAMMER}
    outcome = plan_task(task(tools, places={"a light hammer": (0.1, 0.0, 0.0)}), Exhaustive())
    assert brought(outcome) == ["mallet"]
    (whole,) = [outcome.network.reduced_from]
    assert whole is not None
    assert whole.tokens_left_out == ("a light hammer",)


def test_of_two_suitable_tools_the_nearer_one_is_brought_in() -> None:
    tools = {"far": HAMMER, "near": HAMMER}
    outcome = plan_task(task(tools, places={"near": (0.5, 0.0, 0.0)}), Exhaustive())
    assert brought(outcome) == ["near"]


def test_tools_that_are_needed_together_are_brought_in_one_after_the_other() -> None:
    things = {"ball": [Ball], "hammer": HAMMER, "bar": CROWBAR, "lid": [Lid]}
    outcome = plan_task(task(things, goal="covered nail"), Exhaustive())
    assert outcome.status == "solved"
    assert {"hammer", "bar", "lid"} <= set(brought(outcome))


def test_tools_that_are_of_no_use_alone_are_brought_in_once_each() -> None:
    done = changing("done", Part)
    all_three = block("A", {"part": Part, "first": Tool, "second": Tool, "third": Tool}, (), [done("part")])
    of = serial.domain([all_three], [done], serial.in_series([all_three]))
    whole = serial.task(of, [("done", "part 0")], tools=3)
    outcome = plan_task(whole, Exhaustive())
    assert outcome.status == "solved"
    assert [each.blocks for each in outcome.network.expanded_with] == [(), (), ("A",)]
    assert brought(outcome) == ["tool 0", "tool 1", "tool 2"]


def test_without_any_tool_it_is_proven_on_all_that_is_relevant() -> None:
    planner = Exhaustive()
    outcome = plan_task(task({"a light hammer": HAMMER, "ball": [Ball]}), planner)
    assert outcome.status == "unsolvable"
    assert brought(outcome) == ["a light hammer"]
    assert len(planner.asked) == 1


def test_what_only_rests_need_not_be_brought_in_to_prove_that_there_is_no_plan() -> None:
    planner = Exhaustive()
    outcome = plan_task(task({"stone": []}), planner)
    assert (outcome.status, brought(outcome), len(planner.asked)) == ("unsolvable", [], 1)


def test_the_order_of_tokens_does_not_matter() -> None:
    things = {"ball": [Ball], "bar": CROWBAR, "lid": [Lid], "hammer": HAMMER, "mallet": HAMMER}
    wide = task(things, goal="covered nail")
    told = {tuple(brought(plan_task(shuffled(wide, seed), Exhaustive()))) for seed in range(5)}
    assert len(told) == 1


def test_a_goal_with_a_choice_keeps_all_that_it_leaves_to_choose_from() -> None:
    wide = task({"hammer": HAMMER, "another nail": [Nail], "ball": [Ball]}, goal="covered nail")
    wide = wide.replaced(goal=(Atom("driven", (ANY,)),))
    outcome = plan_task(wide, Exhaustive())
    assert brought(outcome) == ["hammer"]
    assert outcome.chosen is not None
    assert outcome.chosen.goal == (Atom("driven", ("another nail",)),)
    assert outcome.chosen.domain is wide.domain
    assert check_law(outcome.chosen, outcome.required()) == []


HEAVY_AND_LIGHT = task({"a light hammer": HAMMER, "mallet": HAMMER}, agents={"robot": ("hand", "a light hammer")})


def test_what_the_planner_said_of_the_first_network_is_told() -> None:
    planner = Exhaustive()
    outcome = plan_task(HEAVY_AND_LIGHT, planner)
    (entry,) = outcome.network.expanded_with
    assert (entry.token, entry.blocks) == ("mallet", ())
    assert "the planner has proven that no plan exists without this object in the network" in entry.why
    assert [len(asked.objects) for asked in planner.asked] == sorted({len(asked.objects) for asked in planner.asked})
    text = network_text(document(outcome)["network"])
    assert text.splitlines()[0].startswith("reduced network: 3 of 5 blocks, 4 of 4 tokens; left out: LEVERING, PUSHING")
    assert text.splitlines()[1].startswith("brought in mallet (GRASPABLE, STRIKER): the planner has proven")


class Endless(Exhaustive):
    """A planner that never ends if there is no plan, and records its time limits."""

    def __init__(self) -> None:
        super().__init__()
        self.times: list[float] = []

    def solve(self, problem: PlanningProblem, engine: str, limits: Limits) -> PlannerAnswer:
        self.times.append(limits.time)
        answer = super().solve(problem, engine, limits)
        if answer.status != "solved":
            raise LimitReached("too long", limit="time")
        return answer


def test_a_network_out_of_reach_is_not_given_to_a_planner_that_does_not_end() -> None:
    planner = Endless()
    outcome = plan_task(HEAVY_AND_LIGHT.replaced(limits=Limits(time=400.0)), planner)
    assert brought(outcome) == ["mallet"]
    (given,) = planner.times
    assert 300.0 < given <= 400.0


def test_the_time_limit_is_for_all_attempts_together() -> None:
    class Slow(Exhaustive):
        def solve(self, problem: PlanningProblem, engine: str, limits: Limits) -> PlannerAnswer:
            given.append(limits.time)
            return super().solve(problem, engine, limits)

    given: list[float] = []
    wide = task({"hammer": HAMMER, "mallet": HAMMER}, goal="nail")
    outcome = plan_task(wide.replaced(limits=Limits(time=1e-9)), Slow())
    with pytest.raises(LimitReached, match="time limit"):
        outcome.required()
    assert given == []


# -- laws --------------------------------------------------------------------------------------------------------


@settings(max_examples=40)
@given(st.integers(0, 10_000))
def test_no_plan_that_the_full_network_has_is_lost(seed: int) -> None:
    whole = RandomSeries(seed).task()
    assume(all(can_start(whole.domain.block_by_name[block]) for block in whole.assignment.values()))
    tailored = plan_task(whole, Exhaustive())
    full = find_plan(whole, Exhaustive())
    assert (full.status == "solved") == (tailored.status == "solved")
    if tailored.plan is not None:
        assert check_law(whole, tailored.plan) == []
        # A plan from a reduced network can be written as a plan for the whole network.
        compilation = compile_task(whole)
        actions = plan_actions(compilation, tailored.plan)
        assert compilation.reaches_goal(actions)


KINDS: Sequence[Sequence[type]] = ([Ball], HAMMER, CROWBAR, [Lid], [Striker], [Lever], [Graspable], [])


@settings(max_examples=40)
@given(st.lists(st.sampled_from(KINDS), max_size=5), st.booleans(), st.booleans(), st.integers(0, 99))
def test_tools_are_found_wherever_there_is_a_plan(
    kinds: list[list[type]], covered: bool, light: bool, seed: int
) -> None:
    things = {f"{'light ' if light and i % 2 else ''}{i}": kind for i, kind in enumerate(kinds)}
    whole = task(things, goal="covered nail" if covered else "nail")
    tailored = plan_task(whole, Exhaustive())
    assert find_plan(whole, Exhaustive()).status.replace("not_found", "unknown") == tailored.status
    again = plan_task(shuffled(whole, seed), Exhaustive())
    assert brought(again) == brought(tailored)


# -- what is unrelated ---------------------------------------------------------------------------------------------


def test_unrelated_tokens_and_blocks_are_seen_neither_by_the_facts_nor_by_the_compiler() -> None:
    things = {"hammer": HAMMER}
    few, planner = Exhaustive(), Exhaustive()
    alone = plan_task(task(things), few)
    of = domain(60)
    odd = {f"odd {c.name} {i}": [c] for c in of.classes if c.name.startswith("ODD") for i in range(2)}
    for predicate in of.predicates:
        if "-" in predicate.name:
            object.__setattr__(predicate, "margin", _never)
    crowd = task({**odd, **things}, of=of)
    crowded = plan_task(crowd, planner)
    assert crowded.required().actions == alone.required().actions != ()
    assert crowded.required().makespan == alone.required().makespan
    assert [i for i in crowded.required().instances if not set(i.slots.values()) & set(odd)] == list(
        alone.required().instances
    )
    assert planner.asked == few.asked


def _never(*_: Token) -> None:
    raise AssertionError("a fact about something unrelated was asked for")


# -- bundled tasks -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("name", "left_out"), [("tool_among_distractors", "paddle"), ("tool_choice", "mallet")])
def test_the_hammer_of_a_bundled_task_is_brought_in_and_grasped(name: str, left_out: str) -> None:
    outcome = hybrid_tamp.plan(name)
    network = outcome.network
    assert brought(outcome) == ["hammer"]
    assert network.reduced_from is not None
    assert left_out in network.reduced_from.tokens_left_out
    grasped = [i.slots["tool"] for i in outcome.required().instances if i.block == "GRASPING"]
    assert grasped == ["hammer"]

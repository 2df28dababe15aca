"""Tests of the conversion to unified_planning and back: names, plain problems, compiled problems and the validator."""

from dataclasses import replace
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from planning_problems import DELIVER, DELIVERED, MEETING, SETTLED, random_problem, shortest
from validation import read_action

from hybrid_tamp.model.plan import PlannedAction
from hybrid_tamp.symbolic.engines.plain import PlainProblem
from hybrid_tamp.symbolic.engines.solver import Solver, original_plan, simplify_for
from hybrid_tamp.symbolic.engines.unified import unify
from hybrid_tamp.symbolic.pddl.operators import Operator, PlanningDomain, PlanningProblem

# Keywords of PDDL, names of Python's and unified_planning's own, and names that others may be renamed to.
NASTY = ["and", "not", "at", "over", "all", "define", "domain", "number", "either", "total-cost", "preference", "event"]
NASTY += ["self", "name", "environment", "a", "a-b", "a_b", "a-2", "a-2-2", "and_", "and-2", "not_0", "at-2"]


@pytest.fixture(scope="module")
def solver() -> Solver:
    return Solver()


@st.composite
def nasty_problems(draw: st.DrawFn) -> PlanningProblem:
    """Problems with short plans, in which items of different kinds may have the same name."""
    names = st.permutations(NASTY)
    kinds, things, predicates, operators, variables = (draw(names) for _ in range(5))
    (one, two), wide = [f"?{name}" for name in variables[:2]], draw(st.sampled_from([kinds[0], "object"]))
    here, seen, free = predicates[:3]
    move = Operator(
        operators[0], ((one, wide), (two, kinds[0])), ((here, one), (free,)), ((here, two), (seen, one)), ((here, one),)
    )
    unlock = Operator(operators[1], (), ((here, things[0]),), ((free,),), ())
    domain = PlanningDomain(
        "nasty",
        types=((kinds[0], "object"), (kinds[1], kinds[0])),
        constants=((things[0], kinds[0]),),
        predicates=((here, ((two, "object"),)), (seen, ((one, wide),)), (free, ())),
        operators=(move, unlock),
    )
    objects = ((things[1], kinds[1]), (things[2], kinds[0]))
    return PlanningProblem("nasty", domain, objects, ((here, things[0]),), ((seen, things[1]), (here, things[2])))


@settings(max_examples=40)
@given(nasty_problems())
def test_every_thing_has_one_name_that_nobody_changes(problem: PlanningProblem) -> None:
    from unified_planning.io import PDDLWriter

    unified = unify(problem).problem
    things = [*unified.actions, *unified.fluents, *unified.all_objects, *unified.user_types]
    assert len({thing.name for thing in things}) == len(things)
    writer = PDDLWriter(unified)
    writer.get_domain()
    writer.get_problem()
    assert [writer.get_pddl_name(thing) for thing in things] == [thing.name for thing in things]


@settings(max_examples=25)
@given(problem=nasty_problems())
def test_plans_come_back_in_our_names(solver: Solver, problem: PlanningProblem) -> None:
    constant, (first, second) = problem.domain.constants[0][0], dict(problem.objects)
    move, unlock = (operator.name for operator in problem.domain.operators)
    moves = ((constant, first), (first, second))
    plan = [PlannedAction(unlock), *(PlannedAction(move, places) for places in moves)]
    assert unify(problem).fault(plan) == ""
    reply = {"status": "solved", "actions": tuple(plan), "message": "", "fewest": "first found"}
    assert solver.reply(problem, "pyperplan") == reply


def test_initial_values_are_the_same_sparse_or_not() -> None:
    dense, sparse = unify(DELIVER).problem, unify(DELIVER, sparse=True).problem
    named = [str(fact) for fact, value in dense.initial_values.items() if value.is_true()]
    assert sorted(map(str, sparse.initial_values)) == sorted(named)
    assert len(sparse.initial_values) == len(DELIVER.init) < len(dense.initial_values)


@pytest.mark.parametrize(
    ("actions", "fault"),
    [
        ([read_action("(fly first)")], "action 1, (fly first): there is no operator 'fly'"),
        ([read_action("(move first home)")], "action 1, (move first home): the operator needs 3 objects, got 2"),
        ([read_action("(move second home yard)")], "there is no object 'second'"),
        (
            [DELIVERED[0], read_action("(move yard home yard)")],
            "action 2, (move yard home yard): the type of 'yard' does not fit parameter",
        ),
        (DELIVERED[1:], "Preconditions [at-2(first, yard)] of 1-th action instance"),
        (DELIVERED[:1], "Goals [at-2(first, shop)] are not satisfied"),
        (DELIVERED, ""),
    ],
)
def test_validator_says_what_is_wrong(actions: Any, fault: str) -> None:
    found = unify(DELIVER).fault(actions)
    assert fault in found
    assert bool(fault) == bool(found)


def test_an_add_wins_over_a_delete() -> None:
    again = Operator("again", (("?b", "box"),), (), (("marked", "?b"),), (("marked", "?b"),))
    problem = replace(DELIVER, domain=replace(DELIVER.domain, operators=(again,)), goal=(("marked", "first"),))
    assert unify(problem).fault([PlannedAction("again", ("first",))]) == ""
    assert unify(MEETING).fault([read_action(line) for line in ("(light one)", "(pass one one)", "(reset hub)")]) == ""


def test_what_an_engine_does_not_take_is_compiled_away(solver: Solver) -> None:
    from unified_planning import shortcuts as up
    from unified_planning.engines.plan_validator import SequentialPlanValidator

    lamp = up.UserType("lamp")
    lit, ready = up.Fluent("lit", up.BoolType(), which=lamp), up.Fluent("ready")
    press = up.InstantaneousAction("press", which=lamp)
    press.add_precondition(up.Not(lit(press.parameter("which"))))
    press.add_effect(lit(press.parameter("which")), True)
    look = up.InstantaneousAction("look")
    each = up.Variable("each", lamp)
    look.add_effect(ready, True, up.Forall(lit(each), each))
    problem = up.Problem("lamps")
    problem.add_fluent(lit, default_initial_value=False)
    problem.add_fluent(ready, default_initial_value=False)
    problem.add_actions([press, look])
    problem.add_objects([up.Object("left", lamp), up.Object("right", lamp)])
    problem.add_goal(ready)
    solver._load("pyperplan")
    with solver._factory.OneshotPlanner(name="pyperplan") as planner:
        given_problem, results = simplify_for(planner, problem)
        assert len(results) == 3
        assert planner.supports(given_problem.kind)
        plan = original_plan(planner.solve(given_problem).plan, results)
    assert [step.action.name for step in plan.actions] == ["press", "press", "look"]
    assert SequentialPlanValidator().validate(problem, plan)


def test_a_plain_problem_has_the_same_plans(solver: Solver) -> None:
    solved = 0
    for problem in map(random_problem, range(300)):
        plain = PlainProblem(problem)
        length = shortest(problem)
        assert shortest(plain.problem) == length, problem.name
        if length and solved < 25:
            reply = solver.reply(plain.problem, "pyperplan")
            assert unify(problem).fault([plain.original(action) for action in reply["actions"]]) == ""
            solved += 1
    assert solved == 25


def test_plain_problems_have_no_meeting_effects_and_no_settled_conditions() -> None:
    operators = {operator.name: operator for operator in PlainProblem(MEETING).problem.domain.operators}
    assert list(operators) == ["light", "pass", "reset", "pass-case-1", "reset-case-1"]
    assert operators["pass-case-1"].parameters == (("?s", "spot"),)
    assert operators["reset-case-1"].add == operators["reset-case-1"].delete == (("on", "hub"),)
    assert PlainProblem(MEETING).original(read_action("(pass-case-1 one)")) == read_action("(pass one one)")
    assert PlainProblem(MEETING).original(read_action("(reset-case-1)")) == read_action("(reset hub)")
    assert PlainProblem(SETTLED).problem.domain.operators[0].precondition == ()
    assert PlainProblem(replace(SETTLED, init=())).problem.domain.operators == ()


def test_pyperplan_is_right_about_there_being_no_plan(solver: Solver) -> None:
    """The status of the engine does not claim a proof, but an exhaustive search confirms the answer."""
    said = {problem.name: solver.reply(problem, "pyperplan")["status"] for problem in map(random_problem, range(50))}
    real = {problem.name: shortest(problem) for problem in map(random_problem, range(50))}
    assert said == {name: "unsolvable" if length is None else "solved" for name, length in real.items()}
    assert len(set(said.values())) == 2

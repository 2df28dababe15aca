"""The law checker and VAL give the same verdict on valid plans and on randomly changed plans.

Plans are random walks through the compiled operators, so that they take every edge of the network. VAL checks the
re-encoded timeline. Classical PDDL has no time, so durations (law 6) are checked separately.
"""

import random
from dataclasses import replace
from pathlib import Path

import pytest
from random_tasks.tumbling import random_tumbling
from scenes import rolling_task
from validation import read_action, val_accepts, val_accepts_temporal

from hybrid_tamp.model.law import check_law
from hybrid_tamp.model.plan import BlockInstance, PlannedAction, TaskPlan
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.task import Task
from hybrid_tamp.symbolic.decode import decode
from hybrid_tamp.symbolic.encoding.problem import Compilation, compile_task
from hybrid_tamp.symbolic.engines.plain import lineage
from hybrid_tamp.symbolic.engines.planner_process import PlannerProcess
from hybrid_tamp.symbolic.pddl.joins import FactIndex, bind_condition, join
from hybrid_tamp.symbolic.pddl.operators import Operator, PlanningProblem
from hybrid_tamp.symbolic.reencode import reencode
from hybrid_tamp.symbolic.schedule import schedule
from hybrid_tamp.symbolic.temporal.compilation import compile_durative
from hybrid_tamp.symbolic.temporal.reencoding import reencode_durative

TASKS = {
    "one hand": rolling_task(),
    "two hands, one drum": rolling_task(hands=2, regions=[(0.7, 0.0), (-0.6, 0.0)], goal=[]),
    "two hands, two drums": rolling_task(
        hands=2, drums=[(0.0, 0.0), (0.0, 0.5)], regions=[(0.7, 0.0), (0.9, 0.5), (-0.6, 0.0)], goal=[]
    ),
    "two hands, one box": random_tumbling(3).replaced(goal=()),
    "four hands, one box": random_tumbling(4, hands=4).replaced(goal=()),
}


def walk(compilation: Compilation, rng: random.Random, length: int) -> list[PlannedAction]:
    """Return a sequence of random applicable actions after which no instance is incomplete."""
    facts = set(compilation.problem.init)
    wanted = {fact for fact in compilation.problem.goal if fact[0] not in ("inside", "posture")}
    actions: list[PlannedAction] = []
    best: list[PlannedAction] = []
    for _ in range(length):
        operators = list(compilation.problem.domain.operators)
        rng.shuffle(operators)
        index = FactIndex(sorted(facts))
        chosen = (
            choose_instance(operator, index, ranges_of(compilation.problem, operator), rng) for operator in operators
        )
        found = next(filter(None, chosen), None)
        if found is None:
            break
        operator, binding = found
        facts = operator.effects(binding, facts)
        actions.append(PlannedAction(operator.name, tuple(binding[variable] for variable, _ in operator.parameters)))
        if wanted <= facts:
            best = list(actions)
    return best


def ranges_of(problem: PlanningProblem, operator: Operator) -> dict[str, list[str]]:
    """Return a dictionary that maps each variable of an operator to the objects of its type."""
    parents = dict(problem.domain.types)
    kinds: dict[str, set[str]] = {}
    for name, kind in (*problem.objects, *problem.domain.constants):
        for wide in lineage(kind, parents):
            kinds.setdefault(wide, set()).add(name)
    return {variable: sorted(kinds.get(kind, ())) for variable, kind in operator.parameters}


def choose_instance(
    operator: Operator, index: FactIndex, ranges: dict[str, list[str]], rng: random.Random
) -> tuple[Operator, dict[str, str]] | None:
    """Return a random applicable instance of the operator."""
    conditions = operator.precondition
    seeds = [fact for fact in sorted(index.facts) if fact[0].startswith("in-")]
    rng.shuffle(seeds)
    for seed in seeds:
        for condition in conditions:
            if condition[0] == seed[0]:
                start = bind_condition(condition, seed, {}, ranges)
                binding = None if start is None else next(join(conditions, start, index, ranges), None)
                if binding is not None:
                    return operator, binding
    return None


def with_goal(task: Task, actions: list[PlannedAction]) -> Task:
    """Return the task with the effects of the walk as its goal."""
    compilation = compile_task(task)
    reached: dict[str, Atom] = {}
    for action in actions:
        meaning = compilation.encoded.meanings[action.name]
        if action.name.startswith(("begin-rolling", "begin-tipping")):
            predicate, value = ("inside", "region") if "region" in meaning.roles else ("posture", "outcome")
            thing, there = (compilation.words.user(action.arguments[meaning.roles[role]]) for role in ("object", value))
            reached[thing] = Atom(predicate, (thing, there))
    return task.replaced(goal=tuple(reached.values()))


def broken(plan: TaskPlan, rng: random.Random) -> TaskPlan:
    """Return the plan with an instance dropped, duplicated, or exchanged in its times or tokens."""
    instances = list(plan.instances)
    first, second = rng.randrange(len(instances)), rng.randrange(len(instances))
    one, other = instances[first], instances[second]
    kind = rng.choice(["drop", "double", "swap times", "swap tokens", "swap targets", "shift"])
    if kind == "drop":
        del instances[first]
    elif kind == "double":
        instances.append(replace(one, name=one.name + "'"))
    elif kind == "swap times":
        instances[first], instances[second] = one.during(other.start, other.end), other.during(one.start, one.end)
    elif kind == "swap tokens" and one.block == other.block:
        instances[first], instances[second] = replace(one, slots=other.slots), replace(other, slots=one.slots)
    elif kind == "swap targets" and one.block == other.block:
        instances[first], instances[second] = replace(one, targets=other.targets), replace(other, targets=one.targets)
    elif kind == "shift":
        instances[first] = one.during(one.start + 0.05, one.end + 0.05)
    return TaskPlan(tuple(sorted(instances, key=lambda i: (i.start, i.end, i.name))), plan.makespan)


@pytest.mark.parametrize("name", TASKS)
@pytest.mark.parametrize("seed", range(8))
def test_law_and_val_agree(name: str, seed: int, tmp_path: Path) -> None:
    rng = random.Random(f"{name} {seed}")
    actions = walk(compile_task(TASKS[name]), rng, 40)
    task = with_goal(TASKS[name], actions)
    compilation = compile_task(task)
    plan = schedule(task, decode(compilation, actions))
    assert check_law(task, plan) == []
    assert val_accepts(tmp_path, compilation.problem, actions)
    assert val_accepts(tmp_path, compilation.problem, reencode(compilation, plan))
    for _ in range(12):
        mutant = broken(plan, rng)
        lawful = not [v for v in check_law(task, mutant) if v.law != 6]
        accepted = val_accepts(tmp_path, compilation.problem, reencode(compilation, mutant))
        assert lawful == accepted, (check_law(task, mutant), reencode(compilation, mutant), mutant)


@pytest.mark.parametrize("name", TASKS)
@pytest.mark.parametrize("seed", range(4))
def test_val_accepts_every_lawful_timeline_as_a_temporal_plan(name: str, seed: int, tmp_path: Path) -> None:
    rng = random.Random(f"{name} {seed}")
    actions = walk(compile_task(TASKS[name]), rng, 40)
    task = with_goal(TASKS[name], actions)
    plan = schedule(task, decode(compile_task(task), actions))
    problem, timed = reencode_durative(compile_durative(task), plan)
    assert val_accepts_temporal(tmp_path, problem, timed), timed


@pytest.mark.parametrize("hands", [2, 4])
def test_law_and_val_agree_on_whole_tumbles(hands: int, tmp_path: Path) -> None:
    """Random walks seldom continue after the first tip of a box, but the plan of a planner does."""
    task = random_tumbling(3, hands=hands)
    compilation = compile_task(task)
    with PlannerProcess() as planner:
        actions = planner.solve(compilation.problem, task.planner, task.limits).actions
    plan = schedule(task, decode(compilation, actions))
    assert check_law(task, plan) == []
    assert val_accepts(tmp_path, compilation.problem, reencode(compilation, plan))
    rng = random.Random(hands)
    for _ in range(60):
        mutant = broken(plan, rng)
        lawful = not [v for v in check_law(task, mutant) if v.law != 6]
        accepted = val_accepts(tmp_path, compilation.problem, reencode(compilation, mutant))
        assert lawful == accepted, (check_law(task, mutant), reencode(compilation, mutant), mutant)


def _instance(plan: TaskPlan, block: str) -> BlockInstance:
    return next(i for i in plan.instances if i.block == block)


def _replaced(plan: TaskPlan, old: BlockInstance, *new: BlockInstance) -> TaskPlan:
    return TaskPlan((*(i for i in plan.instances if i is not old), *new), plan.makespan)


@pytest.fixture
def lawful() -> tuple[Task, TaskPlan]:
    task = rolling_task(hands=2)
    compilation = compile_task(task)
    actions: list[PlannedAction] = [
        read_action("(begin-reaching-behind-from-resting hand-0 drum-0 region-0 none-reading n1)"),
        read_action("(fill-rolling-hand-from-reaching-behind hand-0 drum-0 region-0 n1 none-reading)"),
        read_action("(begin-rolling-from-resting drum-0 region-0 no-region-of-within)"),
        read_action("(begin-resting-from-rolling drum-0)"),
        read_action("(leave-rolling-hand-to-resting hand-0 drum-0)"),
    ]
    plan = schedule(task, decode(compilation, actions))
    assert check_law(task, plan) == []
    return task, plan


def laws(task: Task, plan: TaskPlan) -> set[int]:
    return {violation.law for violation in check_law(task, plan)}


def test_law_1_a_token_is_always_in_exactly_one_slot(lawful: tuple[Task, TaskPlan]) -> None:
    task, plan = lawful
    idle = next(i for i in plan.instances if i.slots == {"token": "hand 1"})
    assert 1 in laws(task, _replaced(plan, idle))
    assert 1 in laws(task, _replaced(plan, idle, idle, replace(idle, name="RESTING-9")))


def test_law_2_every_slot_has_one_token_of_its_class(lawful: tuple[Task, TaskPlan]) -> None:
    task, plan = lawful
    rolling = _instance(plan, "ROLLING")
    assert 2 in laws(task, _replaced(plan, rolling, replace(rolling, slots={"object": "drum 0"})))
    swapped = {"hand": "drum 0", "object": "hand 0"}
    assert 2 in laws(task, _replaced(plan, rolling, replace(rolling, slots=swapped)))


def test_law_3_tokens_pass_along_edges_only(lawful: tuple[Task, TaskPlan]) -> None:
    task, plan = lawful
    reaching = _instance(plan, "REACHING:behind")
    waiting = BlockInstance("RESTING-9", "RESTING", {"token": "hand 0"}, reaching.start, reaching.end)
    assert 3 in laws(task, _replaced(plan, reaching, waiting))


def test_law_4_tokens_of_an_instance_come_and_go_together(lawful: tuple[Task, TaskPlan]) -> None:
    task, plan = lawful
    rolling = _instance(plan, "ROLLING")
    apart = (
        replace(rolling, slots={"hand": "hand 0"}),
        replace(rolling, slots={"object": "drum 0"}, start=rolling.start + 0.1),
    )
    assert 4 in laws(task, _replaced(plan, rolling, *apart))
    assert 4 in laws(task, _replaced(plan, rolling, rolling.during(rolling.start, rolling.start)))


def test_law_5_conditions_hold_at_each_reassignment(lawful: tuple[Task, TaskPlan]) -> None:
    task, plan = lawful
    reaching = _instance(plan, "REACHING:behind")
    far = task.replaced(state=task.state.replace({("region 0", "position"): (0.7, 0.3, 0.0)}))
    assert 5 in laws(far, plan)
    idle = next(i for i in plan.instances if i.slots == {"token": "hand 1"})
    watching = replace(reaching, name="REACHING-9", slots={"hand": "hand 1"}, start=idle.start + 0.1, end=plan.makespan)
    assert 5 in laws(task, _replaced(plan, idle, idle.during(idle.start, idle.start + 0.1), watching))


def test_law_6_instances_last_within_their_bounds(lawful: tuple[Task, TaskPlan]) -> None:
    task, plan = lawful
    rolling = _instance(plan, "ROLLING")
    shrunk = [
        i.during(min(i.start, rolling.start + 0.01), i.end if i is not rolling else rolling.start + 0.01)
        if i.start >= rolling.start
        else i
        for i in plan.instances
    ]
    assert 6 in laws(task, TaskPlan(tuple(shrunk), plan.makespan))


def test_law_7_the_plan_starts_in_the_task_and_ends_at_the_goal(lawful: tuple[Task, TaskPlan]) -> None:
    task, plan = lawful
    assert 7 in laws(task.replaced(goal=(Atom("inside", ("drum 0", "region 9")),)), plan)
    assert 7 in laws(task.replaced(assignment={"hand 0": "REACHING:behind"}), plan)
    cut = [i.during(i.start, min(i.end, _instance(plan, "ROLLING").end)) for i in plan.instances if i.start < 6]
    assert 7 in laws(task, TaskPlan(tuple(cut), _instance(plan, "ROLLING").end))

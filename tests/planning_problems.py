"""Small and random planning problems, and a search for shortest plans to check planners."""

import random
from collections import deque
from collections.abc import Iterator
from itertools import product

from hybrid_tamp.model.plan import PlannedAction
from hybrid_tamp.symbolic.pddl.operators import Fact, Operator, PlanningDomain, PlanningProblem

# Boxes move along roads. Only a marked box can be grabbed, and no operator marks one.
DELIVERY = PlanningDomain(
    name="delivery",
    types=(("thing", "object"), ("box", "thing"), ("place", "object")),
    constants=(("home", "place"),),
    predicates=(
        ("at", (("?box", "box"), ("?place", "place"))),
        ("road", (("?from", "place"), ("?to", "place"))),
        ("marked", (("?box", "box"),)),
        ("done", ()),
    ),
    operators=(
        Operator(
            "move",
            (("?box", "box"), ("?from", "place"), ("?to", "place")),
            precondition=(("at", "?box", "?from"), ("road", "?from", "?to")),
            add=(("at", "?box", "?to"),),
            delete=(("at", "?box", "?from"),),
        ),
        Operator("grab", (("?box", "box"),), (("at", "?box", "home"), ("marked", "?box")), (("done",),), ()),
    ),
    comments=(("home", "Home"), ("box", "BOX")),
)

DELIVER = PlanningProblem(
    name="deliver",
    domain=DELIVERY,
    objects=(("first", "box"), ("yard", "place"), ("shop", "place")),
    init=(("at", "first", "home"), ("road", "home", "yard"), ("road", "yard", "shop"), ("road", "shop", "home")),
    goal=(("at", "first", "shop"),),
)
DELIVERED = (PlannedAction("move", ("first", "home", "yard")), PlannedAction("move", ("first", "yard", "shop")))

# This goal is unreachable even without deletions.
UNREACHABLE = PlanningProblem("unreachable", DELIVERY, DELIVER.objects, DELIVER.init, (("done",),))

# A box cannot be at two places. The translator of Fast Downward finds this.
EXCLUSIVE = PlanningProblem(
    "exclusive", DELIVERY, DELIVER.objects, DELIVER.init, (("at", "first", "shop"), ("at", "first", "yard"))
)

TURNING = PlanningDomain(
    name="turning",
    types=(("tile", "object"), ("cell", "object")),
    constants=(),
    predicates=(
        ("on", (("?tile", "tile"), ("?cell", "cell"))),
        ("row", (("?first", "cell"), ("?second", "cell"), ("?third", "cell"))),
    ),
    operators=(
        Operator(
            "turn",
            (*((f"?{tile}", "tile") for tile in "abc"), *((f"?{cell}", "cell") for cell in "xyz")),
            (("row", "?x", "?y", "?z"), ("on", "?a", "?x"), ("on", "?b", "?y"), ("on", "?c", "?z")),
            add=(("on", "?a", "?y"), ("on", "?b", "?z"), ("on", "?c", "?x")),
            delete=(("on", "?a", "?x"), ("on", "?b", "?y"), ("on", "?c", "?z")),
        ),
    ),
)


def _turning(name: str, wanted: str) -> PlanningProblem:
    return PlanningProblem(
        name,
        TURNING,
        objects=tuple((f"t{i}", "tile") for i in range(4)) + tuple((f"c{i}", "cell") for i in range(4)),
        init=tuple(("on", f"t{i}", f"c{i}") for i in range(4))
        + tuple(("row", f"c{i}", f"c{(i + 1) % 4}", f"c{(i + 2) % 4}") for i in range(4)),
        goal=tuple(("on", f"t{tile}", f"c{cell}") for cell, tile in enumerate(wanted)),
    )


TURNED = _turning("turned", "2013")

# A rotation of three tiles is an even permutation, and a swap of two tiles is odd. Only exhaustive search shows this.
ODD = _turning("odd", "1023")

# The only plan deletes and adds the same fact, once with two variables and once with a constant.
MEETING = PlanningProblem(
    "meeting",
    PlanningDomain(
        "meeting",
        (("spot", "object"),),
        (("hub", "spot"),),
        (
            ("lit", (("?s", "spot"),)),
            ("seen", (("?s", "spot"),)),
            ("may", (("?s", "spot"),)),
            ("on", (("?s", "spot"),)),
        ),
        (
            Operator("light", (("?s", "spot"),), (("may", "?s"),), (("lit", "?s"),), ()),
            Operator(
                "pass",
                (("?s", "spot"), ("?t", "spot")),
                (("may", "?t"), ("lit", "?s")),
                (("seen", "?s"), ("lit", "?t")),
                (("lit", "?s"),),
            ),
            Operator("reset", (("?s", "spot"),), (), (("on", "?s"),), (("on", "hub"),)),
        ),
    ),
    objects=(("one", "spot"), ("two", "spot")),
    init=(("may", "one"),),
    goal=(("lit", "one"), ("seen", "one"), ("on", "hub")),
)

# The only operator has a condition that always holds, on a constant.
SETTLED = PlanningProblem(
    "settled",
    PlanningDomain(
        "settled",
        (("spot", "object"), ("wide", "object")),
        (("hub", "wide"),),
        (("open", (("?w", "wide"),)), ("seen", (("?s", "spot"),))),
        (Operator("see", (("?s", "spot"),), (("open", "hub"),), (("seen", "?s"),), ()),),
    ),
    objects=(("one", "spot"),),
    init=(("open", "hub"),),
    goal=(("seen", "one"),),
)


def shortest(problem: PlanningProblem, limit: int = 5000) -> int | None:
    """Return the length of a shortest plan, or None if there is none.

    Raises:
        OverflowError: the search reaches more states than the limit.
    """
    actions = list(_ground(problem))
    first = frozenset(problem.init)
    depth = {first: 0}
    queue = deque([first])
    while queue:
        state = queue.popleft()
        if state.issuperset(problem.goal):
            return depth[state]
        for precondition, add, delete in actions:
            following = (state - delete) | add
            if precondition <= state and following not in depth:
                depth[following] = depth[state] + 1
                queue.append(following)
        if len(depth) > limit:
            raise OverflowError(problem.name)
    return None


def random_problem(seed: int) -> PlanningProblem:
    """Return a problem with few objects, nested types, constants, static facts, and effects on the same fact."""
    rng = random.Random(seed)
    types = (("t0", "object"), ("t1", "t0"), ("t2", "object"))
    constants = (("k0", "t0"),) * rng.randint(0, 1)
    objects = tuple((name, rng.choice(["t0", "t1", "t2"])) for name in "abcd"[: rng.randint(2, 4)])
    kinds = ["t0", "t0", "t1", "t2", "object"]
    predicates = tuple(
        (f"q{i}", tuple((f"?x{j}", rng.choice(kinds)) for j in range(rng.choice([0, 1, 1, 2, 2])))) for i in range(4)
    )
    domain = PlanningDomain("random", types, constants, predicates, ())
    operators = tuple(
        operator for i in range(rng.randint(2, 4)) for operator in _random_operators(rng, domain, f"o{i}")
    )
    domain = PlanningDomain("random", types, constants, predicates, operators)
    facts = list(_facts(domain, constants + objects))
    goal = tuple(rng.sample(facts, min(len(facts), rng.randint(1, 3))))
    return PlanningProblem(f"random-{seed}", domain, objects, tuple(f for f in facts if rng.random() < 0.3), goal)


def _random_operators(rng: random.Random, domain: PlanningDomain, name: str) -> Iterator[Operator]:
    """Yield one random operator, or none if there are no facts to change."""
    # Parameters may have the names of objects and constants.
    parameters = tuple(
        (variable, rng.choice(["t0", "t1", "t2"])) for variable in ("?a", "?k0", "?z")[: rng.randint(0, 3)]
    )
    facts = list(_facts(domain, domain.constants + parameters))
    changing = [fact for fact in facts if fact[0] != "q0"]
    if changing:
        some = [rng.sample(pool, min(len(pool), rng.randint(low, 2))) for pool, low in ((facts, 0), (changing, 1))]
        delete = rng.sample(changing, min(len(changing), rng.randint(0, 2)))
        yield Operator(name, parameters, tuple(some[0]), tuple(some[1]), tuple(delete))


def _facts(domain: PlanningDomain, things: tuple[tuple[str, str], ...]) -> Iterator[Fact]:
    for name, parameters in domain.predicates:
        for values in product(*([each for each, kind in things if _within(domain, kind, p)] for _, p in parameters)):
            yield (name, *values)


def _ground(problem: PlanningProblem) -> Iterator[tuple[frozenset[Fact], frozenset[Fact], frozenset[Fact]]]:
    domain = problem.domain
    things = domain.constants + problem.objects
    for operator in domain.operators:
        choices = ([each for each, kind in things if _within(domain, kind, p)] for _, p in operator.parameters)
        for values in product(*choices):
            bound = dict(zip(dict(operator.parameters), values, strict=True))
            parts = (operator.precondition, operator.add, operator.delete)
            pre, add, delete = (frozenset(tuple(bound.get(a, a) for a in fact) for fact in part) for part in parts)
            yield pre, add, delete


def _within(domain: PlanningDomain, narrow: str, wide: str) -> bool:
    parents = dict(domain.types)
    while narrow != wide and narrow in parents:
        narrow = parents[narrow]
    return narrow == wide

"""Random tasks that need chains of movements. All tasks have plans, as the search in `oracle` has confirmed."""

import numpy as np
from hybrid_tamp_domains.rolling_tumbling import DOMAIN
from numpy.typing import ArrayLike

from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import MidLevel, Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.skills import Region
from random_tasks.small_rolling import Given, place_drum, random_drum, relay_hands, roller
from random_tasks.small_tools import hammer_scene, turned
from random_tasks.small_tumbling import cubelike, random_box, slender, tumbling_task

_FLOOR = np.array([1.0, 1.0, 0.0])
_QUICK = MidLevel(evaluations=100)
_STRUCK = Atom("struck", ("block",))


def chain_rolls(seed: int) -> Task:
    """Return a task in which one hand rolls two drums.

    The drums are drawn by `random_drum`. They lie 1.0 to 1.3 m apart and roll 0.3 to 0.8 m in the direction of +x.
    After this roll, the demonstrated reach first moves the hand away from the drum. After other rolls, the hand may hit
    the drum.
    """
    rng = np.random.default_rng(seed)
    drum, other, given = random_drum(rng, "drum"), random_drum(rng, "other"), Given()
    along, across = np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])
    aside = across * rng.choice((-1.0, 1.0)) * rng.uniform(1.0, 1.3)
    places = {}
    for token, start, name in ((drum, np.zeros(3), "goal"), (other, aside, "other goal")):
        place_drum(given, token, start, 0.0)
        places[name] = start + along * rng.uniform(0.3, 0.8)
    hands = [(roller("hand"), -along * rng.uniform(0.5, 0.8) + aside / 2 + np.array([0.0, 0.0, rng.uniform(0.2, 0.5)]))]
    wanted = {"drum": "goal", "other": "other goal"}
    return _rolling(f"chain_rolls_{seed}", seed, [drum, other], places, wanted, hands, given)


def relay_rolls(seed: int) -> Task:
    """Return a task in which two hands roll a drum in turn, by 0.9 to 1.2 m along x or y.

    Both hands push from the same side. The second hand must go where the first hand stays, so the first hand must give
    way.
    """
    rng = np.random.default_rng(seed)
    drum, given = random_drum(rng, "drum"), Given()
    yaw = float(rng.choice(np.pi / 2 * np.arange(4)))
    along = np.array([np.cos(yaw), np.sin(yaw), 0.0])
    start, far = np.zeros(3), along * rng.uniform(0.9, 1.2)
    middle = far * rng.uniform(0.45, 0.55)
    place_drum(given, drum, start, yaw)
    places = {"goal": far, "middle": middle}
    hands = relay_hands(rng, along, start, middle, far)
    return _rolling(f"relay_rolls_{seed}", seed, [drum], places, {"drum": "goal"}, hands, given)


def _rolling(
    name: str,
    seed: int,
    drums: list[Token],
    places: dict[str, FloatArray],
    wanted: dict[str, str],
    hands: list[tuple[Token, FloatArray]],
    given: dict[tuple[str, str], ArrayLike],
) -> Task:
    regions = [Token.make(each, [Region], {"radius": 0.03}) for each in places]
    given = given | {(each, "position"): place * _FLOOR for each, place in places.items()}
    given |= {(hand.name, "position"): place for hand, place in hands}
    tokens = (*drums, *regions, *(hand for hand, _ in hands))
    goal = tuple(Atom("inside", pair) for pair in wanted.items())
    return Task(name, DOMAIN, tokens, State.of(tokens, given), goal, seed=seed, midlevel=_QUICK)


def tumble_tumble(seed: int) -> Task:
    """Return a task with two tumbles: about one axis in odd seeds, and about two axes in even seeds.

    Two hands turn a box with edges of 0.22 to 0.39 m upside down. In even seeds, the box is too slender to be tumbled
    directly onto the wanted face, so another pair of hands first tumbles the box about the second axis. Mass U(8, 14)
    kg, friction U(0.5, 0.9). The box is displaced by up to 2 cm and 3 degrees.
    """
    rng = np.random.default_rng(seed)
    axis = str(rng.choice(("x", "y")))
    other = "x" if axis == "y" else "y"
    name = f"tumble_tumble_{seed}"
    if seed % 2:
        task = tumbling_task(name, seed, rng, random_box(rng, "box", cubelike(rng)), [axis, axis], "top")
        return task.replaced(midlevel=_QUICK)
    face = str(rng.choice(("right", "left") if axis == "y" else ("back", "front")))
    box = random_box(rng, "box", slender(rng, axis))
    task = tumbling_task(name, seed, rng, box, [axis, axis, other, other], face)
    return task.replaced(midlevel=_QUICK)


def push_push(seed: int) -> Task:
    """Return a task in which a block is pushed round a corner.

    The block needs two pushes of 0.2 to 0.5 m, because no side of the block is perpendicular to the line from the start
    to the goal. One region is at the corner, and a second region is of no use. Mass U(1, 2.5) kg. The pushes are along
    x and y. In oblique directions, Bullet's friction on the floor would turn a thin block too far for the second push.
    """
    rng = np.random.default_rng(seed)
    yaw, side = float(rng.choice(np.pi / 2 * np.arange(4))), float(rng.choice((-1.0, 1.0)))
    ahead, aside = rng.uniform(0.2, 0.5), side * rng.uniform(0.2, 0.5)
    askew = rng.uniform(0.3, 0.5) * np.array([-np.cos(np.radians(25.0)), side * np.sin(np.radians(25.0))])
    places = {"goal": (ahead, aside), "middle": (ahead, 0.0), "decoy": askew}
    return _hammer(f"push_push_{seed}", seed, rng, yaw, {"block": (0.0, 0.0)}, places, {"block": "goal"}, side)


def push_strike(seed: int) -> Task:
    """Return a task in which a block is pushed 0.2 to 0.6 m to a region, and is struck."""
    rng = np.random.default_rng(seed)
    yaw, side = float(rng.uniform(-np.pi, np.pi)), float(rng.choice((-1.0, 1.0)))
    places = {"goal": (rng.uniform(0.2, 0.6), 0.0)}
    task = _hammer(f"push_strike_{seed}", seed, rng, yaw, {"block": (0.0, 0.0)}, places, {"block": "goal"}, side)
    return task.replaced(goal=(_STRUCK, *task.goal))


def carry_push(seed: int) -> Task:
    """Return a task in which a hand pushes a block, carries the tool 0.5 to 0.8 m aside, and pushes another."""
    rng = np.random.default_rng(seed)
    yaw, side = float(rng.uniform(-np.pi, np.pi)), float(rng.choice((-1.0, 1.0)))
    apart = side * rng.uniform(0.5, 0.8)
    blocks = {"block": (0.0, 0.0), "other": (0.0, apart)}
    places = {"goal": (rng.uniform(0.2, 0.5), 0.0), "other goal": (rng.uniform(0.2, 0.5), apart)}
    wanted = {"block": "goal", "other": "other goal"}
    return _hammer(f"carry_push_{seed}", seed, rng, yaw, blocks, places, wanted, side)


def _hammer(
    name: str,
    seed: int,
    rng: np.random.Generator,
    yaw: float,
    blocks: dict[str, tuple[float, float]],
    places: dict[str, ArrayLike],
    wanted: dict[str, str],
    side: float,
) -> Task:
    """Return a task with a hammer. Positions are relative to the heading of the first block.

    The hammer stands behind the first block, where it does not obstruct any push.
    """
    return hammer_scene(
        name,
        seed,
        {block: (turned(yaw, place), yaw) for block, place in blocks.items()},
        {each: turned(yaw, np.asarray(place, dtype=float)) for each, place in places.items()},
        [Atom("inside", pair) for pair in wanted.items()],
        rack=turned(yaw, (-rng.uniform(0.3, 0.4), -side * rng.uniform(0.15, 0.25))),
        facing=float(rng.uniform(-np.pi, np.pi)),
        mass=float(rng.uniform(1.0, 2.5)),
    )


CHAINS = {
    "chain_rolls": chain_rolls,
    "relay_rolls": relay_rolls,
    "push_push": push_push,
    "tumble_tumble": tumble_tumble,
    "push_strike": push_strike,
    "carry_push": carry_push,
}
"""Maps each family of chains to the function that makes its tasks."""

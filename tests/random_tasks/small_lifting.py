"""Small random tasks of joint lifting: loads for two or four hands."""

import numpy as np
from hybrid_tamp_domains.joint_lifting.classes import Liftable

from hybrid_tamp.authoring import DEFAULT_FRICTION
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.constants import GRAVITY
from hybrid_tamp.motion.poses import quaternion_from_rpy
from random_tasks.lifting import random_lifting

KINDS = ("two", "four", "too heavy", "too heavy for four", "same side", "level hand", "flat", "three", "contradiction")


def small_lifting(seed: int, kind: str, rng: np.random.Generator) -> Task:
    """Return a task to lift a box. Kinds other than ``two`` and ``four`` have no plan."""
    hands = 4 if kind in ("four", "too heavy for four", "three") else 2
    task = random_lifting(seed, hands)
    box, state = task.token_by_name["box"], task.state
    changes: dict[str, object] = {}
    if kind.startswith("too heavy"):
        # Friction bears less than this weight even if the hands squeeze with their full force.
        most = hands * 300.0 * DEFAULT_FRICTION * box["friction"] / GRAVITY
        changes["mass"] = float(most * rng.uniform(1.05, 2.0))
    if kind == "flat":
        x, y, _ = box["half_extents"]
        changes["half_extents"] = (x, y, float(rng.uniform(0.02, 0.035)))
    if kind == "same side":
        place = state["hand 1", "position"] + np.array([0.0, 0.25, 0.0])
        state = state.replace({("hand 2", "position"): place})
    if kind == "level hand":
        state = state.replace({("hand 2", "orientation"): quaternion_from_rpy((np.pi / 2, 0.0, 0.0))})
    if "half_extents" in changes:
        state = state.replace({("box", "position"): (0.0, 0.0, changes["half_extents"][2])})  # type: ignore[index]
    own = {name: box[name] for name in ("half_extents", "friction", "mass")}
    lifted = Token.make("box", [Liftable], own | changes)
    tokens = tuple(lifted if token is box else token for token in task.tokens)
    goal = (*task.goal, *((Atom("stands", ("box",)),) if kind == "contradiction" else ()))
    name = f"proof_{seed}_lifting_{kind.replace(' ', '_')}"
    task = task.replaced(name=name, tokens=tokens, state=state, goal=goal)
    return task.restrict([token.name for token in tokens if token.name != "hand 4"]) if kind == "three" else task

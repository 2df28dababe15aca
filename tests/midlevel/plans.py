"""Plans of rolling, written by hand, for tests of the mid-level planner."""

from hybrid_tamp.model.plan import BlockInstance, TaskPlan
from hybrid_tamp.model.task import Task


def reach_and_roll(task: Task, hand: str = "hand 0", drum: str = "drum 0", region: str = "region 0") -> TaskPlan:
    """Return the plan in which a hand rolls a drum to a region, and all other tokens rest."""
    ways = {"object": drum, "region": region}
    instances = [
        BlockInstance("RESTING-1", "RESTING", {"token": hand}, 0.0, 0.1),
        BlockInstance("RESTING-2", "RESTING", {"token": drum}, 0.0, 3.0),
        BlockInstance("REACHING-1", "REACHING:behind", {"hand": hand}, 0.1, 3.0, ways),
        BlockInstance("ROLLING-1", "ROLLING", {"hand": hand, "object": drum}, 3.0, 6.0, {"region": region}),
        BlockInstance("RESTING-3", "RESTING", {"token": hand}, 6.0, 6.1),
        BlockInstance("RESTING-4", "RESTING", {"token": drum}, 6.0, 6.1),
    ]
    others = [token.name for token in task.assigned if token.name not in (hand, drum)]
    instances += [BlockInstance(f"RESTING-{5 + n}", "RESTING", {"token": t}, 0.0, 6.1) for n, t in enumerate(others)]
    return TaskPlan(tuple(instances), 6.1)

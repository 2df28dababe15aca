"""The verb ``planners``: list the planning engines."""

from hybrid_tamp.model.listings import InstalledEngine
from hybrid_tamp.symbolic.engines.installed import list_engines
from hybrid_tamp.symbolic.engines.registry import known_engines


def planner_names() -> tuple[str, ...]:
    """Return the names of the planning engines, with the default engine first."""
    return known_engines()


def list_planners() -> list[InstalledEngine]:
    """Return the planning engines, with the default engine first."""
    return list_engines()

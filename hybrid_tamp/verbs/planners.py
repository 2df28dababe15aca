"""The verb ``planners``: list the planning engines."""

from hybrid_tamp.model.listings import InstalledEngine
from hybrid_tamp.symbolic.engines.installed import list_engines


def list_planners() -> list[InstalledEngine]:
    """Return the planning engines, with the default engine first."""
    return list_engines()

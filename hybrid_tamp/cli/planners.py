"""The verb ``planners``."""

from hybrid_tamp.cli import options
from hybrid_tamp.cli.console import say


def planners(as_json: options.Json = False) -> None:
    """List the planning engines, and how to install others.

    Example: hybrid-tamp planners
    """
    from hybrid_tamp.report.listings import planners_document, planners_table
    from hybrid_tamp.verbs.planners import list_planners

    found = list_planners()
    say(planners_document(found), as_json, lambda: planners_table(found))

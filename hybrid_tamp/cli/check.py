"""The verb ``check``."""

from hybrid_tamp.cli import options
from hybrid_tamp.cli.console import say


def check(task: options.Task, as_json: options.Json = False, domain: options.Domain = None) -> None:
    """Check a task file, and report every fault with its place.

    Example: hybrid-tamp check my_task.yaml
    """
    from hybrid_tamp.verbs.check import check as check_task
    from hybrid_tamp.verbs.loading import Settings

    checked = check_task(task, Settings(domain))
    summary = {
        "schema": "hybrid-tamp/check/1",
        "task": checked.name,
        "domain": checked.domain.name,
        "tokens": len(checked.tokens),
        "goal": [atom.text for atom in checked.goal],
        "status": "ok",
    }
    text = f"{checked.source}: ok, {len(checked.tokens)} tokens in the domain {checked.domain.name}"
    say(summary, as_json, lambda: text)

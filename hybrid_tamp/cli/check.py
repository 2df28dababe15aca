"""The verb ``check``."""

from hybrid_tamp.cli.console import say
from hybrid_tamp.cli.options import DomainOption, JsonOption, TaskArgument


def check(task: TaskArgument, as_json: JsonOption = False, domain: DomainOption = None) -> None:
    """Check a task file: every fault at once, each with its place and what would be right."""
    from hybrid_tamp.verbs.check import check as check_task
    from hybrid_tamp.verbs.loading import Settings

    checked = check_task(task, Settings(domain=domain))
    summary = {
        "schema": "hybrid-tamp/check/1",
        "task": checked.name,
        "domain": checked.domain.name,
        "tokens": len(checked.tokens),
        "goal": [atom.text for atom in checked.goal],
        "status": "ok",
    }
    say(summary, as_json, lambda: f"{checked.source}: ok, {len(checked.tokens)} tokens of {checked.domain.name}")

"""The verb ``affordances``: find which objects afford which blocks, and the effect of adding or removing a token."""

from collections.abc import Sequence
from pathlib import Path

from hybrid_tamp.errors import InputError, Issue
from hybrid_tamp.model.affordances import Affordance, AffordanceResult, View
from hybrid_tamp.model.task import Task
from hybrid_tamp.questions.affordances.perspectives import find_affordances, observer
from hybrid_tamp.questions.affordances.what_if import answer_what_if
from hybrid_tamp.verbs.loading import Settings, load


def affordances(
    source: Task | Path | str,
    settings: Settings = Settings(),  # noqa: B008
    *,
    view: View = "environment",
    agent: str | None = None,
    questions: Sequence[str] = (),
) -> AffordanceResult:
    """Find which objects afford which blocks, and the effect of each proposed change.

    Args:
        source: a task, the path of a task file, or the name of a bundled task.
        settings: settings that override the task file.
        view: the perspective: ``environment``, ``agent``, ``observer`` or ``team``.
        agent: name of an agent. If given, only affordances for this agent or a group with this agent are returned.
        questions: proposed changes. ``+CLASS`` adds a token of the class, and ``-TOKEN`` removes the token.

    Raises:
        InputError: the task file is wrong, the agent is unknown, or a question is neither ``+CLASS`` nor ``-TOKEN``.
    """
    task = load(source, settings)
    _check_agents(task, view, agent)

    def find(changed: Task) -> list[Affordance]:
        return find_affordances(changed, view, agent)

    found = find(task)
    implied = observer(task)[1] if view == "observer" else []
    answers = [answer_what_if(task, question, found, find) for question in questions]
    return AffordanceResult(task, view, tuple(found), tuple(implied), tuple(answers))


def _check_agents(task: Task, view: View, agent: str | None) -> None:
    """Raise `InputError` if the agent is unknown, or if the view needs an agent but the task has no agents."""
    if agent is not None and agent not in task.agents:
        raise InputError([Issue("agent", f"must be an agent of the task {task.name}", repr(agent), tuple(task.agents))])
    if view != "environment" and not task.agents:
        wanted = f"the {view} view needs an agent, but the task {task.name} has no agents"
        raise InputError([Issue("view", wanted, remedy="list each agent's capability tokens under 'agents:'")])

"""The verb ``affordances``: which object affords which block, to whom, and what one token more or less would change."""

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
    """Find which object affords which block in a perspective, and what each question changes.

    Args:
        source: a task, the path of a task file, or the name of a bundled task.
        settings: what replaces what the file says.
        view: the perspective.
        agent: only what this agent, or a group with it, is afforded; everybody by default.
        questions: what if there were one token more or less: ``+CLASS`` or ``-TOKEN``.

    Raises:
        InputError: the task file is wrong, there is no such agent, or a question has another form.
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
    """Check that the task has the agents that a view needs.

    Raises:
        InputError: it has none, or not the one that is named.
    """
    if agent is not None and agent not in task.agents:
        raise InputError([Issue("agent", f"unknown agent in the task {task.name}", repr(agent), tuple(task.agents))])
    if view != "environment" and not task.agents:
        wanted = f"the {view} view needs an agent, and the task {task.name} names none"
        raise InputError([Issue("view", wanted, remedy="say under 'agents:' whose the capability tokens are")])

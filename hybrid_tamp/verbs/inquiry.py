"""Questions about a task, and their answers as documents: beside the pipeline, above the verbs."""

from collections.abc import Callable, Iterable, Sequence
from typing import Literal

from hybrid_tamp.errors import InputError, Issue
from hybrid_tamp.model.explanation import Link
from hybrid_tamp.model.task import Task
from hybrid_tamp.planning.plan import plan
from hybrid_tamp.questions.affordances import perspectives
from hybrid_tamp.questions.affordances.perspectives import Affordance, Implication
from hybrid_tamp.questions.affordances.what_if import asked
from hybrid_tamp.questions.explain.causal_links import causes
from hybrid_tamp.report.affordance_documents import (
    AffordanceEntry,
    AffordancesDocument,
    ExplainDocument,
    ImplicationEntry,
    LinkEntry,
    TokenEntry,
    WhatIfEntry,
)
from hybrid_tamp.symbolic.strategies.stage import Planner
from hybrid_tamp.verbs.explaining import explained

View = Literal["environment", "agent", "observer", "team"]


def explain_task(task: Task, planner: Planner, seconds: float, most: int) -> tuple[ExplainDocument, int]:
    """Return why a task has the plan that it has, or why it has none; and the exit status of planning it.

    Args:
        task: the task.
        planner: a running planner process.
        seconds: how long single changes are looked for [s].
        most: how many are enough.

    Raises:
        InputError: the engine is unknown or not installed.
    """
    outcome = plan(task, planner, suggesting=0.0)
    document = outcome.document
    explanation = document.explanation
    if document.status == "unsolvable" and explanation is not None:
        explanation = explained(task, explanation.kind, explanation.message, True, seconds, most)
    tokens = [
        TokenEntry(token=c.token, used=c.used, why=c.why, links=list(map(_link_entry, c.links)))
        for c in (causes(outcome.chosen or task, outcome.plan) if outcome.plan else ())
    ]
    answer = ExplainDocument(
        task=task.name, domain=task.domain.name, status=document.status, explanation=explanation, tokens=tokens
    )
    return answer, 0 if outcome.error is None else outcome.error.exit_status


def _link_entry(link: Link) -> LinkEntry:
    return LinkEntry(instance=link.instance, atom=link.atom.text, needed_by=link.needed_by_text)


def affordances(task: Task, view: View, agent: str | None, questions: Sequence[str]) -> AffordancesDocument:
    """Return which object affords which block in a perspective, and what each question changes.

    Args:
        task: the task.
        view: the perspective.
        agent: only what this agent is afforded, or a group with it; everybody where it is None.
        questions: what if there were one token more or less: ``+CLASS`` or ``-TOKEN``.

    Raises:
        InputError: there is no such agent, or a question cannot be understood.
    """
    check_agents(task, view, agent)

    def seen(of: Task) -> list[Affordance]:
        return _seen(of, view, agent)

    before = seen(task)
    return AffordancesDocument(
        task=task.name,
        domain=task.domain.name,
        view=view,
        agents={name: list(tokens) for name, tokens in task.agents.items()},
        affordances=_entries(before),
        implied=[_implied(each) for each in perspectives.observer(task)[1]] if view == "observer" else [],
        what_if=[_what_if(question, before, seen(asked(task, question, seen))) for question in questions],
    )


def check_agents(task: Task, view: View, agent: str | None) -> None:
    """Check that the task has the agents that a view needs.

    Raises:
        InputError: it has none, or not the one that is named.
    """
    if agent is not None and agent not in task.agents:
        raise InputError([Issue("--agent", f"unknown agent in the task {task.name}", repr(agent), tuple(task.agents))])
    if view != "environment" and not task.agents:
        wanted = f"the {view} view needs an agent, and the task {task.name} names none"
        raise InputError([Issue("--view", wanted, remedy="say under 'agents:' whose the capability tokens are")])


def _seen(task: Task, view: View, agent: str | None) -> list[Affordance]:
    views: dict[str, Callable[[Task], list[Affordance]]] = {
        "environment": perspectives.environment,
        "agent": lambda of: [each for name in of.agents for each in perspectives.agent(of, name)],
        "observer": lambda of: perspectives.observer(of)[0],
        "team": perspectives.team,
    }
    return [each for each in views[view](task) if agent is None or not each.agents or agent in each.agents]


def _what_if(question: str, before: Iterable[Affordance], after: Iterable[Affordance]) -> WhatIfEntry:
    old, new = ({each.key: each for each in some} for some in (before, after))
    return WhatIfEntry(
        question=question,
        gained=_entries(each for key, each in new.items() if key not in old),
        lost=_entries(each for key, each in old.items() if key not in new),
    )


def _entries(some: Iterable[Affordance]) -> list[AffordanceEntry]:
    return [
        AffordanceEntry(
            agents=list(one.agents), object=one.thing, block=one.block, slot=one.slot, witness=dict(one.witness)
        )
        for one in some
    ]


def _implied(one: Implication) -> ImplicationEntry:
    (agent,) = one.seen.agents
    return ImplicationEntry(
        seen=agent,
        observer=one.observer,
        object=one.seen.thing,
        block=one.seen.block,
        slot=one.seen.slot,
        holds=bool(one.witness),
        witness=dict(one.witness),
    )

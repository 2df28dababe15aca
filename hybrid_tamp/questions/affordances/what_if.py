"""Affordances that are gained or lost if one token is added (``+CLASS``) or removed (``-TOKEN``)."""

from collections.abc import Callable, Iterable

from hybrid_tamp.errors import InputError, Issue
from hybrid_tamp.model.affordance import is_place
from hybrid_tamp.model.affordances import Affordance, WhatIf
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.questions.changes import apply_change, propose_copies, with_ideal, without_token

FindAffordances = Callable[[Task], list[Affordance]]


def answer_what_if(task: Task, question: str, before: Iterable[Affordance], find: FindAffordances) -> WhatIf:
    """Return the affordances that are gained and lost if one token is added or removed.

    Args:
        task: the task without the change.
        question: ``+CLASS`` or ``-TOKEN``.
        before: the affordances without the change.
        find: function that returns the affordances of a task.

    Raises:
        InputError: if the question has another form, or if the class or the token is unknown.
    """
    old, new = ({each.key: each for each in some} for some in (before, find(change_task(task, question, find))))
    return WhatIf(
        question,
        gained=tuple(each for key, each in new.items() if key not in old),
        lost=tuple(each for key, each in old.items() if key not in new),
    )


def change_task(task: Task, question: str, find: FindAffordances) -> Task:
    """Return the task with the change that a question describes (see `answer_what_if`).

    ``+CLASS`` copies a member of the class, preferably a member that belongs to an agent. The copy belongs to the same
    agent, and gets the position with the most affordances (see `propose_copies`). If the class has no members, the new
    token belongs to no agent, and every feasibility fact about the new token holds.

    Raises:
        InputError: if the question has another form, or if the class or the token is unknown.
    """
    sign, name = question[:1], question[1:].strip()
    if sign == "-":
        if name not in task.token_by_name:
            wanted = f"expected a token of the task {task.name}"
            raise InputError([Issue("questions", wanted, repr(name), tuple(sorted(task.token_by_name)))])
        return without_token(task, task.token_by_name[name])
    if sign != "+":
        remedy = "write '+CLASS' to add a token of a class, or '-TOKEN' to remove a token"
        raise InputError([Issue("questions", "a question must begin with + or -", repr(question), remedy=remedy)])
    classes = {each.name: each for each in task.domain.classes if not is_place(each)}
    if name not in classes:
        wanted = f"expected an object class of the domain {task.domain.name}"
        raise InputError([Issue("questions", wanted, repr(name), tuple(sorted(classes)))])
    members = [each for each in task.values_of(classes[name]) if isinstance(each, Token)]
    if not members:
        return with_ideal(task, classes[name])
    # Prefer a member that belongs to an agent. Then the agent gets the copy, otherwise no agent does.
    owned = {token for tokens in task.agents.values() for token in tokens}
    members.sort(key=lambda token: token.name not in owned)
    more = [apply_change(task, change) for change in propose_copies(task, members[0])]
    return max(more, key=lambda changed: len(find(changed)))

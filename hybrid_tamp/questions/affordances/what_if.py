"""A task with one token more or less, as a question asks for: ``+CLASS`` or ``-TOKEN``."""

from collections.abc import Callable

from hybrid_tamp.errors import InputError, Issue
from hybrid_tamp.model.affordance import is_place
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.questions.affordances.perspectives import Affordance
from hybrid_tamp.questions.changes import apply_change, more_tokens, with_ideal, without_token

View = Callable[[Task], list[Affordance]]


def asked(task: Task, question: str, view: View) -> Task:
    """Return the task that a question is about.

    One more token is a copy of the first one of its class, for the same agent, beside it or across from it, where the
    view gains most. Of a class without members it is one that is as able as it takes, of no agent.

    Args:
        task: the task.
        question: ``+CLASS`` or ``-TOKEN``.
        view: what is looked at.

    Raises:
        InputError: the question is no such question, or there is no such class or token.
    """
    sign, name = question[:1], question[1:].strip()
    if sign == "-":
        return without_token(task, _token(task, name))
    if sign != "+":
        remedy = "ask for one more token of a class, '+CLASS', or for one less, '-TOKEN'"
        raise InputError([Issue("--what-if", "a question begins with + or -", repr(question), remedy=remedy)])
    classes = {each.name: each for each in task.domain.classes if not is_place(each)}
    if name not in classes:
        wanted = f"unknown class of things in the domain {task.domain.name}"
        raise InputError([Issue("--what-if", wanted, repr(name), tuple(sorted(classes)))])
    members = [each for each in task.values_of(classes[name]) if isinstance(each, Token)]
    if not members:
        return with_ideal(task, classes[name])
    # An agent's token first: whatever belongs to nobody acts for nobody.
    owned = {token for tokens in task.agents.values() for token in tokens}
    members.sort(key=lambda token: token.name not in owned)
    more = [apply_change(task, change) for change in more_tokens(task, members[0])]
    return max(more, key=lambda changed: len(view(changed)))


def _token(task: Task, name: str) -> Token:
    if name not in task.token_by_name:
        wanted = f"unknown token in the task {task.name}"
        raise InputError([Issue("--what-if", wanted, repr(name), tuple(sorted(task.token_by_name)))])
    return task.token_by_name[name]

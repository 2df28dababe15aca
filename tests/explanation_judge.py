"""Whether an explanation is right, as brute force and the declarations tell."""

from collections.abc import Collection, Iterator

from brute_force import Key, solvable

from hybrid_tamp.feasibility.reasons import Reason
from hybrid_tamp.model.task import Task
from hybrid_tamp.questions.explain.explanation import Explanation
from hybrid_tamp.questions.explain.repairs import Suggestion


def faults(task: Task, explanation: Explanation, every: Collection[Key]) -> Iterator[str]:
    """Yield what is wrong with an explanation, given the keys of all single repairs."""
    for suggestion in explanation.suggestions:
        change, key = suggestion.change, key_of(suggestion)
        if key not in every:
            yield f"{key} is no single repair"
        if not solvable(change.made()):
            yield f"{change.what}: there is still no plan"
    if every and not explanation.suggestions:
        yield "there are single repairs and none is suggested"
    if every and not any(is_among(task, reason, every) for reason in explanation.reasons):
        yield "no reason is among the single repairs"
    if not explanation.reasons:
        yield "there is no reason"
    for reason in explanation.reasons:
        if not is_true(task, reason):
            yield f"not true: {reason.message}"


def key_of(suggestion: Suggestion) -> Key:
    """Return the key of the repair that is suggested."""
    change = suggestion.change
    return (change.kind, *change.key[: 1 if change.kind in ("token", "fact") else 2])


def is_among(task: Task, reason: Reason, every: Collection[Key]) -> bool:
    """Say whether what a reason complains of is what one of the repairs repairs."""
    for kind, *names in every:
        if kind == "fact" and names[0] == reason.atom:
            return True
        if kind == "property" and reason.atom and names[0] in reason.atom.partition("(")[2].rstrip(")").split(", "):
            return True
        if kind == "edge" and reason.kind == "no_edge" and names[1] == reason.lacks:
            return True
        if kind == "class" and names[1] == reason.lacks:
            return True
        if kind == "token" and reason.lacks in (names[0], *_classes(task, names[0])):
            return True
    return False


def is_true(task: Task, reason: Reason) -> bool:
    """Say whether what a reason says can be read off the task."""
    blocks = [b for b in task.domain.blocks if reason.block in (b.name, b.action, "")]
    if reason.kind == "not_feasible":
        positive = not reason.atom.startswith("not ")
        name, _, rest = reason.atom.removeprefix("not ").partition("(")
        values = [task.token_by_name.get(each, each) for each in rest.rstrip(")").split(", ")]
        margin = float(task.domain.predicate_by_name[name].evaluate(task.state, *values))
        return margin < 0 if positive else margin >= 0
    if reason.kind in ("no_token", "too_few_tokens"):
        have = sum(reason.lacks in _classes(task, token.name) for token in task.tokens)
        needed = max(sum(slot.object_class.name == reason.lacks for slot in block.slots) for block in blocks)
        said = f"{have} of class {reason.lacks}" in reason.message or f"the task has {have}" in reason.message
        return said and (reason.block == "" or have < needed)
    if reason.kind == "no_edge":
        return any(f"{b.name}.{s.name}" == reason.lacks for b in task.domain.blocks for s in b.slots)
    return reason.kind in ("no_block", "together")


def _classes(task: Task, name: str) -> tuple[str, ...]:
    return tuple(member.name for member in task.token_by_name[name].classes) if name in task.token_by_name else ()

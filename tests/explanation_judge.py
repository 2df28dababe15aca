"""Checks of explanations by brute force and by the declarations of the domain."""

from collections.abc import Collection, Iterator

from brute_force import Key, solvable

from hybrid_tamp.model.explanation import Explanation, Reason, Suggestion
from hybrid_tamp.model.task import Task
from hybrid_tamp.questions.changes import apply_change


def faults(task: Task, explanation: Explanation, every: Collection[Key]) -> Iterator[str]:
    """Yield the faults of an explanation, given the keys of all single repairs."""
    for suggestion in explanation.suggestions:
        change, key = suggestion.change, key_of(suggestion)
        if key not in every:
            yield f"{key} does not make the task solvable"
        if not solvable(apply_change(task, change)):
            yield f"{change.what}: the changed task still has no plan"
    if every and not explanation.suggestions:
        yield "single repairs exist, but the explanation suggests none"
    if every and not any(is_among(task, reason, every) for reason in explanation.reasons):
        yield "no single repair removes a stated reason"
    if not explanation.reasons:
        yield "there is no reason"
    for reason in explanation.reasons:
        if not is_true(task, reason):
            yield f"not true: {reason.message}"


def key_of(suggestion: Suggestion) -> Key:
    """Return the key of the suggested repair."""
    change = suggestion.change
    return (change.kind, *change.names[: 1 if change.kind in ("token", "fact") else 2])


def is_among(task: Task, reason: Reason, every: Collection[Key]) -> bool:
    """Return whether one of the repairs removes the obstacle that a reason names."""
    lacks = _lacks(reason)
    for kind, *names in every:
        if reason.atom is not None and kind == "fact" and names[0] == reason.atom.text:
            return True
        if reason.atom is not None and kind == "property" and names[0] in reason.atom.arguments:
            return True
        if kind == "edge" and reason.kind == "no_edge" and names[1] == lacks:
            return True
        if kind == "class" and names[1] == lacks:
            return True
        if kind == "token" and lacks in (names[0], *_classes(task, names[0])):
            return True
    return False


def is_true(task: Task, reason: Reason) -> bool:
    """Return whether a reason is true for the task."""
    blocks = [b for b in task.domain.blocks if reason.block in (b.name, b.action, "")]
    lacks = _lacks(reason)
    if reason.kind == "not_feasible":
        assert reason.atom is not None
        values = [task.token_by_name.get(each, each) for each in reason.atom.arguments]
        margin = float(task.domain.predicate_by_name[reason.atom.predicate].evaluate(task.state, *values))
        return margin < 0 if reason.atom.positive else margin >= 0
    if reason.kind == "unreachable":
        assert reason.atom is not None
        return task.margin(reason.atom) < 0 and not solvable(task.replaced(goal=(reason.atom,)))
    if reason.kind in ("no_token", "too_few_tokens"):
        have = sum(lacks in _classes(task, token.name) for token in task.tokens)
        needed = max(sum(slot.object_class.name == lacks for slot in block.slots) for block in blocks)
        said = f"{have} of class {lacks}" in reason.message or f"the task has {have}" in reason.message
        return said and (reason.block == "" or have < needed)
    if reason.kind == "no_edge":
        return any(f"{b.name}.{s.name}" == lacks for b in task.domain.blocks for s in b.slots)
    return reason.kind in ("no_block", "together")


def _lacks(reason: Reason) -> str:
    lacks = reason.lacks
    return "" if lacks is None else ".".join(lacks) if isinstance(lacks, tuple) else lacks.name


def _classes(task: Task, name: str) -> tuple[str, ...]:
    return tuple(member.name for member in task.token_by_name[name].classes) if name in task.token_by_name else ()

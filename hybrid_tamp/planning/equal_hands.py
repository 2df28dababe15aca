"""Instances that differ from a failing instance only in hands that are equal."""

from collections.abc import Iterator
from dataclasses import replace
from itertools import permutations

from hybrid_tamp.model.plan import BlockInstance
from hybrid_tamp.model.refined import Shortfall
from hybrid_tamp.model.task import Task


def swap_equal_hands(task: Task, failing: BlockInstance, shortfall: Shortfall) -> Iterator[BlockInstance]:
    """Yield a failing instance, and those instances that fail for the same reason with other hands.

    Two tokens with basic actions are equal if their classes, properties and shapes are. The entry conditions of a block
    that moves an object determine where its hands begin. So the movement is the same with equal hands. The reason must
    not involve a hand outside of the instance, because that hand may be elsewhere when the hands are exchanged.

    Args:
        task: task of the instance.
        failing: instance of a block that moves an object.
        shortfall: condition that the instance does not satisfy.
    """
    yield failing
    slots = {slot: name for slot, name in failing.slots.items() if _is_hand(task, name)}
    if any(_is_hand(task, name) and name not in failing.roles.values() for name in shortfall.atom.arguments):
        return
    hands = [token.name for token in task.tokens if token.basic_actions]
    kinds = {name: task.token_by_name[name].fixed for name in hands}
    for chosen in permutations(hands, len(slots)):
        swapped = dict(zip(slots, chosen, strict=True))
        if swapped != slots and all(kinds[swapped[slot]] == kinds[name] for slot, name in slots.items()):
            yield replace(failing, slots={**failing.slots, **swapped})


def _is_hand(task: Task, name: str) -> bool:
    token = task.token_by_name.get(name)
    return token is not None and bool(token.basic_actions)

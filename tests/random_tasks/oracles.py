"""The oracle of each family of scenes with obstacles."""

from collections.abc import Mapping

from hybrid_tamp.model.task import Task
from random_tasks.oracle import Check, Opinion, Scene, ask, check_roll
from random_tasks.oracle_carrying import check_carry
from random_tasks.oracle_hammer import check_hammer
from random_tasks.oracle_tumbling import check_tumble

CHECKS: Mapping[str, Check] = {
    "roll": check_roll,
    "tumble_two": check_tumble,
    "tumble_four": check_tumble,
    "carry_two": check_carry,
    "carry_four": check_carry,
    "hammer": check_hammer,
}
"""Maps each family to what its oracle checks."""


def consult(family: str, task: Task) -> Opinion:
    """Return what the oracle of a family says about a task."""
    return ask(CHECKS[family], task)


def confirm(family: str, task: Task) -> str:
    """Return why a task of a family certainly cannot be solved with the skills, or an empty text."""
    return CHECKS[family](Scene(task, generous=True))

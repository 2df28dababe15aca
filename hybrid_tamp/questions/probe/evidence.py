"""Judgement of membership trials: why a trial failed, and whether a trial is evidence for or against the class."""

from collections.abc import Iterator, Mapping

from hybrid_tamp.model.affordance import TOKEN, ObjectClass
from hybrid_tamp.model.plan import BlockInstance
from hybrid_tamp.model.recording import Recording
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.model.trial import TrialRecipe


def is_evidence(task: Task, recording: Recording, member: Token, object_class: type[ObjectClass]) -> bool:
    """Say whether a run is evidence for or against the class. A run without a failure is always evidence.

    A failed run is evidence if some instance used the token as a member of the class, and if the token fills a slot of
    the failed instance.
    """
    if recording.failure is None:
        return True

    def tries(instance: BlockInstance) -> bool:
        slots = task.domain.block_by_name[instance.block].slots
        classes = (slot.object_class for slot in slots if instance.slots[slot.name] == member.name)
        return any(each is not TOKEN and issubclass(object_class, each) for each in classes)

    failed = [each for each in recording.instances if each.name == recording.failure.instance]
    return any(map(tries, recording.instances)) and all(member.name in each.slots.values() for each in failed)


def find_faults(
    recipe: TrialRecipe[Task], recording: Recording, measured: Mapping[tuple[str, str], float]
) -> Iterator[str]:
    """Yield the reasons why a trial failed."""
    if recording.failure is not None:
        yield f"{recording.failure.instance}: {recording.failure.reason}"
    for key, (low, high) in recipe.bounds.items():
        values = [value for (_, name), value in measured.items() if name == key]
        if not values:
            yield f"the domain must measure {key}, got no value"
        yield from (
            f"{key} must be within {low:g} to {high:g}, got {value:.4g}" for value in values if not low <= value <= high
        )
    if recording.failure is None:
        yield from (f"{margin.atom.text} does not hold" for margin in recording.goal if not margin.holds)

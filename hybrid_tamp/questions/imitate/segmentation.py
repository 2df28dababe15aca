"""Segmentation of an observation into a timeline of block instances (paper, Sec. II-E).

The observer sees only states over time. The timeline obeys the law of assignment except where no block explains the
observation.
"""

from collections.abc import Iterator

from hybrid_tamp.model.deadline import NEVER, Deadline
from hybrid_tamp.model.imitation import Segmentation, Unexplained
from hybrid_tamp.model.law import check_law
from hybrid_tamp.model.plan import BlockInstance, TaskPlan
from hybrid_tamp.model.task import Task
from hybrid_tamp.questions.imitate.beam_search import find_best
from hybrid_tamp.questions.imitate.hypotheses import Hypothesis
from hybrid_tamp.questions.imitate.observation import Observation


def segment(task: Task, observation: Observation, deadline: Deadline = NEVER) -> Segmentation:
    """Return the timeline that explains an observation best.

    Args:
        task: task with the tokens, the domain and the initial assignment. Unmet goals are reported as violations.
        observation: observed states over time.
        deadline: deadline of the command.

    Raises:
        LimitReached: the deadline passes.
    """
    best = find_best(task, observation, deadline)
    times = observation.times
    hypotheses = [*((each, each.due) for each in best.past), *((each, observation.last) for each in best.running)]
    plan = TaskPlan(tuple(_instances(task, observation, hypotheses)), float(times[-1]))
    spans = [(each.tokens[0], times[each.start], times[end]) for each, end in hypotheses if each.block is None]
    unexplained = [Unexplained(token, float(start), float(end)) for token, start, end in spans]
    unexplained.sort(key=lambda each: (each.start, each.token))
    return Segmentation(plan, tuple(unexplained), tuple(check_law(task, plan, observation.at)), best.cost)


def _instances(
    task: Task, observation: Observation, hypotheses: list[tuple[Hypothesis, int]]
) -> Iterator[BlockInstance]:
    """Yield a named block instance for each explained hypothesis, in the order of the start times."""
    numbers: dict[str, int] = {}
    for hypothesis, end in sorted(hypotheses, key=lambda pair: (pair[0].start, pair[1], pair[0].slots)):
        if hypothesis.block is None:
            continue
        block = task.domain.block_by_name[hypothesis.block]
        numbers[block.action] = numbers.get(block.action, 0) + 1
        yield BlockInstance(
            f"{block.action}-{numbers[block.action]}",
            hypothesis.block,
            dict(hypothesis.slots),
            float(observation.times[hypothesis.start]),
            float(observation.times[end]),
            dict(hypothesis.targets),
            reached=float(observation.times[hypothesis.reached]) if block.hold else None,
        )

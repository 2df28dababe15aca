"""Segmentation: which tokens were in which blocks, from when to when, as an observation shows (paper, Sec. II-E).

An observer sees states over time only. The timeline obeys the law as far as blocks explain the observation.
"""

from collections.abc import Iterator

from hybrid_tamp.model.imitation import Segmentation, Unexplained
from hybrid_tamp.model.law import check_law
from hybrid_tamp.model.plan import BlockInstance, TaskPlan
from hybrid_tamp.model.task import Task
from hybrid_tamp.questions.imitate.beam_search import Interpretation, find_best
from hybrid_tamp.questions.imitate.hypotheses import Hypothesis
from hybrid_tamp.questions.imitate.observation import Observation


def segment(task: Task, observation: Observation) -> Segmentation:
    """Return the timeline that explains an observation best.

    Args:
        task: its tokens, domain and initial assignment; nothing else of it is read but the goal, for the violations.
        observation: the states over time.
    """
    best = find_best(task, observation)
    times = observation.times
    hypotheses = [(hypothesis, _end(hypothesis, best, observation)) for hypothesis in (*best.past, *best.running)]
    plan = TaskPlan(tuple(_instances(task, observation, hypotheses)), float(times[-1]))
    unexplained = sorted(
        (
            Unexplained(g.tokens[0], float(times[g.start]), float(times[end]))
            for g, end in hypotheses
            if g.block is None
        ),
        key=lambda each: (each.start, each.token),
    )
    violations = tuple(check_law(task, plan, observation.at))
    return Segmentation(plan, tuple(unexplained), violations, best.cost)


def _end(hypothesis: Hypothesis, best: Interpretation, observation: Observation) -> int:
    return observation.last if hypothesis in best.running else hypothesis.due


def _instances(
    task: Task, observation: Observation, hypotheses: list[tuple[Hypothesis, int]]
) -> Iterator[BlockInstance]:
    """Yield the instances of blocks, named in the order in which they begin."""
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

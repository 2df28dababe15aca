"""One durative action a block: shorter plans by Aries, which arranges what a lawful plan is known to need.

The plan tells how many actions there are and how long they are expected to last where it has them. What Aries
arranges is decoded, scheduled and judged like any other plan; where its expectations were wrong, it is asked again
with what the schedule says. It is asked for ever looser sketches of the plan: with the same targets, with the same
tokens, with the same number of actions of each kind, and with some more. A shortest arrangement is that of the
sketch, by estimates; whether there is no shorter plan at all stays open.
"""

import logging
import time
from collections.abc import Iterator
from dataclasses import replace

from hybrid_tamp.model.law import check_law
from hybrid_tamp.model.plan import BlockInstance, TaskPlan
from hybrid_tamp.model.task import Task
from hybrid_tamp.symbolic.decode import UndecodableError
from hybrid_tamp.symbolic.encoding.application import applicable
from hybrid_tamp.symbolic.encoding.problem import Compilation
from hybrid_tamp.symbolic.engines.planner_process import PlannerProcess
from hybrid_tamp.symbolic.estimates import Estimates
from hybrid_tamp.symbolic.pddl.text import action_line
from hybrid_tamp.symbolic.reencode import reencode
from hybrid_tamp.symbolic.schedule import InfeasibleScheduleError, schedule
from hybrid_tamp.symbolic.temporal.compilation import TemporalCompilation, compile_durative
from hybrid_tamp.symbolic.temporal.decoder import decode_durative
from hybrid_tamp.symbolic.temporal.grounding import Run
from hybrid_tamp.symbolic.temporal.problem import Step, TimedAction
from hybrid_tamp.symbolic.temporal.sketch import frame, sketch
from hybrid_tamp.symbolic.temporal.special import specialised
from hybrid_tamp.symbolic.temporal.unified import HORIZON

_LOG = logging.getLogger(__name__)

_ROUNDS = 3
"""So often one sketch is arranged at most, each time with better expectations."""
_LEAST = 3.0
"""With less time left Aries is not asked again [s]: its process alone takes one."""
_LARGEST = 60
"""With more actions than this in a sketch Aries finds nothing in time."""
_MOST_TOKENS = 10
"""With more tokens in blocks than this the grounding takes all the time: 9 take some 5 s, 15 some 15 s."""


class Durative:
    """Plans of one task by durative actions."""

    def __init__(self, task: Task, compilation: Compilation, estimates: Estimates | None = None) -> None:
        """Prepare to plan.

        Args:
            task: the task.
            compilation: the same task, slot by slot: plans are told in its actions, too.
            estimates: those of the task, where others have made some already.
        """
        self.task = task
        self.classical = compilation
        self.estimates = estimates or Estimates(task)
        self.refusals: list[str] = []

    def shorter(self, plan: TaskPlan, seconds: float) -> Iterator[TaskPlan]:
        """Yield lawful plans that are shorter in time than the given one and than each other.

        Args:
            plan: a lawful plan.
            seconds: how long to try [s].
        """
        if len(self.task.assigned) > _MOST_TOKENS:
            return
        until, best = time.monotonic() + seconds, plan
        compilation = compile_durative(self.task)
        for level in range(4):
            sketched = self._sketch(compilation, best, level)
            known = dict(_expected(best))
            for _ in range(_ROUNDS if len(sketched) <= _LARGEST else 0):
                if until - time.monotonic() < _LEAST:
                    return
                share = (until - time.monotonic()) / (1 if level == 3 else 2)
                found = self._arranged(compilation, sketched, known, best.makespan, share)
                if found is None:
                    break
                if found.makespan < best.makespan - 1e-6:
                    best = found
                    yield found
                learnt = known | dict(_expected(found))
                if learnt == known:
                    break
                known = learnt

    def _sketch(self, compilation: TemporalCompilation, plan: TaskPlan, level: int) -> tuple[Step, ...]:
        if level < 2:
            return sketch(compilation, plan, symbols=level == 0)
        return frame(compilation, plan, more=level - 2)

    def _arranged(
        self,
        compilation: TemporalCompilation,
        steps: tuple[Step, ...],
        known: "dict[_Key, float]",
        makespan: float,
        seconds: float,
    ) -> TaskPlan | None:
        """Return what Aries makes of a sketch, as a lawful plan, or None."""
        runs = tuple(replace(run, seconds=known.get(_key(run), run.seconds)) for run in compilation.reached)
        problem = specialised(replace(compilation, reached=runs))
        unit = int(1e3 * makespan * 1.2 / HORIZON) + 1
        with PlannerProcess() as process:
            limits = replace(self.task.limits, time=seconds)
            actions, said = process.arrange(problem, steps, unit, limits)
        if not actions:
            self._refuse(said)
            return None
        return self.judged(compilation, actions)

    def judged(self, compilation: TemporalCompilation, actions: tuple[TimedAction, ...]) -> TaskPlan | None:
        """Return a temporal plan as a lawful task plan, or None, and note why it is refused."""
        try:
            plan = schedule(self.task, decode_durative(compilation, actions), (), self.estimates)
        except (UndecodableError, InfeasibleScheduleError) as error:
            self._refuse(str(error))
            return None
        violations = check_law(self.task, plan)
        told = [] if violations else reencode(self.classical, plan)
        if violations or not applicable(self.classical, told):
            self._refuse("; ".join(map(str, violations)) or "it has no form slot by slot")
            return None
        return replace(plan, actions=tuple(map(action_line, told)))

    def _refuse(self, reason: str) -> None:
        _LOG.info("durative actions: %s", reason)
        self.refusals.append(reason)


_Key = tuple[str, tuple[tuple[str, str], ...], tuple[str, str]]


def _key(run: Run) -> _Key:
    return run.block, run.roles, run.source


def _expected(plan: TaskPlan) -> Iterator[tuple[_Key, float]]:
    """Yield how long the instances of a plan that begin after its start are expected to last [s]."""
    before: dict[str, tuple[BlockInstance, str]] = {}
    for instance in sorted(plan.instances, key=lambda i: (i.start, i.end, i.name)):
        # A run is told by its anchor's source; whichever token has it, it is among these.
        for token in instance.slots.values():
            if token in before:
                source = (before[token][0].block, before[token][1])
                end = instance.end if instance.reached is None else instance.reached
                yield (instance.block, tuple(instance.roles.items()), source), round(end - instance.start, 6)
        before.update({token: (instance, slot) for slot, token in instance.slots.items()})

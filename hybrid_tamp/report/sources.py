"""Values of keys that are not attributes of a dataclass; the docstrings describe the keys in the JSON Schemas."""

import shlex
from math import isfinite
from typing import Literal

from hybrid_tamp.model.explanation import Reason, Suggestion
from hybrid_tamp.model.network import slot_text
from hybrid_tamp.model.outcome import PlannerFigures, PlanOutcome
from hybrid_tamp.model.plan import PlannedAction
from hybrid_tamp.model.planned_network import PlannedNetwork
from hybrid_tamp.model.refined import Retuning, Tuned, Value
from hybrid_tamp.model.run_result import RunResult


def objective(outcome: PlanOutcome) -> Literal["length", "makespan"]:
    """Whether the planner minimises the number of actions or the makespan."""
    return "makespan" if outcome.task.objective == "makespan" else "length"


def actions(outcome: PlanOutcome) -> tuple[PlannedAction, ...]:
    """The PDDL plan, one line per action."""
    return () if outcome.plan is None else outcome.plan.actions


def proven_shortest(figures: PlannerFigures) -> bool:
    """Whether it is proven that no plan has a shorter makespan; the planners here prove no makespan."""
    return False


def refined(outcome: PlanOutcome) -> PlanOutcome | None:
    """How the hyperparameters were optimised; null if they were not."""
    return None if outcome.refinement is None else outcome


def edges(network: PlannedNetwork) -> tuple[tuple[str, str], ...]:
    """Pairs of 'BLOCK.slot', source first."""
    return tuple((slot_text(source), slot_text(target)) for source, target in network.edges)


def kind(reason: Reason) -> str:
    """What is wrong, in a word."""
    return reason.kind


def message(reason: Reason) -> str:
    """The reason in words."""
    if reason.probe is None:
        return reason.message
    return f"{reason.message}; {describe_probe(*reason.probe)}"


def describe_probe(source: str, token: str) -> str:
    """Return the command that finds out of which classes a token of a task is a member."""
    return f"'hybrid-tamp probe {source} --token {shlex.quote(token)} --write NEW.yaml' finds out"


def solvable(suggestion: Suggestion) -> Literal[True]:
    """Whether the changed task has a plan; always true, because it was planned."""
    return True


def moves(tuned: Tuned) -> tuple[str, ...]:
    """Performance measures that it affects."""
    return tuple(".".join(measure) for measure in tuned.moves)


def before(retuning: Retuning) -> Value | None:
    """The optimum of the forward models in physics; null if its run failed."""
    return retuning.before if isfinite(retuning.before.violation) else None


def best(retuning: Retuning) -> Value | None:
    """The values that were kept, in physics; null if every run failed."""
    return retuning.best if isfinite(retuning.best.violation) else None


def breaches(result: RunResult) -> tuple[str, ...]:
    """Breaches of the law of assignment by the recording; empty if there are none."""
    return tuple(breach.text for breach in result.law)


def result_schema(result: RunResult) -> Literal["hybrid-tamp/result/1"]:
    """Name of the document that the result is."""
    return "hybrid-tamp/result/1"

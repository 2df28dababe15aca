"""Values of keys that are not attributes. The functions' docstrings describe the keys in the JSON Schemas."""

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
    """Whether the makespan is proven to be minimal; always false, because none of the planners proves this."""
    return False


def refined(outcome: PlanOutcome) -> PlanOutcome | None:
    """Optimisation of the hyperparameters; null if no hyperparameters were optimised."""
    return None if outcome.refinement is None else outcome


def edges(network: PlannedNetwork) -> tuple[tuple[str, str], ...]:
    """Edges as pairs of ('BLOCK.slot' of the source, 'BLOCK.slot' of the destination)."""
    return tuple((slot_text(source), slot_text(target)) for source, target in network.edges)


def kind(reason: Reason) -> str:
    """Kind of the reason in one word."""
    return reason.kind


def message(reason: Reason) -> str:
    """Text of the reason."""
    if reason.probe is None:
        return reason.message
    return f"{reason.message}; {describe_probe(*reason.probe)}"


def describe_probe(source: str, token: str) -> str:
    """Return advice to run the command that finds the classes of a token."""
    return f"find out with 'hybrid-tamp probe {source} --token {shlex.quote(token)} --write NEW.yaml'"


def solvable(suggestion: Suggestion) -> Literal[True]:
    """Whether the changed task has a plan; always true, because a plan of the changed task was found."""
    return True


def moves(tuned: Tuned) -> tuple[str, ...]:
    """Performance measures that the hyperparameter affects."""
    return tuple(".".join(measure) for measure in tuned.moves)


def before(retuning: Retuning) -> Value | None:
    """Value of the plan in physics at the optimum of the forward models; null if the run failed."""
    return retuning.before if isfinite(retuning.before.violation) else None


def best(retuning: Retuning) -> Value | None:
    """Value of the plan in physics with the chosen hyperparameters; null if every run failed."""
    return retuning.best if isfinite(retuning.best.violation) else None


def breaches(result: RunResult) -> tuple[str, ...]:
    """Breaches of the law of assignment by the recording; empty if there are none."""
    return tuple(breach.text for breach in result.law)


def collisions(result: RunResult) -> tuple[str, ...]:
    """Collisions that the independent check of the recording finds; empty if there are none."""
    return tuple(collision.text for collision in result.collisions)


def out_of_bounds(result: RunResult) -> tuple[str, ...]:
    """Metrics outside the bounds of the domain, each with its value and its bounds."""
    return tuple(each.text for each in result.out_of_bounds)


def result_schema(result: RunResult) -> Literal["hybrid-tamp/result/1"]:
    """Name and version of the document."""
    return "hybrid-tamp/result/1"

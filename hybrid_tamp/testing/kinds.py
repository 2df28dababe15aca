"""The kinds of mistakes that the check of a domain finds, each with its meaning and its remedy."""

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True)
class MistakeKind:
    """A kind of mistake in a domain.

    Attributes:
        meaning: what the check found, in one or two sentences.
        remedy: how to correct the mistake.
    """

    meaning: str
    remedy: str


KINDS: Mapping[str, MistakeKind] = {
    "shape": MistakeKind(
        "A function returns an array of the wrong shape.",
        "compute one result for each state of a batch, e.g. np.linalg.norm(..., axis=-1)",
    ),
    "batch": MistakeKind(
        "A function has one result for a state in a batch and another result for the same state alone.",
        "do not mix the states of a batch: reduce along the last axis only",
    ),
    "error": MistakeKind(
        "A function raises an exception.",
        "correct the function in the line that the message names",
    ),
    "reads": MistakeKind(
        "The margin of a predicate depends on a varying property that `reads` does not list, or on a token that is no "
        "argument. Static predicates with `reads` may read further properties, whose initial values then count. Or a "
        "running block reads a property of a target that `Target.reads` does not list.",
        "add the property to 'reads' of the predicate or the target, or make the token a parameter of the predicate",
    ),
    "sees": MistakeKind(
        "A policy, a system or an initial value reads a token without a role in the block.",
        "make the token a slot or a target of the block, or do not read the token",
    ),
    "writes": MistakeKind(
        "The system changes a property of a token in a slot, but `writes` does not list the property.",
        "add the property to 'writes', or leave the property unchanged",
    ),
    "holds": MistakeKind(
        "The system changes a token that is in no slot of the block.",
        "make the token a slot of the block, or leave the token unchanged",
    ),
    "commands": MistakeKind(
        "A policy commands a token that is in no slot of the block, or an action that the token lacks.",
        "command only the actions of the tokens in the slots",
    ),
    "limit": MistakeKind(
        "The policy exceeds the limit of a basic action in more than half of the steps. Rollouts and runs scale the "
        "command down.",
        "scale the command to the limit, move more slowly, or correct the unit of the command",
    ),
    "chance": MistakeKind(
        "Two policies, or two systems, that are made from the same arguments differ.",
        "remove random numbers, clocks and variables that instances share",
    ),
    "memory": MistakeKind(
        "A policy or a system has another result when it is called again with the same arguments.",
        "compute the result from the arguments of the call only, and compute constants in the factory function",
    ),
    "sign": MistakeKind(
        "A block moves away from its exit condition in all rollouts, or an entry condition fails for all tokens "
        "although tokens start in the block.",
        "reverse the sign of the margin, or the sign of the command or of the movement",
    ),
    "unit": MistakeKind(
        "A declared unit is no SI unit, a margin changes more than 10 times as fast as the property of the same unit "
        "that the margin reads, a bound is implausible for its unit, e.g. 90 rad, or a pose changes more than 10 times "
        "as fast or as slowly as the velocity says.",
        "use SI units: metres in place of millimetres, and radians in place of degrees",
    ),
    "exit": MistakeKind(
        "No rollout of a block towards certain targets reached the exit conditions.",
        "correct the policy, the system, the initial hyperparameters or the longest duration",
    ),
    "idle": MistakeKind(
        "The exit conditions of a block that moves tokens held at the start of all rollouts.",
        "add an exit condition that only the movement makes true, or correct the margins of the exit conditions",
    ),
    "entry": MistakeKind(
        "In the walks, the entry conditions and the invariants of a block never held at the same time, or the block "
        "has an entry condition that no block establishes.",
        "add a block or a token that makes the condition true, or correct the condition and the sign of its margin",
    ),
    "effect": MistakeKind(
        "An exit condition is an effect that no rollout produces, although other effects of the block occur.",
        "correct the block's system so that the exit condition becomes true, or remove the condition from 'exit'",
    ),
    "undeclared": MistakeKind(
        "An atom became true or false during a block, but no exit condition declares this effect.",
        "add the effect to 'exit'",
    ),
    "keeps": MistakeKind(
        "A block made an atom true or false, but the block lists the predicate of this atom in `keeps`. Or the block "
        "keeps a predicate in `keeps` without this declaration.",
        "remove the predicate from 'keeps', and declare the effect in 'exit'",
    ),
    "fixed": MistakeKind(
        "An atom of a static predicate without `reads` became true or false, or its margin depends on a varying "
        "property.",
        "list the varying properties in 'reads', or compute the margin from fixed properties only",
    ),
    "bound": MistakeKind(
        "The margin of a static predicate exceeded its `bound`. The check evaluates the bound for visited and for "
        "random positions.",
        "return an upper bound for all displacements of the tokens within the radius",
    ),
    "ends": MistakeKind(
        "A token in a slot of `ends` did not end at the `outcome` of the block, or this `outcome` depends on roles "
        "that `ends` does not list.",
        "correct the outcome, list the roles in 'ends', or remove the slot from 'ends'",
    ),
    "sweep": MistakeKind(
        "A token that the block moves is farther from its poses in the `sweep` of the block than planning allows for.",
        "correct the sweep, or remove it: then planning rolls the block out",
    ),
    "key_pose": MistakeKind(
        "A rollout that reached its exit conditions did not pass a pose in the `key_poses` of the block.",
        "remove the pose, or declare the distance within which every execution passes the pose in 'within'",
    ),
    "invariant": MistakeKind(
        "An entry condition held throughout all rollouts of a block, but is neither an invariant nor waived.",
        "declare the condition as an invariant, or map the condition to a reason in 'waived'",
    ),
    "broken": MistakeKind(
        "In all rollouts of a block, an invariant was broken by more than half of the scale of its predicate.",
        "correct the movement, or remove the condition from 'invariants'",
    ),
    "influence": MistakeKind(
        "A hyperparameter has no influence: the rollouts with its lower and its upper bound are identical.",
        "use the hyperparameter in the policy, or remove the hyperparameter",
    ),
    "bounds": MistakeKind(
        "The lower bound of a hyperparameter exceeds the upper bound, its initial value is always outside the bounds, "
        "or the expected duration always exceeds the longest duration.",
        "exchange or correct the bounds, or compute a value within the bounds and in the declared unit",
    ),
    "contact": MistakeKind(
        "In physics, two tokens of a block touch for more than 0.1 s, or with more force than the task tolerates, but "
        "the block does not allow this contact.",
        "add the pair of roles to 'allowed_contacts', or move around the body",
    ),
    "model": MistakeKind(
        "In physics, a block misses an exit condition that the forward model reaches, takes less than half or more "
        "than twice the time, or a token ends at another position.",
        "correct the forward model, or the policy that works only in the model",
    ),
}
"""Maps each kind of mistake to its meaning and its remedy."""

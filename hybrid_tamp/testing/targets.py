"""Check of `Target.reads`, which lists the varying properties that a running block reads from its targets."""

import numpy as np

from hybrid_tamp.errors import DomainError
from hybrid_tamp.model.affordance import VaryingProperty
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.model.view import View
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.testing.disagreement import Disagreements
from hybrid_tamp.testing.laws import call_policy, call_system, samples_of
from hybrid_tamp.testing.margins import changeable, changed_state
from hybrid_tamp.testing.rollouts import Rollouts

_SIZE = 0.1
"""Size of the change of a property, in SI units."""


def check_target_reads(task: Task, rolled: Rollouts, found: Disagreements, rng: np.random.Generator) -> None:
    """Report each property of a target that changes the commands or the next states, but is not in `Target.reads`.

    The planner lets other blocks change a property of a target if the running block does not read the property. The
    start of the instance is not changed, because values at the start may be read.
    """
    block, binding = rolled.block, rolled.binding
    view = View(binding, rolled.start.layout)
    before = None
    for target in block.targets:
        token = binding[target.name]
        for varying in changeable(task, token) if isinstance(token, Token) else ():
            assert isinstance(token, Token)
            if varying.name in target.reads:
                continue
            before = _responses(rolled, view) if before is None else before
            after = _responses(rolled, view, token, varying, rng)
            largest = 0.0 if after is None or before is None else float(np.abs(after - before).max(initial=0.0))
            if largest > 0.0:
                declared = f"the block reads {', '.join(target.reads) or 'nothing'} of {target.name}"
                measured = (
                    f"a change of the {varying.name} of {token.name} by {_SIZE:g} {varying.unit} changes a command or "
                    f"the next state by {largest:.4g}"
                )
                found.add("reads", block, binding, declared, measured, target.name)


def _responses(
    rolled: Rollouts,
    view: View,
    token: Token | None = None,
    varying: VaryingProperty | None = None,
    rng: np.random.Generator | None = None,
) -> FloatArray | None:
    """Return the commands and the changes of the state for samples of a rollout with a changed property of a token.

    Return None if a function is not defined for the changed state.
    """
    block, binding, start = rolled.block, rolled.binding, view.of(rolled.start)
    samples = list(samples_of(rolled, view))
    if token is not None and varying is not None and rng is not None:
        value = changed_state(start, token, varying, _SIZE, rng)[token, varying.name]
        key = token.name, varying.name
        samples = [(elapsed, state.replace({key: value})) for elapsed, state in samples]
    try:
        commands = [{}] * len(samples) if block.policy is None else call_policy(block, binding, start, samples)
        after = call_system(block, binding, start, samples, commands[: len(samples)])
    except DomainError:
        return None
    arrays = [each[key].ravel() for each in commands[: len(samples)] for key in each]
    for (_, state), values in zip(samples, after, strict=False):
        arrays += [_moved(state, key, values[key]) for key in values]
    return np.concatenate(arrays) if arrays else None


def _moved(state: State, key: tuple[str, str], value: FloatArray) -> FloatArray:
    return np.asarray(value - state[key]).ravel()

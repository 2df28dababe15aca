"""Checks of policies and systems: they must be pure functions, and commands must respect the limits of the actions."""

from collections.abc import Iterator, Sequence

import numpy as np

from hybrid_tamp.model.authored import authored
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.control import CONTROL_PERIOD, Commands, Parameters
from hybrid_tamp.model.predicate import Binding
from hybrid_tamp.model.shapes import check_commands, check_shape, sizes_of
from hybrid_tamp.model.state import State
from hybrid_tamp.model.token import Token
from hybrid_tamp.model.view import View
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.testing.disagreement import Disagreements, role_of
from hybrid_tamp.testing.rollouts import Rollouts

_CALLS = 16
"""Largest number of states along a rollout for which a policy and a system are called."""
_MOST = 0.5
"""Largest share of the calls in which a command may exceed its limit."""

_Key = tuple[str, str]
_Samples = Sequence[tuple[float, State]]
"""Pairs of (elapsed time [s], state of the instance's tokens)."""
_Results = Sequence[dict[_Key, FloatArray]]
"""For each sample, the result for each pair of (token, action or property)."""


def check_laws(rolled: Rollouts, found: Disagreements) -> bool:
    """Call the policy and the system of an instance repeatedly along the rollout with initial hyperparameters.

    Returns:
        Whether the policy and the system are pure functions. If not, other comparisons of rollouts are meaningless.
    """
    block, binding = rolled.block, rolled.binding
    view = View(binding, rolled.start.layout)
    samples = list(samples_of(rolled, view))
    start = view.of(rolled.start)
    pure = True
    commands: _Results = [{} for _ in samples]
    if block.policy is not None:
        calls = [call_policy(block, binding, start, samples) for _ in range(2)]
        pure = _compare("policy", rolled, samples, calls, found)
        commands = calls[0]
        _check_limits(rolled, commands[: len(samples)], found)
    after = [call_system(block, binding, start, samples, commands) for _ in range(2)]
    return _compare("system", rolled, samples, after, found) and pure


def samples_of(rolled: Rollouts, view: View) -> Iterator[tuple[float, State]]:
    """Yield pairs of (elapsed time [s], state of the instance's tokens) along row 0 of the rollouts."""
    length = int(rolled.lengths[0])
    for index in np.unique(np.linspace(0, max(length - 1, 0), _CALLS).astype(int)):
        state = State(rolled.states.layout, rolled.states.values[index, 0])
        yield index * CONTROL_PERIOD, view.of(state)


def _twice(samples: _Samples) -> list[int]:
    """Return the indices of the samples in order, and then again in reverse order."""
    return [*range(len(samples)), *reversed(range(len(samples)))]


def call_policy(block: Block, binding: Binding, start: State, samples: _Samples) -> list[Commands]:
    """Return the commands of a new policy for all samples, in order and then in reverse order."""
    assert block.policy is not None
    where, held = f"{block.name}.policy", {slot.name: binding[slot.name] for slot in block.slots}
    sizes = sizes_of({name: token for name, token in held.items() if isinstance(token, Token)})
    values = block.initial_values(binding, start)
    results = []
    with authored(where, binding):
        policy = block.policy(binding, start, Parameters(values))
        for index in _twice(samples):
            elapsed, state = samples[index]
            results.append(dict(policy(np.float64(elapsed), state)))
    for commands in results:
        check_commands(where, binding, commands, sizes, start)
    return [{key: np.array(value) for key, value in commands.items()} for commands in results]


def call_system(
    block: Block, binding: Binding, start: State, samples: _Samples, commands: _Results
) -> list[dict[_Key, FloatArray]]:
    """Return the next states of a new system for all samples, in order and then in reverse order."""
    results = []
    with authored(f"{block.name}.system", binding):
        system = block.system_maker(binding, start)
        for index in _twice(samples):
            results.append(system(samples[index][1], dict(commands[index]), CONTROL_PERIOD))
    for after in results:
        check_shape(f"{block.name}.system", binding, after.values, start.values.shape)
    return [{key: np.array(after[key]) for key in after.layout.slices} for after in results]


def _compare(what: str, rolled: Rollouts, samples: _Samples, calls: Sequence[_Results], found: Disagreements) -> bool:
    """Compare two instances with each other, and the first call of one instance with the second call."""
    one, other = calls
    count, pure = len(samples), True
    for kind, declared, pairs in (
        ("chance", f"two {what} functions from the same arguments are equal", list(zip(one, other, strict=True))),
        ("memory", f"the {what} has no memory", list(zip(one[:count], one[: count - 1 : -1], strict=True))),
    ):
        for index, (first, second) in enumerate(pairs):
            key = next((key for key in first if not _equal(first[key], second.get(key))), None)
            if key is None and first.keys() == second.keys():
                continue
            name = key or next(iter({*first, *second}))
            elapsed = samples[_twice(samples)[index]][0]
            measured = (
                f"the {name[1]} of {name[0]} is {_text(first.get(name))} and then {_text(second.get(name))} for the "
                f"same state at {elapsed:.3f} s"
            )
            role = next(
                (r for r, value in rolled.binding.items() if isinstance(value, Token) and value.name == name[0]), ""
            )
            found.add(kind, rolled.block, rolled.binding, declared, measured, role)
            pure = False
            break
    return pure


def _equal(one: FloatArray, other: FloatArray | None) -> bool:
    return other is not None and np.array_equal(one, other, equal_nan=True)


def _text(value: FloatArray | None) -> str:
    return "missing" if value is None else np.array2string(np.asarray(value), precision=4)


def _check_limits(rolled: Rollouts, commands: _Results, found: Disagreements) -> None:
    """Report a command that exceeds the limit of its action in most of the calls."""
    tokens = [value for value in rolled.binding.values() if isinstance(value, Token)]
    for token in tokens:
        for action in token.basic_actions:
            norms = [
                float(np.linalg.norm(each[token.name, action.name]))
                for each in commands
                if (token.name, action.name) in each
            ]
            limit = np.inf if action.limit is None else float(token[action.limit])
            above = sum(norm > limit * (1.0 + 1e-6) for norm in norms)
            if norms and above > _MOST * len(norms):
                declared = f"the {action.name} is at most the {action.limit}"
                measured = (
                    f"the {action.name} of {token.name} is up to {max(norms):.4g} {action.unit}, and exceeds the limit "
                    f"of {limit:.4g} {action.unit} in {above} of {len(norms)} steps"
                )
                found.add("limit", rolled.block, rolled.binding, declared, measured, role_of(rolled.binding, [token]))

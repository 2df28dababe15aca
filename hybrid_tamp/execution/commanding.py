"""What the policies of running instances command together, and whose fault it is where something is not finite."""

from collections.abc import Collection

import numpy as np

from hybrid_tamp.errors import DomainError, Issue
from hybrid_tamp.execution.running_instance import RunError, Running
from hybrid_tamp.model.commands import CommandError, CommandLayout
from hybrid_tamp.model.control import Commands
from hybrid_tamp.model.state import State
from hybrid_tamp.motion.arrays import FloatArray


def command(layout: CommandLayout, running: Collection[Running], time: float, state: State) -> FloatArray:
    """Ask all policies, and return what they command as a row.

    Raises:
        DomainError: a policy commands something that does not exist, or that its block does not hold.
        RunError: a command is not finite.
    """
    commands: Commands = {}
    for each in running:
        commands.update(each.commands(time, state))
    try:
        row = layout.row(commands)
    except CommandError as error:
        blocks = ", ".join(sorted({each.block.name for each in running}))
        raise DomainError([Issue(f"policy of {blocks}", str(error))]) from error
    if not np.isfinite(row).all():
        for each in running:
            each.check_finite(commands)
    return row


def blame_state(state: State, running: Collection[Running], time: float) -> RunError:
    """Return the failure of the first instance with a token whose state is not finite.

    Args:
        state: a state that is not finite.
        running: the instances.
        time: until when all was finite [s].
    """
    for each in running:
        for token in each.instance.slots.values():
            for name in (name for owner, name, _ in state.layout.entries if owner == token):
                if not np.isfinite(state[token, name]).all():
                    said = f"the {name} of {token} is no longer finite after {time:.3f} s"
                    return RunError(each.instance.name, said)
    return RunError("", f"the state is no longer finite after {time:.3f} s")

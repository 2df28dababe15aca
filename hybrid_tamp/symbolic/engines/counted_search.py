"""Fast Downward with a counted search for shorter plans, ``python -m hybrid_tamp.symbolic.engines.counted_search``.

The first search finds a plan (``lama-first``). The second search looks for a shorter plan, in the order of the number
of actions (A* with the blind heuristic). So the second search finds a plan with the fewest actions, or proves that the
first plan has the fewest actions. The second search ends after a counted amount of work. Fast Downward has no option
for this, but it reports the number of evaluated states whenever the search has examined all plans of one length. So the
search examines another length only if at most `MOST_EVALUATED` states were evaluated before. This rule depends on no
clock, and the plan does not depend on the load of the machine. Each length takes as many expansions as states are
evaluated and not yet expanded. So the rule also bounds the last length: at most `MOST_EVALUATED` states are expanded.

The program takes the arguments of Fast Downward's driver, and prints its log. The last line is `PROVEN` or `COUNTED`.
"""

import os
import re
import signal
import subprocess
import sys
from collections.abc import Sequence
from contextlib import suppress
from importlib.util import find_spec
from pathlib import Path

MOST_EVALUATED = 500_000
"""Number of evaluated states after which the second search examines no further length of plans."""

PROVEN = "No plan has fewer actions."
COUNTED = f"The search for shorter plans has evaluated {MOST_EVALUATED} states."

SEARCH = (
    "let(hlm,eval_modify_costs(landmark_sum(lm_factory=lm_reasonable_orders_hps(lm_rhw()),pref=false),cost_type=one),"
    "let(hff,eval_modify_costs(ff(),cost_type=one),"
    "iterated([lazy_greedy([hff,hlm],preferred=[hff,hlm],cost_type=one,reopen_closed=false),astar(blind())],"
    "pass_bound=true,repeat_last=false,continue_on_solve=true)))"
)
"""Configuration of both searches. The first is that of the alias ``lama-first``."""

_LENGTH_DONE = re.compile(r"\bf = \d+, (\d+) evaluated")
_FOUND = "Solution found!"
_NONE_SHORTER = ("no plan with cost", "Completely explored state space")


def make_command(plan_file: str) -> list[str]:
    """Return the beginning of the command that replaces the command of Fast Downward's driver in unified_planning."""
    return [sys.executable, "-m", __name__, "--plan-file", plan_file]


def main(arguments: Sequence[str]) -> int:
    """Run the driver with the arguments and return its exit code. Leave the shortest plan in the plan file."""
    plan_file = Path(arguments[list(arguments).index("--plan-file") + 1])
    command = [sys.executable, str(_driver()), *arguments]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, start_new_session=True) as process:
        found, proven = follow_log(process)
        code = process.wait()
    if not found:
        return code
    # The driver numbers the plans, without a plan that is not shorter, e.g. a second empty plan. A plan that was found
    # after the end of the count is ignored.
    numbered = (plan_file.with_name(f"{plan_file.name}.{number}") for number in range(found, 0, -1))
    next(file for file in numbered if file.exists()).replace(plan_file)
    sys.stdout.write(f"{PROVEN if proven else COUNTED}\n")
    return 0


def follow_log(process: "subprocess.Popen[str]") -> tuple[int, bool]:
    """Pass on the log. Return the number of plans, and whether the last plan is proven to have the fewest actions.

    The process is killed when the second search has evaluated enough states.
    """
    found, proven = 0, False
    assert process.stdout is not None
    for line in process.stdout:
        sys.stdout.write(line)
        done = _LENGTH_DONE.search(line)
        if _FOUND in line:
            found += 1
            proven = found > 1
        elif found == 1 and any(sentence in line for sentence in _NONE_SHORTER):
            proven = True
        elif found == 1 and not proven and done and int(done[1]) > MOST_EVALUATED:
            with suppress(ProcessLookupError):  # The process may just have ended.
                os.killpg(process.pid, signal.SIGKILL)
            break
    return found, proven


def _driver() -> Path:
    """Return the path of Fast Downward's driver in the package up_fast_downward."""
    package = find_spec("up_fast_downward")
    assert package is not None, "the registry checks that the engine is installed"
    assert package.origin is not None
    return Path(package.origin).parent / "downward" / "fast-downward.py"


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

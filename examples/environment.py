"""Example of a Gymnasium environment in which the commands of a run reach the goal.

Run the example with ``python examples/environment.py``. It writes the files of the run and a picture of the last state,
``last.png``, to ``out-environment``. It requires Gymnasium (``pip install 'hybrid-tamp[gym]'``).
"""

import sys
from pathlib import Path

from PIL import Image

import hybrid_tamp


def main(folder: Path) -> float:
    """Run a task, repeat its commands in an environment, and print and return the sum of the rewards."""
    commands = hybrid_tamp.run("roll_cylinder", folder).recording.commands
    total, terminated = 0.0, False
    with hybrid_tamp.make_environment(hybrid_tamp.load_task("roll_cylinder")) as environment:
        environment.reset(seed=0)
        for action in commands:
            _, reward, terminated, _, information = environment.step(action)
            total += reward
            if terminated:
                break
        Image.fromarray(environment.render()).save(folder / "last.png")
    print(f"{'reached the goal' if terminated else 'stopped'} at {information['time']:.2f} s, rewards {total:.3f}")
    return total


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "out-environment"))

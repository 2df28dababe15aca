"""Unsolvable tasks that were made by hand, or by random deletions from solvable tasks."""

import random
from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache, partial
from pathlib import Path

import numpy as np
from brute_force import solvable
from scenes import rolling_task
from texts import load_task_text
from workshop import at, cut, workshop_task

from hybrid_tamp.errors import DomainError
from hybrid_tamp.model.affordance import TOKEN
from hybrid_tamp.model.network import ReassignmentNetwork
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token

PROBLEMS = Path(__file__).resolve().parents[1] / "problems"
ALONG_Y = "rpy: [1.5707963267948966, 0, 0]"
UPRIGHT = ("0.10], rpy: [1.5707963267948966, 0, 0]", "0.15]")
FIRST_SEED = 3000
KINDS = ("edge", "token", "class", "weaker", "moved")
Made = Callable[[], Task]


def problem(name: str, *edits: tuple[str, str], once: bool = True) -> Task:
    """Return a bundled task with replacements in its text. Each replacement is made once or everywhere."""
    text = (PROBLEMS / f"{name}.yaml").read_text(encoding="utf-8")
    for old, new in edits:
        assert old in text
        text = text.replace(old, new, 1) if once else text.replace(old, new)
    return load_task_text(text, name)


def without_edge(task: Task, *edges: tuple[str, str]) -> Task:
    """Return the task without edges of its network."""
    kept = [(".".join(a), ".".join(b)) for a, b in task.domain.network.edges]
    network = ReassignmentNetwork(edge for edge in kept if edge not in edges)
    return task.replaced(domain=replace(task.domain, network=network))


def by_hand() -> dict[str, Made]:
    """Return the tasks that were made by hand."""
    force = ("maximal_force: 300", "maximal_force: 60")
    return {
        "roll: no hand": partial(rolling_task, hands=0),
        "roll: region off the line": partial(rolling_task, regions=[(0.7, 0.1)]),
        "roll: region out of the workspace": partial(rolling_task, regions=[(3.0, 0.0)]),
        "roll: two drums, no hand": partial(rolling_task, 0, [(0, 0), (0, 1)], [(0.7, 0), (0.7, 1)], [(0, 0), (1, 1)]),
        "roll: one of two off": partial(rolling_task, 1, [(0, 0), (0, 1)], [(0.7, 0), (0.7, 1.2)], [(0, 0), (1, 1)]),
        "roll: upright drum": lambda: problem("roll_cylinder", UPRIGHT),
        "roll: small workspace": lambda: problem("roll_cylinder", ("[1.4, 0.8, 1.2]", "[0.4, 0.8, 1.2]")),
        "tumble: one hand": lambda: problem("tumble_one_hand"),
        "tumble: heavy box": lambda: problem("tumble_two_hands", ("mass: 14", "mass: 60")),
        "tumble: weak hand": lambda: problem("tumble_two_hands", force),
        "tumble: both on one side": lambda: problem("tumble_two_hands", ("[0.5, 0, 0.55]", "[-0.9, 0, 0.55]")),
        "tumble: hands upright": lambda: problem("tumble_two_hands", (ALONG_Y, "rpy: [0, 0, 0]"), once=False),
        "tumble: low workspace": lambda: problem("tumble_two_hands", ("[2.0, 2.0, 1.5]", "[2.0, 2.0, 0.3]")),
        "workshop: one hand carries": lambda: workshop_task((at(),), hands=(50.0,)),
        "workshop: no hand": lambda: workshop_task((cut(),), hands=()),
        "workshop: no cutter": lambda: workshop_task((cut(),), edges=()),
        "workshop: blunt cutter": lambda: workshop_task((cut(),), edges=(2.0,)),
        "workshop: blunt cutters": lambda: workshop_task((cut(), at()), edges=(2.0, 1.0)),
        "workshop: weak hand": lambda: workshop_task((at(),), hands=(50.0, 20.0)),
        "workshop: weak station": lambda: workshop_task((at(),), loads=(50.0,)),
        "workshop: heavy part": lambda: workshop_task((at(),), parts=((120.0, 3.0),), loads=(200.0,)),
        "workshop: one hand, two goals": lambda: workshop_task((cut(), at()), hands=(50.0,)),
        "workshop: no way to CARRYING": lambda: without_edge(
            workshop_task((at(),), edges=()), ("RESTING.token", "CARRYING.part")
        ),
        "workshop: no way out of CARRYING": lambda: without_edge(
            workshop_task((at(),), edges=()), ("CARRYING.first", "RESTING.token"), ("CARRYING.second", "RESTING.token")
        ),
        "workshop: dead end": lambda: without_edge(
            workshop_task((at(),), edges=()), ("CARRYING.first", "RESTING.token")
        ),
    }


def bases() -> dict[str, Made]:
    """Return the solvable tasks from which unsolvable tasks are made."""
    return {
        "roll": rolling_task,
        "roll two": partial(rolling_task, 2, [(0, 0), (0, 1)], [(0.7, 0), (0.7, 1)], [(0, 0), (1, 1)]),
        "carry": lambda: workshop_task((at(),)),
        "cut": lambda: workshop_task((cut(),), hands=(50.0,)),
        "cut and carry": lambda: workshop_task((cut(), at())),
        "two parts": lambda: workshop_task((cut(0), at(1)), parts=((60.0, 3.0), (90.0, 4.0))),
        "tumble": lambda: problem("tumble_two_hands"),
    }


@lru_cache
def by_deletion(count: int) -> dict[str, Made]:
    """Return `count` tasks that random deletions of alternating kinds have made unsolvable, with proof."""
    found: dict[str, Made] = {}
    seed = FIRST_SEED
    while len(found) < count:
        rng = random.Random(seed)
        seed += 1
        base = rng.choice(sorted(bases()))
        kind = KINDS[len(found) % len(KINDS)]
        task = bases()[base]()
        if kind == "moved" and not base.startswith("roll"):
            continue
        what, made = _deletion(task, kind, rng)
        name = f"{base}: {what}"
        try:
            if name not in found and not solvable(made()):
                found[name] = made
        except DomainError:
            # A domain rejects a slot without edges.
            continue
    return found


def _deletion(task: Task, kind: str, rng: random.Random) -> tuple[str, Made]:
    """Return a random deletion without goal tokens, as a pair of (description, function that makes the task)."""
    named = {name for atom in task.goal for name in atom.arguments}
    token = rng.choice([token for token in task.tokens if token.name not in named and not token.place])
    if kind == "edge":
        source, target = rng.choice([(".".join(a), ".".join(b)) for a, b in task.domain.network.edges])
        return f"edge {source} -> {target}", lambda: without_edge(task, (source, target))
    if kind == "token":
        return f"token {token.name}", lambda: _without(task, token)
    if kind == "class":
        return f"class of {token.name}", lambda: _with(task, replace(token, classes=(TOKEN,), properties={}))
    if kind == "weaker":
        name = next(name for name in ("maximal_force", "force", "edge") if name in token.properties)
        share = rng.choice((0.1, 0.2, 0.3))
        weaker = replace(token, properties={**token.properties, name: token[name] * share})
        return f"{name} of {token.name} x {share}", lambda: _with(task, weaker)
    place = rng.choice([token for token in task.tokens if token.place])
    offset = np.array([rng.uniform(-0.3, 0.3), rng.choice((-1, 1)) * rng.uniform(0.05, 0.3), 0.0])
    moved = task.state.replace({(place.name, "position"): task.state[place, "position"] + offset})
    return f"{place.name} moved by {offset[0]:.2f}, {offset[1]:.2f} m", lambda: task.replaced(state=moved)


def _without(task: Task, gone: Token) -> Task:
    tokens = tuple(token for token in task.tokens if token is not gone)
    return task.replaced(tokens=tokens, state=_state(task, tokens), agents={})


def _with(task: Task, changed: Token) -> Task:
    tokens = tuple(changed if token.name == changed.name else token for token in task.tokens)
    return task.replaced(tokens=tokens, state=_state(task, tokens))


def _state(task: Task, tokens: tuple[Token, ...]) -> State:
    return State.of(tokens, {(t.name, v.name): task.state[t.name, v.name] for t in tokens for v in t.varying})

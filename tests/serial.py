"""Small domains of blocks in series for tests: parts that go through stages, and a planner that reports its effort."""

import re
import subprocess
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from importlib.resources import as_file, files
from itertools import pairwise
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from validation import read_action

from hybrid_tamp.model.affordance import TOKEN, AffordanceClass, ObjectClass, PlaceClass
from hybrid_tamp.model.block import Block, Duration, Slot, Target
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.network import ReassignmentNetwork
from hybrid_tamp.model.plan import PlannedAction
from hybrid_tamp.model.predicate import Atom, Literal, Parameter, Predicate, SymbolSort
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.symbolic.pddl.operators import PlanningProblem
from hybrid_tamp.symbolic.pddl.text import domain_text, problem_text


class Part(AffordanceClass):
    """Something that is worked on."""

    name: ClassVar[str] = "PART"


class Tool(AffordanceClass):
    """Something to work with."""

    name: ClassVar[str] = "TOOL"


class Station(PlaceClass):
    """Somewhere to work."""

    name: ClassVar[str] = "STATION"


def predicate(name: str, *sorts: type[ObjectClass] | SymbolSort, holds: Callable[..., bool], **named: Any) -> Predicate:
    """Return a predicate that initially holds for the values whose names satisfy `holds`."""

    def margin(state: State, *values: Token | str) -> Any:
        return np.where(holds(*(value if isinstance(value, str) else value.name for value in values)), 1.0, -1.0)

    parameters = tuple(Parameter(f"x{index}", sort) for index, sort in enumerate(sorts))
    return Predicate(name, parameters, margin, by_name=True, **named)


def changing(name: str, *sorts: type[ObjectClass] | SymbolSort, at_first: bool = False, **named: Any) -> Predicate:
    """Return a changing predicate that initially holds for all values or for none."""
    return predicate(name, *sorts, holds=lambda *_: at_first, **named)


def block(
    name: str,
    slots: Mapping[str, type[ObjectClass]],
    entry: Iterable[Literal] = (),
    exits: Iterable[Literal] = (),
    targets: Mapping[str, type[ObjectClass] | SymbolSort] | None = None,
    **named: Any,
) -> Block:
    """Return a block that lasts one second and is anchored at its first slot."""
    return Block(
        name=name,
        slots=tuple(Slot(slot, sort) for slot, sort in slots.items()),
        anchor=named.pop("anchor", next(iter(slots))),
        targets=tuple(Target(target, sort) for target, sort in (targets or {}).items()),
        entry=tuple(entry),
        exit=tuple(exits),
        duration=Duration(0.5, 2.0, lambda *_: 1.0),
        **named,
    )


COLOURS = SymbolSort("colour", ("red", "green", "blue"))

RESTING = Block(
    name="RESTING",
    slots=(Slot("token", TOKEN),),
    anchor="token",
    duration=Duration(0.1, 3600.0, lambda *_: 0.1),
    hold=True,
)


def domain(blocks: Sequence[Block], predicates: Sequence[Predicate], edges: Iterable[tuple[str, str]]) -> Domain:
    """Return a domain of parts, tools and stations, with RESTING."""
    return Domain(
        name="serial",
        classes=(Part, Tool, Station),
        predicates=tuple(predicates),
        blocks=(RESTING, *blocks),
        network=ReassignmentNetwork(edges),
        disjoint=((Part, Tool),),
    )


def in_series(blocks: Sequence[Block]) -> list[tuple[str, str]]:
    """Return the edges from RESTING through all blocks and back. The edges connect slots with the same name."""
    edges = [("RESTING.token", f"{blocks[0].name}.{slot.name}") for slot in blocks[0].slots]
    for one, other in pairwise(blocks):
        edges += [(f"{one.name}.{slot.name}", f"{other.name}.{slot.name}") for slot in one.slots]
    return edges + [(f"{blocks[-1].name}.{slot.name}", "RESTING.token") for slot in blocks[-1].slots]


def task(
    of: Domain,
    goal: Iterable[tuple[str, ...]],
    parts: int = 1,
    tools: int = 0,
    stations: int = 0,
    assignment: Mapping[str, str] | None = None,
) -> Task:
    """Return a task with these numbers of tokens: ``part 0``, ``tool 0``, ``station 0`` and so on."""
    kinds: list[tuple[str, int, type[ObjectClass]]] = [
        ("part", parts, Part),
        ("tool", tools, Tool),
        ("station", stations, Station),
    ]
    tokens = [Token.make(f"{kind} {i}", [sort], {}) for kind, count, sort in kinds for i in range(count)]
    atoms = tuple(Atom(name, tuple(arguments)) for name, *arguments in goal)
    return Task("serial", of, tuple(tokens), State.of(tokens, {}), atoms, assignment=dict(assignment or {}))


def stages(count: int, hold: bool = False) -> Domain:
    """Return a domain in which a part goes through all stages, with one block per step, and then back to RESTING."""
    reached = [changing(f"stage-{i}", Part, at_first=i == 0) for i in range(count + 1)]
    blocks = [
        block(
            f"B{i}", {"part": Part}, [reached[i - 1]("part")], [~reached[i - 1]("part"), reached[i]("part")], hold=hold
        )
        for i in range(1, count + 1)
    ]
    return domain(blocks, reached, in_series(blocks))


@dataclass(frozen=True)
class Effort:
    """Result of Fast Downward: numbers of ground operators and expanded states, and the plan or None."""

    operators: int
    expanded: int
    actions: list[PlannedAction] | None


def effort(folder: Path, problem: PlanningProblem) -> Effort:
    """Solve the exported problem with Fast Downward, as the default engine does."""
    (folder / "domain.pddl").write_text(domain_text(problem.domain))
    (folder / "problem.pddl").write_text(problem_text(problem))
    with as_file(files("up_fast_downward") / "downward" / "fast-downward.py") as program:
        command = [sys.executable, program, "--alias", "lama-first", "domain.pddl", "problem.pddl"]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False, timeout=120)
    plan = folder / "sas_plan"
    lines = plan.read_text().splitlines() if plan.exists() else []
    actions = [read_action(line) for line in lines if line.startswith("(")]
    plan.unlink(missing_ok=True)
    return Effort(
        _number(r"Translator operators: (\d+)", done.stdout),
        _number(r"Expanded (\d+) state", done.stdout),
        actions if lines else None,
    )


def _number(pattern: str, text: str) -> int:
    found = re.search(pattern, text)
    return int(found[1]) if found else -1

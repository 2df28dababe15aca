"""Build a task from Python values. The keys and the checks are the same as for a task file."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, is_dataclass
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import BaseModel

from hybrid_tamp.geometry.meshes import MeshShape
from hybrid_tamp.model.affordance import ObjectClass
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.task import Limits, MidLevel, Task
from hybrid_tamp.taskfile.domains import installed_domain
from hybrid_tamp.taskfile.loader import read_task
from hybrid_tamp.taskfile.places import Faults


def make_task(
    domain: Domain | str,
    tokens: Mapping[str, Mapping[str, Any]],
    goal: Sequence[Atom | Mapping[str, Sequence[str | Mapping[str, type[ObjectClass] | str]]]],
    *,
    agents: Mapping[str, Sequence[str]] | None = None,
    assignment: Mapping[str, str] | None = None,
    primitives: Mapping[str, Path | str] | None = None,
    planner: str | None = None,
    objective: str | None = None,
    limits: Limits | None = None,
    midlevel: MidLevel | None = None,
    safety: Mapping[str, float] | None = None,
    seed: int = 0,
    name: str = "task",
) -> Task:
    """Make a task from Python values. The keys and units are the same as in a task file (docs/taskfile.md).

    Args:
        domain: the domain, or the name of an installed domain.
        tokens: maps the name of each token to a mapping with its ``classes`` (names or classes), ``properties``,
            ``shape``, ``fixed`` and ``pose``. A pose has a ``position`` [m], and ``rpy`` [rad] or ``quaternion`` (x, y,
            z, w). Arrays and tuples may be used in place of lists.
        goal: the atoms that must hold at the end. Each atom is an `Atom` or ``{predicate: [tokens]}``. In place of a
            token, ``{"all": CLASS}`` (a class or its name) stands for one atom per token of the class.
        agents: maps each agent to the names of its capability tokens.
        assignment: maps each token to the block in which it starts; the domain's resting block by default.
        primitives: maps each block or action to the file of a motor primitive.
        planner: name of the planning engine.
        objective: quantity to minimise, ``length`` or ``makespan``.
        limits: limits of the command, the planner and the run.
        midlevel: settings for the optimisation of hyperparameters, including bounds and weights of measures.
        safety: maps names of predicates to safety factors of at least 1; the domain's factors by default.
        seed: seed of all random numbers.
        name: name of the task.

    Raises:
        InputError: the values have faults; each issue names the path of a faulty value, e.g. ``tokens.drum.pose``.
    """
    found = installed_domain(domain) if isinstance(domain, str) else domain
    optional = {
        "agents": agents,
        "assignment": assignment,
        "primitives": primitives,
        "planner": planner,
        "objective": objective,
        "limits": limits,
        "midlevel": midlevel,
        "safety": safety,
    }
    required = {"domain": found.name, "tokens": tokens, "goal": goal, "seed": seed, "name": name}
    data = _plain(required | {key: value for key, value in optional.items() if value is not None})
    return read_task(data, Faults(), name, Path(), lambda _: found)


def _plain(value: Any) -> Any:
    """Return a value as plain data, as in a task file."""
    if isinstance(value, type) and issubclass(value, ObjectClass):
        return value.name
    if isinstance(value, Atom):
        arguments = {value.predicate: list(value.arguments)}
        return arguments if value.positive else {"not": arguments}
    if isinstance(value, MeshShape):
        return {"kind": "mesh", "file": str(value.path), "scale": value.scale}
    if isinstance(value, BaseModel):
        return _plain(value.model_dump())
    if is_dataclass(value) and not isinstance(value, type):
        return _plain({key: each for key, each in asdict(value).items() if each is not None})
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    if isinstance(value, Path):
        return str(value)
    if isinstance(value, Mapping):
        return {key: _plain(each) for key, each in value.items()}
    if isinstance(value, tuple | list):
        return [_plain(each) for each in value]
    return value

"""Groups of goal atoms that can be planned separately, and the helpers and tasks of the groups.

Two goal atoms that share a token other than a place are in the same group. A helper, e.g. a hand, is a token that has
basic actions and is in no goal atom. The task of a group has the tokens of the group, some helpers, and places.
"""

from collections.abc import Collection, Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from hybrid_tamp.model.deadline import NEVER, Deadline
from hybrid_tamp.model.facts import StaticFacts, static_facts
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray


@dataclass(frozen=True, order=True)
class Signature:
    """The properties of a helper that matter to the planner. Equal helpers of equal groups have equal signatures.

    Attributes:
        classes: Names of the helper's classes.
        block: Name of the block in which the helper starts.
        facts: Pairs of (predicate, arguments), one for each fact about the helper. Tokens are replaced by labels.
    """

    classes: tuple[str, ...]
    block: str
    facts: tuple[tuple[str, tuple[str, ...]], ...]

    def less_than(self, other: "Signature") -> bool:
        """Return whether the helpers share classes and block, and `other` has all facts of this helper and more."""
        alike = (self.classes, self.block) == (other.classes, other.block)
        return alike and set(self.facts) < set(other.facts)


@dataclass(frozen=True)
class Group:
    """Goal atoms that share tokens.

    Attributes:
        goal: Goal atoms of the group.
        tokens: Names of the tokens in the atoms, without places, in the order of the atoms.
        places: Names of the places in the atoms.
    """

    goal: tuple[Atom, ...]
    tokens: tuple[str, ...]
    places: tuple[str, ...]


def goal_groups(task: Task, holding: Collection[Atom]) -> list[Group]:
    """Return the groups of goal atoms, except groups whose atoms all hold in the initial state (`holding`)."""
    sets: list[tuple[set[str], list[Atom]]] = []
    for atom in task.goal:
        names = {name for name in atom.arguments if name in task.token_by_name and not task.token_by_name[name].place}
        touched = [each for each in sets if each[0] & names]
        sets = [each for each in sets if each not in touched]
        atoms = [other for _, others in touched for other in others]
        sets.append((names.union(*(each[0] for each in touched)), [*atoms, atom]))
    order = {atom: index for index, atom in enumerate(task.goal)}
    found = [_group(task, sorted(atoms, key=order.__getitem__)) for _, atoms in sets]
    unmet = [group for group in found if not all(atom in holding for atom in group.goal)]
    return sorted(unmet, key=lambda group: order[group.goal[0]])


def _group(task: Task, atoms: list[Atom]) -> Group:
    names = dict.fromkeys(name for atom in atoms for name in atom.arguments if name in task.token_by_name)
    places = tuple(name for name in names if task.token_by_name[name].place)
    return Group(tuple(atoms), tuple(name for name in names if name not in places), places)


def goal_tokens(task: Task) -> set[str]:
    """Return the names of all tokens in the goal, including places."""
    return {name for atom in task.goal for name in atom.arguments if name in task.token_by_name}


def helpers(task: Task) -> list[Token]:
    """Return the tokens that have basic actions and are in no goal atom."""
    named = goal_tokens(task)
    return [token for token in task.assigned if token.basic_actions and token.name not in named]


def least_helpers(task: Task, group: Group, holding: Collection[Atom]) -> int:
    """Return the minimum number of helpers with which a group can fill a block for each missing goal atom."""
    sizes = [(literal.predicate.name, len(block.slots)) for block in task.domain.blocks for literal in block.exit]
    missing = [atom.predicate for atom in group.goal if atom not in holding]
    needed = [min((size for name, size in sizes if name == wanted), default=1) for wanted in missing]
    return max(1, max(needed, default=0) - len(group.tokens))


def most_helpers(task: Task) -> int:
    """Return twice the largest number of helpers in one block, so that each of them can be relieved."""
    return max(1, 2 * max(len(block.slots) - 1 for block in task.domain.blocks))


def own_task(task: Task, group: Group, chosen: Iterable[str], places: Collection[str]) -> Task:
    """Return the task of a group. Its tokens are those of the group, the chosen helpers and the given places."""
    return task.restrict({*group.tokens, *chosen, *places}, goal=group.goal)


class Helpers:
    """The distances and signatures of all helpers relative to one group."""

    def __init__(
        self, task: Task, group: Group, holding: Collection[Atom], feasible: StaticFacts, deadline: Deadline = NEVER
    ) -> None:
        """Store the task and the group.

        Args:
            task: Whole task.
            group: Group of goals of the task.
            holding: Atoms that hold in the initial state.
            feasible: Feasibility facts of the task.
            deadline: Deadline of the command.
        """
        self._task = task
        self._deadline = deadline
        self._group = group
        self._holding = holding
        self._feasible = feasible
        self._signatures: dict[str, Signature] = {}

    @cached_property
    def closest(self) -> list[str]:
        """The names of the helpers, sorted by their distance to the group."""
        return sorted((token.name for token in helpers(self._task)), key=lambda name: (self.distance(name), name))

    def distance(self, name: str) -> float:
        """Return the distance from a helper to the closest token of the group [m], or 0 if a position is missing."""
        here = self._position(name)
        there = [place for place in map(self._position, self._group.tokens) if place is not None]
        if here is None or not there:
            return 0.0
        return min(float(np.linalg.norm(here - place)) for place in there)

    def _position(self, name: str) -> FloatArray | None:
        key = (name, "position")
        return self._task.state[key] if key in self._task.state.layout.slices else None

    def signature(self, name: str) -> Signature:
        """Return the signature of a helper.

        Raises:
            LimitReached: If the deadline passes.
        """
        if name not in self._signatures:
            self._deadline.check()
            self._signatures[name] = self._describe(self._task.token_by_name[name])
        return self._signatures[name]

    def _describe(self, helper: Token) -> Signature:
        own = own_task(self._task, self._group, (helper.name,), self._group.places)
        labels = {name: f"#{i}" for i, name in enumerate((*self._group.tokens, *self._group.places))}
        labels[helper.name] = "#helper"
        others = self._task.token_by_name.keys() - labels.keys()
        known = [
            (atom.predicate, tuple(labels.get(name, name) for name in atom.arguments))
            for atom in (*static_facts(own, self._feasible), *self._holding)
            if helper.name in atom.arguments and others.isdisjoint(atom.arguments)
        ]
        block = self._task.start_block(helper.name).name
        return Signature(tuple(c.name for c in helper.classes), block, tuple(sorted(known)))

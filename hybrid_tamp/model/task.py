"""Tasks: tokens of a domain with an initial state, agents and a goal."""

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path

from hybrid_tamp.model.affordance import ObjectClass
from hybrid_tamp.model.bindings import enumerate_bindings, names_of
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.choice import ground_goals
from hybrid_tamp.model.crowding import Crowding, find_crowding
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.predicate import ANY, Atom, Literal, SymbolSort, Value
from hybrid_tamp.model.state import State
from hybrid_tamp.model.token import Token

DEFAULT_PLANNER = "fast-downward"


@dataclass(frozen=True)
class Limits:
    """Limits on planning and running a task.

    The limits `time` and `memory` can end a command, but never change the results of a finished command.

    Attributes:
        time: limit on the wall-clock time of a whole command [s].
        memory: limit on the total memory of the planner and its child processes [MiB].
        refinements: largest number of repeated planner calls after rejected plans.
        contact: largest tolerated force of a contact that no running block allows [N].
        clearance: distance that planned movements keep from bodies at rest [m], as an allowance for the errors of
            servos and of the distances.
    """

    time: float = 600.0
    memory: float = 4096.0
    refinements: int = 3
    contact: float = 20.0
    clearance: float = 0.002


@dataclass(frozen=True)
class Range:
    """Settings of a task for one hyperparameter. None keeps the value that the block declares.

    Attributes:
        lower: lower bound [unit], not below the lower bound of the block.
        upper: upper bound [unit], not above the upper bound of the block.
        default: value if the hyperparameter is not optimised [unit], within the bounds.
    """

    lower: float | None = None
    upper: float | None = None
    default: float | None = None


@dataclass(frozen=True)
class MidLevel:
    """Settings for the optimisation of a plan's hyperparameters (paper, Sec. II-D).

    Attributes:
        optimiser: ``cma`` (CMA-ES) or ``grid`` (direct sampling on a grid, as in the paper).
        evaluations: largest number of rollouts.
        refine: ``physics`` for further optimisation in the physics backend, or ``none``.
        objective: what the search maximises among the candidates that satisfy all conditions: the weighted sum of the
            performance measures (``performance``), or minus the distance between final state and goal (``distance``).
        weights: maps ``BLOCK.measure`` to the measure's weight. The blocks of the task already have these weights.
        hyperparameters: maps ``BLOCK.name`` to a value or to narrower bounds. The blocks already have these settings.
    """

    optimiser: str = "cma"
    evaluations: int = 2000
    refine: str = "none"
    objective: str = "performance"
    weights: Mapping[str, float] = field(default_factory=dict)
    hyperparameters: Mapping[str, float | Range] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Task:
    """One problem of a domain.

    Attributes:
        name: name of the task, by default the stem of the task file.
        domain: domain of the task.
        tokens: all tokens, including places, in the order of the task file.
        state: initial continuous state.
        goal: atoms over tokens that must hold at the end. An atom with `ANY` leaves a choice of tokens or symbols.
        agents: maps each agent to the names of its capability tokens.
        assignment: maps the name of each token to the block in which the token starts.
        planner: name of the planning engine.
        limits: limits on planning.
        seed: seed of all random numbers.
        objective: quantity that is minimised: ``length`` (number of actions) or ``makespan`` (duration of the plan).
        midlevel: settings for the optimisation of hyperparameters.
        safety: maps predicates to the safety factors of the task. The predicates of `domain` already have the factors.
        source: path of the task file, or None.
        primitives: maps a block or action to the file of a learnt motor primitive, which the domain already contains.
    """

    name: str
    domain: Domain
    tokens: tuple[Token, ...]
    state: State
    goal: tuple[Atom, ...]
    agents: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    assignment: Mapping[str, str] = field(default_factory=dict)
    planner: str = DEFAULT_PLANNER
    limits: Limits = Limits()
    seed: int = 0
    objective: str = "length"
    midlevel: MidLevel = field(default_factory=MidLevel)
    safety: Mapping[str, float] = field(default_factory=dict)
    source: Path | None = None
    primitives: Mapping[str, Path] = field(default_factory=dict)

    @cached_property
    def token_by_name(self) -> Mapping[str, Token]:
        """Maps each name to its token."""
        return {token.name: token for token in self.tokens}

    @property
    def assigned(self) -> tuple[Token, ...]:
        """Tokens that must be in a slot at every instant, which are all tokens except places."""
        return tuple(token for token in self.tokens if not token.place)

    @property
    def fixed_bodies(self) -> tuple[str, ...]:
        """Names of the places with a body, which count as a part of the floor, e.g. tables."""
        return tuple(token.name for token in self.tokens if token.place and token.fixed_body)

    def start_block(self, name: str) -> Block:
        """Return the block in which a token starts."""
        return self.domain.block_by_name[self.assignment.get(name, self.domain.resting)]

    def replaced(self, **changes: object) -> "Task":
        """Return a copy of the task with new values of some attributes."""
        return replace(self, **changes)  # type: ignore[arg-type]

    def with_safety(self, factors: Mapping[str, float]) -> "Task":
        """Return the task with other safety factors. `factors` maps names of predicates to factors of at least 1."""
        return self.replaced(domain=self.domain.with_safety(factors), safety={**self.safety, **factors})

    def restrict(self, names: Collection[str], **changes: object) -> "Task":
        """Return the task with only the named tokens and with new values of some attributes."""
        tokens = tuple(token for token in self.tokens if token.name in names)
        return self.replaced(
            tokens=tokens,
            state=State.of(tokens, {(t.name, v.name): self.state[t, v.name] for t in tokens for v in t.varying}),
            agents={agent: tuple(name for name in own if name in names) for agent, own in self.agents.items()},
            assignment={name: block for name, block in self.assignment.items() if name in names},
            **changes,
        )

    def values_of(self, sort: type[ObjectClass] | SymbolSort) -> tuple[Value, ...]:
        """Return the tokens of a class, or the symbols of a sort."""
        if isinstance(sort, SymbolSort):
            return sort.symbols
        return tuple(token for token in self.tokens if token.is_member(sort))

    def value(self, name: str) -> Value:
        """Return the token with this name, or the name itself if the name is a symbol."""
        return self.token_by_name.get(name, name)

    def bind(self, roles: Mapping[str, str]) -> dict[str, Value]:
        """Return a binding of roles to tokens and symbols. `roles` maps each role to the name of a token or symbol."""
        return {role: self.value(name) for role, name in roles.items()}

    def choices(self, block: Block, fixed: Mapping[str, Value] | None = None) -> dict[str, tuple[Value, ...]]:
        """Return a mapping from each role of a block to its possible values. A fixed role has at most one value."""
        every = {role: self.values_of(sort) for role, sort in block.roles.items()}
        fixed = fixed or {}
        return {
            role: tuple(value for value in values if role not in fixed or value == fixed[role])
            for role, values in every.items()
        }

    def margin(self, atom: Atom, state: State | None = None) -> float:
        """Return the signed margin of an atom in a state, by default the initial state.

        The margin of a positive atom with a choice is the largest margin of its groundings, or -inf without groundings.
        """
        if ANY in atom.arguments:
            best = max((self.margin(each, state) for each in self.groundings(atom)), default=-math.inf)
            return best if atom.positive else -best
        literal = Literal(self.domain.predicate_by_name[atom.predicate], atom.arguments, atom.positive)
        return float(literal.margin(state or self.state, self.token_by_name))

    @cached_property
    def unsettled(self) -> tuple[tuple[Atom, Token, type[ObjectClass]], ...]:
        """Triples of (goal atom, token, class). The atom requires the token to be a member, but this is unknown."""
        return tuple(
            (atom, token, parameter.sort)
            for atom in self.goal
            for name, parameter in zip(
                atom.arguments, self.domain.predicate_by_name[atom.predicate].parameters, strict=True
            )
            if not isinstance(parameter.sort, SymbolSort)
            and (token := self.token_by_name.get(name)) is not None
            and token.may_be_member(parameter.sort)
        )

    @property
    def definite(self) -> bool:
        """Whether the task is a single planning problem: the goal has no choice and requires no unknown membership."""
        return not self.unsettled and len(self.alternatives()) == 1

    def groundings(self, atom: Atom) -> tuple[Atom, ...]:
        """Return the groundings of an atom with a choice as positive atoms, in which no token occurs twice."""
        parameters = self.domain.predicate_by_name[atom.predicate].parameters
        choices = {
            parameter.name: self.values_of(parameter.sort) if argument == ANY else (self.value(argument),)
            for argument, parameter in zip(atom.arguments, parameters, strict=True)
        }
        return tuple(Atom(atom.predicate, names_of(bound)) for bound in enumerate_bindings(choices))

    def crowding(self) -> Crowding | None:
        """Return a place that is too small for two bodies that the ground goal puts there, or None."""
        return find_crowding(self.domain, self.token_by_name, self.state, self.goal)

    def alternatives(self) -> tuple["Task", ...]:
        """Return one task for each ground goal of this task, the nearest goal first.

        Raises:
            InputError: if there are too many ground goals, or if there is no ground goal.
        """
        if not any(ANY in atom.arguments for atom in self.goal):
            return (self,)
        goals = ground_goals(self.goal, self.domain.predicate_by_name, self.groundings, self.margin)
        return tuple(self.replaced(goal=goal) for goal in goals)

"""A task: tokens of a domain with their initial state, their agents, and the goal."""

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path

from hybrid_tamp.model.affordance import ObjectClass
from hybrid_tamp.model.bindings import enumerate_bindings, names_of
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.choice import ground_goals
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.predicate import ANY, Atom, Literal, SymbolSort, Value
from hybrid_tamp.model.state import State
from hybrid_tamp.model.token import Token

DEFAULT_PLANNER = "fast-downward"


@dataclass(frozen=True)
class Limits:
    """Bounds on the work for one task.

    Attributes:
        time: wall-clock time of the planner [s].
        memory: memory of the planner and its children together [MiB].
        refinements: largest number of further calls of the planner after refused plans.
    """

    time: float = 60.0
    memory: float = 4096.0
    refinements: int = 3


@dataclass(frozen=True)
class Range:
    """A task's settings of a hyperparameter, in its unit; None keeps the block's declaration.

    Attributes:
        lower: lower bound, not below the block's own.
        upper: upper bound, not above the block's own.
        default: its value without optimisation, within the bounds.
    """

    lower: float | None = None
    upper: float | None = None
    default: float | None = None


@dataclass(frozen=True)
class MidLevel:
    """How the hyperparameters of a plan are optimised (paper, Sec. II-D).

    Attributes:
        optimiser: ``cma`` (CMA-ES) or ``grid`` (direct sampling on a grid, as the paper did).
        evaluations: budget of rollouts.
        seconds: budget of time [s].
        refine: ``none``, or ``physics`` for further optimisation in the physics backend.
        weights: ``BLOCK.measure`` to its weight in the value of a plan; the task's domain has it already.
        hyperparameters: ``BLOCK.name`` to narrower bounds or to its value; the task's domain has them already.
    """

    optimiser: str = "cma"
    evaluations: int = 2000
    seconds: float = 20.0
    refine: str = "none"
    weights: Mapping[str, float] = field(default_factory=dict)
    hyperparameters: Mapping[str, float | Range] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Task:
    """One problem of a domain.

    Attributes:
        name: name of the task, by default the stem of its file.
        domain: the domain.
        tokens: all tokens, places included, in the file's order.
        state: the initial continuous state.
        goal: atoms over tokens that must hold at the end; `ANY` in an atom leaves a choice.
        agents: agent to the names of its capability tokens.
        assignment: token to the block in which it starts.
        planner: name of the planning engine.
        limits: bounds on the work.
        seed: seed of all random numbers.
        objective: the minimised quantity, ``length`` (number of actions) or ``makespan`` (time).
        midlevel: how hyperparameters are optimised.
        source: the task file, or None.
        primitives: block or action to the file of its learned motor primitive; the domain has it already.
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
    source: Path | None = None
    primitives: Mapping[str, Path] = field(default_factory=dict)

    @cached_property
    def token_by_name(self) -> Mapping[str, Token]:
        """Tokens by the user's names."""
        return {token.name: token for token in self.tokens}

    @property
    def assigned(self) -> tuple[Token, ...]:
        """The tokens that must be in a slot at every instant: all but places."""
        return tuple(token for token in self.tokens if not token.place)

    def start_block(self, name: str) -> Block:
        """Return the block in which a token starts."""
        return self.domain.block_by_name[self.assignment.get(name, self.domain.resting)]

    def replaced(self, **changes: object) -> "Task":
        """Return a copy with other values of some attributes."""
        return replace(self, **changes)  # type: ignore[arg-type]

    def restrict(self, names: Collection[str], **changes: object) -> "Task":
        """Return the task with only these tokens, and with other values of some attributes."""
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
        """Return the token of that name, or the name itself as a symbol."""
        return self.token_by_name.get(name, name)

    def bind(self, roles: Mapping[str, str]) -> dict[str, Value]:
        """Return role to token or symbol from role to name."""
        return {role: self.value(name) for role, name in roles.items()}

    def choices(self, block: Block, fixed: Mapping[str, Value] | None = None) -> dict[str, tuple[Value, ...]]:
        """Return role to its possible values, by its class or sort and by the fixed roles."""
        every = {role: self.values_of(sort) for role, sort in block.roles.items()}
        fixed = fixed or {}
        return {
            role: tuple(value for value in values if role not in fixed or value == fixed[role])
            for role, values in every.items()
        }

    def margin(self, atom: Atom, state: State | None = None) -> float:
        """Return the signed margin of an atom, in the initial state by default.

        The margin of an atom with a choice is the largest of its groundings; minus infinity if it has none.
        """
        if ANY in atom.arguments:
            best = max((self.margin(each, state) for each in self.groundings(atom)), default=-math.inf)
            return best if atom.positive else -best
        literal = Literal(self.domain.predicate_by_name[atom.predicate], atom.arguments, atom.positive)
        return float(literal.margin(state or self.state, self.token_by_name))

    @cached_property
    def unsettled(self) -> tuple[tuple[Atom, Token, type[ObjectClass]], ...]:
        """(goal atom, token, class) where the atom needs a membership of the token that is unknown."""
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
        """Whether the task is one planning problem: the goal leaves no choice and needs no unknown membership."""
        return not self.unsettled and len(self.alternatives()) == 1

    def groundings(self, atom: Atom) -> tuple[Atom, ...]:
        """Return the positive groundings of an atom with a choice, over different tokens."""
        parameters = self.domain.predicate_by_name[atom.predicate].parameters
        choices = {
            parameter.name: self.values_of(parameter.sort) if argument == ANY else (self.value(argument),)
            for argument, parameter in zip(atom.arguments, parameters, strict=True)
        }
        return tuple(Atom(atom.predicate, names_of(bound)) for bound in enumerate_bindings(choices))

    def alternatives(self) -> tuple["Task", ...]:
        """Return the tasks with the ground goals of this one, the nearest first.

        Raises:
            InputError: there are too many, or none.
        """
        if not any(ANY in atom.arguments for atom in self.goal):
            return (self,)
        goals = ground_goals(self.goal, self.domain.predicate_by_name, self.groundings, self.margin)
        return tuple(self.replaced(goal=goal) for goal in goals)

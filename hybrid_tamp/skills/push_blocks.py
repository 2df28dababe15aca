"""Maker of the two blocks of a push: the hand reaches a position behind the object, and pushes the object."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from hybrid_tamp.model.affordance import ObjectClass
from hybrid_tamp.model.block import FLOOR, Block, Duration, Slot, Target
from hybrid_tamp.model.control import Hyperparameter
from hybrid_tamp.model.predicate import ANY, Binding, Literal, Parameter, Predicate, SymbolSort, Value
from hybrid_tamp.model.state import State
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.skills.alignment import ALIGNED, Alignment
from hybrid_tamp.skills.classes import Container, StaticEndEffector
from hybrid_tamp.skills.facts import within_reach
from hybrid_tamp.skills.predicates import AT_REST, IN_WORKSPACE, at_place, physical_bound
from hybrid_tamp.skills.pushing import Push
from hybrid_tamp.skills.reaching import ReachGoal, make_reaching
from hybrid_tamp.skills.roles import BODY, MOTION, POSE, get_token

_TOLERANCE = 0.025
"""Largest distance of a hand from its standby position [m]."""
_SPEED, _DECELERATION = 0.2, 0.15
"""Default speed [m/s] and default final deceleration [m/s^2] of a push."""


@dataclass(frozen=True)
class _Roles:
    """The roles of a push, in the order of the arguments of its predicates: hand, object, targets."""

    names: tuple[str, ...]
    sorts: tuple[type[ObjectClass] | SymbolSort, ...]

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        return tuple(map(Parameter, self.names, self.sorts))

    def bind(self, *values: Value) -> Binding:
        return dict(zip(self.names, values, strict=True))

    def reads(self, hand: tuple[str, ...]) -> dict[str, tuple[str, ...]]:
        read = {
            name: POSE
            for name, sort in zip(self.names, self.sorts, strict=True)
            if name != "hand" and not isinstance(sort, SymbolSort)
        }
        return {"hand": hand, **read}


def make_pushing(
    name: str,
    push: Push,
    thing: type[ObjectClass],
    targets: tuple[Target, ...],
    effects: tuple[Literal, ...],
    feasible: tuple[Literal, ...] = (),
    facts: tuple[Literal, ...] | None = None,
    lasting: tuple[Literal, ...] = (),
    keeps: tuple[tuple[Predicate, ...], tuple[Predicate, ...]] = ((), ()),
    hyperparameters: Iterable[Hyperparameter] = (),
    contacts: Iterable[tuple[str, str]] = (("object", FLOOR),),
    description: str = "the hand pushes the object from behind",
) -> tuple[Block, Block]:
    """Return the blocks ``REACHING:behind`` and `name`, with the slots `hand` and `object`.

    By default, the blocks also require two facts: the hand is strong enough (`able_to_push`), and the hand stays in its
    workspace during the push (`push_within_reach`). An object that the push puts into a container may touch whatever
    already lies in this container.

    Args:
        name: name of the pushing block, e.g. ``"SWEEPING"``.
        push: the movement.
        thing: class of the pushed object.
        targets: roles that determine the push, e.g. a region.
        effects: exit conditions in addition to the rest of hand and object.
        feasible: further feasibility facts that the push requires.
        facts: feasibility facts that replace `able_to_push` and `push_within_reach`, or None.
        lasting: conditions that must hold until the reach ends, in addition to the rest of the object.
        keeps: predicates that the reach does not change, and predicates that the push does not change.
        hyperparameters: hyperparameters of the push that replace the default hyperparameters of the same names.
        contacts: pairs of roles that may touch, in addition to the hand and the object.
        description: description of the pushing block in one line.
    """
    sorts = (StaticEndEffector, thing, *(target.sort for target in targets))
    roles = _Roles(("hand", "object", *(target.name for target in targets)), sorts)
    behind = _behind(push, roles)
    facts = (*(_facts(push, roles) if facts is None else facts), *feasible)
    pushing = Block(
        name=name,
        slots=(Slot("hand", StaticEndEffector), Slot("object", thing)),
        anchor="object",
        targets=targets,
        entry=(*facts, behind(*roles.names), AT_REST("object")),
        exit=(*effects, AT_REST("object"), AT_REST("hand"), IN_WORKSPACE("hand")),
        invariants=(IN_WORKSPACE("hand"),),
        writes={"hand": MOTION, "object": BODY},
        keeps=keeps[1],
        allowed_contacts=(("hand", "object"), *contacts, *_beside_others(effects, targets)),
        hyperparameters=_hyperparameters(push, hyperparameters),
        duration=Duration(0.2, 40.0),
        policy=push.policy,
        sweep=push.sweep,
        straight={"object": lambda binding, start: push.line(binding, start)[0]},
        system=push.system,
        description=description,
    )
    reached = (Target("object", thing), *targets)
    return _reach_behind(push, reached, facts, behind(*roles.names), lasting, keeps[0]), pushing


def _reach_behind(
    push: Push,
    targets: tuple[Target, ...],
    facts: tuple[Literal, ...],
    behind: Literal,
    lasting: tuple[Literal, ...],
    keeps: tuple[Predicate, ...],
) -> Block:
    goal = ReachGoal(
        targets=targets,
        position=push.standby,
        orientation=lambda binding, state: push.aligned(binding, state)[get_token(binding, "hand"), "orientation"],
        entry=(*facts, AT_REST("object")),
        arrived=(behind, IN_WORKSPACE("hand")),
        lasting=(AT_REST("object"), *lasting),
        keeps=keeps,
    )
    return make_reaching(goal, "behind")


def _beside_others(effects: Iterable[Literal], targets: Iterable[Target]) -> Iterator[tuple[str, Literal]]:
    """Yield the contacts of the object with everything that already is where a functional effect puts the object."""
    containers = {each.name for each in targets if isinstance(each.sort, type) and issubclass(each.sort, Container)}
    for literal in effects:
        place = literal.predicate.functional_index
        if literal.positive and place is not None and literal.arguments[place] in containers:
            others = (ANY if argument == "object" else argument for argument in literal.arguments)
            yield "object", replace(literal, arguments=tuple(others))


def _hyperparameters(push: Push, replaced: Iterable[Hyperparameter]) -> tuple[Hyperparameter, ...]:
    chosen = (
        Hyperparameter("distance", "m", 0.0, 10.0, lambda b, s: push.line(b, s)[1], "distance of the push"),
        Hyperparameter("speed", "m/s", 0.05, 0.6, lambda b, s: np.asarray(_SPEED), "largest speed"),
        Hyperparameter(
            "deceleration", "m/s^2", 0.02, 1.0, lambda b, s: np.asarray(_DECELERATION), "final deceleration"
        ),
    )
    return tuple({each.name: each for each in (*chosen, *replaced)}.values())


def _facts(push: Push, roles: _Roles) -> tuple[Literal, ...]:
    """Return the conditions that the hand is strong enough and stays in its workspace."""
    return _able(push, roles)(*roles.names), _room(push, roles)(*roles.names)


def _behind(push: Push, roles: _Roles) -> Predicate:
    return at_place(
        "behind",
        roles.parameters,
        _TOLERANCE,
        lambda state, *values: push.standby(roles.bind(*values), state),
        Alignment(lambda state, *values: push.across(roles.bind(*values), state), ALIGNED),
        reads=roles.reads(POSE),
        description="{hand} is behind {object}, ready to push it",
        denial="{hand} is not behind {object}",
    )


def _able(push: Push, roles: _Roles) -> Predicate:
    def margin(*values: Value) -> float:
        binding = roles.bind(*values)
        return float(get_token(binding, "hand")["maximal_force"] - push.resistance(binding).force)

    return physical_bound(
        "able_to_push",
        roles.parameters,
        margin,
        unit="N",
        scale=10.0,
        description="{hand} is strong enough to push {object}",
        denial="{hand} is too weak to push {object} against its friction",
    )


def _room(push: Push, roles: _Roles) -> Predicate:
    def ends(state: State, *values: Value) -> tuple[FloatArray, FloatArray]:
        binding = roles.bind(*values)
        direction, distance = push.line(binding, state)
        begin = push.standby(binding, state)
        return begin, begin + direction * distance[..., None]

    return within_reach(
        "push_within_reach",
        roles.parameters,
        ends,
        # A hand that cannot turn keeps its orientation, and another hand lies across the line.
        reads=roles.reads(()),
        description="{hand} stays in its workspace when it pushes {object}",
        denial="{hand} would leave its workspace when it pushes {object}",
    )

"""Encoder, which converts the blocks of any domain to durative actions.

An action takes all tokens of a block at once. Its parameters are the tokens and targets of the block. The action lasts
until the exit conditions are expected to hold. Then the tokens stay in the block until other actions take them. These
fluents enforce the law of assignment:

| fluent | value |
|---|---|
| `place(token)` | slot of the token; changes when an action ends |
| `passes(slot, slot)` | whether the network has an edge between the two slots |
| `partner(token)` | anchor of the token's instance, if the instance has several slots |
| `let-go(anchor)` | whether the anchor has left its last instance, so that the other tokens may leave |
| `crew(anchor)` | number of tokens with this partner; must equal the number of the other slots when an action ends |
| `reads(anchor)` | locked target that the anchor's instance reads |
| `readers(token)` | number of instances that read the token; must be zero while a block changes the token |
| `completed(token)` | whether the token may stay in its block; must be true in the goal |

A functional predicate becomes a fluent. Its functional argument is the fluent's value, and its other arguments are the
fluent's parameters. A maintained predicate becomes a fluent of one token (`assignment.keeper`), because a token is in
one instance at a time. If the token of a slot may come either with the anchor or separately, each case has its own
action.

The encoding is weaker than the law in two points. Tokens may leave an instance slightly later than its anchor. If a
block has no hold, its tokens may stay in the block after its end.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import product

from hybrid_tamp.model.affordance import TOKEN
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.symbolic.encoding.assignment import ROOT
from hybrid_tamp.symbolic.encoding.vocabulary import Vocabulary
from hybrid_tamp.symbolic.pddl.naming import legal, name_apart, name_variables
from hybrid_tamp.symbolic.pddl.operators import Typed
from hybrid_tamp.symbolic.temporal.action import ActionMaker, Running
from hybrid_tamp.symbolic.temporal.problem import DurativeAction, Fluent, TemporalDomain
from hybrid_tamp.symbolic.temporal.words import NOBODY, Words


@dataclass(frozen=True, eq=False)
class TemporalEncoding:
    """The temporal encoding of a domain.

    Attributes:
        vocabulary: PDDL names that the classical and the temporal encoding share.
        names: PDDL names of the temporal encoding.
        planning: Temporal planning domain.
        running: Maps the name of each action to the block that the action runs.
    """

    vocabulary: Vocabulary
    names: Words
    planning: TemporalDomain
    running: dict[str, Running]


def encode_durative(domain: Domain) -> TemporalEncoding:
    """Encode the blocks and the network of a domain as durative actions. The result does not depend on a task."""
    encoder = _Encoder(Vocabulary(domain))
    built = list(encoder.actions())
    names = name_apart({number: action.name for number, (action, _) in enumerate(built)})
    built = [(replace(action, name=names[number]), running) for number, (action, running) in enumerate(built)]
    planning = TemporalDomain(
        name=legal(domain.name),
        types=(*encoder.vocabulary.types, (encoder.words("slot"), ROOT)),
        constants=tuple(encoder.constants()),
        fluents=tuple(encoder.fluents([action for action, _ in built])),
        actions=tuple(action for action, _ in built),
        comments=encoder.vocabulary.names.changed,
    )
    return TemporalEncoding(encoder.vocabulary, encoder.words, planning, {a.name: running for a, running in built})


class _Encoder:
    def __init__(self, vocabulary: Vocabulary) -> None:
        self.vocabulary = vocabulary
        self.domain = vocabulary.domain
        self.words = Words(vocabulary)

    # -- declarations -------------------------------------------------------------------------------------------

    def constants(self) -> Iterator[Typed]:
        """Yield the constants for symbols, slots and missing values."""
        token, slot = self.vocabulary.type_of(TOKEN), self.words("slot")
        own = {constant for constant, _ in self.vocabulary.constants[-1:]}  # Temporal problems count with numbers.
        yield from (each for each in self.vocabulary.constants if each[0] not in own)
        yield (self.words(NOBODY), token)
        for block in self.domain.blocks:
            yield from ((self.words.slot(block, each.name), slot) for each in block.slots)
        for predicate in self.domain.predicates:
            key = self.words.key(predicate)
            if predicate.maintained and len(key) < len(predicate.parameters):
                for index, parameter in enumerate(predicate.parameters):
                    if index not in key:
                        kind = self.vocabulary.type_of(parameter.sort)
                        yield (self.words("no", predicate.name, parameter.name), kind)

    def fluents(self, actions: list[DurativeAction]) -> Iterator[Fluent]:
        """Yield the fluents of the user's predicates, and the encoder's own fluents that an action mentions."""
        token, slot = self.vocabulary.type_of(TOKEN), self.words("slot")
        yield from self._users()
        mentioned = {fact[0] for action in actions for fact in action.facts}
        own = [
            Fluent(self.words("place"), (("?token", token),), "objects", (slot,)),
            Fluent(self.words("passes"), (("?from", slot), ("?to", slot))),
            Fluent("distinct", (("?one", ROOT), ("?other", ROOT))),
            Fluent(self.words("partner"), (("?token", token),), "objects", (token,)),
            Fluent(self.words("let-go"), (("?token", token),)),
            Fluent(self.words("crew"), (("?token", token),), "number"),
            *(Fluent(self.words.reads(n), (("?token", token),), "objects", (token,)) for n in range(self.words.locks)),
            Fluent(self.words("readers"), (("?token", token),), "number"),
            Fluent(self.words("completed"), (("?token", token),)),
        ]
        yield from (fluent for fluent in own if fluent.name in mentioned)
        for block in self.domain.blocks:
            types = map(self.vocabulary.type_of, block.roles.values())
            roles = tuple(zip(name_variables(block.roles), types, strict=True))
            yield Fluent(self.words("lasts", block.name), roles, "number")

    def _users(self) -> Iterator[Fluent]:
        changing = {self.vocabulary.predicate(p.name): p for p in self.domain.changing_predicates}
        for name, parameters in self.vocabulary.predicates:
            if name in changing:
                key = self.words.key(changing[name])
                values = tuple(kind for i, (_, kind) in enumerate(parameters) if i not in key)
                # A token of any class may leave a block and so end a maintained condition.
                wide = changing[name].maintained and values
                keys = tuple(
                    (parameters[i][0], self.vocabulary.type_of(TOKEN) if wide else parameters[i][1]) for i in key
                )
                yield Fluent(name, keys, "objects" if values else "truth", values)
            else:
                yield Fluent(name, parameters)

    # -- origins of tokens -----------------------------------------------------------------------------

    def actions(self) -> Iterator[tuple[DurativeAction, Running]]:
        """Yield one action for each block and each set of slots whose tokens come from the anchor's last instance."""
        for block in self.domain.blocks:
            choices = [self._choices(block, slot.name) for slot in block.slots]
            for chosen in product(*choices):
                along = frozenset(slot.name for slot, along in zip(block.slots, chosen, strict=True) if along)
                yield ActionMaker(self.words, block, along).build()

    def _choices(self, block: Block, slot: str) -> list[bool]:
        """Return the possible cases for the token of a slot. True means that the token comes with the anchor."""
        return [along for along in (False, True) if self.words.sources(block, slot, along)]

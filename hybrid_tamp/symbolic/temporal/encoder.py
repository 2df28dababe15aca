"""Encoder: block declarations to durative actions, one per block, for any domain.

An action takes all tokens of a block at once and has all targets as parameters. It lasts until the exit conditions are
expected to hold. After that the tokens stay in their slots (the hold) until other actions take them. These fluents
enforce the law of assignment:

| fluent | says |
|---|---|
| `place(token)` | the slot of the token's present or last hold |
| `passes(slot, slot)` | an edge of the network |
| `partner(token)` | the anchor of the token's instance, if the instance has several slots |
| `let-go(anchor)` | the anchor has left its last instance, so the other tokens may leave, too |
| `crew(anchor)` | number of tokens in the anchor's instances; one must be empty before the next reaches its exit |
| `reads(token)` | the tokens that the token's instance reads |
| `readers(token)` | number of instances that read the token; zero while a block changes it |
| `completed(token)` | the block that the token is in has a hold; the goal requires this |

A functional predicate becomes a fluent: its one value is the fluent's value, and its other arguments are the fluent's
parameters. A maintained predicate is a fluent of the token
that carries it (`assignment.keeper`), because a token is in one instance at a time. If the token of a slot may come
together with the anchor or on its own, there is an action for each case.

In two points the encoding is weaker than the law: tokens may leave an instance a little later than its anchor, and
tokens may leave a block without a hold after its end.
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
    """The temporal planning domain of a domain, and a map from the name of each action to the block that it runs."""

    vocabulary: Vocabulary
    names: Words
    planning: TemporalDomain
    running: dict[str, Running]


def encode_durative(domain: Domain) -> TemporalEncoding:
    """Compile the blocks and the network of a domain to durative actions. The result depends on nothing else."""
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
        """Yield the symbols, the slots, and the values that mean 'no value'."""
        token, slot = self.vocabulary.type_of(TOKEN), self.words("slot")
        own = {constant for constant, _ in self.vocabulary.constants[-1:]}  # The count is not used here.
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
        """Yield the fluents of the user, and those of the encoder that an action mentions."""
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
                # Tokens of any class may carry a maintained condition and leave it.
                wide = changing[name].maintained and values
                keys = tuple(
                    (parameters[i][0], self.vocabulary.type_of(TOKEN) if wide else parameters[i][1]) for i in key
                )
                yield Fluent(name, keys, "objects" if values else "truth", values)
            else:
                yield Fluent(name, parameters)

    # -- origins of tokens -----------------------------------------------------------------------------

    def actions(self) -> Iterator[tuple[DurativeAction, Running]]:
        """Yield the actions of every block, one for each set of tokens that come along with the anchor."""
        for block in self.domain.blocks:
            choices = [self._choices(block, slot.name) for slot in block.slots]
            for chosen in product(*choices):
                along = frozenset(slot.name for slot, along in zip(block.slots, chosen, strict=True) if along)
                yield ActionMaker(self.words, block, along).build()

    def _choices(self, block: Block, slot: str) -> list[bool]:
        """Return whether the token of a slot may come on its own, along with the anchor, or both."""
        return [along for along in (False, True) if self.words.sources(block, slot, along)]

"""Encoder: block declarations to durative actions, one a block, generic over domains.

An action takes all tokens of a block at once, with all its targets as parameters. It lasts as long as the block is
expected to until its exit conditions hold; then the tokens stay in their slots, which is the hold, until other actions
take them. What makes it true to the law, up to what `decoder` does:

| fluent | says |
|---|---|
| `place(token)` | the slot in which it holds or held last; `passes(slot, slot)` are the network's edges |
| `partner(token)` | the anchor of the instance in which it holds, where that has several slots |
| `let-go(anchor)` | it has left its last instance: whoever is there may leave, too |
| `crew(anchor)` | how many are in its instances: none of the last one may be left as the next one comes to its exit |
| `reads(token)`, `readers(token)` | what a token's instance reads; a block that changes that has no readers meanwhile |
| `completed(token)` | it is in no block without a hold; asked for by the goal |

A predicate with one value at a time is a fluent of its other arguments. So is what a block maintains, of the token
that carries it (`vocabulary.keeper`): a token is in one instance at a time. A slot whose token may come along with
the anchor from one instance to the next, or on its own, gives an action for either case.

It asks for less than the law in this: tokens may leave an instance a little later than its anchor, and a block
without a hold, which ends at once, may be left later. `decoder` puts that right or refuses the plan.
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
    """The temporal planning domain of a domain, with what each action runs by its name."""

    vocabulary: Vocabulary
    names: Words
    planning: TemporalDomain
    running: dict[str, Running]


def encode_durative(domain: Domain) -> TemporalEncoding:
    """Compile a domain's blocks and network to durative actions; the result depends on nothing else."""
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
        """Symbols, slots, and the values that say 'none'."""
        token, slot = self.vocabulary.type_of(TOKEN), self.words("slot")
        own = {constant for constant, _ in self.vocabulary.constants[-1:]}  # the count, which is not used here
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
        """Every fluent of the user's, and of the encoder's own those that an action mentions."""
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
                # Any token may leave what it maintained, whatever an action knows of it.
                wide = changing[name].maintained and values
                keys = tuple(
                    (parameters[i][0], self.vocabulary.type_of(TOKEN) if wide else parameters[i][1]) for i in key
                )
                yield Fluent(name, keys, "objects" if values else "truth", values)
            else:
                yield Fluent(name, parameters)

    # -- which tokens come from where -----------------------------------------------------------------------------

    def actions(self) -> Iterator[tuple[DurativeAction, Running]]:
        """Yield the actions of every block, one for each choice of the tokens that come along with the anchor."""
        for block in self.domain.blocks:
            choices = [self._choices(block, slot.name) for slot in block.slots]
            for chosen in product(*choices):
                along = frozenset(slot.name for slot, along in zip(block.slots, chosen, strict=True) if along)
                yield ActionMaker(self.words, block, along).build()

    def _choices(self, block: Block, slot: str) -> list[bool]:
        """Return whether the token of a slot may come on its own, along with the anchor, or both."""
        return [along for along in (False, True) if self.words.sources(block, slot, along)]

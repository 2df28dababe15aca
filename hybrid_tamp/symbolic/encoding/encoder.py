"""Encoder, which converts the blocks of any domain to lifted STRIPS operators.

Each edge of the network has operators of one of three kinds:

* ``fill-C-s-from-B`` reserves a token of block B for slot s of block C. A parameter names the anchor of the next
  instance of C. The slots are filled in order. Until C begins, the anchor is claimed and the token stays in B.
* ``begin-C-from-B`` moves the anchor from B to C, and C begins. A block with one slot needs no other operator. The exit
  conditions of C become facts at once. `completed` and `settled` prevent the use of these facts before C ends.
* ``leave-B-r-to-C`` moves the token in slot r of B to C. This happens directly after the anchor leaves B.

Three predicates enforce the law of assignment. `readers` counts the running instances that read a token. A block may
change the token only if this count is zero. `settled` says that the current block of a token does not change the token.
`idle` keeps the reassignments of one instant together. An instance is identified by its block and its anchor.

The encoding has one limit. Two blocks with several slots cannot begin at the same instant.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.task import Task
from hybrid_tamp.symbolic.chaining.chains import Chains, chain_blocks
from hybrid_tamp.symbolic.chaining.repeats import copy_repeated
from hybrid_tamp.symbolic.encoding.edge_operators import EdgeOperators
from hybrid_tamp.symbolic.encoding.fill_order import order_slots
from hybrid_tamp.symbolic.encoding.operator_maker import Meaning
from hybrid_tamp.symbolic.encoding.vocabulary import Vocabulary
from hybrid_tamp.symbolic.pddl.naming import legal, name_apart
from hybrid_tamp.symbolic.pddl.operators import Operator, PlanningDomain


@dataclass(frozen=True, eq=False)
class EncodedDomain:
    """The STRIPS encoding of a domain.

    Attributes:
        vocabulary: PDDL names of the domain in which each chain is one block.
        planning: Planning domain.
        meanings: Maps the name of each operator to its meaning.
        chains: Chains of the domain.
    """

    vocabulary: Vocabulary
    planning: PlanningDomain
    meanings: dict[str, Meaning]
    chains: Chains


def encode_task(task: Task) -> EncodedDomain:
    """Encode the domain of a task with its chains. The chains depend on the goal and on the initial assignment."""
    return _encode(chain_blocks(task))


def encode_domain(domain: Domain) -> EncodedDomain:
    """Encode the blocks and the network of a domain without chains. The result does not depend on a task."""
    return _encode(Chains(domain))


def _encode(chains: Chains) -> EncodedDomain:
    chains = copy_repeated(chains)
    vocabulary = Vocabulary(order_slots(chains.domain))
    built = list(_operators(vocabulary))
    names = name_apart({number: operator.name for number, (operator, _) in enumerate(built)})
    built = [(replace(operator, name=names[number]), meaning) for number, (operator, meaning) in enumerate(built)]
    # A compiler predicate is declared only if an operator or a goal may mention the predicate.
    mentioned = {"idle", "unclaimed", "completed"}
    mentioned |= {fact[0] for o, _ in built for facts in (o.precondition, o.add, o.delete) for fact in facts}
    own = (predicate for predicate in vocabulary.assignment_predicates if predicate[0] in mentioned)
    planning = PlanningDomain(
        name=legal(chains.domain.name),
        types=vocabulary.types,
        constants=vocabulary.constants,
        predicates=(*vocabulary.predicates, *own),
        operators=tuple(operator for operator, _ in built),
        comments=(*vocabulary.names.changed, *chains.comments),
    )
    return EncodedDomain(vocabulary, planning, {operator.name: meaning for operator, meaning in built}, chains)


def _operators(vocabulary: Vocabulary) -> Iterator[tuple[Operator, Meaning]]:
    """Yield a pair of (operator, meaning) for each operator of each edge of the network."""
    maker = EdgeOperators(vocabulary)
    for source, target in vocabulary.domain.network.edges:
        old, new = (vocabulary.domain.block_by_name[end[0]] for end in (source, target))
        if len(new.slots) == 1:
            if source[1] == old.anchor:
                yield from maker.begin(old, new)
            else:
                yield from maker.leave(old, source[1], new)
        elif target[1] != new.anchor:
            yield from maker.fill(old, source[1], new, target[1])
        elif source[1] == old.anchor and old is not new:
            yield from maker.begin(old, new)

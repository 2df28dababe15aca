"""Encoder: block declarations to lifted STRIPS operators, slot by slot, generic over domains.

Three kinds of operator, one for each edge of the network:

* ``fill-C-s-from-B``: a token is reserved for slot s of the next instance of C, whose anchor is given. Slots are
  filled in their order; the anchor is claimed meanwhile. In time the token stays where it is until `begin`.
* ``begin-C-from-B``: the anchor leaves B and C begins; for blocks with one slot this is all there is. C's exit
  conditions become facts at once; `completed` and `settled` keep others from using them before C has ended.
* ``leave-B-r-to-C``: when the anchor has left B, the tokens of B's other slots leave too, before anything else.

What makes it true to the law: `readers` counts the running instances that read a token, and a block that changes the
token needs the count zero; `settled` says that the block a token is in does not change it; `idle` keeps the
reassignments of one instant together. Instances are identified by (block, anchor), so facts over pairs suffice.
Limits: one block with several slots begins at an instant, and an anchor does not pass from a block with several slots
to the same block.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.task import Task
from hybrid_tamp.symbolic.chaining.chains import Chains, chain_blocks
from hybrid_tamp.symbolic.encoding.begin_operators import BeginOperators
from hybrid_tamp.symbolic.encoding.fill_operators import FillOperators
from hybrid_tamp.symbolic.encoding.leave_operators import LeaveOperators
from hybrid_tamp.symbolic.encoding.operator_maker import Meaning
from hybrid_tamp.symbolic.encoding.vocabulary import Vocabulary
from hybrid_tamp.symbolic.pddl.naming import legal, name_apart
from hybrid_tamp.symbolic.pddl.operators import Operator, PlanningDomain, Typed


@dataclass(frozen=True, eq=False)
class EncodedDomain:
    """The planning domain of a domain, with the meaning of each operator by its name.

    The vocabulary's domain has each chain as one block; `chains` leads back to the blocks.
    """

    vocabulary: Vocabulary
    planning: PlanningDomain
    meanings: dict[str, Meaning]
    chains: Chains


def encode_task(task: Task) -> EncodedDomain:
    """Compile the domain of a task with its chains; they depend on the goal and the initial assignment, if at all."""
    return _encode(chain_blocks(task))


def encode_domain(domain: Domain) -> EncodedDomain:
    """Compile a domain's blocks and network, without chains; the result depends on nothing else."""
    return _encode(Chains(domain))


def _encode(chains: Chains) -> EncodedDomain:
    vocabulary = Vocabulary(chains.domain)
    built = list(_operators(vocabulary))
    names = name_apart({number: operator.name for number, (operator, _) in enumerate(built)})
    built = [(replace(operator, name=names[number]), meaning) for number, (operator, meaning) in enumerate(built)]
    planning = PlanningDomain(
        name=legal(chains.domain.name),
        types=vocabulary.types,
        constants=vocabulary.constants,
        predicates=_list_predicates(vocabulary, [operator for operator, _ in built]),
        operators=tuple(operator for operator, _ in built),
        comments=(*vocabulary.names.changed, *chains.comments),
    )
    return EncodedDomain(vocabulary, planning, {operator.name: meaning for operator, meaning in built}, chains)


def _list_predicates(vocabulary: Vocabulary, operators: list[Operator]) -> tuple[tuple[str, tuple[Typed, ...]], ...]:
    """Return the user's predicates and those of the compiler's own that an operator mentions, or a goal."""
    mentioned = {"idle", "unclaimed", "completed"}
    mentioned |= {fact[0] for o in operators for facts in (o.precondition, o.add, o.delete) for fact in facts}
    own = [(name, types) for name, types in vocabulary.assignment_predicates if name in mentioned]
    return (*vocabulary.predicates, *own)


def _operators(vocabulary: Vocabulary) -> Iterator[tuple[Operator, Meaning]]:
    """Yield the operators of every edge of the network, each with its meaning."""
    fills, begins, leaves = FillOperators(vocabulary), BeginOperators(vocabulary), LeaveOperators(vocabulary)
    for source, target in vocabulary.domain.network.edges:
        old, new = (vocabulary.domain.block_by_name[end[0]] for end in (source, target))
        if len(new.slots) == 1:
            if source[1] == old.anchor:
                yield from begins.begin(old, new)
            else:
                yield from leaves.leave(old, source[1], new)
        elif target[1] != new.anchor:
            yield from fills.fill(old, source[1], new, target[1])
        elif source[1] == old.anchor and old is not new:
            yield from begins.begin(old, new)

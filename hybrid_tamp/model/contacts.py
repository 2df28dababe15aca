"""Contacts between tokens, and the rules that say which tokens may touch."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from itertools import permutations

from hybrid_tamp.model.block import FLOOR, Block
from hybrid_tamp.model.ground import ON_FLOOR
from hybrid_tamp.model.plan import BlockInstance
from hybrid_tamp.model.predicate import ANY, Literal, SymbolSort, Value
from hybrid_tamp.model.state import State
from hybrid_tamp.model.token import Token


@dataclass(frozen=True)
class Contact:
    """The largest contact force between two tokens during a time in which neither token changed its instance.

    Attributes:
        tokens: names of the two tokens, or of a token and `FLOOR`.
        instances: names of the instances of the two tokens. The names are equal if both tokens are in the same
            instance. The name is empty for the floor, for places and for the fixed body on which the other token rests.
        force: normal impulse over 10 ms, divided by 10 ms [N].
        time: end of the control period with the largest force [s].
        allowed: whether a running block allowed the contact.
    """

    tokens: tuple[str, str]
    instances: tuple[str, str]
    force: float
    time: float
    allowed: bool = True

    @property
    def pair(self) -> str:
        """The two bodies in words, e.g. ``hand and the floor``."""
        one, other = sorted(self.tokens, key=lambda name: name == FLOOR)
        return f"{one} and {'the floor' if other == FLOOR else other}"

    @property
    def between_instances(self) -> bool:
        """Whether two tokens in different instances touched. False for contacts with the floor or a fixed body."""
        return "" not in self.instances and self.instances[0] != self.instances[1]


class ContactRules:
    """The pairs of tokens that may touch while some instances run.

    Each instance allows the pairs that its block declares. A pair of equal roles allows contact between the tokens with
    this role in all instances of the block. For example, tokens that rest may touch each other. `FLOOR` stands for the
    floor, for every place with a body, and for the fixed body on which the token rests. A condition with a wildcard
    stands for every token for which the condition holds at the time of the contact.
    """

    def __init__(
        self,
        blocks: Mapping[str, Block],
        running: Collection[BlockInstance],
        fixed: Collection[str] = (),
        tokens: Mapping[str, Token] | None = None,
    ) -> None:
        """Collect the pairs of the running instances.

        Args:
            blocks: maps each name to its block.
            running: the running instances.
            fixed: names of the places with a body.
            tokens: maps each name to its token. Required if a token rests on a fixed body, or if a block allows
                contacts by a condition.
        """
        self._tokens = tokens or {}
        self._conditions: list[tuple[str, Literal, Mapping[str, str]]] = []
        self._fixed = frozenset(fixed)
        self._pairs: set[frozenset[str]] = set()
        self._groups: dict[tuple[str, str], set[str]] = {}
        self._known: dict[tuple[str, str], bool] = {}
        for instance in running:
            named = {FLOOR: FLOOR, **instance.roles}
            for one, other in blocks[instance.block].allowed_contacts:
                if isinstance(other, Literal):
                    self._conditions.append((named[one], other, instance.roles))
                elif one == other:
                    self._groups.setdefault((instance.block, one), set()).add(named[one])
                else:
                    self._pairs.add(frozenset((named[one], named[other])))

    def allow(self, one: str, other: str, state: State) -> bool:
        """Return whether two tokens, or a token and `FLOOR`, may touch in a state ``(n,)``."""
        allowed = self._known.get((one, other))
        if allowed is None:
            allowed = self._known[one, other] = self._allow(frozenset((one, other)))
        return allowed or any(
            (token == one and self._holds(literal, roles, other, state))
            or (token == other and self._holds(literal, roles, one, state))
            for token, literal, roles in self._conditions
        )

    def _holds(self, literal: Literal, roles: Mapping[str, str], name: str, state: State) -> bool:
        """Return whether the condition holds with a token in place of the wildcard."""
        sort = literal.predicate.parameters[literal.arguments.index(ANY)].sort
        token = self._tokens.get(name)
        if token is None or isinstance(sort, SymbolSort) or not token.is_member(sort):
            return False
        binding: dict[str, Value] = {role: self._tokens.get(value, value) for role, value in roles.items()}
        return float(literal.margin(state, binding | {ANY: token})) >= 0

    def _allow(self, pair: frozenset[str]) -> bool:
        if pair in self._pairs or any(pair <= group for group in self._groups.values()):
            return True
        return any(
            frozenset((FLOOR, thing)) in self._pairs and (body in self._fixed or self.rests_on(thing, body))
            for thing, body in permutations(pair)
        )

    def rests_on(self, thing: str, body: str) -> bool:
        """Return whether a token rests on a body that nothing can move."""
        ground = self._tokens[thing].ground if thing in self._tokens else ON_FLOOR
        return ground.fixed and ground.body == body

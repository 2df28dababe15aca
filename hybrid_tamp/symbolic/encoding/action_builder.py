"""Builder, which collects the parameters, preconditions and effects of one operator."""

from hybrid_tamp.model.block import Block
from hybrid_tamp.model.predicate import ANY, Literal
from hybrid_tamp.symbolic.chaining.series import Sort, key
from hybrid_tamp.symbolic.encoding.assignment import COUNT
from hybrid_tamp.symbolic.encoding.vocabulary import Vocabulary
from hybrid_tamp.symbolic.pddl.naming import variable_of
from hybrid_tamp.symbolic.pddl.operators import Fact, Operator

Same = dict[str, Sort]
"""Maps roles of the new block to classes. The token of each role also has a role of this class in the old block."""


class ActionBuilder:
    """Collects the preconditions and effects of one operator. A role becomes a variable of the same name."""

    def __init__(self, vocabulary: Vocabulary, block: Block, same: Same | None = None) -> None:
        """Start an operator that assigns a token to a block. Roles in `same` get the narrower class of both blocks."""
        self.vocabulary = vocabulary
        self.block = block
        self._same = same or {}
        self._parameters: dict[str, str] = {}
        self._variables: dict[str, str] = {}
        self._others: dict[str, str] = {}
        self._old_values: dict[Fact, str] = {}
        self._precondition: dict[Fact, None] = {}
        self._add: dict[Fact, None] = {}
        self._delete: dict[Fact, None] = {}

    # -- variables ----------------------------------------------------------------------------------------------

    def role(self, role: str) -> str:
        """Return the variable of a role of the new block. On first use, declare the parameter and its guard."""
        if role not in self._variables:
            sort = self.block.roles[role]
            self._variables[role] = self._declare(role, self.vocabulary.narrower(sort, self._same.get(role, sort)))
            for fact in self.vocabulary.guard(self._variables[role], sort):
                self.require(fact)
        return self._variables[role]

    def other(self, block: Block, role: str, unified: dict[str, str] | None = None) -> str:
        """Return the variable of a role of the old block. Unified roles of both blocks share a variable."""
        if unified and role in unified:
            return self._argument(unified[role])
        if role not in self._others:
            self._others[role] = self._declare(f"old-{role}", block.roles[role])
        return self._others[role]

    def _declare(self, role: str, sort: Sort) -> str:
        variable = self._fresh(role, self.vocabulary.type_of(sort))
        for fact in self.vocabulary.guard(variable, sort):
            self.require(fact)
        return variable

    def _fresh(self, base: str, type_name: str) -> str:
        variable = variable_of(base, self._parameters)
        self._parameters[variable] = type_name
        return variable

    def variable(self, role: str) -> str:
        """Return the variable of a role of the new block. The role must already be a parameter."""
        return self._variables[role]

    @property
    def bound(self) -> set[str]:
        """The roles of the new block that are parameters."""
        return set(self._variables)

    # -- facts --------------------------------------------------------------------------------------------------

    def require(self, fact: Fact) -> None:
        """Add a precondition."""
        self._precondition[fact] = None

    def add(self, fact: Fact) -> None:
        """Add an add effect."""
        self._add[fact] = None

    def delete(self, fact: Fact) -> None:
        """Add a delete effect."""
        self._delete[fact] = None

    def consume(self, fact: Fact) -> None:
        """Require a fact and delete it."""
        self.require(fact)
        self.delete(fact)

    def replace(self, old: Fact, new: Fact) -> None:
        """Require and delete the old fact, and add the new fact."""
        self.consume(old)
        self.add(new)

    def count_readers(self, token: str, change: int, last: bool = False) -> None:
        """Change the number of readers of a token by +1 or -1. With `last`, require that no reader is left."""
        count = self.vocabulary.type_of(COUNT)
        now = self._fresh("readers", count)
        then = self.vocabulary.none_reading if last else self._fresh("readers", count)
        self.require(("next", now, then) if change > 0 else ("next", then, now))
        self.replace(("readers", token, now), ("readers", token, then))

    # -- literals -----------------------------------------------------------------------------------------------

    def require_literal(self, literal: Literal) -> None:
        """Add an entry condition over roles of the new block as a precondition."""
        word = self.vocabulary.predicate(literal.predicate.name, literal.positive)
        self.require((word, *map(self._argument, literal.arguments)))

    def apply_literal(self, literal: Literal) -> None:
        """Add an exit condition over roles of the new block as an effect."""
        name, index = self.vocabulary.predicate(literal.predicate.name), literal.predicate.functional_index
        if ANY in literal.arguments and index is None:
            return  # The predicate is maintained. Its atoms are deleted when the token leaves.
        arguments = [ANY if a == ANY else self._argument(a) for a in literal.arguments]
        if index is not None:
            self._clear(literal, name, arguments, index)
        elif not literal.positive:
            self.delete((name, *arguments))
        if literal.positive:
            self.add((name, *arguments))

    def _clear(self, literal: Literal, name: str, arguments: list[str], index: int) -> None:
        """Delete the old value of a functional predicate. If no exit condition sets a value, add the value 'none'."""
        others = (name, *arguments[:index], *arguments[index + 1 :])
        known = self._known_value(literal, index)
        if known is not None:
            self.consume((name, *arguments[:index], self._argument(known), *arguments[index + 1 :]))
        elif others not in self._old_values:
            sort = literal.predicate.parameters[index].sort
            variable = self._fresh(f"from-{literal.predicate.value_of}", self.vocabulary.type_of(sort))
            self._old_values[others] = variable
            self.consume((name, *arguments[:index], variable, *arguments[index + 1 :]))
        same = [each for each in self.block.exit if each.predicate is literal.predicate and key(each) == key(literal)]
        if not any(each.positive for each in same):
            none = self.vocabulary.no_value(literal.predicate)
            self.add((name, *arguments[:index], none, *arguments[index + 1 :]))

    def _known_value(self, literal: Literal, index: int) -> str | None:
        """Return the role of a functional predicate's old value, or None if no entry condition names the value."""
        for wanted in self.block.entry:
            same = wanted.predicate is literal.predicate and wanted.positive and key(wanted) == key(literal)
            if same and wanted.arguments[index] in self._variables:
                return wanted.arguments[index]
        return None

    def _argument(self, argument: str) -> str:
        if argument in self.block.roles:
            return self.role(argument)
        return self.vocabulary.symbol(argument)

    # -- result -------------------------------------------------------------------------------------------------

    @property
    def roles(self) -> dict[str, int]:
        """Maps each role of the new block to the index of its parameter."""
        order = list(self._parameters)
        return {role: order.index(variable) for role, variable in self._variables.items()}

    def build(self, name: str) -> Operator:
        """Return the operator. Deletes precede adds, so a fact in both sets is left out of the deletes."""
        deleted = tuple(fact for fact in self._delete if fact not in self._add)
        return Operator(name, tuple(self._parameters.items()), tuple(self._precondition), tuple(self._add), deleted)

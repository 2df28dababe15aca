"""Lookup of a binding's tokens and symbols by role, and names of the properties that blocks write."""

from typing import cast

from hybrid_tamp.model.affordance import BODY_STATE
from hybrid_tamp.model.predicate import Binding
from hybrid_tamp.model.token import Token

BODY = tuple(varying.name for varying in BODY_STATE)
"""Names of the varying properties of a body that moves freely."""
POSE = ("position", "orientation")
"""Names of the varying properties that make up a pose."""
MOTION = ("position", "velocity")
"""Names of the varying properties of a hand that does not turn."""


def get_token(binding: Binding, role: str) -> Token:
    """Return the token bound to a role."""
    return cast(Token, binding[role])


def get_tokens(binding: Binding, *roles: str) -> tuple[Token, ...]:
    """Return the tokens bound to several roles, in the order of the roles."""
    return tuple(get_token(binding, role) for role in roles)


def get_symbol(binding: Binding, role: str) -> str:
    """Return the symbol bound to a role."""
    return cast(str, binding[role])

"""The boundary between the library and the functions that authors of domains write.

`authored` translates every exception of such a function to a `DomainError` that names the function, the values of its
roles and the line of the domain's code. Exceptions of the library itself pass unchanged.
"""

import traceback
from collections.abc import Mapping
from pathlib import Path
from types import TracebackType

from hybrid_tamp.errors import DomainError, HybridTampError, Issue, did_you_mean
from hybrid_tamp.model.token import Token, UnknownProperty, UnknownToken

_LIBRARY = Path(__file__).parent.parent
_PACKAGES = frozenset(("numpy", "scipy", "pydantic"))
_LONGEST = 200
OWN_ERRORS = (HybridTampError, MemoryError)
"""Exceptions that pass unchanged."""


class authored:  # noqa: N801 the name of a context manager is lower case
    """Context in which the library calls a function of the domain's author.

    This context manager is a class, because a generator would be slower and some functions run in each control period.

    Args:
        where: name of the function, e.g. ``ROLLING.policy``.
        values: maps each role of the block, or each parameter of the predicate, to its value.

    Raises:
        DomainError: on leaving the context, if the function raised an exception.
    """

    __slots__ = ("_values", "_where")

    def __init__(self, where: str, values: Mapping[str, Token | str]) -> None:
        self._where = where
        self._values = values

    def __enter__(self) -> None:
        pass

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, _: TracebackType | None) -> None:
        if isinstance(error, Exception) and not isinstance(error, OWN_ERRORS):
            raise blame(error, self._where, self._values) from error


def blame(error: Exception, where: str, values: Mapping[str, Token | str]) -> DomainError:
    """Return the translated exception of an author's function. See `authored` for the arguments."""
    wanted = f"the function must not raise an exception{describe_roles(values)}"
    said = str(error).strip().split("\n")[0][:_LONGEST]
    came = f"{type(error).__name__}{said and f': {said}'}{_line(error)}"
    return DomainError([Issue(where, wanted, came, remedy=_advise(error, values))])


def describe_roles(values: Mapping[str, Token | str]) -> str:
    """Return roles with their values as text, e.g. `` for hand=left, object=box``, or an empty text."""
    bound = ", ".join(f"{role}={getattr(value, 'name', value)}" for role, value in values.items())
    return f" for {bound}" if bound else ""


def _line(error: Exception) -> str:
    """Return the innermost line of the domain's code in a traceback, e.g. `` in line 12 of rolling.py``, or empty."""
    frames = [frame for frame in traceback.extract_tb(error.__traceback__) if not _foreign(Path(frame.filename))]
    return f" in line {frames[-1].lineno} of {Path(frames[-1].filename).name}" if frames else ""


def _foreign(file: Path) -> bool:
    """Return whether a file belongs to the library or to a numerical package instead of a domain."""
    return file.is_relative_to(_LIBRARY) or not _PACKAGES.isdisjoint(file.parts)


def _advise(error: Exception, values: Mapping[str, Token | str]) -> str:
    if isinstance(error, UnknownToken) and values:
        return "the function may read only the tokens of its roles"
    key = error.args[0] if isinstance(error, KeyError) and error.args else None
    if isinstance(error, UnknownProperty) or not isinstance(key, str) or not values:
        return ""
    close = did_you_mean(key, tuple(values))
    return f"did you mean {close!r}?" if close else f"the roles are {', '.join(values)}"

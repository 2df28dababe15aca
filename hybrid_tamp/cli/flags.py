"""Errors of the library name arguments of functions; people are told the flags of the command line."""

from dataclasses import replace

from hybrid_tamp.errors import HybridTampError, InputError, LimitReached

_FLAGS = {
    "agent": "--agent",
    "backend": "--backend",
    "block": "BLOCK",
    "classes": "--class",
    "questions": "--what-if",
    "token": "--token",
    "view": "--view",
}
"""Argument to flag."""


def with_flags(error: HybridTampError) -> HybridTampError:
    """Return the error with flags in place of the arguments that its issues name."""
    if isinstance(error, LimitReached):
        return LimitReached(str(error).replace("time_limit", "--time-limit"), limit=error.limit)
    if not isinstance(error, InputError):
        return error
    issues = [
        replace(
            issue,
            where=_FLAGS.get(issue.where, issue.where),
            remedy=issue.remedy.replace("force=True", "--force").replace("classes=[...]", "--class"),
        )
        for issue in error.issues
    ]
    return type(error)(issues)

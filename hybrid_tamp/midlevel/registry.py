"""The optimisers by name."""

from collections.abc import Callable, Mapping

from hybrid_tamp.errors import InputError, Issue
from hybrid_tamp.midlevel.cma import CMAES
from hybrid_tamp.midlevel.grid import Grid
from hybrid_tamp.midlevel.optimiser import Optimiser


def find_optimiser(name: str, *, batch: int | None = None, quick: bool = False) -> Optimiser:
    """Return the optimiser with this name.

    Args:
        name: one of `OPTIMISERS`.
        batch: number of candidates evaluated at once, the population of CMA-ES; None for the optimiser's own choice.
        quick: whether to start close to the default, which is good, and to end when there is little left to gain.

    Raises:
        InputError: no optimiser has this name.
    """
    if name not in OPTIMISERS:
        raise InputError([Issue("", "unknown optimiser", repr(name), tuple(sorted(OPTIMISERS)))])
    return OPTIMISERS[name](batch, quick)


def _cma(batch: int | None, quick: bool) -> Optimiser:
    return CMAES(batch, sigma=0.15, tolerance=2e-3, quick=True) if quick else CMAES(batch)


OPTIMISERS: Mapping[str, Callable[[int | None, bool], Optimiser]] = {
    "cma": _cma,
    "grid": lambda batch, quick: Grid() if batch is None else Grid(batch),
}
"""Makers of the optimisers by name."""

"""The optimisers by name."""

from collections.abc import Callable, Mapping

from hybrid_tamp.errors import InputError, Issue
from hybrid_tamp.midlevel.optimiser import Optimiser


def find_optimiser(name: str, *, batch: int | None = None, noisy: bool = False, quick: bool = False) -> Optimiser:
    """Return the optimiser of this name.

    Args:
        name: one of `OPTIMISERS`.
        batch: candidates evaluated at once, the population of CMA-ES; None for the optimiser's own choice.
        noisy: whether a repeated rollout may score differently.
        quick: whether to begin near the default, which is good, and to end where little is gained any more.

    Raises:
        InputError: there is none of this name.
    """
    if name not in OPTIMISERS:
        raise InputError([Issue("", "unknown optimiser", repr(name), tuple(sorted(OPTIMISERS)))])
    return OPTIMISERS[name](batch, noisy, quick)


def _cma(batch: int | None, noisy: bool, quick: bool) -> Optimiser:
    from hybrid_tamp.midlevel.cma import CMAES

    if quick:
        return CMAES(population=batch, sigma=0.15, tolerance=2e-3, noisy=noisy, quick=True)
    return CMAES(population=batch, noisy=noisy)


def _grid(batch: int | None, noisy: bool, quick: bool) -> Optimiser:
    from hybrid_tamp.midlevel.grid import Grid

    return Grid() if batch is None else Grid(batch)


OPTIMISERS: Mapping[str, Callable[[int | None, bool, bool], Optimiser]] = {"cma": _cma, "grid": _grid}
"""Makers of the optimisers by name."""

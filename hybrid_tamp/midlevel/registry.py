"""Registry of the optimisers by name."""

from collections.abc import Callable, Mapping

from hybrid_tamp.errors import InputError, Issue
from hybrid_tamp.midlevel.cma import CMAES
from hybrid_tamp.midlevel.grid import Grid
from hybrid_tamp.midlevel.optimiser import Optimiser


def find_optimiser(name: str, *, batch: int | None = None, quick: bool = False) -> Optimiser:
    """Return the optimiser with the given name.

    Args:
        name: a key of `OPTIMISERS`.
        batch: number of candidates per batch, which is the population of CMA-ES. None uses the optimiser's default.
        quick: whether to search close to the default point first and to stop once the gains become small.

    Raises:
        InputError: if no optimiser has this name.
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
"""Maps the name of each optimiser to a function that creates the optimiser from ``batch`` and ``quick``."""

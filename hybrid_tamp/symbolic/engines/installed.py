"""The planning engines on this computer."""

from functools import cache
from importlib.metadata import packages_distributions, version

from hybrid_tamp.errors import InputError
from hybrid_tamp.model.listings import InstalledEngine
from hybrid_tamp.symbolic.engines.registry import ENGINES, check_engine


def list_engines() -> list[InstalledEngine]:
    """Return all engines that need no configuration, with the default engine first."""
    return [_describe(name) for name in ENGINES]


def _describe(name: str) -> InstalledEngine:
    engine = ENGINES[name]
    installed, remedy = None, ""
    try:
        check_engine(name)
        installed = _version(engine.module)
    except InputError as error:
        remedy = error.issues[0].remedy
    return InstalledEngine(name, installed, remedy, engine.judge_length(""), engine.proofs is not None)


@cache
def _version(module: str) -> str:
    return version(_distributions()[module][0])


@cache
def _distributions() -> dict[str, list[str]]:
    return {module: list(names) for module, names in packages_distributions().items()}

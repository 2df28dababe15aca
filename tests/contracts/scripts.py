"""The scripts of the repository as modules, so that tests and scripts share their code."""

import importlib.machinery
import importlib.util
import sys
from types import ModuleType

from contracts.imports import ROOT


def load_script(name: str) -> ModuleType:
    """Return a file of scripts/ as a module."""
    loader = importlib.machinery.SourceFileLoader(f"scripts_{name}", str(ROOT / "scripts" / name))
    spec = importlib.util.spec_from_loader(loader.name, loader)
    assert spec is not None
    module = importlib.util.module_from_spec(spec)
    # A dataclass finds its module by name.
    sys.modules[loader.name] = module
    loader.exec_module(module)
    return module

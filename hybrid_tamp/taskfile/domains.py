"""Find domains by name, module or path, and find task files by path or bundled name."""

import hashlib
import os
import sys
from collections.abc import Callable
from importlib import import_module
from importlib.metadata import EntryPoint, entry_points
from importlib.resources import files
from importlib.util import find_spec, module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType
from typing import Any

from hybrid_tamp.errors import InputError, Issue
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.taskfile.places import shown

GROUP = "hybrid_tamp.domains"
"""Entry point group in which installed packages register their domains."""
BESIDE = "domain.py"
"""Name of the file with the domain of the task files in the same folder."""
_IMPORTED = "hybrid_tamp_domain_"
"""Prefix of the names of modules that are imported from a file."""
PROBLEMS = "hybrid_tamp_problems"
"""Package with the bundled task files."""


def available_domains() -> tuple[str, ...]:
    """Return the sorted names of the installed domains."""
    return tuple(sorted({entry.name for entry in entry_points(group=GROUP)}))


def installed_domain(name: str) -> Domain:
    """Return the installed domain with this name. Only the code of installed domains is run.

    Raises:
        InputError: no installed domain has this name, or its module cannot be imported.
    """
    entry = _entry(name)
    if entry is not None:
        return _domain(_loaded(entry.load, entry.value), entry.value)
    remedy = ""
    if name.endswith(".py") or ":" in name:
        remedy = (
            f"a task file cannot refer to code, so install the domain under the entry point group {GROUP} "
            "or pass find_domain to load_task"
        )
    raise InputError([Issue("", "unknown domain", shown(name), available_domains(), remedy)])


def domains_beside(folder: Path) -> Callable[[str], Domain]:
    """Return the function that finds an installed domain, or the domain in the file ``domain.py`` of a folder.

    The file is executed only if no installed domain has the name. A task file can name a domain, but not a file.
    """

    def find(name: str) -> Domain:
        file = folder / BESIDE
        if _entry(name) is not None or not file.is_file():
            return installed_domain(name)
        found = find_domain(str(file))
        if found.name != name:
            message = f"unknown domain; {BESIDE} in the folder of the task defines another domain"
            raise InputError([Issue("", message, shown(name), (found.name,))])
        return found

    return find


def file_of(domain: Domain) -> Path | None:
    """Return the file of a domain that was imported from a single file, or None for an installed domain."""
    for name, module in list(sys.modules.items()):
        found = vars(module).get("DOMAIN") if name.startswith(_IMPORTED) else None
        # Two files may define domains of one name, but never the same classes.
        if isinstance(found, Domain) and (found.name, found.classes) == (domain.name, domain.classes):
            return Path(str(module.__file__))
    return None


def find_domain(name_or_path: str) -> Domain:
    """Return a domain by its installed name, by ``package.module:ATTRIBUTE`` or by the path of its Python file.

    A file is imported only once and must define the attribute ``DOMAIN``. Modules and files are executed, so pass only
    names that you trust. Never pass a name from somebody else's task file.

    Raises:
        InputError: no domain has this name, or its module cannot be imported.
    """
    if _entry(name_or_path) is not None:
        return installed_domain(name_or_path)
    if name_or_path.endswith(".py"):
        # For impossible names, os.path.isfile returns False but Path.is_file raises.
        if not os.path.isfile(name_or_path):
            raise InputError([Issue("", "the file of the domain must exist", shown(name_or_path))])
        path = Path(name_or_path).resolve()
        return _domain(_loaded(lambda: _import_file(path), str(path)), str(path), "DOMAIN")
    module, colon, attribute = name_or_path.partition(":")
    if colon and attribute.isidentifier() and all(part.isidentifier() for part in module.split(".")):
        return _domain(_loaded(lambda: import_module(module), module), name_or_path, attribute)
    remedy = "a domain can also be given as package.module:ATTRIBUTE or as the path of a Python file"
    raise InputError([Issue("", "unknown domain", shown(name_or_path), available_domains(), remedy)])


def _entry(name: str) -> EntryPoint | None:
    return next((entry for entry in entry_points(group=GROUP) if entry.name == name), None)


def _loaded(load: Callable[[], Any], source: str) -> Any:
    """Import a domain. An exception that the domain's code raises is reported as a fault of the domain."""
    try:
        return load()
    except InputError as error:
        raise InputError([Issue(source, "the domain's declarations contradict each other"), *error.issues]) from error
    except (Exception, SystemExit) as error:
        came = f"{type(error).__name__}: {error}"
        raise InputError([Issue(_line_of(error, source), "cannot import the domain's module", came)]) from error


def _line_of(error: BaseException, source: str) -> str:
    """Return the source, followed by the line and column of an error if the traceback contains the line."""
    if isinstance(error, SyntaxError) and error.filename == source:
        return f"{source}:{error.lineno}:{error.offset or 1}"
    line, trace = 0, error.__traceback__
    while trace is not None:
        if trace.tb_frame.f_code.co_filename == source:
            line = trace.tb_lineno
        trace = trace.tb_next
    return f"{source}:{line}:1" if line else source


def _domain(found: Any, source: str, attribute: str | None = None) -> Domain:
    if attribute is not None:
        if not hasattr(found, attribute):
            names = tuple(sorted(key for key, value in vars(found).items() if isinstance(value, Domain)))
            raise InputError([Issue(source, f"the module must define {attribute}", available=names)])
        found = getattr(found, attribute)
    if not isinstance(found, Domain):
        raise InputError([Issue(source, "the domain must be an instance of hybrid_tamp.Domain", type(found).__name__)])
    return found


def _import_file(path: Path) -> ModuleType:
    """Import a file and return its module. Return the earlier module if the file was imported before."""
    known = _module_of(path)
    if known is not None:
        return import_module(known)
    name = f"{_IMPORTED}{hashlib.sha256(str(path).encode()).hexdigest()[:16]}"
    spec = spec_from_file_location(name, path)
    if spec is None or spec.loader is None:
        raise ImportError(f"cannot import {path} as a Python module")
    module = module_from_spec(spec)
    sys.modules[name] = module
    try:
        spec.loader.exec_module(module)
    except BaseException:
        # Remove the incomplete module, so that the next call does not return it.
        del sys.modules[name]
        raise
    return module


def _module_of(path: Path) -> str | None:
    """Return the dotted module name of a file that is installed as a domain or was imported before, else None."""
    for entry in entry_points(group=GROUP):
        try:
            spec = find_spec(entry.module)
        except ImportError:
            # Skip a broken entry point, because the entry point belongs to another package.
            continue
        if spec is not None and spec.origin is not None and Path(spec.origin).resolve() == path:
            return entry.module
    for name, module in list(sys.modules.items()):
        # vars is used, because attribute access makes some modules import other modules.
        file = vars(module).get("__file__") if isinstance(module, ModuleType) else None
        if name != "__main__" and isinstance(file, str) and file.endswith(path.name) and Path(file).resolve() == path:
            return name
    return None


def bundled_tasks() -> tuple[str, ...]:
    """Return the sorted names of the bundled task files without their endings."""
    if find_spec(PROBLEMS) is None:
        return ()
    return tuple(sorted(file.name[:-5] for file in files(PROBLEMS).iterdir() if file.name.endswith(".yaml")))


def find_task_file(text: str) -> Path:
    """Return the path of an existing file, or the path of a bundled task file with the given name.

    Args:
        text: a path, or a bundled task such as ``roll_cylinder`` or ``problems/roll_cylinder.yaml``.

    Raises:
        InputError: there is no such file and no such bundled task; the message lists the bundled names.
    """
    if os.path.isfile(text):
        return Path(text)
    name, bundled = Path(text).name.removesuffix(".yaml"), bundled_tasks()
    if str(Path(text).parent) in (".", "problems") and name in bundled:
        return Path(str(files(PROBLEMS).joinpath(f"{name}.yaml")))
    if os.path.exists(text):
        # Also return paths of folders etc., because reading them raises a clearer error than the error below.
        return Path(text)
    remedy = "'hybrid-tamp tasks' lists the bundled tasks"
    raise InputError([Issue("", "neither a task file nor a bundled task has this name", shown(text), bundled, remedy)])

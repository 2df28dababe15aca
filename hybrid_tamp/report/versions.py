"""Versions of the software that a result depends on."""

import platform
from importlib.metadata import PackageNotFoundError, version

_PACKAGES = ("hybrid-tamp", "numpy", "pybullet", "pybullet-arm64", "unified-planning", "up-fast-downward")


def versions() -> dict[str, str]:
    """Return the versions of Python, the operating system and the installed packages that a result depends on."""
    found = {"python": platform.python_version(), "system": f"{platform.system()} {platform.machine()}"}
    for package in _PACKAGES:
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            continue  # only one of the two alternative packages of pybullet is installed
    return found

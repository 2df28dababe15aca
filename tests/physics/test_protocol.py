"""Tests that find backends by name."""

from importlib.metadata import EntryPoint
from typing import Any

import pytest

from hybrid_tamp.errors import InputError
from hybrid_tamp.physics import protocol as module
from hybrid_tamp.physics.protocol import load, open_backend


@pytest.mark.parametrize("name", ["analytic", "pybullet"])
def test_built_in_backends_open_by_name(name: str) -> None:
    with open_backend(name) as backend:
        assert backend.name == name
        assert backend.timestep == pytest.approx(1 / 240)


def test_unknown_name_says_what_there_is() -> None:
    with pytest.raises(InputError, match="did you mean 'pybullet'"):
        open_backend("pybulet")
    with pytest.raises(InputError, match="available: analytic, pybullet"):
        open_backend("mujoco")


def test_other_packages_offer_backends_by_entry_point(monkeypatch: pytest.MonkeyPatch) -> None:
    def offered(group: str) -> Any:
        assert group == "hybrid_tamp.physics"
        return [EntryPoint("mine", "hybrid_tamp.physics.analytic:AnalyticBackend", group)]

    monkeypatch.setattr(module, "entry_points", offered)
    with pytest.raises(InputError, match="available: analytic, mine, pybullet"):
        open_backend("mujoco")
    with open_backend("mine") as backend:
        assert backend.name == "analytic"


def test_missing_package_is_named() -> None:
    with pytest.raises(InputError, match="no_such_physics, which is not installed"):
        load("no_such_physics.backend:Backend")

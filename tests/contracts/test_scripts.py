"""Every script can be imported. The test suite does not run scripts that take long."""

import pytest
from contracts.imports import ROOT
from contracts.scripts import load_script

PYTHON = [
    path.name
    for path in sorted((ROOT / "scripts").iterdir())
    if path.is_file() and path.read_bytes().startswith(b"#!/usr/bin/env python")
]


@pytest.mark.parametrize("name", PYTHON)
def test_a_script_can_be_loaded(name: str) -> None:
    assert callable(load_script(name).main)

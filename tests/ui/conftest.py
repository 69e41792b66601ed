"""Motion files that the tests of the tabs and of the endpoints upload."""

from __future__ import annotations

from pathlib import Path

import pytest

from motion.formats import write

from .stub_engine import walking


@pytest.fixture(scope="session")
def walkers(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A file of two people, twelve seconds."""
    return write(walking(12.0), tmp_path_factory.mktemp("motion") / "walkers.npz")[0]


@pytest.fixture(scope="session")
def walker(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A file of one person, four seconds."""
    return write(walking(4.0), tmp_path_factory.mktemp("motion") / "walker.bvh")[0]

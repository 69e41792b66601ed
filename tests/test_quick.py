"""``pytest -m quick`` runs some tests of every package in less than a minute."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.quick import TESTS, is_left_out, listed


def test_every_folder_of_tests_is_represented_by_modules_that_are_there() -> None:
    modules = {path.relative_to(TESTS) for path in TESTS.rglob("test_*.py")}
    assert listed() <= modules
    folders = {folder for module in modules if not is_left_out(folder := module.parent.as_posix())}
    assert {module.parent.as_posix() for module in listed()} == folders, "list a quick module of each"


def test_they_are_marked(request: pytest.FixtureRequest) -> None:
    here = Path(__file__).relative_to(TESTS)
    assert here in listed() and request.node.get_closest_marker("quick")

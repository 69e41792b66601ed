"""A cache of their own for all tests, so that they push nothing of the user's out, and the mark of the quick ones."""

import os
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.quick import TESTS, listed

os.environ.setdefault("GRADIO_ANALYTICS_ENABLED", "False")  # before a test imports Gradio: it asks no other host
QUICK = {TESTS / module for module in listed()}


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    """For ``-m quick`` nothing else is imported, which takes longer than the quick tests themselves."""
    if config.option.markexpr != "quick" or collection_path in QUICK:
        return None
    is_test = collection_path.name.startswith("test_") and collection_path.suffix == ".py"
    is_empty = collection_path.is_dir() and not any(collection_path in module.parents for module in QUICK)
    return True if is_test or is_empty else None


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Marks the tests of the modules in ``tests/quick.txt``."""
    for item in items:
        if item.path in QUICK:
            item.add_marker(pytest.mark.quick)


@pytest.fixture(scope="session", autouse=True)
def cache_of_the_tests(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CACHE_HOME", str(tmp_path_factory.mktemp("cache")))
        yield


@pytest.fixture(scope="module")
def own_temporary(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Temporary files lie among the tests': Gradio's client leaves an empty folder for each file that it fetches."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(tempfile, "tempdir", str(tmp_path_factory.getbasetemp()))
        yield

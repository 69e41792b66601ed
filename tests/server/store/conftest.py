"""A notebook in a database of its own."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from webdemo.server.store.database import Database
from webdemo.server.store.notebook import Notebook
from webdemo.server.store.storage import Storage


@pytest.fixture
def notebook(tmp_path: Path) -> Iterator[Notebook]:
    database = Database(tmp_path / "h.db")
    yield Notebook(Storage(database, tmp_path / "motions"))
    database.close()


@pytest.fixture
def history(notebook: Notebook) -> Notebook:
    return notebook

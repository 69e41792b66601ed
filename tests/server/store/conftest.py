"""A notebook in each kind of database."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.server.clients import DATABASES, database_url, drop_tables
from webdemo.server.store.database import Database
from webdemo.server.store.notebook import Notebook


@pytest.fixture(params=DATABASES)
def notebook(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Notebook]:
    database = Database(database_url(request.param, tmp_path))
    yield Notebook(database, tmp_path / "motions", node="n")
    drop_tables(database.engine)
    database.close()

"""A person's runs, counted at all processes of a database."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest
from sqlalchemy import func, select, update

from motion import InputError
from tests.server.clients import DATABASES, database_url, drop_tables
from webdemo.server.queue.places import LOST_AFTER, Place, Places
from webdemo.server.store.database import Database


@pytest.fixture(params=DATABASES)
def two(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[tuple[Places, Places]]:
    """The places of two processes, of which each person may have three."""
    databases = [Database(database_url(request.param, tmp_path)) for _ in range(2)]
    yield Places(databases[0], "one", 3), Places(databases[1], "two", 3)
    drop_tables(databases[0].engine)
    for database in databases:
        database.close()


def count(places: Places) -> int:
    with places.database.session() as session:
        return session.scalar(select(func.count()).select_from(Place)) or 0


def test_a_person_has_so_many_at_all_of_them(two: tuple[Places, Places]) -> None:
    one, other = two
    with ExitStack() as held:
        for places in (one, one, other):
            held.enter_context(places.held("ada"))
        for places in (one, other):
            with pytest.raises(InputError, match="You have 3 runs"), places.held("ada"):
                raise AssertionError
        with one.held("eve"):
            assert count(other) == 4
    assert count(one) == 0
    with one.held("ada"):
        pass


def test_a_run_that_fails_leaves_its_place(two: tuple[Places, Places]) -> None:
    with pytest.raises(ZeroDivisionError), two[0].held("ada"):
        raise ZeroDivisionError
    assert count(two[0]) == 0


def test_a_process_that_is_gone_is_not_counted(two: tuple[Places, Places]) -> None:
    one, other = two
    lost = [other.held("ada") for _ in range(3)]
    for place in lost:
        place.__enter__()
    late = {"seen": Place.seen - LOST_AFTER - 1}
    with pytest.raises(InputError), one.held("ada"):
        raise AssertionError
    with one.database.session.begin() as session:
        session.execute(update(Place).values(late))
    with one.held("ada"):  # its process gives no sign of life
        assert count(one) == 4
    other.refresh()
    with pytest.raises(InputError), one.held("ada"):
        raise AssertionError
    other.clear()  # it begins anew
    assert count(one) == 0

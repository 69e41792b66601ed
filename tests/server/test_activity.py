"""What processes tell each other of their work, in one database."""

from __future__ import annotations

import threading
import time
from pathlib import Path

import pytest

from motion import InputError
from webdemo.server import activity
from webdemo.server.activity import Activity, Item
from webdemo.server.queue.places import LOST_AFTER
from webdemo.server.store.database import Database

RUN = Item("r1", "one", "user ada", "intergen", "runs", 5.0)
STREAM = Item("s1", "two", "user eve", "live stream", "open", 6.0)


@pytest.fixture
def database(tmp_path: Path) -> Database:
    return Database(f"sqlite:///{tmp_path / 'lab.db'}")


def test_all_processes_are_read_and_lost_ones_forgotten(database: Database, monkeypatch: pytest.MonkeyPatch) -> None:
    one, two = Activity(database), Activity(database)
    one.publish("one", [RUN], streams=0)
    two.publish("two", [STREAM], streams=1)
    assert one.items() == [RUN, STREAM] and one.states()["two"]["streams"] == 1
    two.leave("two")
    assert one.items() == [RUN]
    now = time.time()
    monkeypatch.setattr(activity.time, "time", lambda: now + LOST_AFTER + 1)
    assert one.items() == []
    two.publish("two", [STREAM])
    assert list(one.states()) == ["two"]


def test_only_changes_and_heartbeats_are_written(database: Database, monkeypatch: pytest.MonkeyPatch) -> None:
    one = Activity(database)
    one.publish("one", [RUN])
    seen = _seen(database)
    one.publish("one", [RUN])
    assert _seen(database) == seen
    one.publish("one", [])
    changed = _seen(database)
    assert changed > seen
    now = time.time()
    monkeypatch.setattr(activity.time, "time", lambda: now + activity.SEEN_EVERY + 1)
    one.publish("one", [])
    assert _seen(database) > changed


def _seen(database: Database) -> float:
    with database.session() as session:
        process = session.get(activity.Process, "one")
        assert process is not None
        return process.seen


def test_the_process_that_has_a_run_ends_it(database: Database) -> None:
    one, shell = Activity(database), Activity(database)
    one.publish("one", [RUN])
    ended: list[str] = []

    def serve() -> None:
        while not ended:
            one.heed(lambda key: key == "r1" and not ended.append(key))
            time.sleep(0.01)
        one.publish("one", [])

    thread = threading.Thread(target=serve)
    thread.start()
    shell.end("r1")
    thread.join()
    assert ended == ["r1"]
    one.heed(lambda key: pytest.fail("the wish was kept"))


def test_what_nobody_has_or_nobody_ends_is_said(database: Database, monkeypatch: pytest.MonkeyPatch) -> None:
    one = Activity(database)
    one.publish("one", [RUN])
    with pytest.raises(InputError, match="no run or live stream 'r2'"):
        one.end("r2")
    with pytest.raises(InputError, match="The process one has not ended it yet"):
        one.end("r1", wait=0.0)
    now = time.time()
    monkeypatch.setattr(activity.time, "time", lambda: now + 60)
    one.heed(lambda key: False)
    one.heed(lambda key: pytest.fail("an old wish was kept"))

"""Hostile uploads and requests."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from typing import Any

import pytest
from fastapi.testclient import TestClient

from motion import InputError
from tests.server.clients import FIELDS, HERE, client_of, events_of, lab_of, settings_for
from tests.server.lab import stub_module
from webdemo.server.accounts.quotas import Quota
from webdemo.server.queue.queue import FairQueue
from webdemo.ui.visitor import Visitor


@pytest.fixture(scope="module")
def open_to_all(tmp_path_factory: pytest.TempPathFactory) -> Iterator[TestClient]:
    """A server without accounts, open to everybody; 25 requests a minute and person."""
    folder = tmp_path_factory.mktemp("open")
    with client_of(settings_for(folder, open=True, rate=25, address_people=2)) as client:
        client.cookies.clear()
        yield client


def test_a_visitors_history_is_not_had_by_naming_them(open_to_all: TestClient) -> None:
    mine = {"cookie": "pasdedeux_visitor=" + "m" * 32}
    assert "event: complete" in events_of(open_to_all, "generate", FIELDS, mine)
    history = lab_of(open_to_all).history
    with history.database.engine.connect() as connection:
        owners = {row[0] for row in connection.exec_driver_sql("SELECT owner FROM runs")}
    assert len(owners) == 1 and "mmm" not in owners.pop()  # the cookie itself is not kept


def test_throwing_the_cookie_away_gains_nothing(open_to_all: TestClient) -> None:
    answers: list[int] = []
    while 429 not in answers and len(answers) < 600:  # a slow machine is granted more meanwhile
        cookie = f"pasdedeux_visitor={len(answers):032}"
        asked = open_to_all.post("/gradio_api/queue/join", content=b"[]", headers={"cookie": cookie})
        answers.append(asked.status_code)
    assert len(answers) > 20 and answers[-1] == 429
    other = TestClient(open_to_all.app, base_url=HERE, client=("203.0.113.9", 5))
    assert other.post("/gradio_api/queue/join", content=b"[]").status_code != 429


def test_one_address_does_not_fill_the_line(monkeypatch: pytest.MonkeyPatch) -> None:
    started = threading.Event()

    class Busy:
        ready = True

        def run(self, request: Any, cancel: Any = None) -> Iterator[Any]:
            started.set()
            while not cancel.cancelled:
                time.sleep(0.01)
            yield from ()

    queue = FairQueue(Busy(), None, Quota("runs waiting", 4, 3))  # type: ignore[arg-type]
    request = stub_module().GenerateRequest(prompt="x")
    jobs = [queue._enter("first", request, Visitor(person="first", address="a"))]
    assert started.wait(10)
    jobs += [queue._enter(f"s{i}", request, Visitor(person=f"p{i}", address="a")) for i in range(3)]
    with pytest.raises(InputError, match="your network have 3 runs waiting"):
        queue._enter("more", request, Visitor(person="more", address="a"))
    jobs.append(queue._enter("other", request, Visitor(person="other", address="b")))
    for job in jobs:
        job.token.cancel()

"""Whose page event is next, and that nobody fills the queue of events for others."""

from __future__ import annotations

import asyncio
import threading
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import gradio as gr
import pytest
from fastapi import HTTPException
from gradio.routes import App
from gradio.utils import SyncToAsyncIterator
from starlette.routing import Mount

from tests.server.attacks.target import Target
from tests.server.clients import CALL, FIELDS, client_of, lab_of, settings_for, wait_for
from tests.server.lab import ROOT, stub_module
from tests.ui.stub_page import stub_context
from webdemo.server.accounts.quotas import Quota
from webdemo.server.accounts.visitors import Bindings
from webdemo.server.app import create_app
from webdemo.server.http.health import Figures
from webdemo.server.queue import events
from webdemo.server.queue.events import AT_ONCE, FairEvents
from webdemo.ui.page import build_page, start_queue
from webdemo.ui.visitor import Visitor

CLIP = ROOT / "static" / "examples" / "shake-hands.npz"
OLD_LIMIT = 192
"""Events of everybody that the server once took at a time."""


def made(quota: Quota | None = None) -> FairEvents:
    """A queue of a page with a film (one at a time), a list (four at a time) and a run (any number)."""
    with gr.Blocks(analytics_enabled=False) as page:
        for name, limit in (("film", 1), ("list", 4), ("reading", 4), ("tidy", 4), ("run", None)):
            gr.Button().click(lambda: None, concurrency_limit=limit, concurrency_id=name, api_name=name)
    given: Any = {"quota": quota or Quota("tasks", 16), "figures": Figures(), "bindings": Bindings()}
    start_queue(page, partial(FairEvents, **given))
    queue = page._queue
    assert isinstance(queue, FairEvents)
    queue.active_jobs = [None] * 40
    return queue


def ask(queue: FairEvents, who: str | Visitor, what: str) -> None:
    visitor = who if isinstance(who, Visitor) else Visitor(who)
    request: Any = SimpleNamespace(scope={"state": {"visitor": visitor}})
    number = next(n for n, fn in queue.blocks.fns.items() if fn.api_name == what)
    body: Any = SimpleNamespace(fn_index=number, session_hash=None, event_id=None, request=request)
    asyncio.run(queue.push(body, request, None))


def begin(queue: FairEvents) -> Any:
    """The event that the queue begins, as Gradio does; None if none may begin."""
    found = queue.get_events()
    if found is None:
        return None
    (event,), _, group = found
    queue.active_jobs[queue.active_jobs.index(None)] = [event]
    queue.event_queue_per_concurrency_id[group].current_concurrency += 1
    return event


def end(queue: FairEvents, event: Any, seconds: float) -> None:
    queue.active_jobs[queue.active_jobs.index([event])] = None
    queue.event_queue_per_concurrency_id[event.concurrency_id].current_concurrency -= 1
    queue._charge(event, seconds)


def names(queue: FairEvents, count: int, seconds: float = 1.0) -> list[str]:
    """The people whose next events are done, one after the other."""
    found = []
    for _ in range(count):
        event = begin(queue)
        found.append(event.request.scope["state"]["visitor"].person)
        end(queue, event, seconds)
    return found


def test_the_person_served_least_goes_first() -> None:
    queue = made()
    for _ in range(5):
        ask(queue, "greedy", "film")
    assert names(queue, 1) == ["greedy"]
    ask(queue, "late", "film")
    ask(queue, "late", "film")
    assert names(queue, 6) == ["greedy", "late", "greedy", "late", "greedy", "greedy"]


def test_long_events_cost_later_turns() -> None:
    queue = made()
    for _ in range(3):
        ask(queue, "long", "film")
        ask(queue, "short", "film")
    first = begin(queue)
    assert first.request.scope["state"]["visitor"].person == "long"
    end(queue, first, 10.0)
    assert names(queue, 5) == ["short"] * 3 + ["long"] * 2


def test_whoever_has_had_a_long_text_read_waits_longer_for_the_next() -> None:
    """Texts of 2,000 characters, one after the other, took a core from the runs of others."""
    queue = made()
    for who in ("greedy", "greedy", "other"):
        ask(queue, who, "reading")
    end(queue, begin(queue), 0.2)
    assert names(queue, 1, 0.0) == ["other"] and begin(queue) is None
    time.sleep(0.65)
    assert begin(queue) is not None


def test_a_person_has_half_of_a_group_and_so_many_in_all() -> None:
    queue = made()
    for what in ("list", "reading", "tidy"):
        for _ in range(4):
            ask(queue, "greedy", what)
    begun = []
    while event := begin(queue):
        begun.append(event.concurrency_id)
    assert len(begun) == AT_ONCE and max(begun.count(group) for group in begun) == 2
    ask(queue, "other", "list")
    assert begin(queue).request.scope["state"]["visitor"].person == "other"


def test_strangers_of_one_address_share_half_of_a_group() -> None:
    queue = made()
    for i in range(4):
        ask(queue, Visitor(f"visitor {i}", address="203.0.113.9"), "list")
    assert begin(queue) and begin(queue) and begin(queue) is None
    ask(queue, Visitor("visitor x", address="203.0.113.10"), "list")
    assert begin(queue).request.scope["state"]["visitor"].person == "visitor x"


def test_runs_begin_at_once_since_they_wait_elsewhere() -> None:
    queue = made()
    for _ in range(6):
        ask(queue, "one", "run")
    assert all(begin(queue) for _ in range(6))


def test_a_person_and_an_address_have_so_many_unfinished_events() -> None:
    queue = made(Quota("tasks", 3, 5, 14))
    for _ in range(3):
        ask(queue, "greedy", "film")
    begin(queue)  # what is worked on counts as well
    with pytest.raises(HTTPException) as refused:
        ask(queue, "greedy", "list")
    assert refused.value.status_code == 429 and "You already have 3 tasks" in refused.value.detail
    for i in range(5):
        ask(queue, Visitor(f"visitor {i}", address="203.0.113.9"), "film")
    with pytest.raises(HTTPException, match="your network have 5 tasks"):
        ask(queue, Visitor("visitor 6", address="203.0.113.9"), "film")
    for i in range(6):
        ask(queue, f"other {i}", "film")
    with pytest.raises(HTTPException) as refused:
        ask(queue, "another", "film")
    assert refused.value.status_code == 503


def test_whoever_waits_takes_no_thread_from_others(tmp_path: Path) -> None:
    """One address took all 128 threads by as many files that waited to be read."""
    app = create_app(settings_for(tmp_path, open=True), engine=stub_module().StubEngine())
    (page,) = [r.app.get_blocks() for r in app.routes if isinstance(r, Mount) and isinstance(r.app, App)]
    assert page.max_threads >= page._queue.quota.everybody > page._queue.quota.address
    films = [fn.concurrency_limit for fn in page.fns.values() if fn.concurrency_id == "film"]
    assert films and min(films) > 1, "one person's film of ten minutes leaves a place to others"


def test_a_run_whose_page_is_gone_ends_beside_the_event_loop(tmp_path: Path) -> None:
    """What it wrote down at its end kept every other request waiting, for 15 seconds where the database was busy."""
    ends = []

    def run() -> Iterator[int]:
        try:
            yield 1
        finally:
            ends.append(threading.get_ident())

    async def leave() -> None:
        create_app(settings_for(tmp_path, open=True), engine=stub_module().StubEngine())
        running = SyncToAsyncIterator(run(), None)
        await anext(running)
        await running.aclose()

    asyncio.run(leave())
    assert ends and ends[0] != threading.get_ident()


def test_answers_that_nobody_fetches_are_few(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """An opened run takes 2 MB: 2,000 sessions of one stranger's took all memory within minutes."""

    def ask() -> Any:
        return client.post(f"{CALL}/generate", json={"data": FIELDS})

    with client_of(settings_for(tmp_path, events=8, waiting=9)) as client:
        (queue,) = [r.app.get_blocks()._queue for r in client.app.routes if isinstance(r, Mount)]  # type: ignore[attr-defined]
        calls = []
        while (answer := ask()).status_code == 200:
            calls.append(answer.json()["event_id"])
        wait_for(lambda: len(queue._answers) == len(calls))
        assert len(calls) == 8 and ask().status_code == 429
        assert "event: complete" in client.get(f"{CALL}/generate/{calls[0]}").text
        monkeypatch.setattr(events, "UNREAD_SECONDS", 0.0)
        late = ask().json()["event_id"]  # there is a place again
        wait_for(lambda: len(queue.pending_event_ids_session) == 7)
        assert client.get(f"{CALL}/generate/{late}").status_code == 404
        assert sum(not each.empty() for each in queue.pending_messages_per_session.values()) == 7


def test_a_session_that_is_not_there_ends_no_queue(tmp_path: Path) -> None:
    """One call in a session without a name, which Gradio keeps under another, ended the queue for everybody."""
    with client_of(settings_for(tmp_path)) as client:
        (queue,) = [r.app.get_blocks()._queue for r in client.app.routes if isinstance(r, Mount)]  # type: ignore[attr-defined]
        body = {"data": FIELDS, "session_hash": ""}
        assert client.post(f"{CALL}/generate", json=body).status_code == 400
        queue.pending_messages_per_session.max_size = 1  # of so many, the oldest go
        calls = [client.post(f"{CALL}/generate", json={"data": FIELDS}).json()["event_id"] for _ in range(3)]
        wait_for(lambda: queue.stopped or len(queue._answers) == len(calls))
        assert not queue.stopped and not lab_of(client).health.stuck()
        assert "event: complete" in client.get(f"{CALL}/generate/{calls[-1]}").text
        queue.stopped = True
        assert "The queue of events has made no progress" in lab_of(client).health.stuck()
        queue.stopped = False


def test_nothing_that_computes_goes_past_the_queue() -> None:
    """What is called directly sets buttons or stops a run: it takes nothing that a client could make large."""
    page = build_page(stub_context(stub_module().StubEngine()))
    assert not page.api_open
    for fn in page.fns.values():
        if fn.fn is not None and not fn.queue:
            assert all(isinstance(block, gr.State) for block in fn.inputs), fn.name


@pytest.fixture(scope="module")
def target(tmp_path_factory: pytest.TempPathFactory) -> Any:
    with Target(tmp_path_factory.mktemp("events"), accounts=True, stub_pause=0.1, events=16) as target:
        yield target


def sheet(target: Target, who: str) -> list[Any]:
    """What ``/render`` is given for a contact sheet."""
    path = target.upload(who, "hands.npz", CLIP.read_bytes())
    file = {"path": path, "meta": {"_type": "gradio.FileData"}}
    return [file, "png", "bodies", "light", "threequarter", 24, 640, 360, "", 0, "", ""]


def test_one_person_cannot_stop_the_events_of_others(target: Target) -> None:
    """As many events as once stopped everybody's: a few are taken, and others' turn comes after one of them."""
    data = sheet(target, "eve")
    with ThreadPoolExecutor(200) as pool:
        ask = partial(target.ask, "eve", "POST", "/gradio_api/call/render", json={"data": data})
        answers = list(pool.map(lambda _: ask(), range(OLD_LIMIT + 5)))
    refused = [answer for answer in answers if answer.status_code != 200]
    assert len(refused) > OLD_LIMIT / 2 and {answer.status_code for answer in refused} == {429}
    assert "unfinished tasks" in refused[-1].json()["detail"]
    before = target.ask("ada", "GET", "/gradio_api/queue/status").json()["queue_size"]
    assert before >= 8  # or nothing is shown below
    assert "event: complete" in target.call("ada", "render", sheet(target, "ada"))
    after = target.ask("ada", "GET", "/gradio_api/queue/status").json()["queue_size"]
    assert before - after <= 4, "one contact sheet of hers waits for no more than a few of the other's"
    assert "event: complete" in target.call("ada", "generate", FIELDS)


def test_no_event_is_called_past_the_queue(target: Target) -> None:
    for path, body in (("render", {"data": sheet(target, "eve")}), ("predict", {"fn_index": 4, "data": []})):
        answer = target.ask("eve", "POST", f"/gradio_api/run/{path}", json=body)
        assert answer.status_code in (400, 404), path


def test_several_streams_of_a_call_that_are_cut_off_leave_nothing(target: Target) -> None:
    """All but one ended in an error, and what Gradio keeps of each stayed until the server was stopped."""
    data, ends = [*FIELDS[:5], 40, *FIELDS[6:]], '"route": "/gradio_api/call/{api_name}/{event_id}"'
    call = target.ask("ada", "POST", f"{CALL}/generate", json={"data": data}).json()["event_id"]
    before = target.log().count(ends)
    with ExitStack() as cut:
        for _ in range(5):
            stream = target.client("ada").stream("GET", f"{CALL}/generate/{call}")
            assert cut.enter_context(stream).status_code == 200
    wait_for(lambda: target.log().count(ends) == before + 5)
    assert "session_not_found" in target.ask("ada", "GET", "/gradio_api/queue/data?session_hash=never").text
    assert '"level": "error"' not in target.log()


def test_a_film_whose_client_has_left_leaves_its_place(target: Target) -> None:
    """It was drawn to its end, for ten minutes at most, while the same person's next one waited."""
    small = sheet(target, "ada")
    minute = [small[0], "mp4", *small[2:5], 60, 1920, 1080, "", 2, "", ""]
    call = target.ask("ada", "POST", f"{CALL}/render", json={"data": minute}).json()["event_id"]
    with target.client("ada").stream("GET", f"{CALL}/render/{call}") as stream:
        assert stream.status_code == 200
        wait_for(lambda: target.ask("ada", "GET", "/gradio_api/queue/status").json()["queue_size"] == 0)
    began = time.monotonic()
    assert "event: complete" in target.call("ada", "render", small)
    assert time.monotonic() - began < 20

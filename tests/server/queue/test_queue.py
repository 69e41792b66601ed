"""Whose turn it is, caps, places, cancelling; the engine here is a counter that the tests hold."""

from __future__ import annotations

import threading
import time
from typing import Any

import pytest

from motion import InputError
from tests.server.clients import wait_for
from tests.server.queue.people import Gate, make, queue_of, request
from webdemo.inference import run
from webdemo.inference.engine import Engine
from webdemo.inference.run import Cancelled, Progress, Result
from webdemo.server.app import engine_of
from webdemo.server.cluster import ray_engine
from webdemo.server.queue import queue as line
from webdemo.server.settings import Settings
from webdemo.ui.visitor import Visitor


def test_who_has_had_least_goes_first(monkeypatch: pytest.MonkeyPatch) -> None:
    gate, people = make(monkeypatch)
    for i in range(4):
        people.ask("greedy", request(f"greedy {i}"))
    people.ask("late", request("late 0"))
    people.ask("later", request("later 0"))
    gate.open.release(6)
    people.end()
    assert gate.order == ["greedy 0", "late 0", "later 0", "greedy 1", "greedy 2", "greedy 3"]
    assert {name: end.manifest["name"] for name, end in people.ends.items()} == {n: n for n in people.ends}


def test_a_long_run_costs_later_turns(monkeypatch: pytest.MonkeyPatch) -> None:
    gate, people = make(monkeypatch)
    people.ask("long", request("long 0", samples=4))
    people.ask("long", request("long 1"))
    for i in range(3):
        people.ask("short", request(f"short {i}"))
    gate.open.release(5)
    people.end()
    assert gate.order == ["long 0", "short 0", "short 1", "short 2", "long 1"]


def test_a_person_has_so_many_at_work(monkeypatch: pytest.MonkeyPatch) -> None:
    gate, people = make(monkeypatch, running=2, person=8, workers=4)
    for i in range(5):
        people.ask("busy", request(f"{i}"))
    people.ask("other", request("other"))
    wait_for(lambda: "other" in gate.order)
    assert len(gate.order) == 3 and people.queue.running == 3
    gate.open.release(6)
    people.end()
    assert len(gate.order) == 6


def test_a_person_may_not_fill_the_line(monkeypatch: pytest.MonkeyPatch) -> None:
    gate, people = make(monkeypatch, person=2)
    for i in range(4):
        people.ask("one", request(f"r{i}"))
    people.ask("other", request("other"))
    gate.open.release(4)
    people.end()
    assert str(people.ends["r3"]).startswith("You already have 2 runs waiting")
    assert isinstance(people.ends["other"], Result)


def test_one_address_does_not_fill_the_line() -> None:
    queue = queue_of(Gate(), address=3)

    def enter(name: str, address: str) -> Any:
        return queue._enter(name, request(name), Visitor(person=name, address=address))

    enter("first", "a")
    wait_for(lambda: queue.running)
    for name in ("second", "third", "fourth"):
        enter(name, "a")
    with pytest.raises(InputError, match="your network have 3 runs waiting"):
        enter("fifth", "a")
    assert enter("other", "b") and queue.close(0.0) == 1


def test_a_full_line_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    gate, people = make(monkeypatch, everybody=2)
    for name in "abcd":
        people.ask(name, request(name))
    gate.open.release(3)
    people.end()
    assert str(people.ends["d"]).startswith("There are 2 runs waiting here already")


def test_places_and_estimates(monkeypatch: pytest.MonkeyPatch) -> None:
    gate, people = make(monkeypatch)
    people.queue.paces["m"].learn(120.0, 12.0)  # 0.1 s a unit; a request here has 60 units
    for name in "abc":
        people.ask(name, request(name))
    wait_for(lambda: people.waits.get("b") and people.waits.get("c"))
    first, last = people.waits["b"][0], people.waits["c"][0]
    gate.open.release(3)
    people.end()
    assert (first.step, last.step) == (1, 2)
    assert first.seconds_left == pytest.approx(6, abs=1.5)
    assert last.seconds_left == pytest.approx(12, abs=1.5)


def test_cancel_while_waiting_and_while_running(monkeypatch: pytest.MonkeyPatch) -> None:
    gate, people = make(monkeypatch)
    people.ask("a", request("a"))
    people.ask("b", request("b"))
    assert people.queue.cancel("session of b")
    wait_for(lambda: "b" in people.ends)
    assert people.queue.cancel("session of a")
    people.end()
    assert all(isinstance(people.ends[name], Cancelled) for name in "ab")
    assert gate.order == ["a"]
    wait_for(lambda: people.queue.running == 0)
    assert not people.queue.cancel("session of a")
    assert b'pasdedeux_runs_total{model="m",outcome="cancelled"} 2.0' in people.queue.figures.text()


def test_an_error_is_its_own_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    gate, people = make(monkeypatch)
    heard: list[BaseException] = []
    people.queue.broken = heard.append
    people.ask("a", request("crash"))
    people.ask("b", request("b"))
    gate.open.release(2)
    people.end()
    assert isinstance(people.ends["crash"], RuntimeError) and isinstance(people.ends["b"], Result)
    assert [type(error) for error in heard] == [RuntimeError]
    assert b'pasdedeux_errors_total{kind="RuntimeError"} 1.0' in people.queue.figures.text()


def test_stopping_lets_running_end_and_returns_the_rest(monkeypatch: pytest.MonkeyPatch) -> None:
    gate, people = make(monkeypatch)
    people.ask("a", request("a"))
    people.ask("b", request("b"))
    wait_for(lambda: people.queue.running == 1)
    threading.Timer(0.1, gate.open.release).start()
    assert people.queue.close(5.0) == 0
    people.ask("c", request("c"))
    people.end()
    assert isinstance(people.ends["a"], Result)
    assert "The server is stopping" in str(people.ends["b"])
    assert isinstance(people.ends["c"], InputError)


def test_stopping_does_not_wait_for_ever(monkeypatch: pytest.MonkeyPatch) -> None:
    _, people = make(monkeypatch)
    people.ask("a", request("a"))
    wait_for(lambda: people.queue.running == 1)
    assert people.queue.close(0.05) == 1
    people.end()
    assert isinstance(people.ends["a"], (InputError, Cancelled))


def test_several_workers_of_a_group(monkeypatch: pytest.MonkeyPatch) -> None:
    """With replicas, several requests of a model are on their way at once."""
    gate, people = make(monkeypatch, workers=2)
    people.queue.paces["m"].learn(120.0, 12.0)
    for name in "abcd":
        people.ask(name, request(name))
    wait_for(lambda: people.queue.running == 2 and people.waits.get("c") and people.waits.get("d"))
    assert sorted(gate.order) == ["a", "b"]
    assert people.waits["c"][0].seconds_left == pytest.approx(6, abs=1.5)  # each worker has a run of 6 s
    assert people.waits["d"][0].seconds_left == pytest.approx(9, abs=1.5)
    gate.open.release(4)
    people.end()
    assert all(isinstance(end, Result) for end in people.ends.values())


def test_a_long_run_keeps_no_much_shorter_one_waiting(monkeypatch: pytest.MonkeyPatch) -> None:
    """One run of the greatest length and number kept everybody else's waiting for minutes."""
    gate, people = make(monkeypatch)
    people.ask("eve", request("long", steps=1000))
    people.ask("mallory", request("nearly as long", steps=400))
    people.ask("eve", request("her own"))
    people.ask("ada", request("short"))
    time.sleep(0.1)
    assert gate.order == ["long"], "nobody passes one that has just begun"
    people.queue._running[0].started -= 2 * line.PATIENCE
    wait_for(lambda: people.queue.running == 2)
    people.ask("bob", request("another"))
    time.sleep(0.1)
    assert gate.order == ["long", "short"], "one passes at a time, of another person's, and much shorter"
    gate.open.release(5)
    people.end()
    assert all(isinstance(end, Result) for end in people.ends.values())


def test_the_engine_that_settings_name(monkeypatch: pytest.MonkeyPatch) -> None:
    assert isinstance(engine_of(Settings()), Engine)
    monkeypatch.setattr(ray_engine, "find_spec", lambda name: None)
    with pytest.raises(InputError, match="Ray is not installed"):
        engine_of(Settings(engine="ray"))
    monkeypatch.setattr(ray_engine, "find_spec", lambda name: name)
    engine = engine_of(Settings(engine="ray", ray_replicas=3))
    assert isinstance(engine, ray_engine.RayEngine) and engine.parallel == 3 and not engine.ready


def test_the_time_of_a_run_begins_when_it_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    now = 0.0
    monkeypatch.setattr(run, "monotonic", lambda: now)
    gate, people = make(monkeypatch, seconds=600)
    people.ask("ada", request("first"))
    people.ask("eve", request("second"))
    now = 599.0
    gate.open.release()
    wait_for(lambda: "second" in gate.order and "first" in people.ends)
    assert isinstance(people.ends["first"], Result)
    now = 599.0 + 600.0  # the second has waited as long as it may run
    people.ask("ada", request("third"))
    assert people.queue.running == 1 and "second" not in people.ends
    now += 1.0
    people.threads[1].join(timeout=10)
    assert isinstance(people.ends["second"], InputError)
    assert "longer than the 10 minutes that this lab allows" in str(people.ends["second"])
    wait_for(lambda: "third" in gate.order)  # else the second may still take what is released
    gate.open.release()
    people.end()
    assert isinstance(people.ends["third"], Result)


def test_a_result_that_is_there_is_not_too_late(monkeypatch: pytest.MonkeyPatch) -> None:
    now = 0.0
    monkeypatch.setattr(run, "monotonic", lambda: now)
    gate = Gate()
    gate.open.release()
    queue = queue_of(gate, seconds=600)
    events = queue.run("a session", request("x"))
    assert isinstance(next(events), Progress)
    wait_for(lambda: queue.running == 0)
    now = 601.0
    assert isinstance(next(events), Result)

"""A queue before an engine that the tests hold, and people who ask it for runs."""

from __future__ import annotations

import math
import threading
from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import pytest

from tests.server.clients import wait_for
from webdemo.inference.run import Progress, Result
from webdemo.server.accounts.quotas import Quota
from webdemo.server.http.health import Figures
from webdemo.server.queue import queue as line
from webdemo.server.queue.queue import FairQueue
from webdemo.ui.runs import Waiting
from webdemo.ui.visitor import Visitor


def request(name: str, *, samples: int = 1, steps: int = 10, model: str = "m") -> Any:
    return SimpleNamespace(name=name, samples=samples, steps=steps, seconds=5.0, model=model, prompt=name)


class Gate:
    """An engine whose runs end when the test says so."""

    ready = True

    def __init__(self) -> None:
        self.order: list[str] = []
        self.open = threading.Semaphore(0)

    def run(self, request: Any, cancel: Any = None) -> Iterator[Any]:
        self.order.append(request.name)
        yield Progress(stage="text")
        while not self.open.acquire(timeout=0.01):
            cancel.raise_if_cancelled()
        if "crash" in request.name:
            raise RuntimeError("broken")
        yield Result(duets=(), manifest={"name": request.name})


class People:
    """Runs requests of named people in threads and notes how each ended."""

    def __init__(self, queue: FairQueue, monkeypatch: pytest.MonkeyPatch) -> None:
        self.queue = queue
        self.ends: dict[str, Any] = {}
        self.waits: dict[str, list[Waiting]] = {}
        self.threads: list[threading.Thread] = []
        self.who = threading.local()
        monkeypatch.setattr(line, "visitor", lambda: Visitor(person=self.who.name))
        monkeypatch.setattr(line, "TICK", 0.02)

    def ask(self, person: str, wanted: Any) -> None:
        """Asks in a thread of its own; returns when the request is in the line, runs or was refused."""
        thread = self.ask_only(person, wanted)
        wait_for(lambda: self.queue.running or not thread.is_alive())  # the first is taken at once

    def ask_only(self, person: str, wanted: Any) -> threading.Thread:
        """As :meth:`ask`, where nothing takes the first request."""
        before = self.queue.waiting + self.queue.running
        thread = threading.Thread(target=self._run, args=(person, wanted), daemon=True)
        self.threads.append(thread)
        thread.start()
        wait_for(lambda: self.queue.waiting + self.queue.running > before or not thread.is_alive())
        return thread

    def _run(self, person: str, wanted: Any) -> None:
        self.who.name = person
        try:
            for event in self.queue.run(f"session of {wanted.name}", wanted):
                if isinstance(event, Waiting):
                    self.waits.setdefault(wanted.name, []).append(event)
                if isinstance(event, Result):
                    self.ends[wanted.name] = event
        except Exception as error:
            self.ends[wanted.name] = error

    def end(self) -> None:
        for thread in self.threads:
            thread.join(timeout=10)
            assert not thread.is_alive()


def queue_of(gate: Any, person: int = 4, address: float = math.inf, everybody: float = 64, **limits: Any) -> FairQueue:
    usual = {"running": 2, "workers": 1, "seconds": 0.0, "figures": Figures(), "broken": lambda error: None}
    return FairQueue(gate, Quota("runs waiting", person, address, everybody), **(usual | limits))


def make(monkeypatch: pytest.MonkeyPatch, **limits: Any) -> tuple[Gate, People]:
    gate = Gate()
    return gate, People(queue_of(gate, **limits), monkeypatch)

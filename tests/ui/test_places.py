"""Places for reading: one a person, few for all, and whoever had none goes first."""

from __future__ import annotations

import threading
import time

import pytest

from webdemo.ui import places as module
from webdemo.ui.places import Places
from webdemo.ui.visitor import Visitor


def test_a_person_has_one_place_and_others_go_before_their_next(monkeypatch: pytest.MonkeyPatch) -> None:
    who = threading.local()
    monkeypatch.setattr(module, "visitor", lambda: Visitor(who.name, address=who.address))
    places, order, gate = Places(at_once=2), [], threading.Semaphore(0)
    inside: list[str] = []

    def read(name: str, address: str = "") -> None:
        who.name, who.address = name, address
        with places.place():
            order.append(name)
            inside.append(address or name)
            assert len(set(inside)) == len(inside) <= 2
            gate.acquire(timeout=60)
            inside.remove(address or name)

    def ask(*given: str) -> threading.Thread:
        thread = threading.Thread(target=read, args=given)
        thread.start()
        time.sleep(0.05)
        return thread

    threads = [ask("eve") for _ in range(5)]  # the first is in, and the others wait for it
    assert order == ["eve"]
    threads += [ask("ada"), ask("ann", "192.0.2.1"), ask("bob", "192.0.2.1")]
    assert order == ["eve", "ada"]
    for _ in threads:
        gate.release()
        time.sleep(0.05)
    for thread in threads:
        thread.join(timeout=60)
    assert order[2] in ("ann", "bob"), "they are one person, who had none"
    assert order.count("eve") == 5 and len(order) == 8

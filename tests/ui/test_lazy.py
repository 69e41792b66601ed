"""The engine of the page is made on first use, once."""

import threading
from pathlib import Path
from typing import Any

import pytest

from webdemo.inference import engine as engines
from webdemo.inference.run import Progress
from webdemo.ui.lazy import LazyEngine


class Engine:
    """Counts how often it is made."""

    made = 0

    def __init__(self, weights: Path | None = None) -> None:
        type(self).made += 1
        self.weights, self.ready = weights, False

    def warm_up(self) -> None:
        self.ready = True

    def run(self, request: Any, cancel: Any = None) -> Any:
        yield Progress(stage="sample", step=1)


@pytest.fixture(autouse=True)
def stub(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Engine, "made", 0)
    monkeypatch.setattr(engines, "Engine", Engine)


def test_looking_whether_it_is_ready_loads_nothing() -> None:
    lazy = LazyEngine()
    assert not lazy.ready and Engine.made == 0
    lazy.warm_up()
    assert lazy.ready and Engine.made == 1


def test_many_threads_make_one_engine() -> None:
    lazy = LazyEngine(Path("weights"))
    threads = [threading.Thread(target=lazy.warm_up) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert Engine.made == 1 and lazy._made().weights == Path("weights")


def test_the_first_request_says_that_it_loads() -> None:
    lazy = LazyEngine()
    assert [event.stage for event in lazy.run(None)] == ["load", "sample"]
    lazy.warm_up()
    assert [event.stage for event in lazy.run(None)] == ["sample"]

"""The engine, imported when it is first needed, so that the page is up before torch is."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from webdemo.inference.live.partner import LivePartner
from webdemo.inference.run import CancelToken, Progress, Result


class LazyEngine:
    """Stands for :class:`webdemo.inference.engine.Engine` and makes it on first use, in any thread.

    Args:
        weights: as the engine takes them; None for the shipped ones.
    """

    def __init__(self, weights: Path | None = None) -> None:
        self.weights = weights
        self._lock = threading.Lock()
        self._engine: Any = None

    def _made(self) -> Any:
        with self._lock:
            if self._engine is None:
                from webdemo.inference.engine import Engine

                self._engine = Engine() if self.weights is None else Engine(self.weights)
            return self._engine

    @property
    def ready(self) -> bool:
        """True if the networks are loaded; does not load anything."""
        return self._engine is not None and bool(self._engine.ready)

    def warm_up(self) -> None:
        """Imports and loads everything."""
        self._made().warm_up()

    def run(self, request: Any, cancel: CancelToken | None = None) -> Iterator[Progress | Result]:
        """Runs a request; the first one may have to load the networks."""
        if not self.ready:
            yield Progress(stage="load")
        yield from self._made().run(request, cancel=cancel)

    def partner(self, name: str, *, seed: int = 0) -> LivePartner:
        """A partner who answers a stream of poses; the first one may have to load the networks."""
        return self._made().partner(name, seed=seed)

"""The health check: a tiny generation shows that the server can do its work."""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Callable
from typing import Any

from motion import InputError
from webdemo.inference.cancel import CancelToken
from webdemo.inference.requests import GenerateRequest, Result
from webdemo.ui.runs import EngineLike

log = logging.getLogger(__name__)

PAUSE = 30.0
"""Seconds between two tries after one that failed."""


class Health:
    """Ready once a tiny generation has worked, and until a run breaks; then another one is tried.

    Args:
        engine: what generates.
        wants: further things that must hold, by name; each raises where it does not.
    """

    def __init__(self, engine: EngineLike, wants: dict[str, Callable[[], Any]] | None = None) -> None:
        self.engine = engine
        self.wants = wants or {}
        self.stopping = False
        self.error = ""
        self._works = False
        self._tried_at = -PAUSE
        self._lock = threading.Lock()
        self._thread: threading.Thread | None = None

    @property
    def ready(self) -> bool:
        """True if requests should be sent here."""
        return self._works and not self.stopping

    def probe(self) -> None:
        """Starts a tiny generation in its own thread, unless one is running or has just failed."""
        with self._lock:
            busy = self._thread is not None and self._thread.is_alive()
            if self._works or busy or time.monotonic() - self._tried_at < PAUSE:
                return
            self._tried_at = time.monotonic()
            self._thread = threading.Thread(target=self._try, name="health", daemon=True)
            self._thread.start()

    def broken(self, error: BaseException) -> None:
        """A run ended in an error that was not its user's."""
        self._works = False
        self.error = f"a run ended in {type(error).__name__}"

    def report(self) -> tuple[bool, dict[str, Any]]:
        """Returns whether all is well, and the state of each part."""
        self.probe()
        checks: dict[str, str] = {}
        for name, check in self.wants.items():
            try:
                check()
                checks[name] = "ok"
            except Exception as error:
                checks[name] = f"failed ({type(error).__name__})"
        checks["generation"] = "ok" if self._works else f"failed: {self.error}" if self.error else "loading"
        whole = self.ready and all(state == "ok" for state in checks.values())
        failed = any(state.startswith("failed") for state in checks.values())
        status = "stopping" if self.stopping else "ready" if whole else "failed" if failed else "loading"
        return whole, {"status": status, "checks": checks}

    def _try(self) -> None:
        request = GenerateRequest(prompt="Two people wave.", seconds=1.0, steps=1, damping=0.0)
        try:
            self.engine.warm_up()
            *_, result = self.engine.run(request, CancelToken())
            if not isinstance(result, Result):
                raise RuntimeError("no result")
        except InputError as error:
            self.error = str(error)
        except Exception as error:
            log.exception("A tiny generation failed.")
            self.error = f"a tiny generation ended in {type(error).__name__}"
        else:
            self._works, self.error = True, ""

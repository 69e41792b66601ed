"""The parts of a running server, put together."""

from __future__ import annotations

import logging
from typing import Any

from motion import InputError
from webdemo.inference.engine import Engine
from webdemo.server.accounts.accounts import Accounts
from webdemo.server.accounts.quotas import Quotas
from webdemo.server.accounts.visitors import Bindings
from webdemo.server.http.health import Figures, Health
from webdemo.server.live.streams import Streams
from webdemo.server.queue.queue import FairQueue
from webdemo.server.store.database import Database
from webdemo.server.store.notebook import Notebook
from webdemo.server.store.scratch import Scratch
from webdemo.server.store.storage import Storage
from webdemo.server.store.studies import Studies
from webdemo.ui.runs import EngineLike

from .settings import Settings

log = logging.getLogger(__name__)


class Lab:
    """The parts of a running server; ``app.state.lab``.

    Args:
        settings: all of them.
        engine: what generates.
        scratch: uploads and files for download; without it they are not counted.

    Raises:
        InputError: if the database or the data folder cannot be used, or people are to sign in and nobody can.
    """

    def __init__(self, settings: Settings, engine: EngineLike, scratch: Scratch | None = None) -> None:
        self.settings = settings
        self.database = database = Database(settings.database)
        self.accounts = Accounts(database, settings.session_hours)
        if settings.accounts and not settings.proxy_user and self.accounts.empty:
            raise InputError("There are no accounts yet: make one with `python -m webdemo user add NAME`.")
        self.quotas, self.bindings = (quotas := Quotas(settings)), Bindings()
        self.storage = Storage(
            database, settings.motions, quotas.room, scratch=scratch, free_bytes=settings.free_megabytes * 2**20
        )
        self.history = Notebook(self.storage, keep_days=settings.keep_days, publish_days=settings.publish_days)
        self.studies = Studies(self.storage, settings.data / "studies")
        partners: Any = engine if hasattr(engine, "partner") else Engine()  # beside Ray, they run here
        self.streams = Streams(partners, quotas.live)
        self.health = Health(
            engine,
            {"database": database.check, "disk": self.storage.check_disk},
            works={"queue": lambda: self.queue.stuck, "live stream": lambda: self.streams.stuck},
            stuck_seconds=settings.stuck_seconds,
        )
        self.figures = Figures()
        self.queue = FairQueue(
            engine,
            quotas.waiting,
            running=settings.running,
            workers=getattr(engine, "parallel", 1),
            seconds=settings.run_seconds,
            figures=self.figures,
            broken=self.health.broken,
        )
        self.figures.watch("queue_waiting", "Runs that wait", lambda: self.queue.waiting)
        self.figures.watch("queue_running", "Runs that run", lambda: self.queue.running)
        self.figures.watch("live_streams", "Live streams", lambda: self.streams.count)
        self.figures.watch("ready", "1 where a tiny generation works", lambda: self.health.ready)

    @property
    def busy(self) -> bool:
        """True while anything runs on the networks."""
        return bool(self.queue.running or self.streams.count)

    def stop(self) -> None:
        """Accepts no more runs and waits for running ones, at most for the grace period of the settings."""
        self.health.stopping = True
        self.streams.stop()
        left = self.queue.close(self.settings.grace_seconds)
        if left:
            log.warning("%d runs were stopped before their end.", left)


def engine_of(settings: Settings) -> EngineLike:
    """The engine that the settings name.

    Raises:
        InputError: if it is Ray and Ray is not installed.
    """
    if settings.engine == "ray":
        from webdemo.server.cluster.ray_engine import RayEngine

        return RayEngine(address=settings.ray_address, replicas=(1, settings.ray_replicas), cores=settings.ray_cores)
    return Engine()

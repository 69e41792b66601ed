"""The parts of a running server, put together."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

from webdemo.inference.engine import Engine
from webdemo.server.accounts.administration import Administration
from webdemo.server.accounts.people import People
from webdemo.server.accounts.quotas import Quotas
from webdemo.server.accounts.users import SignIns, Users
from webdemo.server.http.guard import OpenAnswers
from webdemo.server.http.health import Figures, Health, check_disk
from webdemo.server.live.streams import Streams
from webdemo.server.queue.queue import FairQueue
from webdemo.server.queue.turns import QueueLimits
from webdemo.server.store.database import Database
from webdemo.server.store.notebook import Notebook
from webdemo.server.store.publishing import Publishing
from webdemo.server.store.scratch import Scratch
from webdemo.server.store.storage import Storage
from webdemo.server.store.studies import Studies
from webdemo.ui.runs import EngineLike

from .settings import Settings

log = logging.getLogger(__name__)

ANSWER_SECONDS = 5.0
"""Least seconds allowed for sending results of finished runs, even with a shorter grace period."""


@dataclass(frozen=True, kw_only=True)
class Lab:
    """The parts of a running server; ``app.state.lab``."""

    settings: Settings
    database: Database
    history: Notebook
    studies: Studies
    publishing: Publishing
    storage: Storage
    queue: FairQueue
    quotas: Quotas
    health: Health
    figures: Figures
    answers: OpenAnswers
    streams: Streams
    people: People
    administration: Administration | None = None
    sign_ins: SignIns | None = None

    @property
    def busy(self) -> bool:
        """True while anything runs on the networks."""
        return bool(self.queue.running or self.streams.count)

    def stop(self) -> None:
        """Accepts no more runs and waits for running ones, at most for the grace period of the settings."""
        until = time.monotonic() + self.settings.grace_seconds
        self.health.stopping = True
        self.streams.stop()
        left = self.queue.close(self.settings.grace_seconds)
        until = max(until, time.monotonic() + ANSWER_SECONDS)
        while self.answers.count and time.monotonic() < until:  # results are still written and sent
            time.sleep(0.05)
        if left:
            log.warning("%d runs were stopped before their end.", left)


def make_lab(settings: Settings, engine: EngineLike, scratch: Scratch | None = None) -> Lab:
    """Puts the parts together.

    Args:
        settings: all of them.
        engine: what generates.
        scratch: uploads and files for download; without it they are not counted.

    Raises:
        InputError: if the accounts, the database or the data folder cannot be used.
    """
    users = Users(settings.users) if settings.users is not None else None
    database = Database(settings.database)
    figures, quotas = Figures(), Quotas.of(settings)
    wants: dict[str, Callable[[], Any]] = {
        "database": database.check,
        "disk": partial(check_disk, settings.data, settings.free_megabytes * 2**20),
    }
    if users is not None:
        _ = users.names  # reports an unreadable file at start
        wants["accounts"] = lambda: users.names
    works: dict[str, Callable[[], float]] = {"queue": lambda: queue.stuck, "live stream": lambda: streams.stuck}
    health = Health(engine, wants, works=works, stuck_seconds=settings.stuck_seconds)
    limits = QueueLimits(running=settings.running, workers=getattr(engine, "parallel", 1), seconds=settings.run_seconds)
    queue = FairQueue(engine, limits, quotas.waiting, figures=figures, broken=health.broken)
    partners: Any = engine if hasattr(engine, "partner") else Engine()  # with an engine elsewhere, they run here
    streams = Streams(partners, quotas.live)
    figures.watch(
        waiting=lambda: queue.waiting,
        running=lambda: queue.running,
        ready=lambda: health.ready,
        live=lambda: streams.count,
    )
    storage = Storage(database, settings.motions, quotas.rooms, scratch=scratch)
    history = Notebook(
        database,
        settings.motions,
        storage=storage,
        keep_days=settings.keep_days,
        link_days=settings.link_days,
        free_bytes=settings.free_megabytes * 2**20,
    )
    return Lab(
        settings=settings,
        database=database,
        history=history,
        queue=queue,
        quotas=quotas,
        publishing=Publishing(history, days=settings.publish_days),
        studies=Studies(database, settings.data / "studies", storage=storage),
        storage=storage,
        health=health,
        figures=figures,
        answers=OpenAnswers(),
        streams=streams,
        people=People(database),
        administration=Administration(database, users, settings) if settings.accounts else None,
        sign_ins=SignIns(database, users, settings.session_hours) if users is not None else None,
    )


def engine_of(settings: Settings) -> EngineLike:
    """The engine that the settings name.

    Raises:
        InputError: if it is Ray and Ray is not installed.
    """
    if settings.engine == "ray":
        from webdemo.server.cluster.ray_engine import RayEngine

        return RayEngine(address=settings.ray_address, replicas=(1, settings.ray_replicas), cores=settings.ray_cores)
    return Engine()

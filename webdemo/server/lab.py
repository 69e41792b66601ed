"""The parts of a running server, put together."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

from webdemo.server.accounts.users import SignIns, Users
from webdemo.server.activity import ENDED, Activity, work_of
from webdemo.server.admin import Administration, versions
from webdemo.server.cluster.instance_lock import InstanceLock
from webdemo.server.http.guard import OpenAnswers
from webdemo.server.http.health import Health, check_disk
from webdemo.server.http.metrics import Figures
from webdemo.server.live.streams import Streams
from webdemo.server.logs import LAST_ERRORS
from webdemo.server.queue.places import Places
from webdemo.server.queue.queue import FairQueue
from webdemo.server.queue.shared_engine import SharedEngine
from webdemo.server.queue.shares import Shares
from webdemo.server.queue.turns import Batcher, QueueLimits
from webdemo.server.store.database import Database
from webdemo.server.store.notebook import Notebook
from webdemo.server.store.people import People
from webdemo.server.store.publishing import Publishing
from webdemo.server.store.scratch import ADDRESS_SHARE, Scratch
from webdemo.server.store.storage import Storage
from webdemo.server.store.studies import Studies
from webdemo.ui.lazy import LazyEngine
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
    places: Places
    shares: Shares
    health: Health
    figures: Figures
    answers: OpenAnswers
    streams: Streams
    people: People
    activity: Activity
    administration: Administration | None = None
    sign_ins: SignIns | None = None
    node: InstanceLock | None = None

    @property
    def name(self) -> str:
        """This process's name."""
        return self.settings.node if self.node is None else self.node.name

    @property
    def busy(self) -> bool:
        """True while anything runs on the networks."""
        return bool(self.queue.running or self.streams.count)

    def share(self) -> None:
        """Exchanges the work done for people with the other processes."""
        self.queue.charge_elsewhere(self.shares.exchange())
        self.people.write()
        self.activity.heed(self.end)
        self.activity.publish(
            self.name,
            work_of(self.name, self.queue, self.streams),
            health=self.health.lately(),
            queue={"waiting": self.queue.waiting, "running": self.queue.running},
            streams=self.streams.count,
            versions=versions(),
            errors=list(LAST_ERRORS.lines),
        )

    def end(self, key: str) -> bool:
        """Ends a run or a live stream of this process; its person is told so. False if it has none of that id."""
        return self.queue.end(key, ENDED) or self.streams.end(key, ENDED)

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
        self.activity.leave(self.name)


def make_lab(
    settings: Settings,
    engine: EngineLike,
    batcher: Batcher | None,
    node: InstanceLock | None,
    scratch: Scratch | None = None,
) -> Lab:
    """Puts the parts together.

    Args:
        settings: all of them.
        engine: what generates.
        batcher: runs several requests of ``engine`` at once.
        node: this process's own name; without it the settings' is taken to be.
        scratch: uploads and files for download; without it they are not counted.

    Raises:
        InputError: if the accounts, the database or the data folder cannot be used.
    """
    name = settings.node if node is None else node.name
    users = Users(settings.users) if settings.users is not None else None
    database = Database(settings.database_url)
    figures = Figures()
    wants: dict[str, Callable[[], Any]] = {
        "database": database.check,
        "disk": partial(check_disk, settings.data, settings.free_megabytes * 2**20),
    }
    if users is not None:
        _ = users.names  # reports an unreadable file at start
        wants["accounts"] = lambda: users.names
    works: dict[str, Callable[[], float]] = {"queue": lambda: queue.stuck, "live stream": lambda: streams.stuck}
    health = Health(engine, wants, works=works, stuck_seconds=settings.stuck_seconds)
    shares, people = Shares(database, name), People(database)
    queue = FairQueue(
        engine,
        _limits(settings, engine),
        batcher=batcher,
        figures=figures,
        broken=health.broken,
        served=shares.add,
        computed=people.add,
    )
    streams = _streams(settings, engine)
    figures.watch(
        waiting=lambda: queue.waiting,
        running=lambda: queue.running,
        ready=lambda: health.ready,
        live=lambda: streams.count,
    )
    storage = storage_of(settings, database, scratch)
    history = history_of(settings, storage, name)
    return Lab(
        settings=settings,
        database=database,
        history=history,
        queue=queue,
        publishing=Publishing(history, days=settings.publish_days),
        studies=studies_of(settings, database, storage),
        storage=storage,
        places=Places(database, name, settings.running + settings.waiting),
        shares=shares,
        health=health,
        figures=figures,
        answers=OpenAnswers(),
        streams=streams,
        node=node,
        people=people,
        activity=Activity(database),
        administration=administration_of(settings, database, users) if settings.accounts else None,
        sign_ins=SignIns(database, users, settings.session_hours) if users is not None else None,
    )


def administration_of(settings: Settings, database: Database, users: Users | None) -> Administration:
    """The acts of administrators of a lab."""
    elsewhere = bool(settings.proxy_user)
    return Administration(database, users, settings.data, settings.person_bytes, elsewhere=elsewhere)


def storage_of(settings: Settings, database: Database, scratch: Scratch | None = None) -> Storage:
    """The room that people have in a lab."""
    total = settings.keep_megabytes * 2**20
    address = min(settings.address_people * settings.person_bytes, ADDRESS_SHARE * total)
    return Storage(
        database,
        settings.motions,
        person_bytes=settings.person_bytes,
        total_bytes=total,
        address_bytes=address,
        scratch=scratch,
        bytes_of=People(database).bytes_of,
    )


def history_of(settings: Settings, storage: Storage, name: str) -> Notebook:
    """The history of a lab, for the process of a name."""
    return Notebook(
        storage.database,
        settings.motions,
        node=name,
        storage=storage,
        keep_days=settings.keep_days,
        keep_favourites=settings.keep_favourites,
        link_days=settings.link_days,
        free_bytes=settings.free_megabytes * 2**20,
    )


def _streams(settings: Settings, engine: EngineLike) -> Streams:
    """The live streams; with an engine elsewhere, their networks run in this process."""
    partners: Any = engine if hasattr(engine, "partner") else LazyEngine()
    return Streams(partners, most=settings.live, address=max(1, settings.live // 2))


def studies_of(settings: Settings, database: Database, storage: Storage | None = None) -> Studies:
    """The blind studies of a lab."""
    return Studies(database, settings.data / "studies", storage=storage or storage_of(settings, database))


def _limits(settings: Settings, engine: EngineLike) -> QueueLimits:
    return QueueLimits(
        running=settings.running,
        waiting=settings.waiting,
        queue=settings.queue,
        batch=settings.batch,
        address=settings.waiting * settings.address_people,
        workers=getattr(engine, "parallel", 1),
        seconds=settings.run_seconds,
    )


def engine_of(settings: Settings) -> tuple[EngineLike, Batcher | None]:
    """The engine that the settings name, and what shares its passes where that is done in this process.

    Raises:
        InputError: if it is Ray and Ray is not installed.
    """
    if settings.engine == "ray":
        from webdemo.server.cluster.ray_engine import RayEngine

        return RayEngine(
            address=settings.ray_address,
            replicas=(1, settings.ray_replicas),
            cores=settings.ray_cores,
            batch=settings.batch,
        ), None
    shared = SharedEngine()
    return shared, shared

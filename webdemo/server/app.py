"""The page and everything around it as one ASGI application."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import time
from collections.abc import AsyncIterator, Callable
from dataclasses import dataclass
from typing import Any

import gradio as gr
from fastapi import FastAPI, Request
from starlette.concurrency import run_in_threadpool
from starlette.responses import JSONResponse, PlainTextResponse, Response

from webdemo.ui.page import build_page, launch_options
from webdemo.ui.runs import EngineLike, Loader

from .accounts import SignIns, Users
from .database import Database
from .engine import SharedEngine
from .figures import Figures
from .guard import Guard, OpenAnswers, may_read_figures
from .health import Health
from .history import History
from .login import login_routes
from .memory import give_back
from .nodes import Node
from .pages import PageCache
from .places import SEEN_EVERY, Places
from .queue import FairQueue
from .recorder import Recorder
from .scratch import Scratch
from .sessions import keep_states_lean, kept_in_cache
from .settings import Settings
from .shares import SHARE_EVERY, Shares
from .turns import Batcher, QueueLimits
from .visitors import Visitors

log = logging.getLogger(__name__)

CLEAN_EVERY = 900.0
"""Seconds between two looks at what is too old or too much."""
TIDY_EVERY = 60.0
"""Seconds between two looks at the files that are there for a while."""
GIVE_BACK_EVERY = 5.0
"""Seconds between two returns of memory that runs have left."""
ANSWER_SECONDS = 5.0
"""How long the answers of runs that ended may take to be sent at least, however short the grace."""
PAGES = 256
"""Pages and programs whose last results are kept; Gradio's own 10,000 would be gigabytes."""
WARM_UP_AFTER = 2.0
"""Seconds between the start and the loading of the networks, which would slow the first page."""


@dataclass(frozen=True, kw_only=True)
class Lab:
    """The parts of a running server; ``app.state.lab``."""

    settings: Settings
    database: Database
    history: History
    queue: FairQueue
    places: Places
    shares: Shares
    health: Health
    figures: Figures
    answers: OpenAnswers
    node: Node | None = None
    tidy: Callable[[], Any] = lambda: None

    def share(self) -> None:
        """Tells the other processes what people had here, and counts what they had there."""
        self.queue.charge_elsewhere(self.shares.exchange())

    def stop(self) -> None:
        """Takes no more runs and lets those that run end, up to the grace that the settings give; blocks."""
        until = time.monotonic() + self.settings.grace_seconds
        self.health.stopping = True
        left = self.queue.close(self.settings.grace_seconds)
        until = max(until, time.monotonic() + ANSWER_SECONDS)
        while self.answers.count and time.monotonic() < until:  # results are still written and sent
            time.sleep(0.05)
        if left:
            log.warning("%d runs were stopped before their end.", left)


def create_app(
    settings: Settings,
    *,
    engine: EngineLike | None = None,
    batcher: Batcher | None = None,
    node: Node | None = None,
    scratch: Scratch | None = None,
) -> FastAPI:
    """Builds the application.

    Args:
        settings: all of them.
        engine: what generates; by default the shipped networks, which also share passes.
        batcher: runs several requests of ``engine`` at once.
        node: this process's own name; without it the settings' is taken to be.
        scratch: for files that are made for download; in the system's temporary folder by default.

    Raises:
        InputError: where the settings would leave the server open unsaid, or what they name cannot be used.
    """
    settings.check()
    name = settings.node if node is None else node.name
    if engine is None:
        engine, batcher = engine_of(settings)
    users = Users(settings.users) if settings.users is not None else None
    if users is not None:
        _ = users.names  # a file that cannot be read is told now
    database = Database(settings.database_url)
    history = History(
        database, settings.motions, node=name, keep_days=settings.keep_days,
        keep_bytes=settings.keep_megabytes * 2**20, keep_favourites=settings.keep_favourites,
        link_days=settings.link_days, free_bytes=settings.free_megabytes * 2**20,
    )  # fmt: skip
    figures = Figures()
    health = Health(engine, {"database": database.check})
    limits = QueueLimits(
        running=settings.running, waiting=settings.waiting, queue=settings.queue, batch=settings.batch,
        address=settings.waiting * settings.address_people,
        workers=getattr(engine, "parallel", 1),
    )  # fmt: skip
    shares = Shares(database, name)
    queue = FairQueue(
        engine, limits, batcher=batcher, figures=figures, broken=health.broken, served=shares.add
    )  # fmt: skip
    figures.watch(waiting=lambda: queue.waiting, running=lambda: queue.running, ready=lambda: health.ready)
    places = Places(database, name, settings.running + settings.waiting)
    page = build_page(
        engine, loader=Loader(engine), runs=Recorder(queue, history, places), history=history,
        files=scratch.files if scratch is not None else None,
    )  # fmt: skip
    lab = Lab(
        settings=settings, database=database, history=history, queue=queue, places=places, shares=shares,
        health=health, figures=figures, answers=OpenAnswers(), node=node,
        tidy=lambda: scratch.clean(kept_in_cache(page)) if scratch is not None else None,
    )  # fmt: skip
    sign_ins = SignIns(database, users, settings.session_hours) if users is not None else None
    visitors = Visitors(settings, sign_ins)

    app = FastAPI(title="Pas de Deux", docs_url=None, redoc_url=None, openapi_url=None, lifespan=_lifespan)
    app.state.lab = lab
    _add_routes(app, lab)
    if sign_ins is not None:
        app.include_router(login_routes(settings, sign_ins, visitors))
    app.add_middleware(PageCache)
    app.add_middleware(
        Guard, settings=settings, visitors=visitors, figures=figures, answers=lab.answers,
        endpoints={str(fn.api_name) for fn in page.fns.values() if fn.api_visibility == "public"},
        functions=frozenset(page.fns),
    )  # fmt: skip
    page.state_session_capacity = PAGES
    page.max_threads = settings.queue + 64  # whoever waits in line holds a thread
    page.queue(default_concurrency_limit=4, max_size=2 * settings.queue + 64)
    options: dict[str, Any] = {
        "allowed_paths": [],
        "server_name": settings.host,
        "server_port": settings.port,
    }
    app = gr.mount_gradio_app(app, page, path="/", root_path=settings.root_path or None,
                              **options, **launch_options())  # fmt: skip
    keep_states_lean(app, page)
    return app


def engine_of(settings: Settings) -> tuple[EngineLike, Batcher | None]:
    """The engine that the settings name, and what shares its passes where that is done in this process.

    Raises:
        InputError: where it is Ray and Ray is not installed.
    """
    if settings.engine == "ray":
        from .ray_engine import RayEngine

        return RayEngine(
            address=settings.ray_address, replicas=(1, settings.ray_replicas), cores=settings.ray_cores,
            batch=settings.batch,
        ), None  # fmt: skip
    shared = SharedEngine()
    return shared, shared


def _add_routes(app: FastAPI, lab: Lab) -> None:
    @app.get("/healthz")
    def healthz() -> Response:
        whole, report = lab.health.report()
        return JSONResponse(report, status_code=200 if whole else 503, headers={"Cache-Control": "no-store"})

    @app.get("/metrics")
    def metrics(request: Request) -> Response:
        address = request.client.host if request.client else ""
        if not may_read_figures(lab.settings, address, request.headers.get("authorization", "")):
            return JSONResponse({"detail": "The figures are not for everybody."}, status_code=403)
        return PlainTextResponse(lab.figures.text(), media_type="text/plain; version=0.0.4; charset=utf-8")


@contextlib.asynccontextmanager
async def _lifespan(app: FastAPI) -> AsyncIterator[None]:
    lab: Lab = app.state.lab
    lost = await run_in_threadpool(lab.history.recover, lab.node.dead if lab.node else None)
    await run_in_threadpool(lab.places.clear)
    if lost:
        log.warning("%d runs of the last time were interrupted.", lost)
    tasks = [
        asyncio.create_task(_later(WARM_UP_AFTER, lab.health.probe)),
        asyncio.create_task(_every(CLEAN_EVERY, lab.history.clean)),
        asyncio.create_task(_every(TIDY_EVERY, lab.tidy)),
        asyncio.create_task(_every(GIVE_BACK_EVERY, give_back)),
        asyncio.create_task(_every(SEEN_EVERY, lab.places.refresh)),
        asyncio.create_task(_every(SHARE_EVERY, lab.share)),
    ]
    try:
        yield
    finally:
        for task in tasks:
            task.cancel()
        await run_in_threadpool(lab.stop)
        if close := getattr(lab.queue.engine, "close", None):
            await run_in_threadpool(close)
        lab.database.close()
        if lab.node is not None:
            lab.node.close()


async def _later(seconds: float, job: Callable[[], Any]) -> None:
    await asyncio.sleep(seconds)
    await run_in_threadpool(job)


async def _every(seconds: float, job: Callable[[], Any]) -> None:
    while True:
        try:
            await run_in_threadpool(job)
        except Exception:
            log.exception("What is done regularly failed.")
        await asyncio.sleep(seconds)

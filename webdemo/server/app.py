"""Builds the ASGI application: the page and its middleware."""

from __future__ import annotations

import asyncio
import contextlib
import gc
import logging
import math
from collections.abc import AsyncIterator, Callable
from functools import partial
from pathlib import Path
from typing import Any

import gradio as gr
import gradio.route_utils
import gradio.utils
from fastapi import FastAPI, Request
from gradio.routes import App
from gradio.utils import get_upload_folder
from starlette.concurrency import run_in_threadpool
from starlette.middleware.cors import CORSMiddleware
from starlette.responses import JSONResponse, PlainTextResponse, Response
from starlette.routing import Mount

from acts import read
from motion import InputError
from webdemo.server.accounts.administration import Administration
from webdemo.server.accounts.login import login_routes
from webdemo.server.http.admin_pages import admin_routes
from webdemo.server.http.guard import Guard, may_read_figures
from webdemo.server.http.page_html import LeanStates, PageCache
from webdemo.server.http.payloads import Payloads
from webdemo.server.http.public_pages import public_routes, study_routes
from webdemo.server.lab import Lab, engine_of
from webdemo.server.live.streams import live_routes
from webdemo.server.queue.events import FairEvents, close_in_a_thread
from webdemo.server.queue.recorder import Recorder
from webdemo.server.store.scratch import Scratch, keep_files_apart, mend_uploads, visitors_folder
from webdemo.ui.components.exports import Shelf
from webdemo.ui.context import PageContext
from webdemo.ui.page import build_page, launch_options, start_queue
from webdemo.ui.runs import EngineLike
from webdemo.ui.visitor import visitor

from .process import give_back, watch
from .settings import Settings

log = logging.getLogger(__name__)

TIDY_EVERY = 60.0
"""Seconds between two cleanings of temporary files."""
PAGES = 256
"""Most sessions whose state is kept; Gradio's default of 10,000 would take gigabytes."""
MOST_FILES = 16
"""Files in one upload."""
WARM_UP_AFTER = 0.5
"""Seconds between the start and the loading of the networks, to answer a waiting browser first."""


def create_app(settings: Settings, *, engine: EngineLike | None = None, scratch: Scratch | None = None) -> FastAPI:
    """Builds the application.

    Args:
        settings: all of them.
        engine: what generates; by default the shipped networks.
        scratch: for uploads and files that are made for download; Gradio's own folder by default.

    Raises:
        InputError: if the settings would leave the server open unsaid, or what they name cannot be used.
    """
    settings.check()
    if engine is None:
        engine = engine_of(settings)
    lab = Lab(settings, engine, scratch)
    shelf = Shelf(
        Path(get_upload_folder()), owner=visitors_folder, admit=lambda size: lab.storage.admit(visitor(), size)
    )
    page = build_page(
        PageContext(
            engine=engine,
            health=lab.health,
            runs=Recorder(lab.queue, lab.history),
            shelf=shelf,
            history=lab.history,
            studies=lab.studies,
        )
    )
    app = FastAPI(title="Pas de Deux", docs_url=None, redoc_url=None, openapi_url=None, lifespan=_lifespan)
    app.state.lab = lab
    app.state.tidy = lambda: lab.storage.tidy(
        {str(file) for block in page.blocks.values() for file in getattr(block, "keep_in_cache", ())}
    )
    _add_routes(app, lab)
    app.include_router(live_routes(lab.streams))
    app.include_router(study_routes(settings, lab.studies))
    app.include_router(public_routes(settings, lab.history))
    if settings.accounts:
        app.include_router(login_routes(settings, lab.accounts))
    if settings.sign_in:
        app.include_router(admin_routes(settings.root_path, Administration(lab.database, settings.data), lab.accounts))
    app.add_middleware(CORSMiddleware)  # no other site may read anything; Gradio's own would let some
    app.add_middleware(PageCache)
    app.add_middleware(Guard, lab=lab, payloads=Payloads(page))
    _mount(app, page, lab)
    return app


def _mount(app: FastAPI, page: gr.Blocks, lab: Lab) -> None:
    """Mounts the page in the application and closes what Gradio leaves open when mounted."""
    settings = lab.settings
    page.state_session_capacity = PAGES
    page.max_threads = int(lab.quotas.events.everybody)  # each that waits for a run or a file holds a thread
    start_queue(page, partial(FairEvents, quota=lab.quotas.events, figures=lab.figures, bindings=lab.bindings))
    lab.health.works["queue of events"] = lambda: math.inf if page._queue.stopped and not lab.health.stopping else 0.0
    options = launch_options() | {"allowed_paths": [], "server_name": settings.host, "server_port": settings.port}
    gr.mount_gradio_app(app, page, path="/", root_path=settings.root_path or None, **options)
    page.has_launched = True  # a mounted page's is never set, and without it Gradio hands any file out
    (mounted,) = [r.app for r in app.routes if isinstance(r, Mount) and isinstance(r.app, App)]
    mounted.state_holder = LeanStates(lab.bindings)
    mounted.state_holder.set_blocks(page)
    keep_files_apart(mounted)
    mend_uploads()
    gradio.utils.SyncToAsyncIterator.aclose = close_in_a_thread  # type: ignore[method-assign]
    parser: Any = gradio.route_utils.GradioMultiPartParser
    gradio.route_utils.GradioMultiPartParser = lambda *given, **options: parser(  # type: ignore[misc,assignment]
        *given, **options | {"max_files": MOST_FILES}
    )
    # Its import of pyplot would hold up the event loop at the first event; nothing here draws by that.
    gradio.utils.MatplotlibBackendMananger = contextlib.nullcontext  # type: ignore[assignment,misc]


def _add_routes(app: FastAPI, lab: Lab) -> None:
    @app.get("/healthz")
    async def healthz() -> Response:
        whole, report = lab.health.report()
        return JSONResponse(report, status_code=200 if whole else 503, headers={"Cache-Control": "no-store"})

    @app.get("/metrics")
    def metrics(request: Request) -> Response:
        address = request.client.host if request.client else ""
        if not may_read_figures(lab.settings, address, request.headers.get("authorization", "")):
            return JSONResponse({"detail": "These figures are not public."}, status_code=403)
        return PlainTextResponse(lab.figures.text(), media_type="text/plain; version=0.0.4; charset=utf-8")


@contextlib.asynccontextmanager
async def _lifespan(app: FastAPI) -> AsyncIterator[None]:
    lab: Lab = app.state.lab
    gc.freeze()  # modules stay: a search for garbage among them holds every thread up
    gc.enable()
    lost = await run_in_threadpool(lab.history.recover)
    if lost:
        log.warning("%d runs were interrupted when the server last stopped.", lost)
    await run_in_threadpool(lab.studies.recover)
    tasks = [
        asyncio.create_task(_later(WARM_UP_AFTER, lab.health.keep_looking)),
        asyncio.create_task(_later(2 * WARM_UP_AFTER, _read_first)),
        asyncio.create_task(_every(900.0, lab.history.clean)),
        asyncio.create_task(_every(TIDY_EVERY, app.state.tidy)),
        asyncio.create_task(_every(5.0, lambda: give_back(resting=not lab.busy))),
        asyncio.create_task(_every(5.0, lab.streams.sweep)),
    ]
    if lab.settings.exit_when_stuck:
        tasks.append(asyncio.create_task(watch(lab.health.stuck)))
    try:
        yield
    finally:
        for task in tasks:
            task.cancel()
        await run_in_threadpool(lab.stop)
        if close := getattr(lab.queue.engine, "close", None):
            await run_in_threadpool(close)
        lab.database.close()


def _read_first() -> None:
    """Loads the parser, so that the first sentence that somebody types is read as fast as later ones."""
    try:
        read("They wave.")
        gc.freeze()  # the parser stays
    except InputError as error:  # the page says so under what is typed
        log.warning("Sentences cannot be read: %s", error)


async def _later(seconds: float, job: Callable[[], Any]) -> None:
    await asyncio.sleep(seconds)
    await run_in_threadpool(job)


async def _every(seconds: float, job: Callable[[], Any]) -> None:
    while True:
        try:
            await run_in_threadpool(job)
        except Exception:
            log.exception("A regular task failed.")
        await asyncio.sleep(seconds)

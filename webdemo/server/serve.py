"""One process that serves the application, and ends well."""

from __future__ import annotations

import logging
import resource
import socket
import sys
from typing import Any

import uvicorn
from starlette.concurrency import run_in_threadpool
from uvicorn.middleware.proxy_headers import ProxyHeadersMiddleware

from motion import InputError
from webdemo.server.http.connections import bounded_protocol
from webdemo.server.store.folders import hold, make_folder
from webdemo.server.store.scratch import Scratch

from .app import Lab, create_app
from .logs import set_up_logs
from .process import share_heaps, tell_systemd
from .settings import Settings

log = logging.getLogger(__name__)

SWITCH_SECONDS = 0.001
"""Interpreter switch interval (CPython's default is 0.005): keeps the page responsive while a thread computes."""
FILES = 512
"""Open files beside the connections: the database, motions, libraries."""
OTHER = "Another process serves the lab in {}: stop it, or choose another folder with PASDEDEUX_DATA."
CLOSING_SECONDS = 5
"""Seconds allowed for open connections once all runs have ended: results are still written and sent."""


class Server(uvicorn.Server):
    """A uvicorn that waits for the runs before it closes the connections which carry them, and tells systemd."""

    def __init__(self, config: uvicorn.Config, lab: Lab) -> None:
        super().__init__(config)
        self.lab = lab

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Begins to serve."""
        await super().startup(sockets)
        if self.started:
            tell_systemd("READY=1")

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        """Lets running work end, then stops the server."""
        tell_systemd("STOPPING=1")
        if not self.force_exit:
            await run_in_threadpool(self.lab.stop)
        await super().shutdown(sockets)


def make_server(settings: Settings, *, scratch: bool = False, **parts: Any) -> Server:
    """The server for the settings; ``parts`` go to :func:`create_app`.

    With ``scratch`` all files of this process, Gradio's as well, lie in the data folder.
    """
    alone = hold(make_folder(settings.data) / "serving.lock", OTHER.format(settings.data))
    if scratch:
        parts["scratch"] = Scratch(settings.data / "scratch", settings.scratch_megabytes * 2**20)
        parts["scratch"].take_uploads()
    app = create_app(settings, **parts)
    app.state.alone = alone  # the lock is released with it
    forwarded: Any = ProxyHeadersMiddleware
    config = uvicorn.Config(
        forwarded(app, trusted_hosts=settings.proxies),
        host=settings.host,
        port=settings.port,
        http=bounded_protocol(settings, app.state.lab.quotas.connections),
        ws="none",
        proxy_headers=False,
        access_log=False,
        log_config=None,
        server_header=False,
        timeout_graceful_shutdown=CLOSING_SECONDS,
        timeout_keep_alive=30,
        loop="asyncio",
        backlog=512,
    )
    return Server(config, app.state.lab)


def serve(settings: Settings) -> None:
    """Serves until SIGTERM or Ctrl+C.

    Raises:
        InputError: if the settings do not fit or the address is taken.
    """
    settings.check()
    with socket.socket(socket.AF_INET6 if ":" in settings.host else socket.AF_INET) as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((settings.host, settings.port))
        except OSError as error:
            raise InputError(
                f"The page cannot be served on {settings.host}:{settings.port} ({error.strerror or error}): "
                "set PASDEDEUX_PORT to a free port."
            ) from None
    set_up_logs(settings.log_level, content=settings.log_content)
    settings = with_room_for_files(settings)
    sys.setswitchinterval(SWITCH_SECONDS)
    share_heaps()
    server = make_server(settings, scratch=True)
    print(f"Pas de Deux is on {settings.url}", flush=True)
    server.run()


def with_room_for_files(settings: Settings) -> Settings:
    """The settings with no more connections than the system lets this process have beside its files.

    A process that may open nothing more can neither take a connection nor read its history.
    """
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    wanted = settings.connections + FILES
    if soft != resource.RLIM_INFINITY and soft < wanted:
        soft = wanted if hard == resource.RLIM_INFINITY else min(wanted, hard)
        resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))
    if soft == resource.RLIM_INFINITY or soft >= wanted:
        return settings
    room = max(soft - FILES, soft // 2)
    log.warning("The system allows %d open files: %d connections are taken.", soft, room)
    return settings.model_copy(update={"connections": room})

"""Public pages over HTTP: ``/share/KEY``, ``/embed/KEY`` and the files that they load, for anybody.

Nothing here looks at who asks, and nothing is changed.
"""

from __future__ import annotations

from urllib.parse import quote

from fastapi import APIRouter, Request
from starlette.responses import FileResponse, HTMLResponse, Response

from webdemo.server.settings import Settings
from webdemo.server.store.sharing import Sharing
from webdemo.ui.components.prediction_view import payload_of
from webdemo.ui.history import Entry
from webdemo.ui.public_html import FILES, Place, embed_html, player_html
from webdemo.ui.visitor import visitor_of
from webdemo.view.payload import Payload

from .routes import NOTHING, Refused

_FILE_HEADERS = {"Cache-Control": "public, max-age=600", "Access-Control-Allow-Origin": "*"}
"""A frame with a sandbox has no origin of its own, and the files are the same for everybody."""


def public_routes(settings: Settings, history: Sharing) -> APIRouter:
    """The routes of public pages."""
    router = APIRouter()
    files = f"{settings.root_path}/shown/"

    def read(key: str) -> tuple[Entry, Payload, float]:
        """The run that a page shows, its motion, and when the page ends."""
        opened, until = history.open_page(key)
        return opened.entry, payload_of(opened.result), until

    @router.get("/share/{key}")
    def share(key: str, request: Request) -> Response:
        entry, payload, until = read(key)
        place = Place(files=files, embed=f"{visitor_of(request).base}embed/{quote(key)}")
        return _sent(player_html(entry, payload, place, until=until))

    @router.get("/embed/{key}")
    def embed(key: str) -> Response:
        entry, payload, _ = read(key)
        return _sent(embed_html(entry, payload, Place(files=files)))

    @router.get("/shown/{name:path}")
    def file(name: str) -> Response:
        if name not in FILES:
            raise Refused(404, NOTHING, "not found")
        return FileResponse(FILES[name], headers=_FILE_HEADERS)

    return router


def _sent(page: str) -> Response:
    return HTMLResponse(page, headers={"Cache-Control": "no-store", "X-Robots-Tag": "noindex"})

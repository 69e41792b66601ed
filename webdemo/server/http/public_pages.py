"""Public pages over HTTP: ``/share/KEY``, ``/embed/KEY`` and the files that they load, for anybody.

Nothing here looks at who asks, and nothing is changed.
"""

from __future__ import annotations

from urllib.parse import quote

from fastapi import APIRouter, Request
from starlette.responses import FileResponse, HTMLResponse, Response

from motion import InputError
from webdemo.server.settings import Settings
from webdemo.server.store.publishing import Publishing, Shown
from webdemo.ui.public_html import FILES, Place, embed_html, payload_of, player_html
from webdemo.ui.visitor import visitor_of
from webdemo.view.payload import Payload

from .routes import Refused

_FILE_HEADERS = {"Cache-Control": "public, max-age=600", "Access-Control-Allow-Origin": "*"}
"""A frame with a sandbox has no origin of its own, and the files are the same for everybody."""
_NOTHING = "There is nothing here."


def public_routes(settings: Settings, publishing: Publishing) -> APIRouter:
    """The routes of public pages."""
    router = APIRouter()
    pages = _Pages(settings.root_path, publishing)

    @router.get("/share/{key}")
    def share(key: str, request: Request) -> Response:
        return pages.whole(key, visitor_of(request).base)

    @router.get("/embed/{key}")
    def embed(key: str) -> Response:
        return pages.player(key)

    @router.get("/shown/{name:path}")
    def file(name: str) -> Response:
        if name not in FILES:
            raise Refused(404, _NOTHING, "not found")
        return FileResponse(FILES[name], headers=_FILE_HEADERS)

    return router


class _Pages:
    """Makes the pages.

    Args:
        root: path under which the lab is.
        publishing: keeps what they show.
    """

    def __init__(self, root: str, publishing: Publishing) -> None:
        self.root, self.publishing = root, publishing

    def whole(self, key: str, base: str) -> Response:
        """The page of a result."""
        shown, payload = self._read(key)
        place = Place(files=f"{self.root}/shown/", embed=f"{base}embed/{quote(key)}")
        return _sent(player_html(shown.entry, payload, place, until=shown.until))

    def player(self, key: str) -> Response:
        """The player alone."""
        shown, payload = self._read(key)
        return _sent(embed_html(shown.entry, payload, Place(files=f"{self.root}/shown/")))

    def _read(self, key: str) -> tuple[Shown, Payload]:
        """The state that a page shows, and its motion; raises Refused where it shows nothing."""
        try:
            return self.publishing.shown(key), payload_of(self.publishing.open(key))
        except InputError as error:
            raise Refused(404, str(error), "public") from None


def _sent(page: str) -> Response:
    return HTMLResponse(page, headers={"Cache-Control": "no-store", "X-Robots-Tag": "noindex"})

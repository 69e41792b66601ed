"""Public pages over HTTP: ``/share/KEY``, ``/embed/KEY`` and the files that they load, for anybody.

Nothing here looks at who asks, and nothing is changed.
"""

from __future__ import annotations

import threading
from collections import OrderedDict
from urllib.parse import quote

from fastapi import APIRouter, Request
from starlette.responses import FileResponse, HTMLResponse, Response

from motion import InputError
from webdemo.server.settings import Settings
from webdemo.server.store.publishing import Publishing
from webdemo.ui.public_html import FILES, Place, embed_html, gallery_html, payload_of, player_html
from webdemo.ui.visitor import visitor_of
from webdemo.view.payload import Payload

from .refused import Refused

KEPT = 32
"""Motions that are kept as the player takes them, the last ones asked for."""
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

    @router.get("/share/{key}/{place}")
    def share_one(key: str, place: str, request: Request) -> Response:
        return pages.one(key, _number(place), visitor_of(request).base)

    @router.get("/embed/{key}")
    def embed(key: str) -> Response:
        return pages.player(key, None)

    @router.get("/embed/{key}/{place}")
    def embed_one(key: str, place: str) -> Response:
        return pages.player(key, _number(place))

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
        self._payloads: OrderedDict[str, Payload] = OrderedDict()
        self._lock = threading.Lock()

    def whole(self, key: str, base: str) -> Response:
        """A gallery, or the only result."""
        try:
            shown = self.publishing.shown(key)
        except InputError as error:
            raise _gone(error) from None
        if len(shown.entries) == 1:
            return self.one(key, next(iter(shown.entries)), base)
        addresses = {number: self._path("share", key, number) for number in shown.entries}
        return _sent(gallery_html(shown.title, shown.entries, addresses, self._place(), until=shown.until))

    def one(self, key: str, number: int, base: str) -> Response:
        """The page of one result."""
        try:
            shown = self.publishing.shown(key)
            payload = self._payload(key, number)
        except InputError as error:
            raise _gone(error) from None
        several = len(shown.entries) > 1
        place = Place(
            files=self._place().files, back=self._path("share", key) if several else "",
            embed=f"{base}embed/{quote(key)}{f'/{number}' if several else ''}",
        )  # fmt: skip
        return _sent(player_html(shown.entries[number], payload, place, until=shown.until))

    def player(self, key: str, number: int | None) -> Response:
        """The player alone, of a result or of the first one."""
        try:
            shown = self.publishing.shown(key)
            number = next(iter(shown.entries)) if number is None else number
            payload = self._payload(key, number)
        except InputError as error:
            raise _gone(error) from None
        return _sent(embed_html(shown.entries[number], payload, self._place()))

    def _payload(self, key: str, number: int) -> Payload:
        """The motion of a result; raises InputError where the page does not show it, kept or not."""
        run = self.publishing.run_of(key, number)
        with self._lock:
            if run in self._payloads:
                self._payloads.move_to_end(run)
                return self._payloads[run]
        payload = payload_of(self.publishing.open(key, number))
        with self._lock:
            self._payloads[run] = payload
            while len(self._payloads) > KEPT:
                self._payloads.popitem(last=False)
        return payload

    def _path(self, kind: str, key: str, number: int | None = None) -> str:
        return f"{self.root}/{kind}/{quote(key)}{'' if number is None else f'/{number}'}"

    def _place(self) -> Place:
        return Place(files=f"{self.root}/shown/")


def _number(place: str) -> int:
    """A place on a page; 0, where nothing is, for anything but a short number."""
    return int(place) if place.isascii() and place.isdigit() and len(place) < 6 else 0


def _gone(error: InputError) -> Refused:
    return Refused(404, str(error), "public")


def _sent(page: str) -> Response:
    return HTMLResponse(page, headers={"Cache-Control": "no-store", "X-Robots-Tag": "noindex"})

"""Pages for those who know a key: public pages, with the files that they load, and blind studies, with their votes.

Public pages change nothing and do not look at who asks. A voter sees the question and pairs of motions without names:
neither prompts' settings nor methods leave the server.
"""

from __future__ import annotations

from urllib.parse import quote

from fastapi import APIRouter, Request
from starlette.responses import FileResponse, HTMLResponse, JSONResponse, Response

from webdemo.server.settings import Settings
from webdemo.server.store.history import History
from webdemo.server.store.studies import Studies
from webdemo.study import Pair
from webdemo.ui.components.prediction_view import payload_of
from webdemo.ui.history import Entry
from webdemo.ui.public_html import FILES, Place, embed_html, player_html, study_html
from webdemo.ui.visitor import visitor_of
from webdemo.view.payload import Payload, build_payload, grid_sample, sample_payload

from .error_pages import never_kept
from .routes import NOTHING, Refused

_FILE_HEADERS = {"Cache-Control": "public, max-age=600", "Access-Control-Allow-Origin": "*"}
"""A frame with a sandbox has no origin of its own, and the files are the same for everybody."""
_NO_COOKIE = "Allow this page to keep a cookie, so that each of your votes counts once: then reload it."
_BY_SCRIPT = "Votes are cast on the study's own page: open its link in a browser."


def public_routes(settings: Settings, history: History) -> APIRouter:
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


def study_routes(settings: Settings, studies: Studies) -> APIRouter:
    """``/study/KEY`` (the page), and POST to ``/study/KEY/next`` and ``…/vote/PAIR/ANSWER`` for its script."""
    router = APIRouter()
    root = settings.root_path

    @router.get("/study/{key}")
    def page(key: str) -> Response:
        here = f"{root}/study/{quote(key, safe='')}"
        return never_kept(study_html(studies.question(key), here, Place(files=f"{root}/shown/")))

    @router.post("/study/{key}/next")
    def following(key: str, request: Request) -> Response:
        return _following(studies, key, _voter(request))

    @router.post("/study/{key}/vote/{number}/{pressed}")
    def vote(key: str, number: int, pressed: str, request: Request) -> Response:
        return _following(studies, key, _voter(request), (number, pressed))

    return router


def _voter(request: Request) -> str:
    """The person who votes; raises Refused for one who cannot be told from others, or a program."""
    if not request.headers.get("origin"):  # the guard has compared it with the host
        raise Refused(403, _BY_SCRIPT, "study")
    visitor = visitor_of(request)
    if not visitor.account and not visitor.person.startswith("visitor "):
        raise Refused(403, _NO_COOKIE, "study")
    return visitor.person


def _following(studies: Studies, key: str, person: str, vote: tuple[int, str] | None = None) -> Response:
    """Takes a vote, if there is one; answers with the next pair and how far the person is."""
    if vote is not None:
        studies.vote(key, person, *vote)
    done, total, number, pair = studies.following(key, person)
    answer = {"done": done, "total": total, "number": number, "pair": pair and pair_payload(pair)}
    return JSONResponse(answer, headers={"Cache-Control": "no-store"})


def pair_payload(pair: Pair) -> Payload:
    """A pair for the player: two cells under one camera, named 1 and 2, without curves or marks."""
    cells = [
        {**sample_payload(motion, curves=(), contacts=()), "caption": str(place)}
        for place, motion in enumerate((pair.first, pair.second), start=1)
    ]
    sample = grid_sample(cells, ["1", "2"], [""])
    return build_payload([sample], skeleton=pair.first.skeleton, title=pair.caption)

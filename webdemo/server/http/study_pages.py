"""The page on which people vote in a blind study, and what its script asks for.

A voter sees the question and pairs of motions without names: neither prompts' settings nor methods leave the server.
"""

from __future__ import annotations

import html
import json
from typing import Any
from urllib.parse import quote

import gradio as gr
from fastapi import APIRouter, Request
from starlette.concurrency import run_in_threadpool
from starlette.responses import JSONResponse, Response

from motion import InputError
from webdemo.server.http.error_pages import never_kept
from webdemo.server.settings import Settings
from webdemo.server.store.studies import Studies
from webdemo.server.store.voting import Shown
from webdemo.study import StudyResult
from webdemo.ui.components.player import PLAYER_FOLDER, PLOTLY_JS
from webdemo.ui.visitor import visitor_of
from webdemo.view.payload import Payload, build_payload, grid_sample, sample_payload

from .refused import Refused

STUDY_FOLDER = PLAYER_FOLDER.parent / "study"
LONGEST_VOTE = 1000
"""Bytes of a vote."""
_NO_COOKIE = "Allow this page to keep a cookie, so that each of your votes counts once: then reload it."
_BY_SCRIPT = "Votes are cast on the study's own page: open its link in a browser."

gr.set_static_paths([STUDY_FOLDER])


def study_routes(settings: Settings, studies: Studies) -> APIRouter:
    """``/study/KEY`` (the page), and POST to ``/study/KEY/next`` and ``/study/KEY/vote`` for its script."""
    router = APIRouter()
    root = settings.root_path

    @router.get("/study/{key}")
    def page(key: str, request: Request) -> Response:
        try:
            invitation = studies.invitation(key, visitor_of(request).person)
        except InputError as error:
            raise Refused(404, str(error), "study") from None
        return never_kept(_page(root, key, invitation.question))

    @router.post("/study/{key}/next")
    def following(key: str, request: Request) -> Response:
        try:
            return _answered(_following(studies, key, _voter(request), visitor_of(request).address))
        except InputError as error:
            raise Refused(422, str(error), "study") from None

    @router.post("/study/{key}/vote")
    async def vote(key: str, request: Request) -> Response:
        person = _voter(request)
        ticket, pressed = _vote(await request.body())
        try:
            await run_in_threadpool(studies.vote, key, person, ticket, pressed)
            answer = await run_in_threadpool(_following, studies, key, person, visitor_of(request).address)
        except InputError as error:
            raise Refused(422, str(error), "study") from None
        return _answered(answer)

    return router


def _voter(request: Request) -> str:
    """The person who votes; raises Refused for one who cannot be told from others, or a program."""
    if not request.headers.get("origin"):  # the guard has compared it with the host
        raise Refused(403, _BY_SCRIPT, "study")
    visitor = visitor_of(request)
    if not visitor.account and not visitor.person.startswith("visitor "):
        raise Refused(403, _NO_COOKIE, "study")
    return visitor.person


def _vote(body: bytes) -> tuple[str, str]:
    """The ticket and the pressed key of a vote's body."""
    try:
        vote = json.loads(body if len(body) <= LONGEST_VOTE else b"")
        ticket, pressed = vote["ticket"], vote["answer"]
    except (ValueError, KeyError, TypeError):
        raise Refused(400, "The vote cannot be read: reload the page.", "study") from None
    if not isinstance(ticket, str) or not isinstance(pressed, str):
        raise Refused(400, "The vote cannot be read: reload the page.", "study")
    return ticket, pressed


def _answered(answer: dict[str, Any]) -> Response:
    return JSONResponse(answer, headers={"Cache-Control": "no-store"})


def _following(studies: Studies, key: str, person: str, address: str) -> dict[str, Any]:
    """The next pair and how far the person is, or the end."""
    shown = studies.hand_out(key, person, address)
    invitation = studies.invitation(key, person)
    answer: dict[str, Any] = {
        "question": invitation.question,
        "total": invitation.total,
        "done": invitation.done,
    }
    if shown is not None:
        return answer | {"ticket": shown.ticket, "wait": shown.wait, "pair": pair_payload(shown)}
    return answer | {"result": _plain(invitation.result) if invitation.result else None}


def pair_payload(shown: Shown) -> Payload:
    """A pair for the player: two cells under one camera, named 1 and 2, without curves or marks."""
    motions = (shown.left, shown.right)
    cells = [
        {**sample_payload(motion, curves=(), contacts=()), "caption": str(place)}
        for place, motion in enumerate(motions, start=1)
    ]
    sample = grid_sample(cells, ["1", "2"], [""])
    return build_payload([sample], skeleton=motions[0].skeleton, title=shown.caption)


def _plain(result: StudyResult) -> dict[str, Any]:
    figures = result.to_dict()
    return {name: figures[name] for name in ("raters", "votes", "comparisons")}


def _page(root: str, key: str, question: str) -> str:
    """The page's HTML; what the owner wrote in it is text."""

    def file(path: str) -> str:
        return f"{root}/gradio_api/file={quote(path)}"

    template = (STUDY_FOLDER / "study.html").read_text(encoding="utf-8")
    template = template.replace("@markup@", (PLAYER_FOLDER / "player.html").read_text(encoding="utf-8"))
    parts = {
        "style": file((STUDY_FOLDER / "study.css").as_posix()),
        "script": file((STUDY_FOLDER / "study.js").as_posix()),
        "player": file((PLAYER_FOLDER / "main.js").as_posix()),
        "plotly": file(PLOTLY_JS.as_posix()),
        "here": f"{root}/study/{quote(key, safe='')}",
        "question": question,
    }
    for name, value in parts.items():  # the question last: nothing in it is replaced
        template = template.replace(f"@{name}@", html.escape(value, quote=True))
    return template

"""Pages that show a result to anybody, with facts around it or as the player alone for a frame of another site's, and
those on which people vote.

The server sends them under a public address (:mod:`webdemo.server.http.public_pages`). What somebody wrote
is text in them, and the motion is data that no browser runs.
"""

from __future__ import annotations

import html
from dataclasses import dataclass
from functools import cache
from typing import Any

from jinja2 import Environment, FileSystemLoader

from webdemo.inference.methods import label_of
from webdemo.ui.components.notebook import made_by
from webdemo.ui.components.player import BODIES_FOLDER, PLAYER_FOLDER, PLOTLY_JS
from webdemo.ui.history import Entry
from webdemo.ui.text.texts import STATIC, TEXTS, TEXTS_JS, say
from webdemo.ui.text.words import day
from webdemo.ui.theme import COLOURS
from webdemo.view.payload import Payload

_PAGES = (STATIC / "share", STATIC / "study")
_ALL = [path for folder in (*_PAGES, PLAYER_FOLDER, BODIES_FOLDER) for path in sorted(folder.rglob("*.*"))]
_LOADED = [PLOTLY_JS, COLOURS, TEXTS_JS, TEXTS, *(path for path in _ALL if path.suffix in (".js", ".json", ".css"))]
FILES = {path.relative_to(STATIC).as_posix(): path for path in _LOADED}
"""All that the pages load, by the names under which they do."""


@dataclass(frozen=True, kw_only=True)
class Place:
    """The place of a page.

    Attributes:
        files: before the names of :data:`FILES`.
        embed: address of the player alone; empty where there is none.
    """

    files: str
    embed: str = ""


def caption(entry: Entry) -> str:
    """One line on how a result was made: by which method, how long, and its seed."""
    model = entry.request.get("model")
    return " · ".join(made_by(label_of(str(model)) if model else "", entry.request))


def player_html(entry: Entry, payload: Payload, place: Place, *, until: float) -> str:
    """A page with one result; ``until`` is when it ends, in seconds since 1970."""
    code = frame_code(place.embed, entry.title) if place.embed else ""
    return _page("page.html", place, title=entry.title, motion=payload, facts=caption(entry), code=code, day=day(until))


def embed_html(entry: Entry, payload: Payload, place: Place) -> str:
    """The player alone, as large as the frame that holds it."""
    return _page("page.html", place, title=entry.title, motion={**payload, "title": entry.title})


def study_html(question: str, here: str, place: Place) -> str:
    """The page of a study, at the address ``here``, on which people vote."""
    return _page("study.html", place, question=question, here=here)


def frame_code(address: str, title: str) -> str:
    """The HTML by which another page shows the player alone."""
    return (
        f'<iframe src="{html.escape(address)}" title="{html.escape(title)}" width="720" height="560" '
        'style="border:0;max-width:100%" allow="fullscreen" loading="lazy"></iframe>'
    )


def _page(template: str, place: Place, **shown: Any) -> str:
    player = (PLAYER_FOLDER / "player.html").read_text(encoding="utf-8")
    return _templates().get_template(template).render(player=player, files=place.files, say=say, **shown)


@cache
def _templates() -> Environment:
    made = Environment(loader=FileSystemLoader(_PAGES), autoescape=True)
    made.policies["json.dumps_kwargs"] = {"separators": (",", ":")}
    return made

"""Pages that show a result to anybody, with facts around it or as the player alone for a frame of another site's.

The server sends them under a public address (:mod:`webdemo.server.http.public_pages`). What somebody wrote
is text in them, and the motion is data that no browser runs.
"""

from __future__ import annotations

import html
import time
from dataclasses import dataclass
from functools import cache

from jinja2 import Environment, FileSystemLoader

from webdemo.inference.methods import label_of
from webdemo.ui.components.notebook import made_by
from webdemo.ui.components.part import STATIC
from webdemo.ui.components.player import BODIES_FOLDER, PLAYER_FOLDER, PLOTLY_JS
from webdemo.ui.history import Entry
from webdemo.ui.text.texts import TEXTS, TEXTS_JS, say
from webdemo.ui.theme import COLOURS
from webdemo.view.payload import Payload

SHARE_FOLDER = PLAYER_FOLDER.parent / "share"
_LOADED = (PLOTLY_JS, COLOURS, TEXTS_JS, TEXTS, SHARE_FOLDER / "share.js", SHARE_FOLDER / "share.css")
_PLAYED = (PLAYER_FOLDER / "player.css", *sorted(PLAYER_FOLDER.rglob("*.js")), *sorted(BODIES_FOLDER.glob("*.json")))
FILES = {path.relative_to(STATIC).as_posix(): path for path in (*_LOADED, *_PLAYED)}
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
    day = time.strftime("%d %B %Y", time.gmtime(until)).lstrip("0")
    code = frame_code(place.embed, entry.title) if place.embed else ""
    return _page(entry, payload, place, facts=caption(entry), code=code, day=day)


def embed_html(entry: Entry, payload: Payload, place: Place) -> str:
    """The player alone, as large as the frame that holds it."""
    return _page(entry, {**payload, "title": entry.title}, place)


def frame_code(address: str, title: str) -> str:
    """The HTML by which another page shows the player alone."""
    return (
        f'<iframe src="{html.escape(address)}" title="{html.escape(title)}" width="720" height="560" '
        'style="border:0;max-width:100%" allow="fullscreen" loading="lazy"></iframe>'
    )


def _page(entry: Entry, payload: Payload, place: Place, **shown: str) -> str:
    player = (PLAYER_FOLDER / "player.html").read_text(encoding="utf-8")
    page = _templates().get_template("page.html")
    return page.render(title=entry.title, motion=payload, player=player, files=place.files, say=say, **shown)


@cache
def _templates() -> Environment:
    made = Environment(loader=FileSystemLoader(SHARE_FOLDER), autoescape=True)
    made.policies["json.dumps_kwargs"] = {"separators": (",", ":")}
    return made

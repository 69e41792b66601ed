"""What is made of a result as the player shows it: a film and a figure, and the address of a link."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any
from urllib.parse import urlencode

from gradio.context import LocalContext

from motion import Clip, Duet, InputError
from webdemo.inference.requests.actor import finite
from webdemo.inference.requests.predict import PredictResult
from webdemo.inference.run import Result
from webdemo.view import film, plotly_figure
from webdemo.view.camera import VIEWS
from webdemo.view.stage import LOOKS, Pane, Style
from webdemo.view.theme import THEMES

from .exports import Record, file_name
from .player import with_shown_roles
from .prediction_view import ghost_of, without_name

LONGEST = 60.0
"""Seconds of motion that the page films; the shell has no such limit."""

DRAWN_IN = 600.0
"""Seconds in which a film must be drawn, as others' films wait for it."""

READ_PLAYER = """(...values) => {
  const player = window.__pasdedeux?.player;
  const { orbit, show } = player ?? {};
  const state = player && {
    yaw: orbit.yaw, elevation: orbit.elevation, view: player.framing.preset, follow: orbit.following,
    frame: Math.round(player.clock.shown), distance: orbit.distance,
    theme: player.themeName, sample: player.sampleIndex,
    look: { both: "both", body: "bodies", skeleton: "skeletons" }[show.figure],
  };
  return [...values.slice(0, -1), JSON.stringify(state ?? {})];
}"""
"""JavaScript that tells how the player shows the motion, as :func:`make_film` takes it: the last of the inputs."""


def suffix() -> str:
    """The suffix of films that can be written here: MP4, or GIF if its encoder is not installed."""
    return ".mp4" if film.can_write(".mp4") else ".gif"


Drawn = Callable[[int, int], None]
"""Hears how many pictures are drawn, and of how many."""


def in_time(progress: Drawn | None = None) -> Drawn:
    """Hears as ``progress`` does, from now on; raises InputError after :data:`DRAWN_IN`, or if its client has left."""
    until = time.monotonic() + DRAWN_IN
    page, own = LocalContext.blocks.get(None), LocalContext.event_id.get(None)

    def hear(done: int, total: int) -> None:
        jobs = page._queue.active_jobs if page is not None else []
        if any(event._id == own and not event.alive for job in jobs for event in job or ()):
            raise InputError("The client that asked for this film has closed its connection: ask again.")
        if time.monotonic() > until:
            raise InputError(
                f"Of {total:,} pictures {done:,} were drawn in {DRAWN_IN / 60:.0f} minutes: ask for fewer pixels, "
                "frames a second or seconds, or use `python -m webdemo render`."
            )
        if progress is not None:
            progress(done, total)

    return hear


def make_film(record: Record, shown: str, folder: Path, progress: Drawn | None = None) -> Path:
    """Films a session's last result as its player shows it.

    Args:
        record: the result.
        shown: what :data:`READ_PLAYER` gave; whatever is unknown in it is left at its default.
        folder: where the film is written.
        progress: hears how far it is.

    Raises:
        InputError: where it is too long.
    """
    state = read_player(shown)
    results = record.compared or {"": record.result}
    panes = [_pane(result, state.get("sample"), name if record.compared else "") for name, result in results.items()]
    if max(pane.motion.seconds for pane in panes) > LONGEST:
        raise InputError(f"Films on the page last {LONGEST:g} s at most: use `python -m webdemo render` for more.")
    path = folder / f"{file_name(record.prompt, record.result.manifest)}{suffix()}"
    style = Style(look=_one_of(state, "look", LOOKS, "bodies"), theme=_one_of(state, "theme", tuple(THEMES), "light"))
    return film.write_film(
        panes,
        path,
        style=style,
        size=film.SIZE if suffix() == ".mp4" else (640, 360),
        view=_one_of(state, "view", VIEWS, "threequarter"),
        follow=state.get("follow") is not False,
        title=record.prompt,
        yaw=number_of(state, "yaw", *_LIMITS["yaw"]),
        elevation=number_of(state, "elevation", *_LIMITS["elevation"]),
        progress=in_time(progress),
    )


def make_figure(record: Record, shown: str, folder: Path, progress: Drawn | None = None) -> Path:
    """The sample that the player shows as a plotly figure, an .html that plays offline; see :func:`make_film`.

    Of compared results it is the first.
    """
    state = read_player(shown)
    motion = _pane(record.result, state.get("sample"), "").motion
    path = folder / f"{file_name(record.prompt, record.result.manifest)}.html"
    theme = _one_of(state, "theme", tuple(THEMES), "light")
    return plotly_figure.write_figure(motion, path, title=record.prompt, theme=theme)


def _pane(result: Result, sample: Any, name: str) -> Pane:
    last = len(result.duets) - 1
    chosen = sample if isinstance(sample, int) and 0 <= sample <= last else 0
    motion: Clip | Duet = result.duets[chosen]
    motion = with_shown_roles(motion, result.manifest)
    if not isinstance(result, PredictResult):
        return Pane(motion, name)
    motion = without_name(motion)
    return Pane(motion, name, ghost_of(motion, result), result.past_frames)


def read_player(shown: str) -> Mapping[str, Any]:
    """Reads the answer of :data:`READ_PLAYER` as a dictionary; an empty one if it is none."""
    try:
        state = json.loads(shown[:2000])
    except (TypeError, ValueError, RecursionError):
        return {}
    return state if isinstance(state, dict) else {}


def _one_of(state: Mapping[str, Any], key: str, known: tuple[str, ...], default: str) -> str:
    value = state.get(key)
    return value if value in known else default


def number_of(state: Mapping[str, Any], key: str, low: float, high: float) -> float | None:
    """A finite number between bounds; None where there is none."""
    value = state.get(key)
    return float(min(max(value, low), high)) if finite(value) else None


_LIMITS = {"yaw": (-1000.0, 1000.0), "elevation": (-0.05, 1.5), "distance": (0.8, 40.0)}
MOST_FRAMES = 100_000


def link_address(base: str, key: str, shown: str) -> str:
    """The address of a run, with the frame and the camera of a player.

    Args:
        base: of the page.
        key: of the link.
        shown: what ``READ_PLAYER`` gave; whatever is unknown in it is left out.
    """
    state: Mapping[str, Any] = read_player(shown)
    asked: dict[str, Any] = {"run": key}
    for name in ("frame", "sample"):
        value = state.get(name)
        if type(value) is int and 0 <= value < MOST_FRAMES:
            asked[name] = value
    for name, (low, high) in _LIMITS.items():
        value = number_of(state, name, low, high)
        if value is not None:
            asked[name] = f"{value:.3f}"
    return f"{base}?{urlencode(asked)}"

"""The player of two-person motion as a Gradio component, and what it is given of a result.

``gr.Plot`` drops plotly's frames, so the player is a ``gr.HTML`` with modules of its own
(``static/player``). Its templates are constant files: what a user typed never becomes part of a
template, it travels as data and the browser sets it as text.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Any, ClassVar

import gradio as gr

from motion import Clip, Duet
from motion.formats import read
from motion.metrics import Contact
from webdemo.inference.run import Result
from webdemo.ui.text.texts import STATIC, TEXTS, TEXTS_JS
from webdemo.ui.theme import COLOURS
from webdemo.view.payload import Payload, build_payload, sample_payload

from .part import Part

PLAYER_FOLDER = STATIC / "player"
BODIES_FOLDER = PLAYER_FOLDER.parent / "bodies"
PLOTLY_JS = STATIC / "plotly" / "plotly-gl3d.min.js"
"""plotly.js with its 3D charts alone: a third of what the whole of it weighs."""
ROUNDS = 3
"""Rounds that an example plays before it rests, so that a page left open costs nothing."""
GIVEN, MADE = "given", "generated"
"""Labels of the two people of a reaction, beside their letters."""

# Only these become reachable over the network: the player's files, its bodies, plotly.js, the colours and the texts.
gr.set_static_paths([BODIES_FOLDER, PLOTLY_JS, COLOURS, TEXTS_JS, TEXTS])


class MotionPlayer(Part):
    """Plays one or two people in 3D.

    Its value is a payload of :func:`webdemo.view.payload.player_payload`, or None for the empty state. While
    something is being made, :func:`busy` lays a message over the scene.

    Args:
        value: the payload shown at first.
        elem_id: id of the element in the page.
    """

    folder = "player"
    style = "& { min-height: 320px; } .pdd:not(.pdd-styled) { visibility: hidden; }"
    declared: ClassVar = {"busy": "", "progress": None}


_NONE = -1
"""The progress of what has none: Gradio leaves None out, and the page keeps what it had."""


def busy(text: str = "", *, progress: float | None = None) -> dict[str, Any]:
    """An update that lays a message over the player; without text it takes the message away.

    Args:
        text: such as ``"Step 12 of 50"``.
        progress: 0 to 1 for the bar under it, None for none.
    """
    return gr.update(busy=text, progress=_NONE if progress is None else progress)


def show(payload: Payload | None) -> dict[str, Any]:
    """An update that shows a payload and takes the message away."""
    return gr.update(value=payload, busy="", progress=_NONE)


def shown_roles(manifest: Mapping[str, Any]) -> tuple[str, str]:
    """Labels beside "A" and "B" for a result of this manifest: of a reaction who was given; "a" and "b" add nothing."""
    asked = manifest.get("request", {})
    if asked.get("kind") != "react":
        return "a", "b"
    return (GIVEN, MADE) if asked.get("role", "a") == "a" else (MADE, GIVEN)


def with_shown_roles(motion: Duet | Clip, manifest: Mapping[str, Any]) -> Duet | Clip:
    """A motion of a result with the roles of :func:`shown_roles`; one person as they are."""
    return replace(motion, roles=shown_roles(manifest)) if isinstance(motion, Duet) else motion


def result_payload(result: Result, *, title: str = "") -> Payload:
    """The player's value for a result: every sample with the contacts of its read-outs."""
    samples = [
        sample_payload(
            with_shown_roles(duet, result.manifest), label=str(i + 1), contacts=_contacts(result.readouts[i : i + 1])
        )
        for i, duet in enumerate(result.duets)
    ]
    return build_payload(samples, skeleton=result.duets[0].skeleton, title=title)


def _contacts(readouts: tuple[Mapping[str, Any], ...]) -> list[Contact] | None:
    """Those of a sample's read-outs, if it has any."""
    contacts = readouts[0].get("contacts") if readouts else None
    return None if contacts is None else [Contact(**contact) for contact in contacts]


@lru_cache(maxsize=1)
def arrival_payload(path: Path) -> Payload | None:
    """A motion file that a page shows before anything is asked of it, played ``ROUNDS`` times, then at rest.

    No touches are marked on its time line, and its title is the sentence that it was made from. None where the file is
    missing.
    """
    if not path.is_file():
        return None
    duet = read(path)
    if not isinstance(duet, Duet):
        return None
    title = (duet.manifest or {}).get("request", {}).get("prompt", "")
    shown = sample_payload(with_shown_roles(duet, duet.manifest or {}), label="1", contacts=())
    return {**build_payload([shown], skeleton=duet.skeleton, title=title), "rounds": ROUNDS}

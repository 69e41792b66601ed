"""A panel that takes an actor from a video or the webcam.

The browser finds the people (``static/camera``) and sends the points on their bodies, never a picture;
:mod:`motion.video` makes clips of them.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import gradio as gr
from pydantic import TypeAdapter

from motion import InputError
from motion.video import people_of, unpack_film

from .accepts import Text
from .actors import Found, Source

CAMERA_FOLDER = Path(__file__).resolve().parents[3] / "static" / "camera"

gr.set_static_paths([CAMERA_FOLDER])

_ON_LOAD = """
const config = window.gradio_config || {};
const root = (config.root || new URL(".", document.baseURI).href).replace(/[/]$/, "");
const encode = (path) => path.split("/").map(encodeURIComponent).join("/");
const folder = root + (config.api_prefix || "/gradio_api") + "/file=" + encode(%s);
const send = (text) => { props.value = text; trigger("submit"); };
import(folder + "/camera.js").then((camera) => camera.mount(element, send, { folder: folder + "/mediapipe/" }));
"""


class CameraPanel(gr.HTML):
    """Chooses or records a video and sends its landmarks as a text; the event is ``submit``.

    Args:
        elem_id: id of the element in the page.
    """

    accepts = TypeAdapter(Text | None)

    def __init__(self, *, elem_id: str | None = None, **kwargs: Any) -> None:
        kwargs = {
            "html_template": (CAMERA_FOLDER / "camera.html").read_text(encoding="utf-8"),
            "js_on_load": _ON_LOAD % json.dumps(CAMERA_FOLDER.as_posix()),
            "apply_default_css": False,
            **kwargs,
        }
        super().__init__(None, elem_id=elem_id, **kwargs)

    def api_info(self) -> dict[str, Any]:
        """Describes the component's value for the API page."""
        return {"type": "string", "description": "landmarks of a film, as the page packs them"}

    def example_payload(self) -> None:
        """None: the component takes no example."""
        return None

    def example_value(self) -> None:
        """None: the component takes no example."""
        return None

    def get_block_name(self) -> str:
        """Gradio's name of the front end that draws it."""
        return "html"


def film_source(text: str | None) -> Source:
    """The people of a film as a source, from what the panel sends.

    Raises:
        InputError: where it is damaged, or nobody can be followed in it.
    """
    if not text:
        raise InputError("There is no film yet: choose a video or use the webcam.")
    sent = unpack_film(text)
    filmed = people_of(sent.landmarks, tilt=sent.tilt, lens=sent.lens, name=sent.name)
    sure = round(100 * float(filmed.confidence.mean()))
    count = "two people" if len(filmed.people) == 2 else "one person"
    line = (
        f"{count} from video, {sure} % of the body seen, camera looks down {filmed.tilt:.0f}° "
        f"({'found' if sent.tilt is None else 'given'})"
    )
    return Source(sent.name, filmed.people, found=Found(line[0].upper() + line[1:], ()), notes=filmed.notes)

"""A panel that takes an actor from a video or the webcam.

The browser finds the person (``static/camera``) and sends the points on the body, never a picture; :mod:`motion.video`
makes a clip of them.
"""

from __future__ import annotations

from pydantic import TypeAdapter

from motion import InputError
from motion.video import person_of, unpack_film

from .accepts import Text
from .actors import Source
from .part import Part


class CameraPanel(Part):
    """Chooses or records a video and sends its landmarks as a text; the event is ``submit``.

    Args:
        elem_id: id of the element in the page.
    """

    accepts = TypeAdapter(Text | None)
    folder = "camera"
    module = "camera.js"


def film_source(text: str | None) -> Source:
    """The person of a film as a source, from what the panel sends.

    Raises:
        InputError: where it is damaged, or nobody can be followed in it.
    """
    if not text:
        raise InputError("There is no video yet: choose one or use the webcam.")
    landmarks, name = unpack_film(text)
    filmed = person_of(landmarks, name=name)
    sure = round(100 * float(filmed.confidence.mean()))
    line = f"One person in the video: {sure} % of the body is seen, and the camera looks down by {filmed.tilt:.0f}°"
    return Source(name, (filmed.person,), found=line, notes=filmed.notes)

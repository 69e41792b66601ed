"""The panel of a partner who answers somebody who moves at once."""

from __future__ import annotations

import base64
import binascii
import json

import numpy as np
from pydantic import TypeAdapter

from motion import FPS, SMPL22, Clip, InputError
from webdemo.inference.requests.live import LONGEST, LiveTake

from .accepts import Text
from .part import Part

FARTHEST = 100.0
"""Metres from the origin: nobody in front of a camera walks further."""
_BROKEN = "The live stream could not be kept, since its motion arrived damaged: press Keep again."


class LivePanel(Part):
    """Lets a partner answer live in the player of the same tab.

    A stream that is to be kept is sent as a text for :func:`take_of`; the event is ``submit``.

    Args:
        elem_id: id of the element in the page.
    """

    accepts = TypeAdapter(Text | None)
    folder = "live"
    module = "live.js"


def take_of(text: str | None) -> LiveTake:
    """A live stream that somebody keeps, from what the panel sends; all of it may be hostile.

    The text is JSON with ``partner`` and ``positions``, base64 of little-endian float32 (2, T, 22, 3) in metres at
    30 fps.

    Raises:
        InputError: where it is damaged, too short or too long.
    """
    try:
        fields = json.loads(text or "")
        data = base64.b64decode(fields["positions"], validate=True)
        partner = str(fields["partner"])
    except (TypeError, ValueError, KeyError, RecursionError, binascii.Error):
        raise InputError(_BROKEN) from None
    frame = 2 * SMPL22.num_joints * 3 * 4
    if not data or len(data) % frame or len(data) > (LONGEST + 1) * FPS * frame:
        raise InputError(_BROKEN)
    people = np.frombuffer(data, "<f4").reshape(2, -1, SMPL22.num_joints, 3)
    if not (np.abs(people) < FARTHEST).all():  # nor for what is not a number
        raise InputError(_BROKEN)
    actor, reactor = (
        Clip(one.copy(), FPS, SMPL22, name=name) for one, name in zip(people, ("you", partner), strict=True)
    )
    return LiveTake(model=partner, actor=actor, reactor=reactor)

"""An online reaction in real time: the actor's frames arrive at the pace of their motion.

This module does not import torch: the page uses it before any network is loaded.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from motion import FPS, InputError
from webdemo.inference.requests import ReactRequest
from webdemo.inference.results import Progress

Array = NDArray[np.floating]


@dataclass(frozen=True)
class LiveFrame:
    """One frame of a live reaction.

    Attributes:
        index: its number from 0.
        raw: (samples, 22, 3) metres, the network's output in the actor's world.
        positions: (samples, 22, 3) metres, as shown.
        seconds: delay after the actor's frame.
    """

    index: int
    raw: Array
    positions: Array
    seconds: float


@dataclass(frozen=True, kw_only=True)
class LiveRequest(ReactRequest):
    """An online reaction to an actor who plays in real time; its motion is that of the same ReactRequest.

    The run reports every frame as a :class:`LiveProgress` and lasts as long as the actor's motion.

    Raises:
        InputError: as a ReactRequest, and for a mode that is not online.
    """

    mode: str = "online"

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.mode != "online":
            raise InputError("Only an online reaction can be live: choose the model regennet, mode online.")


@dataclass(frozen=True, kw_only=True)
class LiveProgress(Progress):
    """A frame of a live reaction, sent as soon as it is generated.

    Attributes:
        frame: the reaction's frame; its ``seconds`` count from the time when the actor's frame was due, so
            they grow if the machine cannot keep up.
    """

    frame: LiveFrame


def paced(frames: Iterator[LiveFrame], *, fps: float = FPS) -> Iterator[LiveFrame]:
    """Requests each frame when the actor's frame is due; the first one immediately.

    Args:
        frames: generates a frame on request.
        fps: the actor's frames a second.
    """
    began = time.perf_counter()
    index = 0
    while True:
        due = began + index / fps
        time.sleep(max(0.0, due - time.perf_counter()))
        frame = next(frames, None)
        if frame is None:
            return
        yield replace(frame, seconds=time.perf_counter() - due)
        index += 1

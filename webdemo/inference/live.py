"""An online reaction at the pace of an actor who plays: each of their frames comes when it is due.

No torch here: the page builds these requests and reads these events before any network loads.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from webdemo.motion import InputError

from .actor import FPS
from .requests import Progress, ReactRequest

Array = NDArray[np.floating]


@dataclass(frozen=True)
class LiveFrame:
    """One frame of a reaction as it came.

    Attributes:
        index: its number from 0.
        raw: (samples, 22, 3) metres as the network gave it, in the actor's world.
        positions: (samples, 22, 3) metres as it is shown.
        seconds: from the actor's frame to this one.
    """

    index: int
    raw: Array
    positions: Array
    seconds: float


@dataclass(frozen=True, kw_only=True)
class LiveRequest(ReactRequest):
    """An online reaction to an actor who plays in real time; its motion is that of the same ReactRequest.

    The run tells of every frame in a :class:`LiveProgress` and lasts as long as the actor's motion.

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
    """A frame of a live reaction, as soon as it is there.

    Attributes:
        frame: the reaction's frame; its ``seconds`` count from when the actor's frame was due, so that they
            grow where the machine cannot keep up.
    """

    frame: LiveFrame


def paced(frames: Iterator[LiveFrame], *, fps: float = FPS) -> Iterator[LiveFrame]:
    """Asks for each frame when the actor's is due and not before, the first at once.

    Args:
        frames: makes a frame when it is asked for one.
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

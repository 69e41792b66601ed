"""Progress of a scene while it is generated."""

from __future__ import annotations

from dataclasses import dataclass

from motion import Duet
from webdemo.inference.run import Progress


@dataclass(frozen=True, kw_only=True)
class SceneProgress(Progress):
    """A window is finished; what is there so far can be shown, and stays if the run is cancelled.

    Attributes:
        sample: its number from 0.
        beat: index of the beat that the window belongs to.
        motion: the scene from its beginning to the window's end.
    """

    sample: int
    beat: int
    motion: Duet

"""A window: frames of a scene that are made in one run of the network."""

from __future__ import annotations

from dataclasses import dataclass

PAST = 48
"""Frames of the motion before a window that it sees (1.6 s)."""
AFTER = 36
"""Frames of the motion after a window that it sees, where there is one already."""
MOST_FRAMES = 300
"""Frames of a window with what it sees: the longest motion that the networks were trained on."""

TAIL = 8
"""Frames that are made behind a window and thrown away where another follows: the network is least sure of the last
ones, and its feet are fast there."""


@dataclass(frozen=True)
class Window:
    """Frames that are made in one run of the network.

    Attributes:
        beat: index of the beat.
        part: its number within the beat, from 0.
        start, stop: frames of the scene that it makes.
        after: frames behind it that are known.
    """

    beat: int
    part: int
    start: int
    stop: int
    after: int = 0

    @property
    def past(self) -> int:
        """Frames before it that it sees."""
        return min(PAST, self.start)

    def tail(self, last: int) -> int:
        """Frames that are made behind it and thrown away, in a scene whose last part ends before frame ``last``."""
        if self.after or self.stop == last:
            return 0
        return min(TAIL, MOST_FRAMES - self.past - (self.stop - self.start))

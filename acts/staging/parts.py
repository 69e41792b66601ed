"""Parts of a scene that are given to a network: what a person does at some frames, or where they go.

All is in the network's frame: metres, Y up, the floor at 0, 30 frames a second. No torch here.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.floating]


@dataclass(frozen=True, eq=False)
class KnownFrames:
    """The motion of a person at some frames, held exactly.

    Attributes:
        person: 0 for a, 1 for b.
        frames: N different frames of the scene, in order.
        positions: (N, 22, 3) metres.
        joints: those that are given; () for all. All but the pelvis are given relative to it. Where only some are
            given, the network is held to them, and the finished motion comes close to them.
        kept: the finished motion has these joints as they are given: a foot that stamps is not planted again.
    """

    person: int
    frames: Sequence[int]
    positions: Array
    joints: Sequence[int] = ()
    kept: bool = False


@dataclass(frozen=True, eq=False)
class KnownPath:
    """A person's places at some frames, and optionally their headings.

    Attributes:
        person: 0 for a, 1 for b.
        frames: N different frames of the scene, in order; between them the way is free.
        places: (N, 2) x and z of the pelvis in metres.
        headings: (N,) radians from +Z towards +X. The network is shown them; they are not held.
        turned: the headings are held, too, by the places of the hips.
    """

    person: int
    frames: Sequence[int]
    places: Array
    headings: Array | None = None
    turned: bool = False


Part = KnownFrames | KnownPath

"""K3HI (Hu et al. 2013): two-person Kinect clips of 15 joints in eight classes.

The release has SBU's file format and scaling but another order of joints, and a third of its "approaching"
and "departing" clips stand in neither list of the split.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from motion.skeleton import K3HI15

from .sbu import KinectPair, read_clips

CLASSES = {
    "approaching": "approach",
    "departing": "depart",
    "exchanging": "exchange",
    "kicking": "kick",
    "pointing": "point",
    "punching": "punch",
    "pushing": "push",
    "shaking": "handshake",
}
"""The folders and the corpus' family of each."""

FPS = 30.0
"""Every class takes about twice SBU's frames, and walking covers 0.028 m a frame (0.84 m/s)."""

CAMERA_PITCH = 5.5
"""Degrees the camera looked down: between the lean of bodies (5.5–8.7°) and the floor's slope (4°)."""


def read_k3hi(data_dir: str | Path) -> list[KinectPair]:
    """All K3HI clips, unrepaired, in the order of their names.

    Args:
        data_dir: the folder with ``Skeletons``, ``Train.txt`` and ``Test.txt``, a folder that holds it as
            ``k3hi``, or either with ``skeletons.tar.xz`` in place of the unpacked files.

    Raises:
        InputError: if the data are not there.
    """
    pairs = []
    for actor, reactor, name, split in read_clips(data_dir, "k3hi", "skeletons.tar.xz", "Skeletons"):
        both = np.stack([actor, reactor])
        family = CLASSES[name.split("/")[0]]
        pairs.append(KinectPair(both, family, name, split, "k3hi", K3HI15, FPS, CAMERA_PITCH))
    return pairs

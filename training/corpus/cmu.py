"""CMU MoCap as the papers on motion prediction cut it: exponential maps in, windows of 17 joints out.

A folder holds ``skeleton.json`` and ``train/ACTION/ACTION_N.txt``, ``test/ACTION/ACTION_N.txt``: one frame a
line, 117 numbers: root translation, root rotation and the exponential maps of 38 joints, at 120 fps. As in
Li et al. (*Convolutional sequence to sequence model for human dynamics*) and the thesis (section 2.5.1), root
translation and rotation are left out and every second frame is kept; the papers call the result 25 fps.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from motion import InputError

Array = NDArray[np.floating]

CHANNELS = 117
WINDOW, PAST, FUTURE = 75, 50, 25
"""Frames of a test window, of its past, and of what follows; a network may look at less of the past."""
HORIZONS = (2, 4, 8, 10, 25)
"""Predicted frames at which the papers report errors: "80, 160, 320, 400 and 1000 ms"."""
ACTIONS = (
    "basketball",
    "basketball_signal",
    "directing_traffic",
    "jumping",
    "running",
    "soccer",
    "walking",
    "washwindow",
)
"""The papers' eight actions; some releases also hold ``walking_extra``."""
LEGS = slice(1, 7)
"""The legs among the 17 joints; root and upper body are the others."""
_MIRROR = (0, 4, 5, 6, 1, 2, 3, 7, 8, 9, 10, 14, 15, 16, 11, 12, 13)


@dataclass(frozen=True)
class CmuSkeleton:
    """The 38 joints of the files and the 17 that are scored.

    Attributes:
        parents: (38,) index of each joint's parent, -1 for the root.
        offsets: (38, 3) metres from the parent.
        channels: (38, 3) columns of each joint's exponential map in a file.
        kept: the 17 joints, as indices of the 38.
    """

    parents: tuple[int, ...]
    offsets: Array
    channels: NDArray[np.intp]
    kept: tuple[int, ...]

    @classmethod
    def read(cls, path: Path) -> CmuSkeleton:
        """Reads ``skeleton.json``; raises InputError where it is missing or has other joints."""
        try:
            values = json.loads(path.read_text())
            made = cls(
                tuple(values["parents"]),
                np.asarray(values["offsets_mm"], dtype=np.float64) / 1000,
                np.asarray(values["expmap_index"]),
                tuple(values["joints_17"]),
            )
        except (OSError, ValueError, KeyError, TypeError) as error:
            raise InputError(f"{path} is missing or is not CMU's skeleton ({error}).") from error
        if made.offsets.shape != (len(made.parents), 3) or made.channels.shape != made.offsets.shape:
            raise InputError(f"{path} is damaged: parents, offsets_mm and expmap_index differ in length.")
        return made

    @property
    def bones(self) -> list[tuple[int, int]]:
        """(parent, child) among the kept joints, over the joints that are left out, as places in ``kept``."""
        found = []
        for place, joint in enumerate(self.kept):
            parent = self.parents[joint]
            while parent >= 0 and parent not in self.kept:
                parent = self.parents[parent]
            if parent >= 0:
                found.append((self.kept.index(parent), place))
        return found

    def forward_kinematics(self, frames: Array) -> Array:
        """Joint positions from a file's frames, without root translation and rotation.

        Args:
            frames: (T, 117).

        Returns:
            (T, 38, 3) metres, the root at 0.
        """
        count = len(frames)
        local = Rotation.from_rotvec(frames[:, self.channels].reshape(-1, 3)).as_matrix()
        local = local.reshape(count, -1, 3, 3)
        world = np.empty_like(local)
        positions = np.zeros((count, len(self.parents), 3))
        # Positions are rows, which matrices turn from the right: a joint's own rotation comes first.
        for joint, parent in enumerate(self.parents):
            if parent < 0:
                world[:, joint] = np.eye(3)
                continue
            world[:, joint] = local[:, joint] @ world[:, parent]
            positions[:, joint] = self.offsets[joint] @ world[:, parent] + positions[:, parent]
        return positions


def read_frames(path: Path) -> Array:
    """(T, 117) of one file; raises InputError for anything else."""
    try:
        frames = np.loadtxt(path, delimiter=",", ndmin=2)
    except (OSError, ValueError) as error:
        raise InputError(f"{path} cannot be read as comma-separated numbers ({error}).") from error
    if frames.shape[1] != CHANNELS or not np.isfinite(frames).all():
        raise InputError(f"{path} does not hold {CHANNELS} finite numbers a line.")
    return frames


def read_actions(folder: Path, split: str, *, phases: bool = False) -> dict[str, list[Array]]:
    """All clips of a split by action.

    Args:
        folder: holds ``skeleton.json``, ``train`` and ``test``.
        split: "train" or "test".
        phases: give the frames that are dropped as a second clip, which doubles the training data.

    Returns:
        per action a list of (T, 17, 3) positions in metres, every second frame; actions in the order of
        the alphabet, without those that hold no file.

    Raises:
        InputError: for a missing or damaged file.
    """
    skeleton = CmuSkeleton.read(folder / "skeleton.json")
    found: dict[str, list[Array]] = {}
    for path in sorted((folder / split).glob("*/*.txt")):
        positions = skeleton.forward_kinematics(read_frames(path))[:, skeleton.kept].astype(np.float32)
        pairs = positions[: len(positions) // 2 * 2]  # of a frame that is kept and one that is dropped
        found.setdefault(path.parent.name, []).extend(pairs[i::2] for i in range(1 + phases))
    if not found:
        raise InputError(f"{folder / split} holds no ACTION/*.txt files of CMU MoCap.")
    return found


def windows(clips: list[Array], length: int = WINDOW, stride: int = 1) -> Array:
    """(windows, length, joints, 3): every window of the clips; clips that are shorter give none."""
    cut = [
        np.moveaxis(np.lib.stride_tricks.sliding_window_view(clip, length, axis=0), -1, 1)[::stride]
        for clip in clips
        if len(clip) >= length
    ]
    return np.concatenate(cut) if cut else np.empty((0, length, 17, 3), dtype=np.float32)


def mirrored(positions: Array) -> Array:
    """Left and right exchanged: (…, 17, 3) → the same shape."""
    return positions[..., _MIRROR, :] * np.array([-1, 1, 1], dtype=positions.dtype)

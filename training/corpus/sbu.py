"""SBU Kinect Interaction (Yun et al. 2012): two-person clips of 15 joints.

The files, their scaling and the split are those of the InterFormer paper's release: every clip is a pair
``skeleton_A.mat``, ``skeleton_B.mat`` with ``curve_B`` of (45, frames); ``Train.txt`` and ``Test.txt`` list
the clips, the actor's file first.
"""

from __future__ import annotations

import tarfile
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from io import BytesIO
from pathlib import Path, PurePosixPath

import numpy as np
from numpy.typing import NDArray
from scipy.io import loadmat

from motion.errors import InputError
from motion.skeleton import SBU15, Skeleton

Array = NDArray[np.floating]

CLASSES = {
    "01": "approach",
    "02": "depart",
    "03": "kick",
    "04": "push",
    "05": "handshake",
    "07": "exchange",
    "08": "punch",
}
"""The folders' numbers and the corpus' family of each; 06 (hug) is not in the release."""

FPS = 15.0
"""A walking step takes 8 frames (0.53 s) and walking covers 0.06 m a frame (0.9 m/s)."""

CAMERA_PITCH = 6.5
"""Degrees the camera looked down: between the lean of standing bodies (9°) and the floor's slope (4°)."""


@dataclass(frozen=True, eq=False)
class KinectPair:
    """Two people as a Kinect recorded them.

    Attributes:
        positions: (2, T, 15, 3) metres in the camera's frame: X left in the image, Y up, Z away from the
            camera (right-handed); the actor first.
        family: the corpus' name of the class.
        name: the clip's folder, e.g. "s01s02/01/001".
        split: "train", "benchmark" (the published test list, never trained on), or "unlisted" (in neither
            list, so who acts is not known).
        dataset: "sbu" or "k3hi".
        skeleton: names and order of the joints.
        fps: frames a second.
        pitch: degrees by which the camera looked down.
    """

    positions: Array = field(repr=False)
    family: str
    name: str
    split: str
    dataset: str
    skeleton: Skeleton
    fps: float
    pitch: float

    @property
    def num_frames(self) -> int:
        """Length in frames."""
        return self.positions.shape[1]

    def swapped(self) -> KinectPair:
        """The same clip with the other person as the actor."""
        return replace(self, positions=self.positions[::-1])


def read_sbu(data_dir: str | Path) -> list[KinectPair]:
    """All SBU clips, unrepaired, in the order of their names.

    Args:
        data_dir: the folder with ``Skeletons_Check``, ``Train.txt`` and ``Test.txt``, a folder that holds
            it as ``sbu``, or either with ``skeletons_check.tar.xz`` in place of the unpacked files.

    Raises:
        InputError: if the data are not there.
    """
    pairs = []
    for actor, reactor, name, split in read_clips(data_dir, "sbu", "skeletons_check.tar.xz", "Skeletons_Check"):
        family = CLASSES[name.split("/")[1]]
        both = np.stack([actor, reactor])
        pairs.append(KinectPair(both, family, name, split, "sbu", SBU15, FPS, CAMERA_PITCH))
    return pairs


def read_clips(data_dir: str | Path, dataset: str, archive: str, top: str) -> Iterator[tuple[Array, Array, str, str]]:
    """(actor (T, 15, 3), reactor, name, split) of every clip in a release of this shape."""
    files = _files(Path(data_dir), dataset, archive, top)
    order: dict[str, tuple[str, str, str]] = {}
    for listing, split in (("Train.txt", "train"), ("Test.txt", "benchmark")):
        for line in files[listing].decode().split("\n"):
            if line.strip():
                actor, reactor = line.split()[:2]
                order[str(PurePosixPath(actor).parent)] = (actor, reactor, split)
    folders = {str(PurePosixPath(name).parent) for name in files if name.endswith(".mat")}
    for folder in sorted(folders):
        listed = (f"{folder}/skeleton_A.mat", f"{folder}/skeleton_B.mat", "unlisted")
        actor, reactor, split = order.get(folder, listed)
        yield _metres(files[actor]), _metres(files[reactor]), folder.removeprefix(f"{top}/"), split


def _files(folder: Path, dataset: str, archive: str, top: str) -> dict[str, bytes]:
    """The release's files by their path below its folder, from the folder or from its archive."""
    for place in (folder, folder / dataset):
        if (place / top).is_dir():
            found = [*place.glob("T*.txt"), *(place / top).rglob("*.mat")]
            return {path.relative_to(place).as_posix(): path.read_bytes() for path in found}
        if (place / archive).is_file():
            with tarfile.open(place / archive) as tar:
                members = [member for member in tar.getmembers() if member.isfile()]
                contents = {member.name.removeprefix("./"): tar.extractfile(member) for member in members}
                return {name: stream.read() for name, stream in contents.items() if stream is not None}
    raise InputError(f"No {dataset} data in {folder}: give the folder that holds {top} or {archive}.")


def _metres(content: bytes) -> Array:
    """(T, 15, 3) metres from a file's (45, T): 15 x, 15 y, 15 z in the image's and the sensor's units."""
    curve = loadmat(BytesIO(content))["curve_B"].astype(np.float64)
    x, y, z = curve.reshape(3, 15, -1).transpose(0, 2, 1)
    return np.stack([(1280 - 2560 * x) / 1000, (960 - 1920 * y) / 1000, 10 * z / 7.8125], axis=-1)

"""SBU Kinect Interaction (Yun et al. 2012): two-person clips of 15 joints, and the repair of Kinect joints.

The files, their scaling and the split are those of the InterFormer paper's release: every clip is a pair
``skeleton_A.mat``, ``skeleton_B.mat`` with ``curve_B`` of (45, frames); ``Train.txt`` and ``Test.txt`` list
the clips, the actor's file first.
"""

from __future__ import annotations

import tarfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from io import BytesIO
from pathlib import Path, PurePosixPath

import numpy as np
from numpy.typing import NDArray
from scipy.io import loadmat
from scipy.ndimage import median_filter

from webdemo.motion.errors import InputError
from webdemo.motion.skeleton import SBU15, Skeleton

Array = NDArray[np.floating]

CLASSES = {
    "01": "approach", "02": "depart", "03": "kick", "04": "push", "05": "handshake", "07": "exchange",
    "08": "punch",
}  # fmt: skip
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
    for actor, reactor, name, split in _clips(data_dir, "sbu", "skeletons_check.tar.xz", "Skeletons_Check"):
        family = CLASSES[name.split("/")[1]]
        both = np.stack([actor, reactor])
        pairs.append(KinectPair(both, family, name, split, "sbu", SBU15, FPS, CAMERA_PITCH))
    return pairs


def _clips(data_dir: str | Path, dataset: str, archive: str, top: str) -> Iterator[tuple[Array, Array, str, str]]:
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


def upright(positions: Array, pitch: float) -> Array:
    """Camera coordinates turned so that Y is vertical, for a camera that looks down by ``pitch`` degrees."""
    angle = np.radians(pitch)
    cos, sin = np.cos(angle), np.sin(angle)
    return positions @ np.array([[1, 0, 0], [0, cos, sin], [0, -sin, cos]]).T


def without_sideways_lean(positions: Array, skeleton: Skeleton) -> Array:
    """Takes a standing lean towards or away from the camera out of one person.

    A Kinect that sees people from the side fits their near surface and tips trunks by up to 20° in depth,
    which nobody does for a whole clip. The median lean of the legs and of the trunk is turned back, each
    about the axis across the image; leaning along the image (forwards and backwards here) stays.

    Args:
        positions: (T, 15, 3) metres, level.
    """
    index = skeleton.index

    def middle(part: str) -> Array:
        return (positions[:, index(f"left_{part}")] + positions[:, index(f"right_{part}")]) / 2

    def angle(vector: Array) -> float:
        return float(np.degrees(np.median(np.arctan2(vector[:, 2], vector[:, 1]))))

    hips, feet = middle("hip"), middle("foot")
    trunk, legs = angle(positions[:, index("neck")] - hips), angle(hips - feet)
    limbs = [index(f"{side}_{part}") for side in ("left", "right") for part in ("knee", "foot")]
    above = [joint for joint in range(skeleton.num_joints) if joint not in limbs]
    ground = np.median(feet, axis=0)
    result = ground + upright(positions - ground, legs)
    centre = ground + upright(hips - ground, legs)
    result[:, above] = centre[:, None] + upright(positions[:, above] - hips[:, None], trunk)
    return result


def unswap(positions: Array, skeleton: Skeleton, parts: Sequence[str], fps: float) -> tuple[Array, int]:
    """Undoes exchanges of left and right that a tracker makes in the middle of a clip.

    For every frame "as recorded" or "exchanged" is chosen by dynamic programming: what moves the parts
    least from frame to frame and keeps the length of the bone they hang on.

    Args:
        positions: (T, 15, 3) metres.
        parts: the joints that are exchanged together, without their side, from the body outwards.

    Returns:
        the repaired positions and how many frames were exchanged.
    """
    left = [skeleton.index(f"left_{part}") for part in parts]
    right = [skeleton.index(f"right_{part}") for part in parts]
    states = np.stack([positions[:, left + right], positions[:, right + left]])  # (2, T, 2P, 3)
    anchors = [skeleton.parents[left[0]], skeleton.parents[right[0]]]
    first = states[:, :, [0, len(parts)]] - positions[None][:, :, anchors]
    length = np.linalg.norm(first, axis=-1)
    stretch = np.sum((length - np.median(length[0], axis=0)) ** 2, axis=-1)  # (2, T)
    noise, stride = 0.06, 2.0 / fps  # metres of length noise; metres a limb may move in a frame
    cost = stretch / noise**2 + np.array([0.0, 0.5])[:, None]
    jump = np.sum((states[:, None, 1:] - states[None, :, :-1]) ** 2, axis=(-1, -2)) / stride**2
    total, back = cost[:, 0], []
    for frame in range(1, len(positions)):
        ways = jump[:, :, frame - 1] + total[None]
        back.append(ways.argmin(axis=1))
        total = ways.min(axis=1) + cost[:, frame]
    path = [int(total.argmin())]
    for choice in reversed(back):
        path.append(int(choice[path[-1]]))
    chosen = np.array(path[::-1])
    if chosen.mean() > 0.5:
        chosen = 1 - chosen
    repaired = positions.copy()
    repaired[:, left + right] = states[chosen, np.arange(len(positions))]
    return repaired, int(chosen.sum())


def exchanged(positions: Array, skeleton: Skeleton) -> Array:
    """The whole clip with left and right joints exchanged, for a body that was taken for its back."""
    return positions[..., list(skeleton.mirror), :]


def without_spikes(positions: Array, fps: float, *, threshold: float = 0.15) -> Array:
    """NaN where a joint leaves its path for a moment: further than ``threshold`` metres from its median.

    Args:
        positions: (T, J, 3) metres.
        fps: sets the median's window, a third of a second.
    """
    window = 2 * round(fps / 6) + 1
    smooth = median_filter(positions, size=(window, 1, 1), mode="nearest")
    spike = np.linalg.norm(positions - smooth, axis=-1) > threshold
    # A joint that is far off half the time is moving, not jumping.
    spike &= spike.mean(axis=0) < 0.25
    return np.where(spike[..., None], np.nan, positions)

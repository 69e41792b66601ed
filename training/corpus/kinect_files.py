"""SBU (Yun et al. 2012) and K3HI (Hu et al. 2013): two-person Kinect clips of 15 joints.

The files, their scaling and the split are those of the InterFormer paper's release: every clip is a pair
``skeleton_A.mat``, ``skeleton_B.mat`` with ``curve_B`` of (45, frames); ``Train.txt`` and ``Test.txt`` list
the clips, the actor's file first. A third of K3HI's "approaching" and "departing" clips stand in neither list.
"""

from __future__ import annotations

import tarfile
from dataclasses import dataclass, field, replace
from io import BytesIO
from pathlib import Path, PurePosixPath

import numpy as np
from numpy.typing import NDArray
from scipy.io import loadmat

from motion.errors import InputError
from motion.skeleton import K3HI15, SBU15, Skeleton

Array = NDArray[np.floating]


@dataclass(frozen=True)
class Release:
    """A data set.

    Attributes:
        archive, top: its packed file, and its folder of clips.
        skeleton: names and order of the joints.
        fps: frames a second. A walking step of SBU takes 8 frames (0.53 s) and walking covers 0.06 m a frame (0.9 m/s);
            K3HI's classes take about twice SBU's frames, and walking covers 0.028 m a frame (0.84 m/s).
        pitch: degrees by which the camera looked down, between the lean of standing bodies and the floor's slope.
        classes: the folders' names and the corpus' family of each; SBU's 06 (hug) is not in the release.
    """

    archive: str
    top: str
    skeleton: Skeleton
    fps: float
    pitch: float
    classes: dict[str, str]


_SBU = {
    "01": "approach",
    "02": "depart",
    "03": "kick",
    "04": "push",
    "05": "handshake",
    "07": "exchange",
    "08": "punch",
}
_K3HI = {
    "approaching": "approach",
    "departing": "depart",
    "exchanging": "exchange",
    "kicking": "kick",
    "pointing": "point",
    "punching": "punch",
    "pushing": "push",
    "shaking": "handshake",
}
RELEASES = {
    "sbu": Release("skeletons_check.tar.xz", "Skeletons_Check", SBU15, 15.0, 6.5, _SBU),
    "k3hi": Release("skeletons.tar.xz", "Skeletons", K3HI15, 30.0, 5.5, _K3HI),
}


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
        skeleton, fps, pitch: see :class:`Release`.
    """

    positions: Array = field(repr=False)
    family: str
    name: str
    split: str
    dataset: str
    skeleton: Skeleton
    fps: float
    pitch: float

    def swapped(self) -> KinectPair:
        """The same clip with the other person as the actor."""
        return replace(self, positions=self.positions[::-1])


def read_pairs(data_dir: str | Path) -> list[KinectPair]:
    """All clips of both sets, unrepaired, each set in the order of the clips' names.

    Args:
        data_dir: the folder that holds ``sbu`` and ``k3hi``, each unpacked or with its archive.

    Raises:
        InputError: if the data of a set are not there.
    """
    return [pair for dataset in RELEASES for pair in read_release(data_dir, dataset)]


def read_release(data_dir: str | Path, dataset: str) -> list[KinectPair]:
    """All clips of "sbu" or "k3hi"; ``data_dir`` may also be the folder of the set itself."""
    release = RELEASES[dataset]
    files = _files(Path(data_dir), dataset, release)
    order: dict[str, tuple[str, str, str]] = {}
    for listing, split in (("Train.txt", "train"), ("Test.txt", "benchmark")):
        for line in filter(str.strip, files[listing].decode().split("\n")):
            actor, reactor = line.split()[:2]
            order[str(PurePosixPath(actor).parent)] = (actor, reactor, split)
    pairs = []
    for folder in sorted({str(PurePosixPath(name).parent) for name in files if name.endswith(".mat")}):
        name = folder.removeprefix(f"{release.top}/")
        actor, reactor, split = order.get(folder, (f"{folder}/skeleton_A.mat", f"{folder}/skeleton_B.mat", "unlisted"))
        family = next(release.classes[part] for part in name.split("/") if part in release.classes)
        both = np.stack([_metres(files[actor]), _metres(files[reactor])])
        pairs.append(KinectPair(both, family, name, split, dataset, release.skeleton, release.fps, release.pitch))
    return pairs


def _files(folder: Path, dataset: str, release: Release) -> dict[str, bytes]:
    """The release's files by their path below its folder, from the folder or from its archive."""
    for place in (folder, folder / dataset):
        if (place / release.top).is_dir():
            found = [*place.glob("T*.txt"), *(place / release.top).rglob("*.mat")]
            return {path.relative_to(place).as_posix(): path.read_bytes() for path in found}
        if (place / release.archive).is_file():
            with tarfile.open(place / release.archive) as tar:
                contents = {
                    member.name.removeprefix("./"): tar.extractfile(member) for member in tar if member.isfile()
                }
                return {name: stream.read() for name, stream in contents.items() if stream is not None}
    raise InputError(f"No {dataset} data in {folder}: give the folder that holds {release.top} or {release.archive}.")


def _metres(content: bytes) -> Array:
    """(T, 15, 3) metres from a file's (45, T): 15 x, 15 y, 15 z in the image's and the sensor's units."""
    curve = loadmat(BytesIO(content))["curve_B"].astype(np.float64)
    x, y, z = curve.reshape(3, 15, -1).transpose(0, 2, 1)
    return np.stack([(1280 - 2560 * x) / 1000, (960 - 1920 * y) / 1000, 10 * z / 7.8125], axis=-1)

"""SBU (Yun et al. 2012) and K3HI (Hu et al. 2013): two-person Kinect clips of 15 joints, mended, and fitted to bodies.

The files, their scaling and the split are those of the InterFormer paper's release: every clip is a pair
``skeleton_A.mat``, ``skeleton_B.mat`` with ``curve_B`` of (45, frames); ``Train.txt`` and ``Test.txt`` list
the clips, the actor's file first. A third of K3HI's "approaching" and "departing" clips stand in neither list and are
not read, since nobody says who acts.

A Kinect's errors are corrected here: lean, sides, spikes, open trunks.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from scipy.io import loadmat
from scipy.ndimage import median_filter

from motion import FPS, InputError
from motion.ik import body_scale, fit_skeleton
from motion.kinematics import project_to_skeleton
from motion.skeleton import K3HI15, SBU15, SMPL22, Skeleton
from motion.transforms import canonicalize, heading_matrix, resample
from motion.vectors import Array, rotations_by, wrapped

from .sources import unpacked


@dataclass(frozen=True)
class Release:
    """A data set.

    Attributes:
        top: its folder of clips.
        skeleton: names and order of the joints.
        fps: frames a second. A walking step of SBU takes 8 frames (0.53 s) and walking covers 0.06 m a frame (0.9 m/s);
            K3HI's classes take about twice SBU's frames, and walking covers 0.028 m a frame (0.84 m/s).
        pitch: degrees by which the camera looked down, between the lean of standing bodies and the floor's slope.
        classes: the folders' names and the corpus' family of each; SBU's 06 (hug) is not in the release.
    """

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
    "sbu": Release("Skeletons_Check", SBU15, 15.0, 6.5, _SBU),
    "k3hi": Release("Skeletons", K3HI15, 30.0, 5.5, _K3HI),
}


@dataclass(frozen=True, eq=False)
class Pair:
    """A listed clip of two people, the actor first.

    Attributes:
        positions: (2, T, 22, 3) metres at 30 fps, canonical to the actor; as a Kinect recorded them (2, T, 15, 3) in
            the camera's frame: X left in the image, Y up, Z away from the camera (right-handed).
        family: the corpus' name of its class.
        dataset: "sbu" or "k3hi".
        name: the clip's folder, e.g. "s01s02/01/001".
        test: True in the published test list, on which nothing is trained.
        error: metres between the fitted body and the Kinect's joints, at most.
    """

    positions: Array = field(repr=False)
    family: str
    dataset: str
    name: str
    test: bool
    error: float = 0.0


def read_release(data_dir: str | Path, dataset: str) -> list[Pair]:
    """The listed clips of "sbu" or "k3hi", unrepaired, in the order of their names.

    Args:
        data_dir: holds the folder of the set, or is it; unpacked or with its archive.

    Raises:
        InputError: if the data are not there.
    """
    release, folder = RELEASES[dataset], Path(data_dir)
    pairs = []
    with unpacked(folder / dataset if (folder / dataset).is_dir() else folder, "T*.txt") as lists:
        for path in lists:
            for line in filter(str.strip, path.read_text().splitlines()):
                actor, reactor = (path.parent / word for word in line.split()[:2])
                name = actor.parent.relative_to(path.parent / release.top)
                family = next(release.classes[part] for part in name.parts if part in release.classes)
                both = np.stack([_metres(actor), _metres(reactor)])
                pairs.append(Pair(both, family, dataset, str(name), path.name == "Test.txt"))
    if not pairs:
        raise InputError(f"No {dataset} data in {folder}: give the folder that holds {release.top}, or its archive.")
    return sorted(pairs, key=lambda pair: pair.name)


def _metres(path: Path) -> Array:
    """(T, 15, 3) metres from a file's (45, T): 15 x, 15 y, 15 z in the image's and the sensor's units."""
    curve = loadmat(path)["curve_B"].astype(np.float64)
    x, y, z = curve.reshape(3, 15, -1).transpose(0, 2, 1)
    return np.stack([(1280 - 2560 * x) / 1000, (960 - 1920 * y) / 1000, 10 * z / 7.8125], axis=-1)


# ---- repairs and bodies ------------------------------------------------------------------------------


ANKLE = float(-SMPL22.offsets[SMPL22.index("left_foot"), 1])
"""Height of an ankle over its sole in metres."""
_DEPTH_TRUST = 0.4  # a Kinect's depth is about this much less certain than its image plane, as a weight
_NOISE = 0.02  # metres; the tracker keeps many bones rigid, so bones alone would tell too little


def fitted(pair: Pair) -> Pair:
    """The same two people on SMPL22: repaired, fitted, at 30 fps, feet at the floor."""
    release = RELEASES[pair.dataset]
    skeleton, fps = release.skeleton, release.fps
    level = upright(pair.positions, release.pitch)
    repaired = [_repaired(own, other, pair) for own, other in zip(level, level[::-1], strict=True)]
    scale = float(np.mean([body_scale(person, skeleton) for person in repaired]))
    weights = np.broadcast_to(np.array([1.0, 1.0, _DEPTH_TRUST]), level[0].shape)
    known: dict[str, Any] = {"weights": weights, "fps": fps, "noise": _NOISE, "scale": scale}
    fits = [fit_skeleton(person, skeleton, **known) for person in repaired]
    people = np.stack([project_to_skeleton(resample(fit.positions, fps, FPS))[0] for fit in fits])
    error = max(fit.error for fit in fits)
    return replace(pair, positions=canonicalize(people).astype(np.float32), error=error)


def _repaired(own: Array, other: Array, pair: Pair) -> Array:
    """(T, 15, 3) positions over the floor with sides and spikes mended, of a person and the other one, level."""
    skeleton, fps = RELEASES[pair.dataset].skeleton, RELEASES[pair.dataset].fps
    for parts in (("shoulder", "elbow", "wrist", "hip", "knee", "foot"), ("knee", "foot"), ("foot",)):
        own = unswap(own, skeleton, parts, fps)
    ahead = _ahead(own, other, pair)
    if ahead is not None:
        if np.mean(np.cos(_deviation(own, ahead, skeleton))) < -0.3:
            own = own[:, list(skeleton.mirror)]  # the tracker took the back for the front
        own = _turned_trunk(own, ahead, skeleton)
    own = without_spikes(without_sideways_lean(own, skeleton), fps)
    feet = own[:, [skeleton.index("left_foot"), skeleton.index("right_foot")]]
    # Depth noise lifts and sinks feet; the lower fifth of heights is where they stand.
    return own - np.array([0.0, np.nanpercentile(feet[..., 1], 20) - ANKLE, 0.0])


def _ahead(own: Array, other: Array, pair: Pair) -> Array | None:
    """(T, 2) where this person should face in XZ: forwards for a person who walks, and otherwise to the other.

    ``None`` where nothing can be expected: of a person who stands while the other leaves, or who points at something.
    """
    torso = RELEASES[pair.dataset].skeleton.index("torso")
    middle = own[:, torso][:, [0, 2]]
    walk = middle[-1] - middle[0]
    if pair.family in ("approach", "depart") and np.linalg.norm(walk) > 0.5:
        return np.broadcast_to(walk, middle.shape)
    if pair.family in ("depart", "point"):
        return None
    return other[:, torso][:, [0, 2]] - middle


def _deviation(own: Array, ahead: Array, skeleton: Skeleton) -> Array:
    """(T,) radians from where this person should face to where the hips face, positive from +X to +Z."""
    across = (own[:, skeleton.index("left_hip")] - own[:, skeleton.index("right_hip")])[:, [0, 2]]
    difference = np.arctan2(across[:, 0], -across[:, 1]) - np.arctan2(ahead[:, 1], ahead[:, 0])
    return wrapped(difference)


def _turned_trunk(own: Array, ahead: Array, skeleton: Skeleton) -> Array:
    """Hips and shoulders turned a little about the body's axis, towards where the person should face.

    A Kinect that sees people from the side takes their trunks as open towards it, by 14° in SBU and 30° in
    K3HI on the median; hands and feet, seen themselves, stay.
    """
    angle = np.clip(0.6 * np.median(_deviation(own, ahead, skeleton)), *np.radians([-25.0, 25.0]))
    plate = [skeleton.index(f"{side}_{part}") for side in ("left", "right") for part in ("shoulder", "hip")]
    centre = own[:, [skeleton.index("torso")]]
    result = own.copy()
    result[:, plate] = centre + (own[:, plate] - centre) @ heading_matrix(angle).T
    return result


def upright(positions: Array, pitch: float) -> Array:
    """Camera coordinates turned so that Y is vertical, for a camera that looks down by ``pitch`` degrees."""
    return positions @ rotations_by(np.radians([-pitch, 0.0, 0.0])).T


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


def unswap(positions: Array, skeleton: Skeleton, parts: Sequence[str], fps: float) -> Array:
    """Undoes exchanges of left and right that a tracker makes in the middle of a clip.

    For every frame "as recorded" or "exchanged" is chosen by dynamic programming: what moves the parts
    least from frame to frame and keeps the length of the bone they hang on.

    Args:
        positions: (T, 15, 3) metres.
        parts: the joints that are exchanged together, without their side, from the body outwards.
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
    for ways, own in zip(np.moveaxis(jump, -1, 0), cost[:, 1:].T, strict=True):
        back.append((ways + total).argmin(axis=1))
        total = (ways + total).min(axis=1) + own
    path = [int(total.argmin())]
    for choice in reversed(back):
        path.insert(0, int(choice[path[0]]))
    chosen = np.array(path) ^ (np.mean(path) > 0.5)
    repaired = positions.copy()
    repaired[:, left + right] = states[chosen, np.arange(len(positions))]
    return repaired


def without_spikes(positions: Array, fps: float) -> Array:
    """NaN where a joint leaves its path for a moment: further than 15 cm from its median.

    Args:
        positions: (T, J, 3) metres.
        fps: sets the median's window, a third of a second.
    """
    window = 2 * round(fps / 6) + 1
    smooth = median_filter(positions, size=(window, 1, 1), mode="nearest")
    spike = np.linalg.norm(positions - smooth, axis=-1) > 0.15
    # A joint that is far off half the time is moving, not jumping.
    spike &= spike.mean(axis=0) < 0.25
    return np.where(spike[..., None], np.nan, positions)

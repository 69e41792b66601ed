"""Building blocks that turn real single-person clips into longer motion on constant bones.

Everything works on a :class:`Motion`: local rotations and a root path. Bones stay constant because only rotations are
blended; feet step and stay where they stand because :func:`realise` solves the legs after all blending.
Headings are radians about Y, 0 along +Z and positive towards +X, as in ``motion.transforms``.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from scipy.ndimage import gaussian_filter1d

from motion import FPS
from motion.cleaning import foot_contacts, plant_feet
from motion.footsteps import pivoting, stepping
from motion.kinematics import fit_rotations, forward_kinematics, global_rotations
from motion.skeleton import SIDES, SMPL22
from motion.smoothing import minimum_jerk
from motion.transforms import heading_matrix
from motion.vectors import Array, slerp, wrapped

ARMS = {
    side: tuple(SMPL22.index(f"{side}_{joint}") for joint in ("collar", "shoulder", "elbow", "wrist")) for side in SIDES
}
GLIDES = 0.6
"""Metres a second of a foot that stands, at most."""
_MIRROR = np.diag([-1.0, 1.0, 1.0])
_GAZE = {"spine2": 0.12, "spine3": 0.18, "neck": 0.5}


@dataclass(frozen=True, eq=False)
class Motion:
    """One person's motion, ready to be cut, placed, joined and layered.

    Attributes:
        rotations: (T, 22, 3, 3) local rotations, the root's against the world.
        root: (T, 3) root path in metres.
        sources: the files it comes from.
    """

    rotations: Array = field(repr=False)
    root: Array = field(repr=False)
    sources: tuple[str, ...] = ()

    def __len__(self) -> int:
        return len(self.root)

    def __getitem__(self, frames: slice) -> Motion:
        return replace(self, rotations=self.rotations[frames], root=self.root[frames])

    @property
    def headings(self) -> Array:
        """(T,) unwrapped heading of the hips in radians."""
        across = self.rotations[:, 0, :, 0]
        return np.unwrap(np.arctan2(-across[:, 2], across[:, 0]))


def ease(steps: int) -> Array:
    """(steps,) from just above 0 to just below 1 with zero slope and curvature at both ends."""
    return minimum_jerk((np.arange(steps) + 1.0) / (steps + 1.0))


def motion_from_positions(positions: Array, *, sources: tuple[str, ...] = ()) -> Motion:
    """A :class:`Motion` from (T, 22, 3) positions in metres with the floor at 0."""
    positions = np.asarray(positions, dtype=np.float64)
    return Motion(fit_rotations(positions), positions[:, 0].copy(), sources)


def mirror(motion: Motion) -> Motion:
    """The motion as a mirror in the plane X = 0 shows it: left and right exchanged."""
    swap = list(SMPL22.mirror)
    return replace(
        motion, rotations=_MIRROR @ motion.rotations[:, swap] @ _MIRROR, root=motion.root * np.array([-1.0, 1.0, 1.0])
    )


def facing_at(motion: Motion, frame: int) -> float:
    """Heading in radians around a frame; averaged over a stride where the person walks."""
    frame = frame % len(motion)
    near = motion.root[max(frame - 8, 0) : frame + 9]
    walks = np.linalg.norm((near[-1] - near[0])[[0, 2]]) * FPS > 0.4 * len(near)
    window = 16 if walks else 5
    return float(motion[max(frame - window, 0) : frame + window + 1].headings.mean())


def place(motion: Motion, x: float, z: float, angle: float, *, frame: int = 0) -> Motion:
    """Moves a motion so that at ``frame`` its root is at (x, z) and its hips look towards heading ``angle``."""
    motion = steer(motion, np.full(len(motion), angle - facing_at(motion, frame)))
    shift = np.array([x - motion.root[frame, 0], 0.0, z - motion.root[frame, 2]])
    return replace(motion, root=motion.root + shift)


def time_warp(motion: Motion, rate: float) -> Motion:
    """Plays a motion ``rate`` times as fast (1.1 is 10 % shorter)."""
    frames = max(round((len(motion) - 1) / rate) + 1, 2)
    times = np.linspace(0, len(motion) - 1, frames)
    low = np.minimum(times.astype(int), len(motion) - 2)
    share = times - low
    root = motion.root[low] + share[:, None] * (motion.root[low + 1] - motion.root[low])
    return replace(motion, rotations=slerp(motion.rotations[low], motion.rotations[low + 1], share[:, None]), root=root)


def join(first: Motion, second: Motion, *, blend: int = 12, turn: float = 0.0) -> Motion:
    """``first`` then ``second``, which is moved to start where the first ends, cross-faded over ``blend``.

    The two overlap by ``blend`` frames (at most half of either), so the result is that much shorter
    than both together. The second faces ``turn`` radians beside where the first faces.
    """
    blend = max(min(blend, len(first) // 2, len(second) // 2), 1)
    middle = blend // 2
    seam = len(first) - blend + middle
    second = place(second, *first.root[seam, [0, 2]], facing_at(first, seam) + turn, frame=middle)
    weight = ease(blend)
    tail, head = slice(len(first) - blend, None), slice(0, blend)
    rotations = slerp(first.rotations[tail], second.rotations[head], weight[:, None])
    root = first.root[tail] * (1 - weight[:, None]) + second.root[head] * weight[:, None]
    return Motion(
        np.concatenate([first.rotations[:-blend], rotations, second.rotations[blend:]]),
        np.concatenate([first.root[:-blend], root, second.root[blend:]]),
        tuple(dict.fromkeys(first.sources + second.sources)),
    )


def steer(motion: Motion, extra: Array, pace: Array | float = 1.0) -> Motion:
    """Bends the path, and scales how fast the root travels over the ground; feet are planted later.

    Args:
        extra: (T,) radians by which each frame is turned beyond the original.
        pace: times the speed, for all frames or (T,).
    """
    matrices = heading_matrix(np.asarray(extra))
    rotations = motion.rotations.copy()
    rotations[:, 0] = matrices @ rotations[:, 0]
    steps = np.einsum("tij,tj->ti", matrices[:-1], np.diff(motion.root, axis=0))
    steps[:, [0, 2]] *= np.broadcast_to(pace, len(motion))[:-1, None]
    root = np.concatenate([motion.root[:1], motion.root[:1] + np.cumsum(steps, axis=0)])
    return replace(motion, rotations=rotations, root=root)


def looped(motion: Motion, again: Motion, frames: int, *, blend: int) -> Motion:
    """At least so many frames: a motion and, as often as they need, another one, cross-faded over ``blend``."""
    while len(motion) < frames:
        motion = join(motion, again, blend=blend)
    return motion


def layer(base: Motion, over: Motion, *, start: int, joints: tuple[int, ...], blend: int = 10) -> Motion:
    """Plays some joints of ``over`` on top of ``base`` from frame ``start`` on, fading in and out."""
    frames = min(len(over), len(base) - start)
    blend = max(min(blend, frames // 2), 1)
    weight = np.ones(frames)
    weight[:blend], weight[frames - blend :] = ease(blend), ease(blend)[::-1]
    rotations = base.rotations.copy()
    inside, chosen = slice(start, start + frames), list(joints)
    rotations[inside, chosen] = slerp(base.rotations[inside, chosen], over.rotations[:frames, chosen], weight[:, None])
    return replace(base, rotations=rotations, sources=tuple(dict.fromkeys(base.sources + over.sources)))


def look_at(motion: Motion, target: Array, *, amount: float = 0.8) -> Motion:
    """Turns neck and upper spine a little towards ``target`` (T, 3), up to 70°; nothing behind the back."""
    world = global_rotations(motion.rotations)
    forward = world[:, SMPL22.index("spine3")] @ np.array([0.0, 0.0, 1.0])
    wanted = target - motion.root
    angle = wrapped(np.arctan2(wanted[:, 0], wanted[:, 2]) - np.arctan2(forward[:, 0], forward[:, 2]))
    seen = np.clip((np.radians(140) - np.abs(angle)) / np.radians(50), 0, 1)
    angle = gaussian_filter1d(np.clip(angle, -1.2, 1.2) * seen * amount, 5.0, mode="nearest")
    rotations = motion.rotations.copy()
    for name, share in _GAZE.items():
        joint = SMPL22.index(name)
        parent = world[:, SMPL22.parents[joint]]
        rotations[:, joint] = np.swapaxes(parent, -1, -2) @ heading_matrix(angle * share) @ parent @ rotations[:, joint]
    return replace(motion, rotations=rotations)


def realise(motion: Motion) -> Array:
    """(T, 22, 3) positions of a person who steps where they glide or turn, and whose feet stay where they stand.

    Standing feet glide where a way was bent or scaled, so more speed is allowed them than in a recording.
    """
    positions = forward_kinematics(motion.rotations, motion.root)
    positions = pivoting(stepping(positions, FPS), FPS)
    return plant_feet(positions, foot_contacts(positions, FPS, speed=GLIDES))


def blend_for(first: Motion, second: Motion) -> int:
    """Frames over which to blend so that no joint has to hurry: 10 to 24, by how far the poses are apart."""
    ends = np.stack([first.rotations[-1], second.rotations[0]])
    ends[:, 0] = np.eye(3)
    one, other = forward_kinematics(ends, np.zeros((2, 3)))
    return int(np.clip(8 + 22 * np.linalg.norm(one - other, axis=-1).max(), 10, 24))

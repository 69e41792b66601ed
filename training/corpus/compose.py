"""Building blocks that turn real single-person clips into longer motion on constant bones.

Everything works on a :class:`Motion`: local rotations, a root path and which foot is planted when. Bones
stay constant because only rotations are blended; feet stay where they are planted because
:func:`realise` solves the legs after all blending (two-bone IK towards the place where each foot landed).
Headings are radians about Y, 0 along +Z and positive towards +X, as in ``webdemo.motion.transforms``.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d, maximum_filter1d
from scipy.spatial.transform import Rotation

from webdemo.motion.kinematics import fit_rotations, forward_kinematics, global_rotations
from webdemo.motion.skeleton import SMPL22
from webdemo.motion.transforms import heading, heading_matrix

Array = NDArray[np.floating]
FPS = 30
LEGS = tuple(
    tuple(SMPL22.index(f"{side}_{joint}") for joint in ("hip", "knee", "ankle", "foot"))
    for side in ("left", "right")
)
ARMS = {
    side: tuple(SMPL22.index(f"{side}_{joint}") for joint in ("collar", "shoulder", "elbow", "wrist"))
    for side in ("left", "right")
}
_MIRROR = np.diag([-1.0, 1.0, 1.0])
_GAZE = {"spine2": 0.12, "spine3": 0.18, "neck": 0.5}


@dataclass(frozen=True, eq=False)
class Motion:
    """One person's motion, ready to be cut, placed, joined and layered.

    Attributes:
        rotations: (T, 22, 3, 3) local rotations, the root's against the world.
        root: (T, 3) root path in metres.
        contacts: (T, 2) True where the left and the right foot are planted.
        sources: the files it comes from.
    """

    rotations: Array = field(repr=False)
    root: Array = field(repr=False)
    contacts: NDArray[np.bool_] = field(repr=False)
    sources: tuple[str, ...] = ()

    def __len__(self) -> int:
        return len(self.root)

    def __getitem__(self, frames: slice) -> Motion:
        return replace(
            self, rotations=self.rotations[frames], root=self.root[frames], contacts=self.contacts[frames]
        )

    @property
    def headings(self) -> Array:
        """(T,) unwrapped heading of the hips in radians."""
        across = self.rotations[:, 0, :, 0]
        return np.unwrap(np.arctan2(-across[:, 2], across[:, 0]))


def motion_from_positions(positions: Array, *, sources: tuple[str, ...] = ()) -> Motion:
    """A :class:`Motion` from (T, 22, 3) positions in metres with the floor at 0."""
    positions = np.asarray(positions, dtype=np.float64)
    return Motion(fit_rotations(positions), positions[:, 0].copy(), planted(positions), sources)


def planted(positions: Array, *, height: float = 0.055, speed: float = 0.3) -> NDArray[np.bool_]:
    """(T, 2) True where a foot rests on the floor: the toe low (metres) and slow (metres a second).

    Gaps and runs shorter than four frames are closed and dropped.
    """
    toes = positions[:, [LEGS[0][3], LEGS[1][3]]]
    moving = np.linalg.norm(np.gradient(gaussian_filter1d(toes, 1.0, axis=0), axis=0)[..., [0, 2]], axis=-1)
    resting = (toes[..., 1] - np.percentile(toes[..., 1], 3) < height) & (moving * FPS < speed)
    for foot in range(2):
        for value in (True, False):  # first close gaps, then drop short runs
            for start, stop in runs(resting[:, foot] != value):
                if stop - start < 4 and start > 0 and stop < len(resting):
                    resting[start:stop, foot] = value
    return resting


def runs(mask: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """(start, stop) of every stretch of True."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], mask, [False]]).astype(np.int8)))
    return [(int(a), int(b)) for a, b in zip(edges[::2], edges[1::2], strict=True)]


def mirror(motion: Motion) -> Motion:
    """The motion as a mirror in the plane X = 0 shows it: left and right exchanged."""
    swap = list(SMPL22.mirror)
    return replace(
        motion,
        rotations=_MIRROR @ motion.rotations[:, swap] @ _MIRROR,
        root=motion.root * np.array([-1.0, 1.0, 1.0]),
        contacts=motion.contacts[:, ::-1],
    )


def tempo(motion: Motion, scale: Array) -> Motion:
    """Scales how fast the root travels over the ground by ``scale`` (T,); feet are planted later."""
    steps = np.diff(motion.root, axis=0)
    steps[:, [0, 2]] *= np.asarray(scale)[:-1, None]
    root = np.concatenate([motion.root[:1], motion.root[:1] + np.cumsum(steps, axis=0)])
    return replace(motion, root=root)


def turned(motion: Motion, angle: float) -> Motion:
    """Turns the whole motion by ``angle`` radians about the world's vertical axis."""
    matrix = heading_matrix(angle)
    rotations = motion.rotations.copy()
    rotations[:, 0] = matrix @ rotations[:, 0]
    return replace(motion, rotations=rotations, root=motion.root @ matrix.T)


def facing_at(motion: Motion, frame: int, *, window: int = 5) -> float:
    """Heading in radians around a frame; averaged over a stride where the person walks."""
    frame = frame % len(motion)
    near = motion.root[max(frame - 8, 0) : frame + 9]
    if np.linalg.norm((near[-1] - near[0])[[0, 2]]) * FPS > 0.4 * len(near):
        window = 16
    return float(motion.headings[max(frame - window, 0) : frame + window + 1].mean())


def travel_heading(motion: Motion) -> float:
    """Heading of the straight line from the first to the last frame's root."""
    step = motion.root[-1] - motion.root[0]
    return float(np.arctan2(step[0], step[2]))


def place(
    motion: Motion, x: float, z: float, angle: float, *, frame: int = 0, along: str = "facing"
) -> Motion:
    """Moves a motion so that at ``frame`` its root is at (x, z) and it looks towards heading ``angle``.

    Args:
        along: "facing": the hips' heading at that frame counts; "travel": the line from start to end.
    """
    current = facing_at(motion, frame) if along == "facing" else travel_heading(motion)
    motion = turned(motion, angle - current)
    shift = np.array([x - motion.root[frame, 0], 0.0, z - motion.root[frame, 2]])
    return replace(motion, root=motion.root + shift)


def slerp(first: Array, second: Array, weight: Array) -> Array:
    """Rotations (…, 3, 3) a share ``weight`` (broadcast over the leading axes) of the way to ``second``.

    By Rodrigues' formula; rotations within a hundredth of a radian of a half turn apart have no shortest
    way, there the axis is found through quaternions.
    """
    relative = np.swapaxes(first, -1, -2) @ second
    trace = relative[..., 0, 0] + relative[..., 1, 1] + relative[..., 2, 2]
    skew = (relative - np.swapaxes(relative, -1, -2)) / 2
    angle = np.arctan2(
        np.sqrt(skew[..., 2, 1] ** 2 + skew[..., 0, 2] ** 2 + skew[..., 1, 0] ** 2), (trace - 1) / 2
    )
    sine = np.sin(angle)
    share = np.broadcast_to(weight, angle.shape) * angle
    axis = skew / np.where(sine > 1e-7, sine, 1.0)[..., None, None]
    half_turn = angle > np.pi - 0.01
    if half_turn.any():
        vectors = Rotation.from_matrix(relative[half_turn]).as_rotvec()
        x, y, z = (vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)).T
        zero = np.zeros_like(x)
        axis[half_turn] = np.stack([zero, -z, y, z, zero, -x, -y, x, zero], axis=-1).reshape(-1, 3, 3)
    part = np.sin(share)[..., None, None] * axis + (1 - np.cos(share))[..., None, None] * (axis @ axis)
    return first + first @ part


def ease(steps: int) -> Array:
    """(steps,) from just above 0 to just below 1 with zero slope and curvature at both ends."""
    t = (np.arange(steps) + 1.0) / (steps + 1.0)
    return t**3 * (10 + t * (6 * t - 15))


def time_warp(motion: Motion, rate: float) -> Motion:
    """Plays a motion ``rate`` times as fast (1.1 is 10 % shorter)."""
    frames = max(round((len(motion) - 1) / rate) + 1, 2)
    times = np.linspace(0, len(motion) - 1, frames)
    low = np.minimum(times.astype(int), len(motion) - 2)
    share = times - low
    root = motion.root[low] + share[:, None] * (motion.root[low + 1] - motion.root[low])
    return replace(
        motion,
        rotations=slerp(motion.rotations[low], motion.rotations[low + 1], share[:, None]),
        root=root,
        contacts=motion.contacts[np.round(times).astype(int)],
    )


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
    contacts = np.where(weight[:, None] < 0.5, first.contacts[tail], second.contacts[head])
    return Motion(
        np.concatenate([first.rotations[:-blend], rotations, second.rotations[blend:]]),
        np.concatenate([first.root[:-blend], root, second.root[blend:]]),
        np.concatenate([first.contacts[:-blend], contacts, second.contacts[blend:]]),
        tuple(dict.fromkeys(first.sources + second.sources)),
    )


def chain(*segments: Motion, blend: int = 12) -> Motion:
    """Several motions of one person after one another."""
    joined = segments[0]
    for segment in segments[1:]:
        joined = join(joined, segment, blend=blend)
    return joined


def steer(motion: Motion, extra: Array) -> Motion:
    """Bends the path: ``extra`` (T,) is how far, in radians, each frame is turned beyond the original."""
    matrices = heading_matrix(np.asarray(extra))
    rotations = motion.rotations.copy()
    rotations[:, 0] = matrices @ rotations[:, 0]
    steps = np.einsum("tij,tj->ti", matrices[:-1], np.diff(motion.root, axis=0))
    root = np.concatenate([motion.root[:1], motion.root[:1] + np.cumsum(steps, axis=0)])
    return replace(motion, rotations=rotations, root=root)


def drift(motion: Motion, offset: Array) -> Motion:
    """Adds (T, 3) metres to the root path, e.g. a weight shift; the planted feet stay."""
    return replace(motion, root=motion.root + offset)


def layer(base: Motion, over: Motion, *, start: int, joints: tuple[int, ...], blend: int = 10) -> Motion:
    """Plays some joints of ``over`` on top of ``base`` from frame ``start`` on, fading in and out."""
    frames = min(len(over), len(base) - start)
    blend = max(min(blend, frames // 2), 1)
    weight = np.ones(frames)
    weight[:blend], weight[frames - blend :] = ease(blend), ease(blend)[::-1]
    rotations = base.rotations.copy()
    inside, chosen = slice(start, start + frames), list(joints)
    rotations[inside, chosen] = slerp(
        base.rotations[inside, chosen], over.rotations[:frames, chosen], weight[:, None]
    )
    return replace(base, rotations=rotations, sources=tuple(dict.fromkeys(base.sources + over.sources)))


def lean(motion: Motion, angle: Array, *, towards: float = 0.0) -> Motion:
    """Bends the spine by ``angle`` (T,) radians towards a heading against the body's own (0: forward)."""
    axis = np.array([np.cos(towards), 0.0, -np.sin(towards)])
    rotations = motion.rotations.copy()
    bend = Rotation.from_rotvec(np.asarray(angle)[:, None] / 3 * axis).as_matrix()
    for joint in ("spine1", "spine2", "spine3"):
        rotations[:, SMPL22.index(joint)] = rotations[:, SMPL22.index(joint)] @ bend
    return replace(motion, rotations=rotations)


def look_at(motion: Motion, target: Array, *, amount: float = 0.8) -> Motion:
    """Turns neck and upper spine a little towards ``target`` (T, 3), up to 70°; nothing behind the back."""
    world = global_rotations(motion.rotations)
    forward = world[:, SMPL22.index("spine3")] @ np.array([0.0, 0.0, 1.0])
    wanted = target - motion.root
    angle = np.arctan2(wanted[:, 0], wanted[:, 2]) - np.arctan2(forward[:, 0], forward[:, 2])
    angle = (angle + np.pi) % (2 * np.pi) - np.pi
    seen = np.clip((np.radians(140) - np.abs(angle)) / np.radians(50), 0, 1)
    angle = gaussian_filter1d(np.clip(angle, -1.2, 1.2) * seen * amount, 5.0, mode="nearest")
    rotations = motion.rotations.copy()
    for name, share in _GAZE.items():
        joint = SMPL22.index(name)
        parent = world[:, SMPL22.parents[joint]]
        rotations[:, joint] = (
            np.swapaxes(parent, -1, -2) @ heading_matrix(angle * share) @ parent @ rotations[:, joint]
        )
    return replace(motion, rotations=rotations)


def loop(motion: Motion, frames: int, *, blend: int = 20) -> Motion:
    """A motion of at least ``frames`` frames made by playing this one again and again, cut to length."""
    looped = motion
    while len(looped) < frames:
        looped = join(looped, motion, blend=blend)
    return looped[:frames]


def realise(motion: Motion) -> Array:
    """(T, 22, 3) positions with planted feet: forward kinematics, then :func:`plant_feet`."""
    return plant_feet(forward_kinematics(motion.rotations, motion.root), motion.contacts)


def plant_feet(positions: Array, contacts: NDArray[np.bool_], *, stride: float = 0.18) -> Array:
    """Holds every planted foot where it landed by bending the leg; bones keep their length.

    A "planted" foot that travels more than ``stride`` metres (a blend between two stances) takes a step
    instead of sliding. The body sinks a little where a leg would otherwise be too short.

    Args:
        positions: (T, 22, 3) metres.
        contacts: (T, 2) left and right foot planted.
    """
    positions = positions.copy()
    toes = [positions[:, leg[3]] for leg in LEGS]
    steps = one_after_the_other([steps_in(toes[f], contacts[:, f], stride=stride) for f in (0, 1)])
    targets = []
    for foot, (_, _, ankle, toe) in enumerate(LEGS):
        shift = foot_shift(toes[foot], contacts[:, foot], steps[foot])
        below = np.maximum(-toes[foot][:, 1], 0.04 - positions[:, ankle, 1])
        shift[:, 1] += gaussian_filter1d(np.maximum(below, 0), 1.5)
        targets.append(positions[:, [ankle, toe]] + shift[:, None])
    sink = np.zeros(len(positions))
    for target, (hip, knee, ankle, _) in zip(targets, LEGS, strict=True):
        longest = 0.998 * (SMPL22.bone_lengths[knee] + SMPL22.bone_lengths[ankle])
        gap = positions[:, hip] - target[:, 0]
        height = np.sqrt(np.maximum(longest**2 - gap[:, 0] ** 2 - gap[:, 2] ** 2, 0.3))
        sink = np.maximum(sink, gap[:, 1] - height)
    positions[..., 1] -= gaussian_filter1d(maximum_filter1d(np.clip(sink, 0, 0.15), 9), 3.0)[:, None]
    forward = np.stack([np.sin(heading(positions)), np.zeros(len(positions)), np.cos(heading(positions))], -1)
    for target, (hip, knee, ankle, toe) in zip(targets, LEGS, strict=True):
        positions[:, knee], positions[:, ankle] = two_bone(
            positions[:, hip], positions[:, knee], positions[:, ankle], target[:, 0], forward
        )
        positions[:, toe] = positions[:, ankle] + target[:, 1] - target[:, 0]
    return positions


def steps_in(toe: Array, contact: NDArray[np.bool_], *, stride: float) -> list[int]:
    """Frames at which a "planted" foot is carried further than ``stride`` metres and so must step."""
    found, open_runs = [], runs(contact)
    while open_runs:
        start, stop = open_runs.pop()
        flat = toe[start:stop][:, [0, 2]]
        if stop - start < 4 or np.linalg.norm(np.ptp(flat, axis=0)) <= stride:
            continue
        speed = np.linalg.norm(np.gradient(flat, axis=0), axis=-1)
        middle = start + int(np.argmax(gaussian_filter1d(speed, 2.0)))
        found.append(middle)
        open_runs += [(start, middle - 8), (middle + 9, stop)]
    return sorted(found)


def one_after_the_other(steps: list[list[int]], *, apart: int = 12) -> list[list[int]]:
    """Step times of both feet, moved so that the two never step at once (``apart`` frames at least)."""
    left, right = (list(foot) for foot in steps)
    for i, one in enumerate(left):
        for j, other in enumerate(right):
            if abs(one - other) < apart:
                centre, sign = (one + other) / 2, 1 if one <= other else -1
                left[i], right[j] = int(centre - sign * apart / 2), int(centre + sign * apart / 2)
    return [left, right]


def foot_shift(toe: Array, contact: NDArray[np.bool_], steps: list[int], *, half: int = 6) -> Array:
    """(T, 3) how far a foot must move each frame so that it rests while planted; smooth in between.

    Args:
        toe: (T, 3) the toe before.
        contact: (T,) where it should rest.
        steps: frames around which it is lifted and set down elsewhere, ``half`` frames before to after.
    """
    contact = contact.copy()
    lift = np.zeros(len(toe))
    carried = np.zeros(len(toe), dtype=bool)
    for middle in steps:
        low, high = max(middle - half, 0), min(middle + half + 1, len(toe))
        contact[low:high] = False
        carried[max(middle - 14, 0) : middle + 15] = True
        lift[low:high] = np.maximum(lift[low:high], 0.05 * np.sin(np.linspace(0, np.pi, high - low)) ** 2)
    shift = np.zeros_like(toe)
    known = np.zeros(len(toe), dtype=bool)
    for start, stop in runs(contact):
        settled = ~carried[start:stop]
        rest = toe[start:stop][settled] if settled.any() else toe[start:stop]
        shift[start:stop] = (rest.mean(axis=0) - toe[start:stop]) * np.array([1.0, 0.0, 1.0])
        known[start:stop] = True
    if known.any():
        for start, stop in runs(~known):
            before = shift[start - 1] if start else shift[stop] if stop < len(toe) else 0.0
            after = shift[stop] if stop < len(toe) else before
            shift[start:stop] = before + ease(stop - start)[:, None] * (after - before)
    shift[:, 1] += lift
    return gaussian_filter1d(shift, 0.7, axis=0, mode="nearest")


def two_bone(root: Array, middle: Array, end: Array, target: Array, pole: Array) -> tuple[Array, Array]:
    """Two-bone IK: where the middle joint and the end go when the end should reach ``target``.

    All arguments (T, 3); the bend keeps to the plane in which the limb is bent now, and leans to ``pole``
    where the limb is nearly straight. A target out of reach is approached as far as the bones allow.

    Returns:
        (T, 3) middle joint and (T, 3) end; bone lengths are those of the input.
    """
    upper = np.linalg.norm(middle - root, axis=-1, keepdims=True)
    lower = np.linalg.norm(end - middle, axis=-1, keepdims=True)
    reach = target - root
    distance = np.linalg.norm(reach, axis=-1, keepdims=True)
    along = reach / np.maximum(distance, 1e-6)
    distance = np.clip(distance, np.abs(upper - lower) + 1e-3, (upper + lower) * 0.9995)
    old = end - root
    old = old / np.maximum(np.linalg.norm(old, axis=-1, keepdims=True), 1e-6)
    offset = middle - root
    offset = offset - np.sum(offset * old, axis=-1, keepdims=True) * old
    bend = offset + 0.03 * pole
    bend = bend - np.sum(bend * along, axis=-1, keepdims=True) * along
    bend = bend / np.maximum(np.linalg.norm(bend, axis=-1, keepdims=True), 1e-6)
    cosine = (upper**2 + distance**2 - lower**2) / (2 * distance)
    height = np.sqrt(np.maximum(upper**2 - cosine**2, 0))
    return root + along * cosine + bend * height, root + along * distance

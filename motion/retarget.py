"""Any rig's motion onto the 22 SMPL joints with their own constant bones.

Positions carry everything that is needed here, so rest poses that make no sense (Bandai Namco's, whose bones
all point along X) do no harm. Limbs keep the directions of the rig's bones. Pelvis, spine, chest and neck
are turned as frames made of an up and a left–right direction, measured against the rig's own rest pose
where that is a standing one. The root's path is scaled by leg length, so that steps fit the legs.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import overload

import numpy as np

from .cleaning import foot_contacts, plant_feet
from .clip import Clip, Duet
from .errors import InputError
from .guesses import Places, axis_of, find_up, leg_length, places_of, turn_of
from .ik import body_scale, fit_skeleton
from .kinematics import project_to_skeleton
from .rigs import BodyParts, RigMotion
from .skeleton import SMPL22
from .transforms import resample
from .vectors import FLAT, Array, square_frame, unit

_J = {name: index for index, name in enumerate(SMPL22.joint_names)}
_NO_BODY = 1e-3
"""Metres: joints that all lie closer together than this are no body."""
_LEG = float(SMPL22.bone_lengths[_J["left_knee"]] + SMPL22.bone_lengths[_J["left_ankle"]])
# Recorded feet are steadier than generated ones: pinning them only while they are slow preserves the moments
# of landing and lift-off.
_CONTACT_SPEED = 0.25
# The pitch of SMPL's foot (ankle to toe) when it stands flat, downwards.
_toe = SMPL22.offsets[_J["left_foot"]]
_FLAT_FOOT = float(np.arctan2(-_toe[1], np.hypot(_toe[0], _toe[2])))
# Where pelvis, spine1, spine2 and spine3 lie between the midpoint of the hips and the neck.
_spine = [float(-SMPL22.offsets[_J["left_hip"], 1])]
_spine += [float(SMPL22.bone_lengths[_J[name]]) for name in ("spine1", "spine2", "spine3", "neck")]
_STRAIGHT, _TALL = 0.9, 1.2
"""A rest pose stands if this share of the way from its ankles to its neck lies along one axis, and if that is so many
times the length of its legs."""
UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "inch": 0.0254}
"""Metres of each unit, the likeliest first."""
_LEGS = (0.59, 1.67)
"""Length of people's legs over that of an average person's."""
_BLOCK = 2048
"""Frames whose rotations are fitted at once."""
_SPINE_FRACTIONS = np.cumsum(_spine) / np.sum(_spine)


def retarget(rig: RigMotion, *, fps: float = 30.0, plant: bool = True) -> Clip:
    """Brings a rig's motion onto SMPL22, its feet on the floor at height 0.

    Args:
        rig: any humanoid rig with its motion.
        fps: frame rate of the result.
        plant: hold standing feet still and above the floor.

    Returns:
        a clip over the same place as in the file.

    Raises:
        InputError: if no human body is found in the rig.
    """
    return retarget_together([rig], fps=fps, plant=plant)[0]


def retarget_together(rigs: Sequence[RigMotion], *, fps: float = 30.0, plant: bool = True) -> tuple[Clip, ...]:
    """Brings rigs that share one world onto SMPL22, as :func:`retarget` does one: one scale, one floor, one length.

    Raises:
        InputError: if no human body is found in a rig.
    """
    scale = float(np.mean([leg_scale(rig) for rig in rigs]))
    people = [_on_smpl(rig, fps, scale) for rig in rigs]
    frames = min(len(person) for person in people)
    floor = np.array([0.0, min(_floor_height(person) for person in people), 0.0])
    return tuple(
        replace(_finished(person[:frames] - floor, fps, rig.name, plant), notes=rig.notes)
        for person, rig in zip(people, rigs, strict=True)
    )


@overload
def to_smpl(motion: Clip) -> Clip: ...
@overload
def to_smpl(motion: Duet) -> Duet: ...
def to_smpl(motion: Clip | Duet) -> Clip | Duet:
    """Brings joints of another known layout (SBU15, K3HI15, NTU25, CMU17) onto SMPL22's constant bones.

    A skeleton is fitted to the whole clip (:func:`~motion.ik.fit_skeleton`), then the feet are put
    on the floor and planted. Two people share one scale and one floor. SMPL22 comes back as it is.

    Raises:
        InputError: if all joints of a person lie in one place.
    """
    for clip in motion.people:
        if not np.ptp(clip.positions, axis=1).max() > _NO_BODY:
            raise InputError("All joints of a person lie in one place: export the motion with its bones.")
    if motion.skeleton.joint_names == SMPL22.joint_names:
        return motion
    lowest = min(float(clip.positions[..., 1].min()) for clip in motion.people)
    sources = [clip.positions.astype(np.float64) - np.array([0.0, lowest, 0.0]) for clip in motion.people]
    scale = float(np.mean([body_scale(source, motion.skeleton) for source in sources]))
    fitted = [fit_skeleton(source, motion.skeleton, fps=motion.fps, scale=scale).positions for source in sources]
    floor = min(_floor_height(person) for person in fitted)
    clips = [
        replace(_finished(person - np.array([0.0, floor, 0.0]), motion.fps, clip.name), notes=clip.notes)
        for person, clip in zip(fitted, motion.people, strict=True)
    ]
    return Duet(clips[0], clips[1], motion.roles, motion.manifest) if isinstance(motion, Duet) else clips[0]


def leg_scale(rig: RigMotion) -> float:
    """SMPL22's leg length over the rig's: what its path is multiplied by so that its steps fit the legs."""
    length = leg_length(places_of(rig))
    if not length > 0.05:
        raise InputError(f"{rig.name or 'The rig'} has legs of zero length: export it with its bones.")
    return _LEG / length


def in_metres(rigs: Sequence[RigMotion]) -> tuple[RigMotion, ...]:
    """Rigs of one file in metres, whose places are changed as they are.

    Its unit is the one of :data:`UNITS` in which the first one's legs are a person's, or what makes them so.
    """
    name = unit_of(places_of(rigs[0]))
    scale = UNITS[name] if name else leg_scale(rigs[0])
    for rig in rigs:
        rig.positions[:] *= scale
    return tuple(replace(rig, offsets=scale * rig.offsets, metres_per_unit=scale) for rig in rigs)


def unit_of(places: Places) -> str:
    """The first of :data:`UNITS` in which a person's legs are as long as people's; "" where there is none."""
    legs = leg_length(places)
    return next((unit for unit, metres in UNITS.items() if _LEGS[0] <= metres * legs / _LEG <= _LEGS[1]), "")


def _on_smpl(rig: RigMotion, fps: float, scale: float) -> Array:
    """(T, 22, 3) Y-up positions on SMPL22's bones at the new frame rate; the floor is the file's, scaled."""
    source = _bodies(rig.positions, rig.parts, turn_of(up_axis(rig)))
    positions = _transfer(source, _standing_rest(rig), scale)
    if rig.fps == fps:
        return positions
    # A spline between frames bends bones by fractions of a millimetre; rotations set them right.
    return _on_bones(resample(positions, rig.fps, fps))


def _on_bones(positions: Array) -> Array:
    """:func:`~motion.kinematics.project_to_skeleton`, some frames at a time to spare memory."""
    places = np.empty(positions.shape)
    for start in range(0, len(positions), _BLOCK):
        block = slice(start, start + _BLOCK)
        places[block], _ = project_to_skeleton(positions[block])
    return places


def _finished(positions: Array, fps: float, name: str, plant: bool = True) -> Clip:
    if plant:
        positions = plant_feet(positions, foot_contacts(positions, fps, speed=_CONTACT_SPEED))
    return Clip(_on_bones(positions), fps, name=name)


def up_axis(*rigs: RigMotion) -> str:
    """The axis of :data:`~motion.guesses.AXES` that is up for rigs of one world, as they say or :func:`find_up` finds.

    The usual axis is the one along which the rest pose stands; in a BVH its people may lie or crawl all the time.
    """
    first = rigs[0]
    if first.up is not None:
        return first.up
    return find_up([places_of(rig) for rig in rigs], rest_axis(first) or "y", firm=first.y_up)


def rest_axis(rig: RigMotion) -> str:
    """The axis along which a rig's rest pose stands; empty for one that does not stand."""
    rest = _bodies(rig.rest_positions()[None], rig.parts, np.eye(3))
    tall = np.mean([rest["neck"] - rest[f"{side}_ankle"] for side in ("left", "right")], axis=(0, 1))
    stands = np.abs(tall).max() > max(_STRAIGHT * np.linalg.norm(tall), _TALL * leg_length(rest))
    return axis_of(tall) if stands else ""


def _bodies(positions: Array, parts: BodyParts, upright: Array) -> dict[str, Array]:
    """(T, 3) of every part the rig has, turned ``upright`` (3, 3), by SMPL22's names.

    ``spine0``… are the joints of its spine.
    """
    bodies: dict[str, Array] = {name: positions[:, joint] @ upright.T for name, joint in parts.joints.items()}
    if not {"left_collar", "right_collar"} <= set(bodies):  # a single collar does not determine the chest
        bodies = {name: place for name, place in bodies.items() if not name.endswith("_collar")}
    for number, joint in enumerate(parts.spine):
        bodies[f"spine_{number}"] = positions[:, joint] @ upright.T
    bodies.setdefault("neck", (bodies["left_shoulder"] + bodies["right_shoulder"]) / 2)
    return bodies


def _standing_rest(rig: RigMotion) -> dict[str, Array] | None:
    """The rig's rest pose (1 frame), Y up and facing +Z, or ``None`` where it is not a standing one."""
    rest = rig.rest_positions()[None]
    bodies = _bodies(rest, rig.parts, np.eye(3))
    ankles = (bodies["left_ankle"] + bodies["right_ankle"]) / 2
    tall = (bodies["neck"] - ankles)[0]
    straight = np.abs(tall).max() > 0.97 * np.linalg.norm(tall) and np.linalg.norm(tall) > 0.7
    across = (bodies["left_hip"] - bodies["right_hip"])[0]
    if not straight or np.linalg.norm(across) < 0.05:
        return None
    bodies = _bodies(rest, rig.parts, turn_of(axis_of(tall)))
    frame = square_frame(np.array([[0.0, 1.0, 0.0]]), bodies["left_hip"] - bodies["right_hip"])[0]
    bodies = {name: place @ frame for name, place in bodies.items()}
    legs_down = all(
        (bodies[f"{s}_hip"] - bodies[f"{s}_ankle"])[0, 1] > 0.5 and (bodies["neck"] - bodies[f"{s}_hip"])[0, 1] > 0.2
        for s in ("left", "right")
    )
    return bodies if legs_down else None


def _trunk(bodies: dict[str, Array]) -> dict[str, Array]:
    """(T, 3, 3) world frames (left, up, forward as columns) of pelvis, spine1–3 and neck."""
    hips = (bodies["left_hip"] + bodies["right_hip"]) / 2
    # The pelvis joint itself (spine_0) lies at no agreed height, the hips do.
    chain = [hips, *(bodies[f"spine_{n}"] for n in range(1, 30) if f"spine_{n}" in bodies), bodies["neck"]]
    points = _along(np.stack(chain, axis=1), _SPINE_FRACTIONS[:-1])
    points = np.concatenate([hips[:, None], points[:, 1:], bodies["neck"][:, None]], axis=1)
    ups = np.diff(points, axis=1)  # pelvis, spine1, spine2, spine3
    across_hips = unit(bodies["left_hip"] - bodies["right_hip"])
    across_chest: Array = bodies["left_shoulder"] - bodies["right_shoulder"]
    if "left_collar" in bodies and "right_collar" in bodies:
        collars: Array = bodies["left_collar"] - bodies["right_collar"]
        if np.median(np.linalg.norm(collars, axis=-1)) > 0.06:
            across_chest = collars
    across_chest = unit(across_chest)
    frames = {}
    for number, name in enumerate(("pelvis", "spine1", "spine2", "spine3")):
        share = number / 3
        frames[name] = square_frame(ups[:, number], (1 - share) * across_hips + share * across_chest)
    head = bodies.get("head")
    frames["neck"] = frames["spine3"] if head is None else square_frame(head - bodies["neck"], across_chest)
    return frames


def _transfer(source: dict[str, Array], rest: dict[str, Array] | None, scale: float) -> Array:
    """(T, 22, 3) positions on SMPL22's bones, scaled; the floor is still where it was, scaled."""
    frames = _trunk(source)
    if rest is not None:
        # What the rig calls upright is upright: frames count from its rest pose.
        frames = {name: frame @ np.swapaxes(_trunk(rest)[name], -1, -2) for name, frame in frames.items()}

    count = len(source["neck"])
    result = np.zeros((count, SMPL22.num_joints, 3))
    offsets = SMPL22.offsets
    middle_of_hips = (offsets[_J["left_hip"]] + offsets[_J["right_hip"]]) / 2
    hips = (source["left_hip"] + source["right_hip"]) / 2
    result[:, 0] = hips * scale - frames["pelvis"] @ middle_of_hips
    for parent, joint in SMPL22.bones:
        name, parent_name = SMPL22.joint_names[joint], SMPL22.joint_names[parent]
        if parent_name in frames:
            bone = frames[parent_name] @ offsets[joint]
        else:
            bone = _limb_bone(source, name, parent_name, joint, frames)
        result[:, joint] = result[:, parent] + bone
    _level_feet(result, source, rest)
    return result


def _limb_bone(source: dict[str, Array], name: str, parent_name: str, joint: int, frames: dict[str, Array]) -> Array:
    length = SMPL22.bone_lengths[joint]
    if name.endswith("_shoulder"):
        if "left_collar" not in source:
            return frames["spine3"] @ SMPL22.offsets[joint]
        # Collars begin anywhere between the spine and halfway out; their middle is a place all rigs share.
        start = (source["left_collar"] + source["right_collar"]) / 2
        return unit(source[name] - start) * length
    if name not in source:  # a toe or wrist that the rig lacks
        return frames["pelvis"] @ SMPL22.offsets[joint]
    return unit(source[name] - source[parent_name]) * length


def _level_feet(result: Array, source: dict[str, Array], rest: dict[str, Array] | None) -> None:
    """Pitches feet so that the rig's flat foot is SMPL's flat foot, in place."""
    for side in ("left", "right"):
        ankle, toe = _J[f"{side}_ankle"], _J[f"{side}_foot"]
        if f"{side}_foot" not in source:
            continue
        bone = result[:, toe] - result[:, ankle]
        pitch = np.arctan2(-bone[:, 1], np.hypot(bone[:, 0], bone[:, 2]))
        if rest is not None:
            flat_bone = (rest[f"{side}_foot"] - rest[f"{side}_ankle"])[0]
            flat = np.arctan2(-flat_bone[1], np.hypot(flat_bone[0], flat_bone[2]))
        else:
            # A foot is flat where it stands: low and slow.
            places = source[f"{side}_ankle"]
            speed = np.linalg.norm(np.gradient(places, axis=0), axis=-1) if len(places) > 1 else np.zeros(1)
            low = places[:, 1] <= np.quantile(places[:, 1], 0.5)
            slow = speed <= np.quantile(speed[low], 0.5)
            flat = np.median(pitch[low & slow])
        correction = np.clip(_FLAT_FOOT - flat, -0.5, 0.5)
        horizontal = unit(bone * FLAT)
        length = np.linalg.norm(bone, axis=-1, keepdims=True)
        new_pitch = (pitch + correction)[:, None]
        down = np.array([0.0, -1.0, 0.0])
        result[:, toe] = result[:, ankle] + length * (np.cos(new_pitch) * horizontal + np.sin(new_pitch) * down)


def _floor_height(positions: Array) -> float:
    """Height of the floor: a low quantile of the lower foot, robust to single bad frames."""
    feet = positions[:, [_J["left_foot"], _J["right_foot"], _J["left_ankle"], _J["right_ankle"]], 1]
    return float(np.quantile(feet.min(axis=-1), 0.05))


def _along(points: Array, fractions: Array) -> Array:
    """(T, F, 3) places at fractions of the length of polylines (T, P, 3)."""
    lengths = np.median(np.linalg.norm(np.diff(points, axis=1), axis=-1), axis=0)
    at = np.concatenate([[0.0], np.cumsum(lengths)])
    at = at / max(at[-1], 1e-9)
    segment = np.clip(np.searchsorted(at, fractions, side="right") - 1, 0, len(lengths) - 1)
    share = (fractions - at[segment]) / np.maximum(at[segment + 1] - at[segment], 1e-9)
    return points[:, segment] + share[:, None] * (points[:, segment + 1] - points[:, segment])

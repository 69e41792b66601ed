"""BVH files as other programs would write them, from a motion whose truth is known."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from motion import SMPL22

_CENTRE = ("pelvis", "spine1", "spine2", "spine3", "neck", "head")
_SIDED = ("collar", "shoulder", "elbow", "wrist", "hip", "knee", "ankle", "foot")


def _rig(centre: str, limbs: str, side: str, before: str = "") -> dict[str, str]:
    """Names by SMPL22's names.

    Args:
        centre: from pelvis to head, "-" for a joint that the rig lacks.
        limbs: the parts of a side, from collar to wrist and from hip to foot.
        side: a pattern with {part} and {Side} (Left), {S} (L), {s} (l) or {字} (左).
        before: what the names of the centre begin with.
    """
    names = dict(zip(_CENTRE, (f"{before}{name}" * (name != "-") for name in centre.split()), strict=True))
    for which in ("left", "right"):
        sided = {
            "Side": which.title(),
            "S": which[0].upper(),
            "s": which[0],
            "字": {"left": "左", "right": "右"}[which],
        }
        for part, name in zip(_SIDED, limbs.split(), strict=True):
            names[f"{which}_{part}"] = side.format(**sided, part=name)
    return {ours: theirs for ours, theirs in names.items() if theirs}


_SPINE, _LIMBS = "Hips Spine Spine1 Spine2 Neck Head", "Shoulder Arm ForeArm Hand UpLeg Leg Foot ToeBase"
_GENESIS = "hip abdomenLower chestLower chestUpper neckLower head"
_SUFFIXED = "Hips_Bob Spine_Bob Spine1_Bob Spine2_Bob Neck_Bob Head_Bob"
_UPPER = "Shoulder UpperArm LowerArm Hand UpperLeg LowerLeg Foot Toes"
_JOINTS = "Collar Shoulder Elbow Wrist Hip Knee Ankle"
_STRETCHED = "shoulder arm_stretch forearm_stretch hand thigh_stretch leg_stretch foot toes_01"
_BENT = "Collar ShldrBend ForearmBend Hand ThighBend Shin Foot Toe"
_UNREAL = "clavicle upperarm lowerarm hand thigh calf foot ball"
_BIPED = "Clavicle UpperArm Forearm Hand Thigh Calf Foot Toe0"
RIGS = {
    "bandai-namco": _rig("Hips Spine - Chest Neck Head", _UPPER, "{part}_{S}"),
    "mixamo": _rig(_SPINE, _LIMBS, "mixamorig:{Side}{part}", "mixamorig:"),
    "motionbuilder": _rig(_SPINE, _LIMBS.replace("ToeBase", "Toe"), "{Side}{part}"),
    "cmu": _rig(
        "root lowerback upperback thorax lowerneck head",
        "clavicle humerus radius wrist femur tibia foot toes",
        "{s}{part}",
    ),
    "xsens": _rig("Hips Chest Chest2 Chest4 Neck Head", f"{_JOINTS} Toe", "{Side}{part}"),
    "rokoko": _rig(
        "Hips Spine1 Spine2 Spine4 Neck Head", "Shoulder Arm ForeArm Hand Thigh Shin Foot Toe", "{Side}{part}"
    ),
    "reactidle": _rig(
        "pelvis spine - spine.001 neck face", "shoulder upper_arm forearm hand thigh shin foot toe", "{part}.{S}"
    ),
    "unreal": _rig("pelvis spine_01 spine_02 spine_03 neck_01 head", _UNREAL, "{part}_{s}"),
    "biped": _rig("Pelvis Spine Spine1 Spine2 Neck Head", _BIPED, "Bip01 {S} {part}", "Bip01 "),
    "kinect": _rig("SpineBase - - SpineMid Neck Head", f"{_JOINTS} Foot", "{part}{Side}"),
    "optitrack": _rig("Hip Ab - Chest Neck Head", "Shoulder UArm FArm Hand Thigh Shin Foot Toe", "{S}{part}"),
    "daz-genesis-8": _rig(_GENESIS, _BENT, "{s}{part}"),
    "auto-rig": _rig("root.x spine_01.x spine_02.x spine_03.x neck.x head.x", _STRETCHED, "{part}.{s}"),
    "a prefix": _rig(_SPINE, _LIMBS, "Zoë{Side}{part}", "Zoë "),
    "a suffix": _rig(_SUFFIXED, _LIMBS, "{Side}{part}_Bob"),
    "mikumikudance": _rig("センター 上半身 - 上半身2 首 頭", "肩 腕 ひじ 手首 足 ひざ 足首 つま先", "{字}{part}"),
}
RIGS["capitals"] = {joint: name.upper() for joint, name in RIGS["motionbuilder"].items()}


def bvh_text(
    rotations: np.ndarray,
    root: np.ndarray,
    names: dict[str, str] | None = None,
    *,
    unit: float = 100.0,
    order: str = "ZXY",
    positions_everywhere: bool = False,
    z_up: bool = False,
    frame_time: float = 1 / 30,
) -> str:
    """A BVH of SMPL22's motion.

    Args:
        rotations: (T, 22, 3, 3) local rotations; those of joints without a name must be identity.
        root: (T, 3) metres.
        names: the rig's names by SMPL22's; joints left out are merged into their parents.
        unit: file units a metre.
        order: of the rotation channels.
        positions_everywhere: give every joint position channels, and an OFFSET that makes no sense.
        z_up: write a Z-up world.
    """
    names = names or {name: name for name in SMPL22.joint_names}
    kept = [joint for joint, name in enumerate(SMPL22.joint_names) if name in names]
    rest = SMPL22.rest_positions()
    parent_of = {}
    for joint in kept:
        parent = SMPL22.parents[joint]
        while parent >= 0 and parent not in kept:
            parent = SMPL22.parents[parent]
        parent_of[joint] = parent
    tilt = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]) if z_up else np.eye(3)
    lines, columns = ["HIERARCHY"], []

    def write(joint: int, depth: int) -> None:
        parent = parent_of[joint]
        offset = np.zeros(3) if parent < 0 else (rest[joint] - rest[parent]) @ tilt.T
        has_positions = parent < 0 or positions_everywhere
        shown = offset * unit * (0.5 if positions_everywhere else 1)
        lines.append(f"{'JOINT' if depth else 'ROOT'} {names[SMPL22.joint_names[joint]]}")
        lines.extend(["{", "OFFSET " + " ".join(f"{v:.6f}" for v in shown)])
        channels = ["Xposition", "Yposition", "Zposition"] * has_positions + [f"{axis}rotation" for axis in order]
        lines.append(f"CHANNELS {len(channels)} " + " ".join(channels))
        if has_positions:
            place = root @ tilt.T if parent < 0 else np.tile(offset, (len(root), 1))
            columns.append(place * unit)
        local = rotations[:, joint]
        local = tilt @ local @ tilt.T
        columns.append(Rotation.from_matrix(local).as_euler(order, degrees=True))
        children = [child for child in kept if parent_of[child] == joint]
        for child in children:
            write(child, depth + 1)
        if not children:
            tip = np.array([0, -0.02, 0.05]) @ tilt.T * unit
            lines.extend(["End Site", "{", "OFFSET " + " ".join(f"{v:.6f}" for v in tip), "}"])
        lines.append("}")

    write(0, 0)
    values = np.concatenate(columns, axis=1)
    lines += ["MOTION", f"Frames: {len(values)}", f"Frame Time: {frame_time:.7f}"]
    lines += [" ".join(f"{v:.6f}" for v in row) for row in values]
    return "\n".join(lines) + "\n"

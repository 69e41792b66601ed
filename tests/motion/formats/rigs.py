"""BVH files as other programs would write them, from a motion whose truth is known."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from motion import SMPL22

_SIDED = ("collar", "shoulder", "elbow", "wrist", "hip", "knee", "ankle", "foot")


def _rig(centre: dict[str, str], limbs: tuple[str, ...], side: str) -> dict[str, str]:
    """Names by SMPL22's names; ``side`` is a pattern with {side} (Left/left/L/l) and {part}."""
    names = dict(centre)
    for which in ("left", "right"):
        for part, name in zip(_SIDED, limbs, strict=True):
            names[f"{which}_{part}"] = side.format(
                Side=which.title(), side=which, S=which[0].upper(), s=which[0], part=name
            )
    return names


def _centre(*names: str) -> dict[str, str]:
    return dict(zip(("pelvis", "spine1", "spine2", "spine3", "neck", "head"), names, strict=True))


_MIXAMO_LIMBS = ("Shoulder", "Arm", "ForeArm", "Hand", "UpLeg", "Leg", "Foot", "ToeBase")

RIGS = {
    "bandai-namco": _rig(
        {"pelvis": "Hips", "spine1": "Spine", "spine3": "Chest", "neck": "Neck", "head": "Head"},
        ("Shoulder", "UpperArm", "LowerArm", "Hand", "UpperLeg", "LowerLeg", "Foot", "Toes"),
        "{part}_{S}",
    ),
    "mixamo": _rig(
        {
            "pelvis": "mixamorig:Hips",
            "spine1": "mixamorig:Spine",
            "spine2": "mixamorig:Spine1",
            "spine3": "mixamorig:Spine2",
            "neck": "mixamorig:Neck",
            "head": "mixamorig:Head",
        },
        _MIXAMO_LIMBS,
        "mixamorig:{Side}{part}",
    ),
    "motionbuilder": _rig(
        _centre("Hips", "Spine", "Spine1", "Spine2", "Neck", "Head"),
        ("Shoulder", "Arm", "ForeArm", "Hand", "UpLeg", "Leg", "Foot", "Toe"),
        "{Side}{part}",
    ),
    "cmu": _rig(
        _centre("root", "lowerback", "upperback", "thorax", "lowerneck", "head"),
        ("clavicle", "humerus", "radius", "wrist", "femur", "tibia", "foot", "toes"),
        "{s}{part}",
    ),
    "xsens": _rig(
        _centre("Hips", "Chest", "Chest2", "Chest4", "Neck", "Head"),
        ("Collar", "Shoulder", "Elbow", "Wrist", "Hip", "Knee", "Ankle", "Toe"),
        "{Side}{part}",
    ),
    "rokoko": _rig(
        _centre("Hips", "Spine1", "Spine2", "Spine4", "Neck", "Head"),
        ("Shoulder", "Arm", "ForeArm", "Hand", "Thigh", "Shin", "Foot", "Toe"),
        "{Side}{part}",
    ),
    "reactidle": _rig(
        {"pelvis": "pelvis", "spine1": "spine", "spine3": "spine.001", "neck": "neck", "head": "face"},
        ("shoulder", "upper_arm", "forearm", "hand", "thigh", "shin", "foot", "toe"),
        "{part}.{S}",
    ),
    "unreal": _rig(
        _centre("pelvis", "spine_01", "spine_02", "spine_03", "neck_01", "head"),
        ("clavicle", "upperarm", "lowerarm", "hand", "thigh", "calf", "foot", "ball"),
        "{part}_{s}",
    ),
    "biped": _rig(
        _centre("Bip01 Pelvis", "Bip01 Spine", "Bip01 Spine1", "Bip01 Spine2", "Bip01 Neck", "Bip01 Head"),
        ("Clavicle", "UpperArm", "Forearm", "Hand", "Thigh", "Calf", "Foot", "Toe0"),
        "Bip01 {S} {part}",
    ),
    "kinect": _rig(
        {"pelvis": "SpineBase", "spine3": "SpineMid", "neck": "Neck", "head": "Head"},
        ("Collar", "Shoulder", "Elbow", "Wrist", "Hip", "Knee", "Ankle", "Foot"),
        "{part}{Side}",
    ),
    "optitrack": _rig(
        {"pelvis": "Hip", "spine1": "Ab", "spine3": "Chest", "neck": "Neck", "head": "Head"},
        ("Shoulder", "UArm", "FArm", "Hand", "Thigh", "Shin", "Foot", "Toe"),
        "{S}{part}",
    ),
    "daz-genesis-8": _rig(
        _centre("hip", "abdomenLower", "chestLower", "chestUpper", "neckLower", "head"),
        ("Collar", "ShldrBend", "ForearmBend", "Hand", "ThighBend", "Shin", "Foot", "Toe"),
        "{s}{part}",
    ),
    "auto-rig": _rig(
        _centre("root.x", "spine_01.x", "spine_02.x", "spine_03.x", "neck.x", "head.x"),
        ("shoulder", "arm_stretch", "forearm_stretch", "hand", "thigh_stretch", "leg_stretch", "foot", "toes_01"),
        "{part}.{s}",
    ),
    "a prefix": _rig(
        _centre("Zoë Hips", "Zoë Spine", "Zoë Spine1", "Zoë Spine2", "Zoë Neck", "Zoë Head"),
        _MIXAMO_LIMBS,
        "Zoë{Side}{part}",
    ),
    "a suffix": _rig(
        _centre("Hips_Bob", "Spine_Bob", "Spine1_Bob", "Spine2_Bob", "Neck_Bob", "Head_Bob"),
        _MIXAMO_LIMBS,
        "{Side}{part}_Bob",
    ),
    "mikumikudance": {
        "pelvis": "センター",
        "spine1": "上半身",
        "spine3": "上半身2",
        "neck": "首",
        "head": "頭",
        **{
            f"{side}_{part}": letter + name
            for side, letter in (("left", "左"), ("right", "右"))
            for part, name in zip(_SIDED, ("肩", "腕", "ひじ", "手首", "足", "ひざ", "足首", "つま先"), strict=True)
        },
    },
}


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

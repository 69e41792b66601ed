"""Two people as two BVH files in one world, each with a standing T-pose as its rest pose."""

from __future__ import annotations

import warnings
from pathlib import Path

import numpy as np
import scipy  # its parts are loaded with their first use
from numpy.typing import NDArray

from motion.clip import Clip, Duet
from motion.skeleton import SMPL22

from .files import check_smpl, write_files
from .skinned import rigged

Array = NDArray[np.floating]

# Where the chains end beyond the last joints, in metres: the crown, the finger tips and the toe tips.
_TIPS = {
    "head": (0.0, 0.18, 0.02),
    "left_wrist": (0.17, 0.0, 0.0),
    "right_wrist": (-0.17, 0.0, 0.0),
    "left_foot": (0.01, -0.01, 0.07),
    "right_foot": (-0.01, -0.01, 0.07),
}


def write_bvh(duet: Duet, path: str | Path) -> list[Path]:
    """Writes ``NAME_a.bvh`` and ``NAME_b.bvh`` beside each other for a path ``NAME.bvh``.

    Metres, Y up, both in the duet's world; only the root has position channels and an OFFSET of zero, so
    that readers which add it and readers which replace it agree. Bones have each person's own lengths.

    Returns:
        the two paths.

    Raises:
        InputError: for people who are not on SMPL22, or where the files cannot be written.
    """
    path = Path(path)
    stem = path.name[: -len(".bvh")] if path.name.lower().endswith(".bvh") else path.name
    files = {path.with_name(f"{stem}_{letter}.bvh"): clip for letter, clip in zip("ab", duet.people, strict=True)}
    return write_files({file: bvh_text(clip).encode("ascii") for file, clip in files.items()})


def bvh_text(clip: Clip) -> str:
    """One person's BVH."""
    check_smpl(clip, "BVH")
    positions = clip.positions.astype(np.float64)
    rotations, offsets = rigged(clip)
    order: list[int] = []
    lines = ["HIERARCHY"]
    _write_joint(0, 0, offsets, lines, order)
    with warnings.catch_warnings():
        # In gimbal lock any split between two of the angles is right.
        warnings.simplefilter("ignore")
        angles = scipy.spatial.transform.Rotation.from_matrix(rotations[:, order].reshape(-1, 3, 3)).as_euler(
            "ZXY", degrees=True
        )
    angles = np.unwrap(angles.reshape(len(positions), -1), axis=0, period=360.0)
    values = np.concatenate([positions[:, 0], angles], axis=-1)
    lines += ["MOTION", f"Frames: {len(values)}", f"Frame Time: {1.0 / clip.fps:.8f}"]
    pattern = " ".join(["%.6f"] * values.shape[1])
    lines += [pattern % tuple(row) for row in values.tolist()]
    return "\n".join(lines) + "\n"


def _write_joint(joint: int, depth: int, offsets: Array, lines: list[str], order: list[int]) -> None:
    tab, inner = "\t" * depth, "\t" * (depth + 1)
    name = SMPL22.joint_names[joint]
    order.append(joint)
    lines += [f"{tab}{'JOINT' if depth else 'ROOT'} {name}", f"{tab}{{"]
    lines.append(f"{inner}OFFSET {_numbers(offsets[joint])}")
    positions = "" if depth else "Xposition Yposition Zposition "
    lines.append(f"{inner}CHANNELS {3 if depth else 6} {positions}Zrotation Xrotation Yrotation")
    for child in SMPL22.children[joint]:
        _write_joint(child, depth + 1, offsets, lines, order)
    if not SMPL22.children[joint]:
        lines += [f"{inner}End Site", f"{inner}{{", f"{inner}\tOFFSET {_numbers(_TIPS[name])}", f"{inner}}}"]
    lines.append(f"{tab}}}")


def _numbers(values: Array | tuple[float, ...]) -> str:
    return " ".join(f"{value:.6f}" for value in values)

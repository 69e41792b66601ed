"""Motion as other programs write it: Kinect text, .trc, .c3d, Inter-X, InterHuman and archives."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Mapping

import c3d
import numpy as np
from scipy.spatial.transform import Rotation

from motion import SMPL22
from motion.formats.smpl import PELVIS
from motion.kinematics import fit_rotations
from tests.motion.bodies import marching

JOINT = dict(zip(SMPL22.joint_names, marching(24)[0].swapaxes(0, 1), strict=True))
"""Places (24, 3) by joint."""
TO_Z_UP = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])


def skeleton_text(people: np.ndarray, missing: dict[int, set[int]] | None = None) -> str:
    """(P, T, 25, 3) as NTU RGB+D writes it; ``missing``: the frames that lack a person."""
    lines = [str(people.shape[1])]
    for frame in range(people.shape[1]):
        here = [p for p in range(len(people)) if frame not in (missing or {}).get(p, ())]
        lines.append(str(len(here)))
        for person in here:
            lines += [f"7205759403792{person} 0 1 1 1 1 0 0.02 -0.2 2", "25"]
            lines += [" ".join(map(str, xyz)) + " 0 0 0 0 0 0 0 0 2" for xyz in people[person, frame]]
    return "\n".join(lines)


def sbu_text(raw: np.ndarray) -> str:
    """(T, 90) numbers between 0 and 1 as SBU writes them."""
    return "\n".join(f"{i + 1}," + ",".join(f"{v:.6f}" for v in row) for i, row in enumerate(raw))


def keypoints() -> dict[str, np.ndarray]:
    """Pose2Sim's names of a body's joints, (T, 3) metres, Y up."""
    names = {"foot": "BigToe"}
    sided = {
        f"{side[0].upper()}{names.get(part, part.title())}": JOINT[f"{side}_{part}"]
        for side in ("left", "right")
        for part in ("hip", "knee", "ankle", "foot", "shoulder", "elbow", "wrist")
    }
    return {**sided, "Neck": JOINT["neck"], "Head": JOINT["head"]}


def trc_text(points: Mapping[str, np.ndarray], *, rate: object = 30, unit: str = "m", scale: float = 1.0) -> str:
    """A .trc file as OpenSim writes it."""
    names, frames = list(points), len(next(iter(points.values())))
    head = [
        "PathFileType\t4\t(X/Y/Z)\ttest.trc",
        "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames",
        f"{rate}\t{rate}\t{frames}\t{len(names)}\t{unit}\t{rate}\t1\t{frames}",
        "Frame#\tTime\t" + "\t\t\t".join(names) + "\t\t",
        "\t\t" + "\t".join(f"X{n}\tY{n}\tZ{n}" for n in range(1, len(names) + 1)),
    ]
    for frame in range(frames):
        values = [value * scale for name in names for value in points[name][frame]]
        cells = ["" if np.isnan(value) else f"{value:.5f}" for value in values]
        head.append("\t".join([str(frame + 1), f"{frame / 30:.4f}", *cells]))
    return "\n".join(head) + "\n"


def c3d_bytes(points: Mapping[str, np.ndarray], *, scale: float = -1.0) -> bytes:
    """A .c3d file of points (T, 3) in metres, in millimetres and Z up, as laboratories record.

    The numbers are floats, or whole ones of a ``scale`` above 0.
    """
    writer = c3d.Writer(point_rate=100.0, point_scale=scale)
    writer.set_point_labels(list(points))
    stacked = np.stack(list(points.values()), axis=1) @ TO_Z_UP.T * 1000.0
    for frame in stacked:
        row = np.zeros((len(points), 5), dtype=np.float32)
        row[:, :3] = np.nan_to_num(frame)
        row[:, 3] = np.where(np.isnan(frame).any(-1), -1.0, 0.0)
        writer.add_frames([(row, np.zeros((0, 0)))])
    buffer = io.BytesIO()
    writer.write(buffer)
    return buffer.getvalue()


def interx(positions: np.ndarray, *, z_up: bool = True, flat: bool = True) -> dict[str, np.ndarray]:
    """Inter-X' arrays of a motion on SMPL22's bones."""
    turn = TO_Z_UP if z_up else np.eye(3)
    rotations = fit_rotations(positions)
    rotations[:, 0] = turn @ rotations[:, 0]
    vectors = Rotation.from_matrix(rotations.reshape(-1, 3, 3)).as_rotvec().reshape(-1, 22, 3)
    body = vectors[:, 1:].reshape(len(positions), 63) if flat else vectors[:, 1:]
    return {
        "root_orient": vectors[:, 0],
        "pose_body": body,
        "trans": positions[:, 0] @ turn.T - PELVIS,
        "pose_lhand": np.zeros((len(positions), 45)),
        "betas": np.ones((1, 10)),
        "gender": np.array("male"),
    }


def interhuman(positions: np.ndarray) -> np.ndarray:
    """(T, 492) of InterHuman: 62 joints, Z up, then 51 rotations."""
    frames = np.random.default_rng(0).normal(size=(len(positions), 492)).astype(np.float32)
    frames[:, :66] = (positions @ TO_Z_UP.T).reshape(-1, 66)
    return frames


def zipped(parts: dict[str, bytes]) -> bytes:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in parts.items():
            archive.writestr(name, data)
    return buffer.getvalue()

"""DeepMimic's captured clips (Peng et al. 2018): JSON rows of a root path and joint rotations."""

from __future__ import annotations

import json

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation, Slerp

from motion import InputError
from motion.rigs import RigMotion

Array = NDArray[np.floating]

# Name, parent, offset in metres (X ahead, Y up, Z to the right) and width in numbers of each joint, in the
# order of a row; sizes from the data set's own humanoid3d.txt.
_JOINTS = (
    ("Hips", -1, (0.0, 0.0, 0.0), 4),
    ("Spine", 0, (0.0, 0.236151, 0.0), 4),
    ("Neck", 1, (0.0, 0.223894, 0.0), 4),
    ("RightUpLeg", 0, (0.0, 0.0, 0.084887), 4),
    ("RightLeg", 3, (0.0, -0.421546, 0.0), 1),
    ("RightFoot", 4, (0.0, -0.409870, 0.0), 4),
    ("RightArm", 1, (-0.024050, 0.243500, 0.183110), 4),
    ("RightForeArm", 6, (0.0, -0.274788, 0.0), 1),
    ("LeftUpLeg", 0, (0.0, 0.0, -0.084887), 4),
    ("LeftLeg", 8, (0.0, -0.421546, 0.0), 1),
    ("LeftFoot", 9, (0.0, -0.409870, 0.0), 4),
    ("LeftArm", 1, (-0.024050, 0.243500, -0.183110), 4),
    ("LeftForeArm", 11, (0.0, -0.274788, 0.0), 1),
)
_TIPS = (
    ("Head", 2, (0.0, 0.175, 0.0)),
    ("RightHand", 7, (0.0, -0.258947, 0.0)),
    ("LeftHand", 12, (0.0, -0.258947, 0.0)),
    ("RightToeBase", 5, (0.12, -0.055, 0.0)),
    ("LeftToeBase", 10, (0.12, -0.055, 0.0)),
)
WIDTH = 1 + 3 + sum(joint[3] for joint in _JOINTS)


def read_deepmimic(data: bytes, *, name: str = "", fps: float = 30.0) -> RigMotion:
    """Reads one clip; knees and elbows are angles about the axis to the right, the rest quaternions w x y z.

    Raises:
        InputError: where the rows are not :data:`WIDTH` finite numbers each, with seconds above 0.
    """
    try:
        rows = np.array(json.loads(data)["Frames"], dtype=np.float64)
    except (ValueError, KeyError, TypeError, UnicodeDecodeError) as error:
        raise InputError(f"{name} is no DeepMimic motion ({error}): it needs JSON with 'Frames'.") from error
    if rows.ndim != 2 or rows.shape[1] != WIDTH or len(rows) < 2 or not np.isfinite(rows).all():
        raise InputError(f"{name} is no DeepMimic motion: it needs two rows or more of {WIDTH} numbers.")
    if not (rows[:-1, 0] > 0).all():
        raise InputError(f"{name} has a frame that lasts no time: give every row its seconds.")
    times = np.concatenate([[0.0], np.cumsum(rows[:-1, 0])])
    grid = np.minimum(np.arange(0.0, times[-1] + 1e-6, 1 / fps), times[-1])
    root = np.stack([np.interp(grid, times, rows[:, column]) for column in (1, 2, 3)], axis=-1)
    turns, column = [], 4
    for _, _, _, width in _JOINTS:
        part = rows[:, column : column + width]
        turn = (
            Rotation.from_rotvec(part * np.array([[0.0, 0.0, 1.0]]))
            if width == 1
            else Rotation.from_quat(part[:, [1, 2, 3, 0]])
        )
        turns.append(Slerp(times, turn)(grid).as_matrix())
        column += width
    joints = [(n, p, o) for n, p, o, _ in _JOINTS] + list(_TIPS)
    places = np.empty((len(grid), len(joints), 3))
    world: list[Array] = []
    for index, (_, parent, offset) in enumerate(joints):
        if parent < 0:
            places[:, index] = root
        else:
            places[:, index] = places[:, parent] + world[parent] @ np.array(offset)
        own = turns[index] if index < len(turns) else np.eye(3)
        world.append(own if parent < 0 else world[parent] @ own)
    offsets = np.array([offset for _, _, offset in joints])
    return RigMotion(
        tuple(n for n, _, _ in joints), tuple(p for _, p, _ in joints), offsets, places, None, fps, name=name, up="y"
    )

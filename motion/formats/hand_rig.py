"""The joints of fingers in exported files: 30 more below the wrists, in the order of :class:`motion.hands.Fingers`."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from motion.body import Body
from motion.hands import FINGERS, SIDES
from motion.skeleton import SMPL22

Array = NDArray[np.floating]

FINGER_JOINTS = tuple(f"{side}_{finger}{k}" for side in SIDES for finger in FINGERS for k in (1, 2, 3))
"""Their names, such as "left_index2"."""
PARENTS = tuple(
    SMPL22.index(f"{side}_wrist") if k == 0 else SMPL22.num_joints + 15 * s + 3 * f + k - 1
    for s, side in enumerate(SIDES)
    for f in range(len(FINGERS))
    for k in range(3)
)
"""The joint above each, where SMPL22's come first."""
_WRISTS = np.array([SMPL22.index(f"{side}_wrist") for side in SIDES])


@dataclass(frozen=True, eq=False)
class HandRig:
    """The 30 finger joints that hang on a body's wrists.

    Attributes:
        offsets: (30, 3) metres from the joint above, in the T-pose.
        joints: (30, 3) places in the pose of binding.
        turns: (30, 3, 3) rotations from the pose of binding to the T-pose: their wrist's.
        bones: (V, 4) joints that move each vertex of the body, of SMPL22's and these.
        weights: (V, 4) their shares.
    """

    offsets: Array
    joints: Array
    turns: Array
    bones: NDArray[np.integer]
    weights: Array

    @classmethod
    def of(cls, body: Body) -> HandRig:
        """The rig of a body that has fingers."""
        assert body.fingers is not None
        joints = body.fingers.joints.reshape(30, 3)
        turns = np.repeat(body.turns[_WRISTS], 15, axis=0)
        above = np.concatenate([body.joints, joints])[list(PARENTS)]
        offsets = np.einsum("jik,jk->ji", turns, joints - above)
        return cls(offsets, joints, turns, *_bindings(body))

    def rotations(self, body: Body, shapes: Array) -> Array:
        """(T, 30, 3, 3) of each joint against the one above it, for finger shapes (T, 2, 20)."""
        assert body.fingers is not None
        local = body.fingers.local(shapes).reshape(-1, 30, 3, 3)
        return self.turns @ local @ np.swapaxes(self.turns, -1, -2)


def _bindings(body: Body) -> tuple[NDArray[np.integer], Array]:
    """(V, 4) joints and (V, 4) shares, with the fingers' in place of a part of the wrists'."""
    fingers = body.fingers
    assert fingers is not None
    count = SMPL22.num_joints
    rows = np.arange(len(fingers.vertices))[:, None]
    dense = np.zeros((len(fingers.vertices), count + 30))
    np.add.at(dense, (rows, body.bones[fingers.vertices]), body.weights[fingers.vertices])
    dense *= 1.0 - fingers.weights.sum(axis=1, keepdims=True)
    np.add.at(dense, (rows, count + fingers.bones), fingers.weights)
    order = np.argsort(-dense, axis=1, kind="stable")[:, :4]
    bones, weights = body.bones.copy(), body.weights.copy()
    bones[fingers.vertices] = order
    weights[fingers.vertices] = np.take_along_axis(dense, order, axis=1)
    return bones, weights / weights.sum(axis=1, keepdims=True)

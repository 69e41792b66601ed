"""Fingers of a stored body: their joints, the axes about which they bend, and the vertices that they move."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
from scipy.spatial import cKDTree

from motion.body import in_base64
from motion.hands import FINGERS, SIDES
from motion.vectors import unit

from .makehuman import J, MakeHuman

NAMES = {"thumb": "Thumb", "index": "Index", "middle": "Middle", "ring": "Ring", "pinky": "Pinky"}
_NEAREST = 3
"""Vertices of MakeHuman's hand of which one of the stored body takes its weights."""


def fingers(
    mh: MakeHuman, before: np.ndarray, after: np.ndarray, body: dict[str, np.ndarray]
) -> dict[str, Any]:
    """The fingers as they are stored.

    Args:
        mh: MakeHuman's mesh.
        before: (N, 3) its vertices in its own stance.
        after: (N, 3) the same in the pose of binding.
        body: ``vertices`` (V, 3), ``bones`` and ``weights`` (V, 4) of the stored body.
    """
    whole, table = mh.weights(), _finger_weights(mh)
    joints, tips, flex, close, normals = [], [], [], [], []
    chosen, shares = [], []
    owner = np.take_along_axis(body["bones"], body["weights"].argmax(axis=1)[:, None], axis=1)[:, 0]
    for side, name in enumerate(SIDES):
        wrist = J[f"{name}_wrist"]
        hand = np.flatnonzero(whole[:, wrist] > 0.99)
        solid = np.c_[before[hand], np.ones(len(hand))]
        moved, *_ = np.linalg.lstsq(solid, after[hand], rcond=None)  # the hand turns and stretches as one
        places = np.array([
            [np.r_[mh.joint(before, f"{name[0]}-finger-{1 + f}-{1 + k}"), 1.0] @ moved for k in range(4)]
            for f in range(len(FINGERS))
        ])  # fmt: skip
        bends, closing, out = _axes(places, side)
        joints.append(places[:, :3])
        tips.append(places[:, 3])
        flex.append(bends)
        close.append(closing)
        normals.append(out)
        mine = np.flatnonzero(owner == wrist)
        away, near = cKDTree(after[hand]).query(body["vertices"][mine], k=_NEAREST)
        pull = 1 / np.maximum(away, 1e-5)
        pull /= pull.sum(axis=1, keepdims=True)
        share = np.einsum("vn,vnf->vf", pull, table[hand][near][..., 15 * side : 15 * side + 15])
        chosen.append(mine[share.sum(axis=1) > 0.02])
        kept = np.zeros((len(chosen[-1]), 30))
        kept[:, 15 * side : 15 * side + 15] = share[share.sum(axis=1) > 0.02]
        shares.append(kept)
    vertices, weights = np.concatenate(chosen), np.concatenate(shares)
    bones = np.argsort(-weights, axis=1)[:, :3]
    return {
        "joints": np.array(joints).reshape(-1, 3).round(5).tolist(),
        "flex": np.array(flex).reshape(-1, 3).round(5).tolist(),
        "close": np.array(close).reshape(-1).round(4).tolist(),
        "normals": np.array(normals).round(5).tolist(),
        "vertices": in_base64(vertices, "<u2"),
        "bones": in_base64(bones, "u1"),
        "weights": in_base64(np.rint(255 * np.take_along_axis(weights, bones, axis=1)), "u1"),
    }


def _axes(places: np.ndarray, side: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Axes about which joints bend (5, 3, 3), angles that close the fingers (5,), and the palm's normal (3,)."""
    across = places[1, 0] - places[4, 0]  # from the little finger to the index finger
    along = places[2, 1] - (places[1:, 0].mean(axis=0) - 0.08 * (places[2, 2] - places[2, 0]))
    out = np.cross(along, across) if side == 0 else np.cross(across, along)
    out /= np.linalg.norm(out)
    out *= np.sign(out @ [0.0, -1.0, 0.0] + 1e-6)  # the palms face down
    straight = places[2, 3] - places[2, 0]
    bends, closing = np.zeros((5, 3, 3)), np.zeros(5)
    for f in range(5):
        goal = out if f else unit(places[3, 0] - places[0, 1] + 0.03 * out)  # the thumb bends over the palm
        for k in range(3):
            bends[f, k] = unit(np.cross(places[f, k + 1] - places[f, k], goal))
        if f:
            flat = [v - (v @ out) * out for v in (places[f, 3] - places[f, 0], straight)]
            one, other = map(unit, flat)
            closing[f] = np.arctan2(np.cross(one, other) @ out, one @ other)
    return bends, closing, out


def _finger_weights(mh: MakeHuman) -> np.ndarray:
    """(N, 30) shares of the finger joints, left hand first, three a finger from the thumb on."""
    table = json.loads((mh.root / "rigs/standard/weights.mixamo.json").read_text())["weights"]
    found = np.zeros((len(mh.vertices), 30))
    for side, name in enumerate(SIDES):
        for f, finger in enumerate(FINGERS):
            for k in range(3):
                pairs = table[f"mixamorig:{name.title()}Hand{NAMES[finger]}{k + 1}"]
                for vertex, weight in pairs:
                    found[vertex, 15 * side + 3 * f + k] += weight
    return found / np.maximum(found.sum(axis=1, keepdims=True), 1.0)

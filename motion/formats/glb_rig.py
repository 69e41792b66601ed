"""Motion on the skeleton of a glTF character: its nodes, names, bones, meshes, materials and pose of binding stay.

What each joint is turned by follows from the pose of binding: beside the body's rotations
(:func:`motion.body.bone_rotations`) in it each joint has one constant rotation. Only the animation is new.
"""

from __future__ import annotations

import copy
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from motion.body import bone_rotations
from motion.clip import Clip, Duet
from motion.errors import InputError
from motion.retarget import floor_on_smpl, leg_scale, retarget, up_rotation
from motion.rigs import RigMotion, match_joints, pairs_of
from motion.skeleton import SMPL22
from motion.smoothing import smoothstep
from motion.transforms import mirrored

from .files import check_smpl
from .glb_file import GlbFile, opened
from .glb_motion import MESHES, metres_per_unit, read_glb_people
from .glb_nodes import Rig, bind_pose, parts_of, people, placed, quaternions, split, with_those_above
from .glb_reader import read_character
from .glb_writer import Buffer
from .recording import Animation
from .skinned import posed, reached, root_path

Array = NDArray[np.floating]

_REST = SMPL22.rest_positions()
_SOLE = float(_REST[SMPL22.index("left_ankle"), 1] - _REST[SMPL22.index("left_foot"), 1])
"""Metres from SMPL22's ankle down to the floor."""
_REACH = (0.2, 0.6)
"""Metres from a wrist to the nearest joint of the other person: there it is all, and not at all, where it was made."""
_LIFTS = (-0.05, 0.3)
_ACROSS, _MIRROR = np.diag([-1.0, 1.0, 1.0]), np.diag([-1.0, 1.0, 1.0, 1.0])


def glb_on_rig(
    clip: Clip, reference: str | Path | bytes, *, name: str | None = None, animation: Animation | None = None
) -> bytes:
    """One person's motion on the skeleton of an animated character, in the world of its own animation.

    Args:
        clip: on SMPL22, metres, as it was made for the person that was read from the reference.
        reference: a .glb of one animated person, or its bytes.
        name: what to call it in messages.
        animation: the one that the person was read from, of several; the first by default.

    Returns:
        the file, with one animation at the clip's frame rate.

    Raises:
        InputError: for another skeleton, or a file that is no animated character.
    """
    check_smpl(clip, "A rig")
    moved = read_glb_people(reference, name=name, animation=animation)
    if len(moved) != 1:
        raise InputError(f"{moved[0].name} holds {len(moved)} people: a partner needs the rig of one.")
    with opened(reference, name, "used as a rig", harmless=MESHES) as file:
        skeleton = _skeleton(file)
        upright, lift = up_rotation(moved[0]), floor_on_smpl(moved[0])
        moves = [skeleton.moved(clip, lift, upright)]
        return _animated(copy.deepcopy(file.document), file.blob, moves, clip.fps, "partner")


def glb_wearing(duet: Duet, reference: str | Path | bytes, *, name: str | None = None) -> bytes:
    """Both people on a character of their own, each under a node that is called by their role.

    Everything is as large as the character is: paths are scaled so that steps fit its legs.

    Args:
        duet: on SMPL22, metres.
        reference: a skinned .glb, or its bytes.
        name: what to call it in messages.

    Raises:
        InputError: for another skeleton, or a file that is no character.
    """
    check_smpl(duet, "A character")
    with opened(reference, name, "used as a character") as file:
        skeleton = _skeleton(file)
        lift = _lift(skeleton, reference, name)
        document = copy.deepcopy(file.document)
        first, *_ = starts = _twice(document, file.node_parents(), duet.roles)
        moves = []
        for clip, other, start in zip(duet.people, duet.people[::-1], starts, strict=True):
            moved = skeleton.moved(clip, lift, near=_near(clip, other))
            moves.append({(node + start - first, path): values for (node, path), values in moved.items()})
        if duet.manifest:
            manifest = json.loads(json.dumps(duet.manifest, default=str))
            document["asset"] = {**document.get("asset", {}), "extras": {"manifest": manifest}}
        return _animated(document, file.blob, moves, duet.a.fps, "duet")


@dataclass(frozen=True, eq=False)
class _Skeleton:
    """The one person of a file in the pose of binding.

    Attributes:
        rig: the joints' nodes.
        rest: the pose of binding as a motion of one frame, in metres.
        bones: (J, 3) metres from the parent to each joint, in the parent's own axes.
        turns: (J, 3, 3) the joints' rotations in it.
        holders: (J, 3, 3) world rotation of the node above each joint, against the nearest joint above; of none,
            against the world.
        base: (4, 4) world matrix of the node above the root of the body.
        root: index of that root.
        mirrored: the file's world shows what is named left on the right; all this is of its mirror image.
    """

    rig: Rig
    rest: RigMotion = field(repr=False)
    bones: Array = field(repr=False)
    turns: Array = field(repr=False)
    holders: Array = field(repr=False)
    base: Array = field(repr=False)
    root: int
    mirrored: bool

    def moved(
        self, clip: Clip, lift: float, upright: Array | None = None, near: Mapping[str, Array] | None = None
    ) -> dict[tuple[int, str], Array]:
        """Values of the channels of a person's motion, by node and path.

        Args:
            clip: on SMPL22.
            lift: metres by which the person stands above the floor at 0.
            upright: (3, 3) rotation that turns the file's world to Y up; it is by default.
            near: (T,) share of the way that each wrist goes to where the person's is, by side.
        """
        upright = np.eye(3) if upright is None else upright
        if self.mirrored:
            clip = replace(clip, positions=mirrored(clip.positions), rotations=None)
            upright = _ACROSS @ upright @ _ACROSS
            near = near and {"left": near["right"], "right": near["left"]}
        rig, rest = self.rig, self.rest
        stands = up_rotation(rest)
        pairs = pairs_of(rest)
        own = bone_rotations(retarget(rest, fps=rest.fps, plant=False).positions)[0]
        constants = {joint: own[ours].T @ stands @ self.turns[joint] for joint, ours in pairs.items()}
        above = np.array(rig.above)
        usual = np.where(
            above[:, None, None] < 0, stands @ self.turns, np.swapaxes(self.turns[above], -1, -2) @ self.turns
        )
        world = posed(rest, self.bones, clip, pairs, constants, usual)
        if near is not None:
            world = reached(rest, self.bones, clip, pairs, usual, world, lift, near)
        path = root_path(rest, self.bones, clip, world, lift) @ upright / rest.metres_per_unit
        world = upright.T @ world
        found: dict[tuple[int, str], Array] = {}
        for joint, node in enumerate(rig.nodes):
            if self.root in rest.path_to_root(joint):
                parent = rig.above[joint]
                holder = self.holders[joint] if parent < 0 else world[:, parent] @ self.holders[joint]
                found[node, "rotation"] = quaternions(np.swapaxes(holder, -1, -2) @ world[:, joint])
        back = np.linalg.inv(self.base)
        found[rig.nodes[self.root], "translation"] = path @ back[:3, :3].T + back[:3, 3]
        return found


def _near(clip: Clip, other: Clip) -> dict[str, Array]:
    """(T,) by side: 1 while a wrist is near enough to the other person to touch them, 0 while it is far away."""
    found = {}
    for side in ("left", "right"):
        wrist = clip.positions[:, None, SMPL22.index(f"{side}_wrist")]
        away = np.linalg.norm(other.positions - wrist, axis=-1).min(axis=1).astype(np.float64)
        found[side] = smoothstep((_REACH[1] - away) / (_REACH[1] - _REACH[0]))
    return found


def _skeleton(file: GlbFile) -> _Skeleton:
    """The one person of a file.

    Raises:
        InputError: for none or several.
    """
    parents = file.node_parents()
    found, problems = [], []
    for rig in people(file, parents):
        try:
            found.append(_in_binding(file, parents, rig))
        except InputError as problem:
            problems.append(problem)
    if not found:
        raise problems[0]
    if len(found) > 1:
        file.refuse(f"it holds {len(found)} people", "export one alone")
    return found[0]


def _in_binding(file: GlbFile, parents: Sequence[int], rig: Rig) -> _Skeleton:
    world = placed(file, with_those_above(rig.nodes, parents), parents)
    still = np.stack([world[node][0] for node in rig.nodes])
    if (np.abs(np.linalg.det(still[:, :3, :3])) < 1e-15).any():
        file.refuse("a joint in it has no size", "apply its scale")
    is_mirrored = _is_mirrored(still)
    if is_mirrored:
        world = {node: _MIRROR @ each for node, each in world.items()}
        still = _MIRROR @ still
    bound = bind_pose(file, rig)
    bound = still if bound is None else _MIRROR @ bound if _is_mirrored(bound) else bound
    turns = split(bound[:, :3, :3])[0]
    facing = split(still[:, :3, :3])[0]
    count = len(rig.nodes)
    bones, offsets, holders = np.zeros((count, 3)), np.zeros((count, 3)), np.empty((count, 3, 3))
    places = np.zeros((count, 3))
    for joint, (node, above) in enumerate(zip(rig.nodes, rig.above, strict=True)):
        holder = split(world[parents[node]][:, :3, :3])[0][0] if parents[node] >= 0 else np.eye(3)
        holders[joint] = holder if above < 0 else facing[above].T @ holder
        if above >= 0:
            bones[joint] = facing[above].T @ (still[joint, :3, 3] - still[above, :3, 3])
            offsets[joint] = turns[above] @ bones[joint]
            places[joint] = places[above] + offsets[joint]
    names = tuple(file.joint_name(node) for node in rig.nodes)
    rest = RigMotion(names, rig.above, offsets, places[None], None, 30.0, name=file.label)
    scale = metres_per_unit(rest)
    rest = RigMotion(names, rig.above, scale * offsets, scale * places[None], None, 30.0, scale, file.label)
    root = rest.path_to_root(match_joints(rest).pelvis)[-1]
    above = parents[rig.nodes[root]]
    base = world[above][0] if above >= 0 else _MIRROR if is_mirrored else np.eye(4)
    return _Skeleton(rig, rest, scale * bones, turns, holders, base, root, is_mirrored)


def _is_mirrored(joints: Array) -> bool:
    """True for world matrices (J, 4, 4) that show what is left on the right."""
    return bool(np.linalg.det(joints[0, :3, :3]) < 0)


def _lift(skeleton: _Skeleton, reference: str | Path | bytes, name: str | None) -> float:
    """Metres by which soles that are thicker than SMPL22's raise a character, in SMPL22's size."""
    character = read_character(reference, name=name)
    rest = skeleton.rest
    parts = match_joints(rest)
    names = [rest.joint_names[joint] for side in (parts.left, parts.right) if (joint := side["ankle"]) is not None]
    ankles = [character.joint_names.index(each) for each in names if each in character.joint_names]
    if not ankles:
        return 0.0
    height = up_rotation(rest)[1]
    bones = np.linalg.norm(character.joints - character.joints[np.maximum(character.parents, 0)], axis=-1)
    longer = rest.bone_lengths.sum() / max(float(bones[np.array(character.parents) >= 0].sum()), 1e-9)
    deep = (character.joints[ankles] @ height).mean() - (character.vertices @ height).min()
    return float(np.clip(deep * longer * leg_scale(rest) - _SOLE, *_LIFTS))


def _twice(document: dict[str, Any], parents: Sequence[int], roles: Sequence[str]) -> list[int]:
    """Gives a description all its nodes twice, each copy under a node with its role; where the copies begin."""
    nodes, skins = document["nodes"], document.get("skins", [])
    count, skin_count = len(nodes), len(skins)
    scene = document.get("scenes", [{}])[document.get("scene", 0)]
    top = scene.get("nodes", [number for number, parent in enumerate(parents) if parent < 0])
    # What stands above a skinned mesh does not move it, so that it belongs at the top.
    skinned = [n for n, node in enumerate(nodes) if node.get("skin") is not None and not node.get("children")]
    for node in nodes:
        if node.get("children"):
            node["children"] = [child for child in node["children"] if child not in skinned]
            if not node["children"]:
                del node["children"]
    starts = [0, count]
    nodes += [_shifted(node, count, skin_count) for node in copy.deepcopy(nodes)]
    skins += [
        {**skin, "joints": [joint + count for joint in skin["joints"]]}
        | ({"skeleton": skin["skeleton"] + count} if skin.get("skeleton") is not None else {})
        for skin in copy.deepcopy(skins)
    ]
    shown: list[int] = []
    for role, start in zip(roles, starts, strict=True):
        nodes.append({"name": role, "children": [start + node for node in top if node not in skinned]})
        shown += [len(nodes) - 1, *(start + node for node in skinned)]
    document |= {"scene": 0, "scenes": [{"name": "duet", "nodes": shown}]}
    return starts


def _shifted(node: dict[str, Any], nodes: int, skins: int) -> dict[str, Any]:
    if node.get("children"):
        node["children"] = [child + nodes for child in node["children"]]
    if node.get("skin") is not None:
        node["skin"] += skins
    return node


def _animated(
    document: dict[str, Any], blob: bytes, moves: Sequence[Mapping[tuple[int, str], Array]], fps: float, name: str
) -> bytes:
    """The file with one animation of these channels; nodes lose what they were turned by."""
    document["animations"] = [{"name": name}]
    buffer = Buffer(document, blob)
    clock = buffer.clock(len(next(iter(moves[0].values()))), fps)
    for (node, path), values in (each for person in moves for each in person.items()):
        buffer.animate(node, path, values, clock)
        if (matrix := document["nodes"][node].pop("matrix", None)) is not None:  # animated nodes have none
            parts = parts_of(np.array(matrix, dtype=np.float64))
            document["nodes"][node] |= {each: part.tolist() for each, part in parts.items()}
    return buffer.packed()

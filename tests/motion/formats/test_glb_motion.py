"""Motion out of glTF binary: any rig, any unit, any way of key frames, and what is wrong said in a sentence."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from motion import SMPL22, Clip, Duet, InputError
from motion.formats import glb_motion as reader
from motion.formats import read, write
from motion.formats.glb_file import GlbFile, Stored
from motion.formats.glb_motion import Channel, read_glb
from motion.formats.importing import Imported, import_motion
from motion.formats.recording import ImportChoices
from motion.retarget import retarget
from motion.transforms import mirrored
from tests.motion.bodies import marching

from .characters import glb_motion, glb_takes, in_a_mirror, packed, unpacked
from .rigs import RIGS

POSITIONS, ROTATIONS = marching(30)
ROOT = POSITIONS[:, 0]
Z_UP = Rotation.from_euler("x", 90, degrees=True).as_matrix()
WALK = glb_motion(ROTATIONS, ROOT)


@pytest.mark.parametrize(
    "given",
    [
        {},
        {"unit": 100.0, "turn": Z_UP},
        {"start": 2.5},
        {"way": "CUBICSPLINE"},
        {"way": "STEP"},
        {"axes": Rotation.random(22, random_state=0).as_matrix()},
    ],
    ids=["plain", "a turned armature in centimetres", "later", "splines", "steps", "axes of their own"],
)
def test_joints_stand_where_they_do_in_the_file(given: dict[str, Any]) -> None:
    data = glb_motion(ROTATIONS, ROOT, **given)
    (found,) = read_glb(data, name="walk.glb")[0]
    order = [found.joint_names.index(RIGS["mixamo"][ours]) for ours in SMPL22.joint_names]
    assert found.fps == 30 and found.metres_per_unit == 1.0
    np.testing.assert_allclose(found.positions[:, order], POSITIONS, atol=1e-4)
    clip = retarget(found, plant=False)
    assert np.linalg.norm(clip.positions - POSITIONS, axis=-1).max() < 0.06
    assert (
        import_motion(data, name="walk.glb").describe() == "22 joints found; lengths in m, Y is up, 30 frames a second"
    )


@pytest.mark.parametrize(("fps", "count", "rate"), [(24.0, 37, 24), (60.0, 15, 60), (120.0, 8, 120), (2.0, 436, 30)])
def test_frame_rates_are_those_of_the_keys(fps: float, count: int, rate: float) -> None:
    found = import_motion(glb_motion(ROTATIONS, ROOT, fps=fps), name="walk.glb")
    assert found.fps == rate and found.people[0].fps == 30
    assert abs(found.people[0].num_frames - count) <= 1, "as long as in the file"
    faster = import_motion(glb_motion(ROTATIONS, ROOT, fps=fps), name="walk.glb", choices=ImportChoices(fps=2 * rate))
    assert abs(2 * faster.people[0].num_frames - count) <= 3


def test_our_own_file_comes_back_as_it_was(tmp_path: Path) -> None:
    duet = Duet(Clip(POSITIONS, 30), Clip(POSITIONS + np.float32([0, 0, 2]), 30), ("actor", "reactor"))
    write(duet, tmp_path / "duet.glb")
    found = read(tmp_path / "duet.glb")
    assert isinstance(found, Duet) and found.fps == 30
    np.testing.assert_allclose(found.positions, duet.positions, atol=1e-4)


def test_several_people_share_one_clock_and_one_world() -> None:
    data = glb_motion(ROTATIONS, ROOT, people=3)
    people = read_glb(data, name="crowd.glb")[0]
    assert [len(person.positions) for person in people] == [30] * 3
    for number, person in enumerate(people):
        np.testing.assert_allclose(person.positions[:, 0], ROOT + np.array([2 * number, 0, 0]), atol=1e-4)
    assert len(import_motion(data, name="crowd.glb").people) == 3


def test_a_spline_goes_through_its_keys_along_its_tangents() -> None:
    times = np.array([0.0, 1.0, 3.0])
    values = np.stack([times**2, times**2, times**2], axis=1)
    slope = np.stack([2 * times] * 3, axis=1)
    channel = Channel(0, "translation", times, np.stack([slope, values, slope], axis=1), "CUBICSPLINE")
    moments = np.linspace(-1, 4, 41)
    wanted = np.clip(moments, 0, 3) ** 2
    np.testing.assert_allclose(channel.at(moments)[:, 0], wanted, atol=1e-9)


def _sampled(**fields: Any) -> dict[str, Any]:
    (animation,) = unpacked(WALK)[0]["animations"]
    return {"animations": [animation | {"samplers": [each | fields for each in animation["samplers"]]}]}


GLTF = unpacked(WALK)[0]
CLOCK = GLTF["animations"][0]["samplers"][0]["input"]
"""The accessor of the times, and the view that it is alone in."""


def _changed(kind: str, number: int, **fields: Any) -> dict[str, Any]:
    return {kind: [each | fields if i == number else each for i, each in enumerate(GLTF[kind])]}


WRONG: dict[str, tuple[dict[str, Any], str]] = {
    "no animation": ({"animations": []}, "has no animation: export it with one"),
    "a view outside": (_changed("bufferViews", CLOCK, byteOffset=2**30), "outside of the file"),
    "a stride of none": (_changed("bufferViews", CLOCK, byteStride=3), "outside of the file"),
    "too many keys": (_changed("accessors", CLOCK, count=10**9), "are the limit"),
    "another file": ({"buffers": [{"byteLength": 4, "uri": "file:///etc/passwd"}]}, "in other files"),
    "a circle": (_changed("nodes", 21, children=[0]), "circle|two parents"),
    "a node that is not there": (_changed("nodes", 0, children=[999]), "is not there"),
    "wrong kinds": ({"skins": [7]}, "is damaged"),
    "keys of another number": (_sampled(output=0), "do not fit|not read here"),
    "a node nowhere": ({"nodes": [each | {"translation": [1e999, 0, 0]} for each in GLTF["nodes"]]}, "nowhere|damaged"),
    "no person": ({"nodes": [each | {"name": "rope"} for each in GLTF["nodes"]]}, "no joint that looks like"),
    "everything in one place": ({"nodes": [{**each, "scale": [0, 0, 0]} for each in GLTF["nodes"]]}, "of zero length"),
    "compression": ({"extensionsRequired": ["EXT_meshopt_compression"]}, "EXT_meshopt"),
}


@pytest.mark.parametrize("name", WRONG)
def test_what_is_wrong_is_one_sentence(name: str) -> None:
    changes, says = WRONG[name]
    with pytest.raises(InputError, match=says) as error:
        read_glb(glb_motion(ROTATIONS, ROOT, **changes), name="walk.glb")[0]
    assert "\n" not in str(error.value) and str(error.value).startswith("walk.glb")


@pytest.mark.parametrize(
    ("data", "says"),
    [
        (b"nothing at all, really", "not a glTF binary"),
        (WALK[:-3000], "cut off"),
        (WALK[:4] + b"\1\0\0\0" + WALK[8:], "version 1"),
    ],
)
def test_other_files_are_one_sentence(data: bytes, says: str) -> None:
    with pytest.raises(InputError, match=says):
        read_glb(data, name="walk.glb")


def test_long_motions_are_refused_before_they_are_read(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(InputError, match="more than the 600 s allowed"):
        read_glb(glb_motion(ROTATIONS[:4], ROOT[:4], fps=1 / 300), name="walk.glb")[0]
    monkeypatch.setattr(reader, "MOST_KEYS", 100)
    with pytest.raises(InputError, match="key frames"):
        read_glb(WALK, name="walk.glb")[0]
    monkeypatch.undo()
    monkeypatch.setattr(reader, "MAX_NUMBERS", 100)
    with pytest.raises(InputError, match="lower its frame rate"):
        read_glb(WALK, name="walk.glb")[0]


def _shared(joints: int, keys: int, *, apart: int = 0) -> bytes:
    """A walk of many joints that all turn by one sampler, or by one each whose keys begin ``apart`` bytes later."""
    document, blob = unpacked(WALK)
    views, accessors, nodes = document["bufferViews"], document["accessors"], document["nodes"]
    (animation,), (skin,) = document["animations"], document["skins"]
    first, more = len(nodes), joints - len(skin["joints"])
    nodes += [{"name": f"extra {number}"} for number in range(more)]
    nodes[1]["children"] += range(first, first + more)
    skin["joints"] += range(first, first + more)
    del skin["inverseBindMatrices"]
    times = (np.arange(keys) / 50).astype("<f4").tobytes()
    turns = np.tile(np.array([0, 0, 0, 1], "<f4"), (keys + joints, 1)).tobytes()
    for data in (times, turns):
        views.append({"buffer": 0, "byteOffset": len(blob), "byteLength": len(data)})
        blob += data
    kinds = {"componentType": 5126, "count": keys}
    accessors.append({"bufferView": len(views) - 2, "type": "SCALAR", **kinds})
    for number in range(joints if apart else 1):
        accessors.append({"bufferView": len(views) - 1, "byteOffset": apart * number, "type": "VEC4", **kinds})
    outputs = range(len(accessors) - (joints if apart else 1), len(accessors))
    animation["samplers"] = [{"input": outputs[0] - 1, "output": output} for output in outputs]
    animation["channels"] = [
        {"sampler": number if apart else 0, "target": {"node": joint, "path": "rotation"}}
        for number, joint in enumerate(skin["joints"])
    ]
    document["buffers"][0]["byteLength"] = len(blob)
    return packed(document, blob)


class Decoding:
    """Counts the rows that are decoded."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.rows = 0
        whole = GlbFile.decoded

        def counted(file: GlbFile, stored: Stored, what: str) -> Any:
            self.rows += stored.rows
            return whole(file, stored, what)

        monkeypatch.setattr(GlbFile, "decoded", counted)


def test_a_sampler_that_joints_share_is_decoded_and_worked_out_once(monkeypatch: pytest.MonkeyPatch) -> None:
    data, keys = _shared(200, 1000), 1000
    decoding, courses = Decoding(monkeypatch), []
    at = Channel.at
    monkeypatch.setattr(Channel, "at", lambda channel, moments: courses.append(1) or at(channel, moments))
    (found,) = read_glb(data, name="walk.glb")[0]
    assert found.positions.shape == (1000, 200, 3)
    assert decoding.rows == 2 * keys and len(courses) == 1


def test_key_frames_that_overlap_are_refused_before_they_are_decoded(monkeypatch: pytest.MonkeyPatch) -> None:
    data = _shared(200, 1000, apart=16)
    decoding = Decoding(monkeypatch)
    with pytest.raises(InputError, match=r"walk\.glb cannot be read as motion because its key frames overlap"):
        read_glb(data, name="walk.glb")[0]
    assert decoding.rows == 0


BONES = {
    "hip": "UpperLeg",
    "knee": "LowerLeg",
    "ankle": "Foot",
    "foot": "Toes",
    "collar": "Shoulder",
    "shoulder": "UpperArm",
    "elbow": "LowerArm",
    "wrist": "Hand",
}
"""VRM's names of the limbs."""


@pytest.mark.parametrize("kind", ["VRM", "VRMC_vrm", "VRMC_vrm_animation"])
def test_vrm_is_glb_whose_bones_are_named_beside_the_nodes(kind: str) -> None:
    names = {name: f"骨{number}" for number, name in enumerate(SMPL22.joint_names)}
    document, blob = unpacked(glb_motion(ROTATIONS, ROOT, names, skinned=False))
    called = {node.get("name"): number for number, node in enumerate(document["nodes"])}
    bones: dict[str, Any] = {"hips": {"node": called[names["pelvis"]]}, "head": {"node": called[names["head"]]}}
    for name in SMPL22.joint_names:
        side, _, part = name.rpartition("_")
        if side:
            bones[f"{side}{BONES[part]}"] = {"node": called[names[name]]}
    held = [{"bone": bone, **its} for bone, its in bones.items()] if kind == "VRM" else bones
    document["extensions"] = {kind: {"humanoid": {"humanBones": held}}}
    suffix = "vrma" if kind == "VRMC_vrm_animation" else "vrm"
    clip = read(packed(document, blob), name=f"x.{suffix}")
    assert isinstance(clip, Clip)
    assert np.linalg.norm(clip.positions - read(WALK, name="walk.glb").positions, axis=-1).max() < 0.08


def test_a_mirrored_armature_walks_forwards() -> None:
    walk = ROOT + np.linspace(0, 1, len(ROOT))[:, None] * [0.0, 0.0, 1.0]
    found = read(in_a_mirror(glb_motion(ROTATIONS, walk)), name="walk.glb")
    truth = read(glb_motion(ROTATIONS, walk), name="walk.glb")
    assert isinstance(found, Clip) and isinstance(truth, Clip)
    np.testing.assert_allclose(found.positions, mirrored(truth.positions), atol=0.02)


FILE = glb_takes(ROTATIONS, ROOT, ["Walk", "glide", "3", "2"])


def limbs(found: Imported) -> float:
    """Metres by which the wrists move against the pelvis: none where the person glides."""
    moved = found.people[0].positions - found.people[0].positions[:, :1]
    return float(np.ptp(moved[:, [20, 21]], axis=0).max())


def imported(animation: Any) -> Imported:
    return import_motion(FILE, name="x.glb", choices=ImportChoices(animation=animation))


@pytest.mark.parametrize(
    ("choice", "number"), [(None, 1), ("walk", 1), (1, 1), (" GLIDE ", 2), (2, 2), ("2", 4), ("3", 3)]
)
def test_another_is_chosen_by_its_name_or_else_by_its_number(choice: Any, number: int) -> None:
    found = imported(choice)
    assert found.animations is not None and found.animations.taken == (number,)
    assert (limbs(found) > 0.1) == (number == 1)


@pytest.mark.parametrize(
    ("way", "share", "place"), [("STEP", 0.6, 0.0), ("LINEAR", 0.6, 0.6), ("CUBICSPLINE", 0.5, 0.375)]
)
def test_between_keys(way: str, share: float, place: float) -> None:
    """The spline leaves 0 with a slope of 1 and arrives at 1 with one of 2; 7 and 9 are those of its other sides."""
    keys = np.array([[7.0, 0.0, 1.0], [2.0, 1.0, 9.0]])[..., None] * np.ones(3)
    channel = Channel(0, "translation", np.array([0.0, 1.0]), keys if way == "CUBICSPLINE" else keys[:, 1], way)
    np.testing.assert_allclose(channel.at(np.array([share])), [[place] * 3])


def test_whole_numbers_stand_for_fractions() -> None:
    blob = np.array([32767, 0, -32767, 16384], dtype=np.int16).tobytes()
    stored = Stored("VEC4", 1, 5122, 0, 8, True)
    found = GlbFile(packed({"asset": {"version": "2.0"}}, blob), "x.glb").decoded(stored, "turns")
    np.testing.assert_allclose(found, [[1, 0, -1, 0.5]], atol=1e-4)

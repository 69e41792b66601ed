"""Parts of the files of the free single-person sets, on made-up files; made clips slowed to what a body does."""

from __future__ import annotations

import json

import numpy as np
from scipy.spatial.transform import Rotation

from motion import Duet
from motion.formats.glb_writer import glb_bytes
from motion.kinematics import bone_lengths, forward_kinematics
from motion.retarget import retarget
from motion.skeleton import SMPL22
from tests.motion.bodies import marching
from training.corpus import sources
from training.corpus.beats.script import MENU
from training.corpus.sources import load_sources, read_deepmimic

J = SMPL22.index


def row(seconds: float = 1 / 30, **angles: float) -> list[float]:
    """A DeepMimic frame of a person who stands at (1, 0.9, 2), with angles of the joints of one number."""
    quaternion = [1.0, 0.0, 0.0, 0.0]
    values = [seconds, 1.0, 0.9, 2.0]
    joints = "root chest neck right_hip right_knee right_ankle right_shoulder right_elbow "
    joints += "left_hip left_knee left_ankle left_shoulder left_elbow"
    for name in joints.split():
        values += [angles.get(name, 0.0)] if name.endswith(("knee", "elbow")) else quaternion
    return values


def clip(rows: list[list[float]]) -> bytes:
    return json.dumps({"Loop": "none", "Frames": rows}).encode()


def test_deepmimic_bends_elbows_forward_and_keeps_the_root() -> None:
    rig = read_deepmimic(clip([row(right_elbow=1.2)] * 4), name="x.txt")
    names = list(rig.joint_names)
    root = rig.positions[0, names.index("Hips")]
    np.testing.assert_allclose(root, [1.0, 0.9, 2.0])
    bent, straight = (rig.positions[0, names.index(f"{side}Hand")] - root for side in ("Right", "Left"))
    assert bent[0] > 0.2 and abs(straight[0]) < 0.05  # +X is ahead
    assert bent[2] > 0.1 > -0.1 > straight[2]  # +Z is to the right
    person = retarget(rig).positions
    assert person[0, J("right_wrist"), 1] > person[0, J("left_wrist"), 1] + 0.1


def test_clips_made_by_hand_are_read_from_glb_and_damaged_files_left_out(tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(sources, "CUTS", {"mesh2motion": (sources.Cut("duet", "sit-down"),)})
    people = np.stack([marching(90)[0], marching(90, seed=1)[0]])
    (tmp_path / "mesh2motion").mkdir()
    (tmp_path / "mesh2motion" / "x-animations.glb").write_bytes(b"glTF" + bytes(40))
    assert not list(sources._read_all(tmp_path))
    (tmp_path / "mesh2motion" / "y-animations.glb").write_bytes(glb_bytes(Duet.from_positions(people, fps=30.0)))
    ((action, *_, source, dataset), positions), *others = sources._read_all(tmp_path)
    assert (action, source, dataset) == ("sit-down", "mesh2motion_duet", "mesh2motion") and not others
    assert len(positions) >= 85 and np.ptp(positions[:, 0, 2]) > 0.2


def test_made_clips_are_slowed_and_rounded_and_slow_ones_kept() -> None:
    time = np.arange(40) / 30

    def wave(hertz: float) -> np.ndarray:
        rotations = np.tile(np.eye(3), (40, 22, 1, 1))
        turn = np.stack([0 * time, 0 * time, 1.3 * np.sin(2 * np.pi * hertz * time)], -1)
        rotations[:, J("left_shoulder")] = Rotation.from_rotvec(turn).as_matrix()
        return forward_kinematics(rotations, np.tile([0.0, 0.95, 0.0], (40, 1)))

    fast, calm = sources.humanly(wave(3.0)), sources.humanly(wave(0.0))
    tip = fast[:, J("left_wrist")] - fast[:, 0]
    assert len(calm) == 40 < len(fast)
    assert np.linalg.norm(np.diff(tip, axis=0), axis=-1).max() * 30 < 1.1 * sources.MOST_SPEED
    assert np.linalg.norm(np.diff(tip, n=2, axis=0), axis=-1).max() * 900 < 1.2 * sources.MOST_ACCELERATION
    np.testing.assert_allclose(bone_lengths(fast) - SMPL22.bone_lengths[1:], 0, atol=1e-6)


def test_sources_take_the_vocabulary_along(tmp_path) -> None:
    folder = tmp_path / "data" / "deepmimic"
    folder.mkdir(parents=True)
    (folder / "humanoid3d_jump.txt").write_bytes(clip([row()] * 60))
    (folder / "humanoid3d_unused.txt").write_bytes(clip([row()] * 60))
    (folder / "humanoid3d_getup_facedown.txt").write_bytes(clip([row(right_elbow=k / 40) for k in range(60)]))
    clips = {c.action: c for c in load_sources(tmp_path / "data", cache_dir=tmp_path / "cache")}
    assert set(clips) == {"jump", "get-up-front", "lie-down-front"}
    assert clips["jump"].dataset == "deepmimic" and clips["jump"].source == "deepmimic_humanoid3d_jump"
    up, down = clips["get-up-front"].positions, clips["lie-down-front"].positions
    bend = [body[:, J("right_wrist"), 1] - body[:, J("right_elbow"), 1] for body in (up, down)]
    assert bend[0][-1] > bend[0][0] + 0.1 and bend[1][0] > bend[1][-1] + 0.1


def test_every_listed_action_is_played_by_a_beat() -> None:
    used = {name for option in MENU.values() for name in option.needs}
    # Besides others, where they are there.
    used |= {"run", "sneak", "shadow-box", "dance-show", "ballet", "talking", "sitting-talk"}
    listed = {cut.action for cuts in sources.CUTS.values() for cut in cuts}
    assert listed and listed <= used

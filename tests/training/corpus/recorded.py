"""People who move as formulas say, as a library of recordings, and scenes of beats that are made of it."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from motion.kinematics import bone_lengths, forward_kinematics
from motion.skeleton import SMPL22
from training.corpus.beats import script
from training.corpus.beats.acts import ACTS
from training.corpus.beats.play import Play
from training.corpus.cues import STILL, Scene, SourceClip
from training.corpus.library import Library

J = SMPL22.index


def standing(frames: int, *, sway: float = 0.01) -> tuple[np.ndarray, np.ndarray]:
    """Local rotations and root of a person whose arms hang and who sways a little."""
    rotations = np.tile(np.eye(3), (frames, 22, 1, 1))
    rotations[:, J("left_shoulder")] = Rotation.from_rotvec([0, 0, -1.3]).as_matrix()
    rotations[:, J("right_shoulder")] = Rotation.from_rotvec([0, 0, 1.3]).as_matrix()
    root = np.zeros((frames, 3))
    root[:, 0] = sway * np.sin(np.arange(frames) / 20)
    root[:, 1] = -SMPL22.rest_positions()[:, 1].min() - 0.005
    return rotations, root


def gesture(frames: int, *hands: str) -> np.ndarray:
    """Raises hands and lowers them."""
    rotations, root = standing(frames)
    angle = 2.6 * np.sin(np.linspace(0, np.pi, frames)) ** 2 - 1.3
    for hand in hands:
        sign = 1 if hand == "left" else -1
        rotations[:, J(f"{hand}_shoulder")] = Rotation.from_rotvec(
            np.stack([0 * angle, 0 * angle, sign * angle], -1)
        ).as_matrix()
    return forward_kinematics(rotations, root)


def bow(frames: int) -> np.ndarray:
    rotations, root = standing(frames)
    bend = np.sin(np.linspace(0, np.pi, frames)) ** 2
    rotations[:, J("spine1")] = Rotation.from_rotvec(np.stack([bend, 0 * bend, 0 * bend], -1)).as_matrix()
    return forward_kinematics(rotations, root)


def walk(frames: int, speed: float = 1.2) -> np.ndarray:
    """Legs that swing under a root that moves evenly; feet are planted by the code under test."""
    rotations, root = standing(frames, sway=0.0)
    root[:, 2] = speed * np.arange(frames) / 30
    root[:, 1] -= 0.03
    phase = 2 * np.pi * np.arange(frames) / 32
    for sign, side in ((1, "left"), (-1, "right")):
        swing = -0.42 * sign * np.sin(phase)
        knee = 0.5 * np.clip(sign * np.cos(phase), 0, None)
        rotations[:, J(f"{side}_hip")] = Rotation.from_euler("x", (swing - knee / 2)[:, None]).as_matrix()
        rotations[:, J(f"{side}_knee")] = Rotation.from_euler("x", knee[:, None]).as_matrix()
    return forward_kinematics(rotations, root)


def clips(split: str = "train") -> list[SourceClip]:
    """The recordings of a split."""

    def clip(positions: np.ndarray, action: str, side: str | None = None) -> SourceClip:
        return SourceClip(positions, action, "normal", side, f"{split}-{action}-{side}", "made-up", split)

    left = walk(150, speed=0.0) + 0.6 * np.arange(150)[:, None, None] / 30 * np.array([1.0, 0, 0])
    return [
        clip(forward_kinematics(*standing(400)), "idle"),
        clip(bow(80), "bow"),
        clip(walk(200), "walk"),
        clip(walk(150, speed=-0.7), "walk-back"),
        clip(left, "walk-left", "left"),
        clip(left * np.array([-1.0, 1, 1]), "walk-right", "right"),
        clip(gesture(80, "right"), "bye"),
        *(clip(gesture(90, side), "wave", side) for side in ("left", "right")),
        *(clip(gesture(90, side), "raise-hand", side) for side in ("left", "right")),
        clip(gesture(90, "left", "right"), "wave", "both"),
        clip(gesture(90, "left", "right"), "raise-hand", "both"),
    ]


SOURCES = [*clips("train"), *clips("test")]


_SHARED = "shake-hands high-five fist-bump hug walk-together walk-hand-in-hand ring part walk-past"
KINDS = (
    [(cue, cue) for cue in _SHARED.split()],
    [
        ("walk-up", STILL),
        ("run-up", STILL),
        ("walk-up+wave", STILL),
        ("walk-away", "wave"),
        ("walk-away", "follow"),
        ("walk-around", "turn-to"),
        ("step-aside", STILL),
        ("hand-over", "take-from"),
        ("hand-over?", "wave-off"),
        ("hug?", "step-back"),
        ("pat:shoulder", "turn-to"),
        ("hand-on:shoulder", STILL),
        ("whisper", "listen"),
        ("help-up", "stand-up"),
        ("push", "stumble"),
        ("punch", "dodge"),
        ("kick", "fall-down>stand-up"),
        ("throw-ball", "catch-thing"),
        ("walk-together+talk", "walk-together"),
    ],
    [(cue, other) for cue in ACTS for other in (cue, STILL, *script.ANSWERS)],
)
"""Cues of a and b: done together, answered, and what one person does alone with any answer."""


def bone_error(positions: np.ndarray) -> float:
    return float(np.abs(bone_lengths(positions) - SMPL22.bone_lengths[1:]).max())


def staged(library: Library, *beats: tuple[str, str, str], heading: float = 0.0) -> Scene:
    """A scene of beats of the menu that a begins, with what a and b are to do in each; the first seed that does it.

    b stands 2.6 m before the place where a stands with a ``heading`` (0: towards b).
    """
    for seed in range(200):
        rng = np.random.default_rng(seed)
        play = Play(rng, library, (((0.0, 0.0), heading), ((0.0, 2.6), np.pi)))
        for name, *_ in beats:
            script.MENU[name].make(play, 0)
        acts = [beat.acts for beat in play.beats if not beat.minor]
        if acts == [tuple(acts) for _, *acts in beats] and play.sync() < script.MOST:
            return script.as_scene(rng, play)
    raise AssertionError(f"{beats} never fit")


def main(scene: Scene) -> list[dict]:
    return [beat for beat in scene.beats if not beat["minor"]]


def path(scene: Scene, person: int, beat: dict) -> np.ndarray:
    """(frames, 2) of the root over the ground in a beat."""
    return scene.positions[person, beat["start"] : beat["end"], 0][:, [0, 2]]

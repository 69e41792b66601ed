"""The accuracy of motion from film: ``python -m training.evaluate.camera --data FOLDER --work FOLDER``.

Recorded clips are rendered (:mod:`.camera_scenes`), the page's own scripts find landmarks in the films
(:mod:`.camera_browser`), :mod:`motion.video` makes clips of them, and those are compared with what was rendered after
one turn about the vertical and one shift. Films and landmarks are kept in the work folder.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from motion import SMPL22, Clip
from motion.metrics.quality import ANKLE_HEIGHT, TOE_HEIGHT
from motion.video import people_of, unpack_film
from motion.video.place import LENS
from motion.video.tracks import tracks_of

from .camera_browser import detector
from .camera_scenes import FPS, HELD_OUT, TUNING, Scene, camera, pictures, truth, write_video

Array = NDArray[np.floating]

_TOES = [SMPL22.index("left_foot"), SMPL22.index("right_foot")]
_ANKLES = [SMPL22.index("left_ankle"), SMPL22.index("right_ankle")]


@dataclass(frozen=True)
class Score:
    """The errors of a person against the truth.

    Attributes:
        joints: mean distance of the joints about the pelvis, mm.
        pose: the same after the best rotation of every frame, mm.
        path: mean distance of the pelvis over the floor, cm.
        slide: mean speed of the feet that truly stand, cm/s; NaN where none does.
    """

    joints: float
    pose: float
    path: float
    slide: float


def aligned(found: Array, true: Array) -> Array:
    """The motion (T, 22, 3) after the turn about the vertical and the shift that bring it nearest to the truth."""
    middle, goal = found.mean(axis=(0, 1)), true.mean(axis=(0, 1))
    a, b = (found - middle).reshape(-1, 3), (true - goal).reshape(-1, 3)
    angle = np.arctan2(np.sum(a[:, 0] * b[:, 2] - a[:, 2] * b[:, 0]), np.sum(a[:, [0, 2]] * b[:, [0, 2]]))
    cos, sin = np.cos(angle), np.sin(angle)
    return (found - middle) @ np.array([[cos, 0, sin], [0, 1, 0], [-sin, 0, cos]]) + goal


def score(found: Array, true: Array) -> Score:
    """Compares motions (T, 22, 3) of the same frames."""
    near = aligned(found, true)
    about = near - near[:, :1] - (true - true[:, :1])
    path = np.linalg.norm((near - true)[:, 0, [0, 2]], axis=-1)
    low = (true[:, _TOES, 1] < TOE_HEIGHT) & (true[:, _ANKLES, 1] < ANKLE_HEIGHT)
    still = np.linalg.norm(np.diff(true[:, _TOES], axis=0), axis=-1) * FPS < 0.3
    stands = low[1:] & low[:-1] & still
    speed = np.linalg.norm(np.diff(near[:, _TOES][..., [0, 2]], axis=0), axis=-1) * FPS
    return Score(
        1000 * float(np.linalg.norm(about, axis=-1).mean()),
        1000 * float(np.linalg.norm(_best_turned(near, true), axis=-1).mean()),
        100 * float(path.mean()),
        100 * float(speed[stands].mean()) if stands.any() else float("nan"),
    )


def _best_turned(found: Array, true: Array) -> Array:
    a, b = found - found.mean(axis=1, keepdims=True), true - true.mean(axis=1, keepdims=True)
    u, _, vt = np.linalg.svd(np.swapaxes(b, 1, 2) @ a)
    u[..., 2] *= np.linalg.det(u @ vt)[:, None]
    return a @ np.swapaxes(u @ vt, 1, 2) - b


def scores(scene: Scene, text: str, people: Sequence[Clip], *, lens: float = LENS) -> list[Score]:
    """A scene's people against the truth, each with the one they are nearest to."""
    landmarks = unpack_film(text).landmarks
    first = round(tracks_of(landmarks)[0].start * FPS)
    made = []
    for clip in people_of(landmarks, lens=lens).people:
        found = clip.positions.astype(np.float64)
        pairs = []
        for person in people:
            true = person.positions[first : first + len(found)].astype(np.float64)
            pairs.append(score(found[: len(true)], true))
        made.append(min(pairs, key=lambda pair: pair.joints))
    return made


def lens_of(scene: Scene) -> float:
    """Degrees that the scene's camera sees from corner to corner."""
    return float(2 * np.degrees(np.arctan(np.hypot(*scene.size) / 2 / camera(scene).focal)))


def main(argv: Sequence[str] | None = None) -> None:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--data", type=Path, required=True, help="folder of the recordings")
    parser.add_argument("--work", type=Path, required=True, help="folder for films and landmarks")
    given = parser.parse_args(argv)
    given.work.mkdir(parents=True, exist_ok=True)
    scenes = {"tuning": TUNING, "held out": HELD_OUT}
    people = {scene.name: truth(scene, given.data) for scene in (*TUNING, *HELD_OUT)}
    for scene in (*TUNING, *HELD_OUT):
        film = given.work / f"{scene.name}.mp4"
        if not film.exists():
            write_video(pictures(scene, people[scene.name]), film, scene.size)
    with detector(given.work) as find:
        for scene in (*TUNING, *HELD_OUT):
            kept = given.work / f"{scene.name}.json"
            if not kept.exists():
                kept.write_text(find(f"{scene.name}.mp4")[0])
    for label, group in scenes.items():
        for lens in (None, LENS):
            print(f"{label}, lens {'known' if lens is None else f'{lens:g}°'}")
            rows = []
            for scene in group:
                text = (given.work / f"{scene.name}.json").read_text()
                found = scores(scene, text, people[scene.name], lens=lens or lens_of(scene))
                rows += found
                for one in found:
                    print(
                        f"| {scene.name} | {one.joints:.0f} | {one.pose:.0f} | {one.path:.0f} | {one.slide:.0f} |"
                    )
            means = [
                np.nanmean([getattr(row, name) for row in rows])
                for name in ("joints", "pose", "path", "slide")
            ]
            print("| mean | " + " | ".join(f"{value:.0f}" for value in means) + " |", flush=True)


if __name__ == "__main__":
    main()

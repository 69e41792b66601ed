"""Rendered films with known joints, on which the way from video to motion is measured.

Recorded clips move the player's bodies; a camera that stands still films them with
:class:`webdemo.view.stage.Stage`. The films hold what a phone's would not: clean edges, even light, no clothes.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from motion import Clip, Duet
from motion.formats import read
from motion.transforms import put_on_floor, turn
from webdemo.inference.actor import at_30_fps
from webdemo.view.camera import Camera
from webdemo.view.stage import Pane, Stage, Style

SIZE = (1280, 720)
FPS = 30


@dataclass(frozen=True)
class Scene:
    """A film to render.

    Attributes:
        name: of the film.
        clips: stems of one or two recordings.
        start, seconds: the part of them that is used.
        yaw, elevation: of the camera about the people, degrees; yaw 0 looks at the first one's face.
        distance: metres from the camera to the middle of the people.
        height: metres above the floor of the point in the middle of the picture.
        gap: metres between the two, who face each other.
        size: pixels of the picture; upright for a phone.
        theme: "light" or "dark".
    """

    name: str
    clips: tuple[str, ...]
    start: float = 0.0
    seconds: float = 5.0
    yaw: float = 0.0
    elevation: float = 5.0
    distance: float = 3.6
    height: float = 0.92
    gap: float = 1.2
    size: tuple[int, int] = SIZE
    theme: str = "light"


_BN1 = "dataset-1_"
TUNING = (
    Scene("walk-towards", (f"{_BN1}walk_normal_001",), start=1.0, distance=5.0),
    Scene("dance", (f"{_BN1}dance-short_normal_001",), start=1.0, yaw=25),
    Scene("punch", (f"{_BN1}punch_normal_001",), yaw=-35, elevation=12),
    Scene("bow", (f"{_BN1}bow_normal_001",), yaw=60),
    Scene("meet", (f"{_BN1}bye_normal_001", f"{_BN1}respond_normal_001"), yaw=80, distance=4.2),
)
"""Films on which constants of the conversion were chosen."""
HELD_OUT = (
    Scene("walk-aside", ("002_01",), yaw=70, distance=5.5, elevation=3),
    Scene("walk-slant", ("005_01",), yaw=35, distance=5.5, elevation=15, theme="dark"),
    Scene("ballet", ("005_02",), yaw=10, distance=4.0),
    Scene("kick", (f"{_BN1}kick_normal_001",), yaw=20, elevation=8),
    Scene("guide", (f"{_BN1}guide_normal_001",), yaw=-20, size=(720, 1280), distance=3.2),
    Scene("greet", (f"{_BN1}bye_happy_001", f"{_BN1}bow_happy_001"), yaw=90, distance=4.2),
    Scene("spar", (f"{_BN1}punch_normal_002", f"{_BN1}kick_normal_001"), yaw=65, elevation=12, distance=4.4),
    Scene("hidden", (f"{_BN1}byebye_normal_001", f"{_BN1}respond_normal_001"), yaw=35, distance=4.4),
)
"""Films that were looked at only to measure."""


def truth(scene: Scene, data: Path) -> tuple[Clip, ...]:
    """The people of a scene at 30 frames a second, the middle of their way at the origin."""
    people = []
    for number, stem in enumerate(scene.clips):
        (path,) = data.rglob(f"{stem}.bvh")
        clip = at_30_fps(_first(read(path)))
        first = round(scene.start * FPS)
        positions = clip.positions[first : first + round(scene.seconds * FPS)].astype(np.float64)
        middle = (positions[:, 0].min(axis=0) + positions[:, 0].max(axis=0)) / 2
        ahead = positions[0, 1] - positions[0, 2]  # from the right hip to the left one
        placed = turn(positions - middle * [1, 0, 1], float(np.arctan2(ahead[2], ahead[0])))
        if len(scene.clips) == 2:
            side = -1 if number == 0 else 1
            placed = turn(placed, 0.0 if number == 0 else np.pi) + np.array([0, 0, side * scene.gap / 2])
        people.append(put_on_floor(placed))
    frames = min(map(len, people))
    return tuple(Clip(person[:frames], FPS, name=role) for person, role in zip(people, "ab", strict=False))


def _first(motion: Clip | Duet) -> Clip:
    return motion if isinstance(motion, Clip) else motion.a


def camera(scene: Scene) -> Camera:
    """The camera, which stands still."""
    target = np.array([0.0, scene.height, 0.0])
    return Camera(target, np.radians(scene.yaw), np.radians(scene.elevation), scene.distance, scene.size)


def pictures(scene: Scene, people: tuple[Clip, ...]) -> Iterator[NDArray[np.uint8]]:
    """The film's pictures (height, width, 4)."""
    motion = Duet(*people, roles=("a", "b")) if len(people) == 2 else people[0]
    stage = Stage(Pane(motion), Style(names=False, theme=scene.theme), scene.size)
    times = np.arange(people[0].num_frames) / FPS
    return stage.pictures(times, [camera(scene)] * len(times))


def write_video(shown: Iterator[NDArray[np.uint8]], path: Path, size: tuple[int, int]) -> None:
    """Writes pictures as H.264 in MP4."""
    import av

    with av.open(str(path), "w") as film:
        stream = film.add_stream("libx264", rate=Fraction(FPS), options={"preset": "veryfast", "crf": "20"})
        stream.width, stream.height, stream.pix_fmt = *size, "yuv420p"
        for picture in shown:
            film.mux(stream.encode(av.VideoFrame.from_ndarray(np.ascontiguousarray(picture), format="rgba")))
        film.mux(stream.encode(None))

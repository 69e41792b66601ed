"""Contact sheets hold everybody."""

from __future__ import annotations

import numpy as np

from motion import SMPL22, Clip, Duet
from motion.body import load_body, skin
from webdemo.view.camera import cameras


def test_people_who_part_quickly_stay_in_each_moment() -> None:
    rest = SMPL22.rest_positions() + np.array([0, 0.98, 0])
    way = np.linspace(0.4, 4.0, 90)
    people = [rest + side * way[:, None, None] * np.array([0, 0, 1.0]) for side in (-1, 1)]
    duet = Duet.from_positions(np.stack(people).astype(np.float32), fps=30.0)
    size = (200, 230)
    for frame in (0, 45, 89):
        found = cameras([duet], size=size, times=np.array([frame / 30]), around=0.0)[0][0]
        pixels = found.project(duet.positions[:, frame].reshape(-1, 3))[0]
        assert (pixels > 0).all() and (pixels < size).all()


def test_heads_are_not_cut_off() -> None:
    rest = (SMPL22.rest_positions() + np.array([0, 0.98, 0]))[None]
    clip = Clip(np.repeat(rest, 4, axis=0).astype(np.float32), 30.0)
    size = (250, 288)
    found = cameras([clip], size=size, times=np.array([0.0]), around=0.0)[0][0]
    crown = found.project(skin(load_body("man"), clip.positions[:1].astype(float))[0])[0]
    assert (crown > 0).all() and (crown < size).all()

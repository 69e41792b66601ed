"""How long one person takes to answer the other, on motions whose delay is known."""

from __future__ import annotations

import numpy as np
import pytest

from motion import SMPL22
from motion.metrics import response_delay, summary
from motion.metrics.response import LONGEST_DELAY

from .scenes import FPS, duet, face_to_face


def lift(frames: int, begins: int) -> np.ndarray:
    """(T,) from 0 to 1 within half a second."""
    path = np.zeros(frames)
    share = np.linspace(0, np.pi, FPS // 2)
    path[begins : begins + FPS // 2] = (1 - np.cos(share)) / 2
    path[begins + FPS // 2 :] = 1.0
    return path


def answering(delay: int, frames: int = 90, first: int = 35) -> np.ndarray:
    """Each lifts both arms and trunk by half a metre; the second ``delay`` frames after the first."""
    scene = face_to_face(2.0, frames=frames)
    for person, begins in ((0, first), (1, first + delay)):
        scene[person, :, :, 1] += 0.5 * lift(frames, begins)[:, None]
    return scene


@pytest.mark.parametrize("delay", [-20, -5, 0, 4, 12, 30])
def test_the_delay_of_an_answer_is_found(delay: int) -> None:
    assert response_delay(duet(answering(delay))) == pytest.approx(delay / FPS, abs=1.5 / FPS)
    assert summary(duet(answering(delay)))["response_delay"] == pytest.approx(delay / FPS, abs=1.5 / FPS)


def test_another_size_pace_and_noise_of_the_answer_change_little() -> None:
    scene = answering(12)
    scene[1] = scene[1, :1] + 0.4 * (scene[1] - scene[1, :1])
    scene += np.random.default_rng(0).normal(0, 0.002, scene.shape)
    assert response_delay(duet(scene)) == pytest.approx(0.4, abs=0.07)


def test_the_people_exchanged_exchange_its_sign() -> None:
    found = response_delay(duet(answering(9)))
    assert found is not None and response_delay(duet(answering(9)[::-1])) == pytest.approx(-found)


def test_where_nobody_answers_there_is_no_delay() -> None:
    assert response_delay(duet(face_to_face(2.0))) is None
    alone = answering(10)
    alone[1] = alone[1, :1]
    assert response_delay(duet(alone)) is None
    late = answering(round(LONGEST_DELAY * FPS) + 20, frames=140)
    assert response_delay(duet(late)) is None
    for frames in (1, 2, 4):
        assert response_delay(duet(answering(0)[:, :frames])) is None


def test_any_joint_that_moves_counts() -> None:
    scene = face_to_face(2.0, frames=90)
    wrists = [SMPL22.index("left_wrist"), SMPL22.index("right_wrist"), SMPL22.index("left_elbow")]
    scene[0, :, wrists, 2] += 0.8 * lift(90, 20)
    scene[1, :, wrists, 2] -= 0.8 * lift(90, 29)
    assert response_delay(duet(scene)) == pytest.approx(0.3, abs=1.5 / FPS)

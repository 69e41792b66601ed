"""Kinect text: both kinds come back as they were, and nothing else gets through."""

import numpy as np
import pytest

from motion import SKELETONS, Duet, InputError
from motion.formats import read
from tests.motion.bodies import as_stored

from .written import sbu_text, skeleton_text


@pytest.fixture
def bodies() -> np.ndarray:
    return np.random.default_rng(0).normal(size=(2, 12, 25, 3)).round(4)


def test_skeleton_files_hold_their_two_people(bodies: np.ndarray) -> None:
    duet = as_stored(skeleton_text(bodies).encode(), name="S001.skeleton")
    assert isinstance(duet, Duet)
    assert duet.fps == 30
    np.testing.assert_allclose(duet.positions, bodies, atol=1e-5)


def test_frames_without_a_body_are_interpolated_and_ghosts_left_out(bodies: np.ndarray) -> None:
    duet = as_stored(skeleton_text(bodies, {1: {0, 5}}).encode(), name="x.skeleton")
    np.testing.assert_allclose(duet.b.positions[5], (bodies[1, 4] + bodies[1, 6]) / 2, atol=1e-5)
    np.testing.assert_allclose(duet.b.positions[0], bodies[1, 1], atol=1e-5)
    alone = as_stored(skeleton_text(bodies, {1: set(range(3, 12))}).encode(), name="x.skeleton")
    np.testing.assert_allclose(alone.positions, bodies[0], atol=1e-5)


def test_a_joint_that_is_nan_for_a_frame_is_interpolated(bodies: np.ndarray) -> None:
    broken = bodies.copy()
    broken[0, 4, 7, 1] = np.nan
    duet = as_stored(skeleton_text(broken).encode(), name="x.skeleton")
    assert isinstance(duet, Duet)
    np.testing.assert_allclose(duet.a.positions[4, 7], (bodies[0, 3, 7] + bodies[0, 5, 7]) / 2, atol=1e-5)


def test_a_body_that_is_found_again_is_the_same_one_and_a_gap_is_said() -> None:
    body = np.random.default_rng(3).normal(scale=0.3, size=(1, 60, 25, 3)).round(4)
    three = np.concatenate([body, body + 1.0, body + 1.0])
    lost = {1: set(range(20, 60)), 2: set(range(35))}
    duet = as_stored(skeleton_text(three, lost).encode(), name="x.skeleton")
    assert isinstance(duet, Duet)
    np.testing.assert_allclose(duet.b.positions[[5, 50]], three[1, [5, 50]], atol=1e-5)
    assert duet.b.notes == ("x.skeleton: person B is not seen from 0.7 to 1.2 s and is interpolated there.",)
    end = as_stored(skeleton_text(three[:2], {1: set(range(35, 60))}).encode(), name="x.skeleton")
    assert isinstance(end, Duet) and "from 1.2 to 2.0 s and is held still" in end.b.notes[0]


def test_sbu_numbers_become_metres() -> None:
    raw = np.random.default_rng(1).uniform(0.1, 0.9, size=(9, 90)).round(6)
    duet = as_stored(sbu_text(raw).encode(), name="skeleton_pos.txt")
    assert duet.fps == 15
    assert duet.skeleton is SKELETONS["sbu15"]
    x, y, z = raw[4, 45:48]  # the second person's head
    expected = [(1280 - 2560 * x) / 1000, (960 - 1920 * y) / 1000, 10 * z / 7.8125]
    np.testing.assert_allclose(duet.b.positions[4, 0], expected, atol=1e-5)


WRONG = {
    "no Kinect text": (b"hello world", "begins neither"),
    "huge count": (b"999999999\n1\n", "lasts"),
    "cut short": (b"3\n1\nid\n25\n0 0 0", "cut short"),
    "words": (b"1\n1\nid\n25\n0 a 0\n", "line 5: something is not a number"),
    "nan": (b"1\n1\nid\n25\n" + b"0 nan 0\n" * 25, "NaN in every frame"),
    "short row": (b"1,0.5,0.5\n", "90 are needed"),
    "far": (("1," + ",".join(["1e9"] * 90)).encode(), "away"),
}


@pytest.mark.parametrize("case", WRONG)
def test_wrong_files_are_refused_in_one_sentence(case: str) -> None:
    data, says = WRONG[case]
    with pytest.raises(InputError, match=rf"\A.*{says}.*\Z"):
        read(data, name="clip.skeleton")

"""The finish of a scene leaves what is kept of a given motion as it is."""

from __future__ import annotations

import numpy as np
import pytest

from motion import SMPL22, Duet
from motion.transforms import heading_matrix
from webdemo.inference import SceneRequest
from webdemo.inference.finish import cleanup
from webdemo.inference.finish.cleanup import finished
from webdemo.inference.story.beats import Beat

FRAMES = 180


def _still(gap: float = 1.4) -> np.ndarray:
    """Two people who stand face to face without moving: (2, T, 22, 3) float32."""
    pose = SMPL22.standing()
    other = pose @ heading_matrix(np.pi).T + np.array([0.0, 0.0, gap])
    return np.tile(np.stack([pose, other])[:, None], (1, FRAMES, 1, 1)).astype(np.float32)


def test_frames_that_are_kept_stay_and_what_is_remade_between_them_is_finished() -> None:
    scene = _still(0.2)
    motion = Duet.from_positions(scene, fps=30.0, roles=("a", "b"))
    request = SceneRequest(beats=(Beat("They wait."),), motion=motion, start=2.0, end=4.0)
    found = finished(request, scene)
    np.testing.assert_array_equal(found[:, :60], scene[:, :60])
    np.testing.assert_array_equal(found[:, 120:], scene[:, 120:])
    assert np.abs(found[:, 85:95] - scene[:, 85:95]).max() > 0.005
    assert np.abs(np.diff(found, axis=1)).max() < 0.02, "no jump at the edges"


@pytest.mark.parametrize(
    ("part", "words"), [("palms_met", "They high-five."), ("hands_clasped", "They walk hand in hand.")]
)
def test_hands_meet_in_the_beats_in_which_the_words_say_so(
    monkeypatch: pytest.MonkeyPatch, part: str, words: str
) -> None:
    shares: list[np.ndarray] = []

    def met(pair: np.ndarray, share: np.ndarray) -> np.ndarray:
        shares.append(share)
        return pair

    monkeypatch.setattr(cleanup, part, met)
    beats = (Beat("They wave.", seconds=3.0), Beat(words, seconds=3.0))
    finished(SceneRequest(beats=beats), _still())
    assert not shares[0][:69].any() and (shares[0][90:] == 1).all()
    assert np.abs(np.diff(shares[0])).max() < 0.15, "no jolt at the seam"


def test_two_who_stand_in_each_other_are_moved_apart() -> None:
    request = SceneRequest(beats=(Beat("They wait.", seconds=6.0),))
    found = finished(request, _still(0.12))
    chests = np.linalg.norm(found[0, :, SMPL22.index("spine3")] - found[1, :, SMPL22.index("spine3")], axis=-1)
    assert chests.min() > 0.17

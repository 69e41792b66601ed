"""Children in requests: made as adults, shown at their size, and gone on from as they were."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from motion import SMPL22, Duet
from motion.looks import SIZES, UNSAID
from motion.metrics import compare
from motion.sizes import floor_scale
from tests.inference.runs import run
from webdemo.inference import Engine, GenerateRequest, Result, SceneRequest
from webdemo.inference.finish.looks import enlarged, furnished
from webdemo.inference.requests.paths import FloorPath, FloorPoint
from webdemo.inference.requests.predict import PredictRequest, PredictResult
from webdemo.inference.story import Beat
from webdemo.inference.story.poses import Pose

QUICK: dict[str, Any] = {"steps": 3, "seed": 1}
CHILD = SIZES["girl"]
LEG = SMPL22.index("left_knee")


def bones(duet: Duet) -> np.ndarray:
    """Mean length of a thigh of each person, as a share of SMPL22's."""
    thighs = duet.positions[:, :, LEG] - duet.positions[:, :, SMPL22.index("left_hip")]
    return np.linalg.norm(thighs, axis=-1).mean(axis=1) / SMPL22.bone_lengths[LEG]


def test_a_girl_of_the_words_is_made_at_her_size(engine: Engine) -> None:
    result = run(engine, GenerateRequest(prompt="A man waves at a girl.", seconds=3.0, **QUICK))
    (duet,) = result.duets
    assert duet.looks == ("man", "girl")
    np.testing.assert_allclose(bones(duet), (1.0, CHILD), atol=0.01)
    assert result.manifest["looks"] == duet.manifest["looks"] == ["man", "girl"]
    assert result.readouts[0]["before"] is None and result.readouts[0]["after"] == compare(None, duet)["after"]
    again = run(engine, GenerateRequest(prompt="A man waves at a girl.", seconds=3.0, **QUICK))
    np.testing.assert_array_equal(again.duets[0].positions, duet.positions)


def test_a_path_on_the_floor_is_where_it_was_drawn(engine: Engine) -> None:
    path = FloorPath("a", (FloorPoint(0.0, 0.0, 0.0), FloorPoint(1.2, 0.9, 3.0)))
    request = GenerateRequest(prompt="A man walks. A girl waves.", seconds=4.0, paths=(path,), **QUICK)
    longer = enlarged(request).paths[0].points[-1]
    assert longer.x == pytest.approx(request.paths[0].points[-1].x / floor_scale((1.0, CHILD)))
    points = request.paths[0].points
    (duet,) = run(engine, request).duets
    for point in (points[0], points[-1]):
        at = duet.positions[0, min(round((point.seconds or 0.0) * 30), duet.num_frames - 1), 0]
        np.testing.assert_allclose(at[[0, 2]], [point.x, point.z], atol=0.12)


def test_a_childs_pose_is_asked_for_as_an_adults() -> None:
    rest = SMPL22.standing()
    pose = Pose("b", 1.0, CHILD * rest + [0.5, 0.0, 0.0])
    request = SceneRequest(beats=(Beat("A man waves at a girl.", seconds=3.0),), poses=(pose,), **QUICK)
    (large,) = enlarged(request).poses
    np.testing.assert_allclose(large.positions, rest + np.array([0.5 / floor_scale((1.0, CHILD)), 0.0, 0.0]), atol=1e-3)
    same = replace(pose, positions=rest)
    (kept,) = enlarged(replace(request, poses=(same,))).poses
    np.testing.assert_allclose(kept.positions, rest, atol=1e-3)


def test_what_comes_next_of_a_girl_is_hers(engine: Engine, shipped: Engine) -> None:
    """The predictor would lift her to an adult's height."""
    motion = run(engine, GenerateRequest(prompt="A man waves at a girl.", seconds=3.0, **QUICK)).duets[0]
    request = PredictRequest(motion=motion, marker=2.0, seconds=1.0)
    result = run(shipped, request)
    assert isinstance(result, PredictResult) and result.truth is not None
    (duet,) = result.duets
    assert duet.looks == ("man", "girl")
    np.testing.assert_array_equal(duet.positions[:, :60], motion.positions[:, :60])
    np.testing.assert_array_equal(result.truth.positions, motion.positions[:, 60:])
    np.testing.assert_allclose(bones(duet.cut(60)), (1.0, CHILD), atol=0.01)
    toes = [SMPL22.index("left_foot"), SMPL22.index("right_foot")]
    assert abs(duet.positions[1, -1, toes, 1].min() - motion.positions[1, 59, toes, 1].min()) < 0.06
    off = np.linalg.norm(duet.positions[:, 60:90] - motion.positions[:, 60:90], axis=-1).mean(axis=(0, 2))
    np.testing.assert_allclose(result.error, 1000 * off, atol=0.02)


def test_who_is_given_with_a_childs_bones_wears_a_childs_body(engine: Engine) -> None:
    duet = run(engine, GenerateRequest(prompt="A man waves at a girl.", seconds=3.0, **QUICK)).duets[0]
    bare = replace(duet, looks=UNSAID, things=(), grips=())
    result = furnished(Result(duets=(bare,), manifest={}, readouts=({"after": {}},)), [])
    assert result.duets[0].looks == ("man", "girl")
    assert result.readouts[0]["after"] == compare(None, result.duets[0])["after"]
    np.testing.assert_array_equal(result.duets[0].positions, bare.positions)

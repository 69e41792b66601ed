"""A prediction's promises: the past stays, the seam does not jump, bones keep, who stands still stays."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from models.motion_mlp import MotionMLP, MotionMLPConfig
from models.weights_io import save_network
from motion import SMPL22, Clip, Duet, InputError, stacked_positions
from motion.formats import read
from motion.kinematics import bone_lengths, forward_kinematics
from motion.skeleton import SBU15
from motion.transforms import heading_matrix
from webdemo.inference import PredictRequest, PredictResult
from webdemo.inference.engine import Engine
from webdemo.inference.method import WEIGHTS
from webdemo.inference.pipelines.predictor import PredictorPipeline, faded, with_bones_of, with_planted_feet
from webdemo.inference.requests.predict import mean_steps
from webdemo.ui.text.examples import CLIPS


def walker(seconds: float = 3.0, fps: float = 30.0, turn: float = 0.7) -> Clip:
    """A person who glides along and swings an arm."""
    times = np.arange(round(seconds * fps)) / fps
    rotations = np.tile(np.eye(3), (len(times), 22, 1, 1))
    rotations[:, 0] = heading_matrix(turn)
    swing = np.sin(4 * times)
    c, s = np.cos(swing), np.sin(swing)
    shoulder = rotations[:, SMPL22.index("right_shoulder")]
    shoulder[:, 0, 0], shoulder[:, 0, 1], shoulder[:, 1, 0], shoulder[:, 1, 1] = c, s, -s, c
    root = np.stack([np.sin(turn) * times, np.full_like(times, 0.96), np.cos(turn) * times], axis=1)
    return Clip(forward_kinematics(rotations, root) * 1.1, fps, name="walker")


@pytest.fixture(scope="session")
def predicting(tmp_path_factory: pytest.TempPathFactory) -> Engine:
    """An engine whose predictor has weights drawn at random, large enough to jump if it could."""
    torch.manual_seed(0)
    network = MotionMLP(MotionMLPConfig(width=32, blocks=1))
    with torch.no_grad():
        for parameter in network.parameters():
            parameter.normal_(std=0.02)
    folder = tmp_path_factory.mktemp("predictors")
    save_network(folder / "motion-mlp", network, kind="mlp", fps=30.0)
    return Engine(folder)


def predict(engine: Engine, **asked: object) -> PredictResult:
    (result,) = (e for e in engine.run(PredictRequest(**asked)) if isinstance(e, PredictResult))
    return result


@pytest.mark.parametrize("seconds", [0.5, 1.0, 4.0])
def test_one_person_goes_on(predicting: Engine, seconds: float) -> None:
    clip = walker()
    result = predict(predicting, motion=clip, marker=1.5, seconds=seconds)
    (motion,) = result.duets
    assert isinstance(motion, Clip) and motion.num_frames == 45 + round(30 * seconds)
    assert motion.positions[:45].tobytes() == clip.positions[:45].tobytes()
    assert result.past_frames == 45 and np.isfinite(motion.positions).all()
    assert np.allclose(bone_lengths(motion.positions[45:]), bone_lengths(motion.positions[44]), atol=1e-4)
    steps = mean_steps(motion.positions)
    assert steps[44] <= steps[15:44].max() + 1e-6
    # Every second of a recursion begins as smoothly as the first.
    seams = steps[[frame for frame in (74, 104, 134) if frame < len(steps)]]
    assert np.all(seams <= steps.max() + 1e-6)
    known = min(45, round(30 * seconds))
    assert len(result.error) == len(result.true_speed) == known and len(result.speed) == round(30 * seconds)
    real = clip.positions[45 : 45 + known].astype(np.float64)
    expected = 1000 * np.linalg.norm(motion.positions[45 : 45 + known] - real, axis=-1).mean(-1)
    assert np.allclose(result.error, expected, atol=0.1)


def test_two_people_go_on_as_each_would_alone(predicting: Engine) -> None:
    a, b = walker(), walker(turn=-2.0)
    result = predict(predicting, motion=Duet(a, b), marker=2.0, seconds=1.0)
    assert isinstance(result.duets[0], Duet) and result.manifest["request"]["motion"]["people"] == 2
    assert result.duets[0].manifest is not None
    for person, alone in zip(result.duets[0].people, (a, b), strict=True):
        single = predict(predicting, motion=alone, marker=2.0, seconds=1.0).duets[0]
        assert np.allclose(person.positions, single.positions, atol=1e-4)


def test_where_a_motion_lies_changes_nothing(predicting: Engine) -> None:
    clip = walker()
    matrix, shift = heading_matrix(1.2), np.array([3.0, 0.0, -2.0])
    moved = clip.with_positions(clip.positions @ matrix.T + shift)
    here = predict(predicting, motion=clip, seconds=1.0).duets[0].positions
    there = predict(predicting, motion=moved, seconds=1.0).duets[0].positions
    assert np.allclose(here @ matrix.T + shift, there, atol=1e-3)


@pytest.mark.parametrize(
    ("asked", "sentence"),
    [
        ({"marker": 0.4}, "The past is 0.40 s long, and 1 s or more is needed: move the marker"),
        ({"marker": 5.0}, "The marker, 5 s, is after the end of the motion, which lasts 3.00 s."),
        ({"marker": float("nan")}, "Marker must be a number"),
        ({"motion": walker(0.5)}, "The past is 0.50 s long, and 1 s or more is needed: give a longer motion."),
        ({"motion": walker(61.0)}, "The motion lasts 61 s: cut it to 60 s or less."),
        ({"seconds": 9.0}, "Length must be from 0.5 to 4 seconds, not 9."),
        ({"motion": Clip(np.zeros((60, 15, 3)), 30.0, SBU15)}, "SMPL's 22 joints, not sbu15's"),
    ],
)
def test_what_cannot_be_predicted_is_one_sentence(asked: dict, sentence: str) -> None:
    with pytest.raises(InputError) as error:
        PredictRequest(**{"motion": walker()} | asked)
    assert sentence in str(error.value) and "\n" not in str(error.value)


def test_teleporting_joints_are_refused_where_they_are_looked_at() -> None:
    positions = walker().positions.copy()
    positions[50, 20] += 2.0
    broken = walker().with_positions(positions)
    with pytest.raises(InputError, match=r"The left wrist jumps 3\.\d m from one frame to the next at 1\.\d\d s"):
        PredictRequest(motion=broken, marker=2.0)
    assert PredictRequest(motion=broken, marker=1.5).past_frames == 45
    with pytest.raises(InputError, match="NaN"):
        walker().with_positions(np.full_like(positions, np.nan))


def test_two_predictions_are_joined_without_haste() -> None:
    ahead = np.array([0.0, 0.0, 0.01])
    pose = np.random.default_rng(0).normal(size=(2, 1, 22, 3))
    steady = pose + ahead * np.arange(31)[:, None, None]
    assert np.allclose(faded(steady[:, :11], steady[:, 1:]), steady[:, 1:])
    assert np.allclose(faded(steady[:, :1], steady[:, 1:]), steady[:, 1:])
    aside = pose + np.array([0.01, 0.0, 0.0]) * np.arange(31)[:, None, None]
    made = faded(steady[:, :11], aside[:, 1:])
    steps = mean_steps(np.concatenate([pose, made], axis=1))
    assert steps.max() < 0.01 + 1e-9 and steps.min() > 0.007
    assert np.allclose(np.diff(made[:, 10:], axis=1), [0.01, 0.0, 0.0])


def test_the_shipped_network_goes_on_moving_without_a_jump() -> None:
    """Eq. 2.13 of Chopin's thesis, over all shipped examples and markers two tenths of a second apart."""
    predictor = PredictorPipeline(WEIGHTS / "motion-mlp")
    own, real, errors, held = [], [], [], []
    for path in sorted(CLIPS.glob("*.npz")):
        people = stacked_positions(read(path)).astype(np.float64)
        for marker in range(30, people.shape[1] - 30, 6):
            past, truth = people[:, :marker], people[:, marker : marker + 30]
            made = predictor.predict(past, 30)
            own.append(mean_steps(np.concatenate([past[:, -1:], made], axis=1)))
            real.append(mean_steps(np.concatenate([past[:, -1:], truth], axis=1)))
            assert np.all(own[-1][:, 0] <= mean_steps(past[:, -30:]).max(axis=1) + 1e-6)
            errors.append(np.linalg.norm(made - truth, axis=-1).mean())
            held.append(np.linalg.norm(past[:, -1:] - truth, axis=-1).mean())
    share = np.concatenate(own).mean(0) / np.concatenate(real).mean(0)
    assert len(errors) > 30 and np.all((share > 0.7) & (share < 1.3)), share
    assert np.mean(errors) < 0.85 * np.mean(held)


def test_feet_that_stand_stay_where_the_past_left_them() -> None:
    pose = SMPL22.standing()
    lean = np.zeros_like(pose)
    lean[:, 0] = 0.05 * pose[:, 1]
    sway = np.sin(np.arange(30) / 8)[:, None, None]
    past = (pose + sway * lean)[None]
    slide = 0.004 * np.arange(1, 41)[:, None, None] * np.array([0.0, 0.0, 1.0])
    future = with_bones_of(past[:, -1], past[:, -1:] + slide[None])
    made = with_planted_feet(past, future, 30.0)
    feet = [SMPL22.index(f"{side}_foot") for side in ("left", "right")]
    moved = np.linalg.norm((made - past[:, -1:])[..., feet, :], axis=-1)
    assert np.linalg.norm((future - past[:, -1:])[..., feet, :], axis=-1).max() > 0.15
    assert moved[0, :20].max() < 0.02
    assert np.allclose(bone_lengths(made), bone_lengths(future), atol=1e-4)
    joined_up = np.concatenate([past, made], axis=1)
    assert mean_steps(joined_up)[0, 29] <= mean_steps(past).max() + 1e-6
    # Who floats, or does not move, is left as they are.
    up = np.array([0.0, 0.5, 0.0])
    assert np.array_equal(with_planted_feet(past + up, future + up, 30.0), future + up)
    held = np.repeat(past[:, -1:], 40, axis=1)
    assert np.array_equal(with_planted_feet(past, held, 30.0), held)

"""What is given of a scene is met by what the pipeline makes, after clean-up too, and nonsense is refused."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
import torch

from acts.staging.given import places_of
from acts.staging.window import KnownFrames, KnownPath, Part
from models.known import KNOWN_FEATURES
from models.motion_tokens import FEATURES
from motion import SMPL22, Duet, InputError
from motion.transforms import heading_matrix
from webdemo.inference import Engine, GenerateRequest
from webdemo.inference.pipelines.given import FADE, Scene, directed, draft_of, with_given, with_joints
from webdemo.inference.run import CancelToken, StageTimer

FRAMES = 60


def walker(frames: int = FRAMES, angle: float = 0.0, speed: float = 1.0) -> np.ndarray:
    rest = (SMPL22.rest_positions() + np.array([0, 0.98, 0])) @ heading_matrix(angle).T
    way = np.arange(frames)[:, None, None] / 30 * speed * np.array([np.sin(angle), 0, np.cos(angle)])
    return rest + way


def make(engine: Engine, parts: Sequence[Part], **changes: float) -> Duet:
    pipeline = engine.pipeline("intergen")
    request = GenerateRequest(prompt="They walk away from each other.", seconds=FRAMES / 30, steps=4, **changes)
    scene = directed(pipeline.model, FRAMES, parts)
    *_, result = pipeline.run(request, CancelToken(), StageTimer(), scene=scene)
    return result.duets[0]


def test_a_span_and_a_pose_are_held_exactly(either_engine: Engine) -> None:
    past = walker()[:20]
    pose = walker(angle=1.0)[40:41] + np.array([1.0, 0, 0])
    parts = [KnownFrames(0, range(20), past), KnownFrames(1, [45], pose)]
    duet = make(either_engine, parts)
    np.testing.assert_allclose(duet.a.positions[:20], past, atol=1e-6)
    np.testing.assert_allclose(duet.b.positions[45], pose[0], atol=1e-6)
    free = make(either_engine, [])
    assert np.abs(free.a.positions[:20] - past).max() > 0.1
    assert np.abs(free.b.positions[45] - pose[0]).max() > 0.1


def test_a_draft_is_shown_and_not_held(reading_engine: Engine) -> None:
    poses, frames = walker()[::5], range(0, FRAMES, 5)
    model = reading_engine.pipeline("intergen").model
    parts = [KnownFrames(0, frames, poses, soft=True), KnownPath(1, [0], np.zeros((1, 2)))]
    scene = directed(model, FRAMES, parts)
    assert scene.draft is not None and scene.draft.any() and scene.given is not None
    assert torch.equal(scene.given.features, directed(model, FRAMES, places_of(parts)).given.features)
    assert scene.shares.max() < 0.3, "places alone"
    assert not scene.draft.view(*scene.draft.shape[:2], 2, -1)[:, :, 1].any(), "it is person a's"


@pytest.mark.parametrize("strictness", [0.0, 0.5, 1.0])
def test_a_free_draft_is_shown_and_never_held(reading_engine: Engine, strictness: float) -> None:
    model = reading_engine.pipeline("intergen").model
    place = KnownPath(0, [0, 30], np.zeros((2, 2)))
    free = KnownFrames(0, range(0, FRAMES, 5), walker()[::5], range(22), soft=True, free=True)
    scene = directed(model, FRAMES, [place, free], strictness)
    assert scene.draft is not None and scene.draft.any()
    assert torch.equal(scene.shares, directed(model, FRAMES, [place], strictness).shares)
    assert not any(isinstance(part, KnownFrames) for part in scene.parts)


def test_a_draft_is_filled_in_between_near_poses(reading_engine: Engine) -> None:
    model = reading_engine.pipeline("intergen").model
    drafted = [draft_of(model, FRAMES, [KnownFrames(0, at, walker()[at], soft=True)]) for at in ([0, 16], [0, 48])]
    said = [draft.view(1, -1, 2, 2, KNOWN_FEATURES)[:, :, 0, :, FEATURES + 3].flatten().sum() for draft in drafted]
    assert said[0] >= 16 / model.layout.frames_per_knot, "every knot between them"
    assert said[1] == 2


def test_a_draft_faces_as_the_joints_that_it_has() -> None:
    angle = 2.5
    poses = walker(angle=angle, speed=0.0)[:2]
    poses[:, 1:3] = poses[:, :1]  # the hips are nobody's
    above = [0, SMPL22.index("left_shoulder"), SMPL22.index("right_shoulder")]
    (path,) = places_of([KnownFrames(0, [0, 1], poses, above, soft=True)])
    assert isinstance(path, KnownPath) and path.headings is not None
    np.testing.assert_allclose(path.headings, angle, atol=1e-6)
    (path,) = places_of([KnownFrames(0, [0, 1], poses, [0, SMPL22.index("neck")], soft=True)])
    assert isinstance(path, KnownPath) and path.headings is None


def test_the_stricter_a_plan_the_nearer_are_its_poses(reading_engine: Engine) -> None:
    poses, frames, total = walker()[::5], range(0, FRAMES, 5), 8
    model = reading_engine.pipeline("intergen").model
    parts = [KnownFrames(0, frames, poses, soft=True), KnownPath(1, [0], np.zeros((1, 2)))]
    x = torch.randn(1, model.layout.num_tokens(FRAMES), 2 * model.layout.token_features)
    off: list[float] = []
    for strictness in (0.0, 0.3, 0.55, 0.8):
        scene = directed(model, FRAMES, parts, strictness)
        scene = replace(scene, poses=scene.poses or directed(model, FRAMES, parts, 0.5).poses)
        held = scene.held(total)
        off.append(sum(float((given(x) - scene.poses(x)).abs().mean()) for given in held))
    assert off == sorted(off, reverse=True) and len({round(each, 6) for each in off}) == len(off)
    strict = directed(model, FRAMES, parts, 1.0)
    assert strict.draft is None and strict.parts == parts, "what is finished meets the poses"


def test_a_given_heading_is_shown_to_a_network_that_sees_it(reading_engine: Engine) -> None:
    way = walker()[:, 0][:, [0, 2]]
    turned = [make(reading_engine, [KnownPath(0, range(FRAMES), way, np.full(FRAMES, h))]) for h in (0.0, 2.0)]
    assert not np.allclose(turned[0].a.positions, turned[1].a.positions, atol=1e-4)


def test_clean_up_is_taken_back_at_given_frames_and_fades() -> None:
    made, given = np.zeros((40, 22, 3)), np.ones((2, 22, 3))
    found = with_given(made, np.array([30, 10]), given * np.array([2.0, 1.0])[:, None, None])
    assert (found[10] == 1).all() and (found[30] == 2).all()
    assert (found[20] == 0).all(), "half-way between them"
    assert (with_given(made, np.array([10]), given[:1])[10 + FADE + 1 :] == 0).all()
    assert (np.diff(found[10:21, 0, 0]) < 0).all()
    assert (with_given(made, np.array([0]), given[:1])[1:7, 0, 0] > 0).all()


def test_a_single_pose_moves_only_what_is_near_it() -> None:
    made = np.stack([walker(), walker(speed=0.8)]).astype(np.float32)
    pose = made[0, 30:31].copy()
    pose[..., 1:, 0] += 0.05
    frames = FRAMES
    scene = Scene(frames, None, parts=[KnownFrames(0, [30], pose)])
    found = scene.duet(made, lambda person: person).positions
    np.testing.assert_allclose(found[0, 30], pose[0], atol=1e-6)
    away = np.abs(np.arange(frames) - 30) > FADE
    np.testing.assert_allclose(found[0, away], made[0, away], atol=1e-6)


@pytest.mark.parametrize(
    ("parts", "says"),
    [
        ([KnownFrames(0, [60], walker(1))], "from 0 to 59"),
        ([KnownFrames(0, [], walker(1)[:0])], "from 0 to 59"),
        ([KnownFrames(0, [5, 5], walker(2))], "each once"),
        ([KnownFrames(0, range(9), walker(9)), KnownPath(0, [5, 20], np.zeros((2, 2)))], "Two given parts"),
    ],
)
def test_nonsense_is_refused_in_one_sentence(engine: Engine, parts: list[Part], says: str) -> None:
    with pytest.raises(InputError, match=says):
        directed(engine.pipeline("intergen").model, FRAMES, parts)


def test_joints_that_are_kept_are_met_smoothly_and_bones_stay_as_long() -> None:
    rest = SMPL22.rest_positions() + np.array([0.0, 0.95, 0.0])
    made = np.repeat(rest[None], 90, axis=0)
    frames = np.arange(30, 70, 3)
    poses = np.repeat(rest[None], len(frames), axis=0)
    poses[..., 0] += 0.05 + 0.1 * np.sin((frames - 30) / 8)[:, None]
    joints = [j for j in range(22) if j not in (18, 19, 20, 21)]
    found = with_joints(made, KnownFrames(0, frames.tolist(), poses, joints, kept=True))
    assert np.abs(found[frames] - poses).max() < 1e-3, "the arms go with the shoulders"
    assert np.abs(np.diff(found[31:69], n=3, axis=0)).max() < 0.004, "also between the given frames"
    assert np.abs(found[:15] - made[:15]).max() < 1e-3

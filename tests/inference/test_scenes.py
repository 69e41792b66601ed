"""Scenes through the engine: windows that join, kept parts, spans bit for bit, wishes that are met."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import torch

from acts import Plan
from motion import SMPL22, Duet
from motion.metrics import compare
from motion.skeleton import ARMS
from tests.inference.runs import positions, run
from webdemo.inference import Cancelled, CancelToken, Engine, GenerateRequest, Result, SceneRequest
from webdemo.inference.story import Beat, FloorPath, FloorPoint, Pose, SceneProgress
from webdemo.inference.story.sentences import as_scene

QUICK: dict[str, Any] = {"steps": 3}
BEATS = (Beat("They wave.", seconds=2.0), Beat("They walk away.", seconds=2.5), Beat("They bow.", seconds=1.5))


@pytest.fixture(scope="module")
def story(engine: Engine) -> Result:
    return run(engine, SceneRequest(beats=BEATS, **QUICK))


def test_a_scene_has_the_length_of_its_beats_and_says_what_made_it(story: Result) -> None:
    assert positions(story).shape == (2, 180, 22, 3) and np.isfinite(positions(story)).all()
    assert SceneRequest.from_dict(story.manifest["request"]).beats == BEATS
    assert story.readouts[0]["after"]


def test_nobody_jolts_where_one_beat_of_a_story_ends(shipped: Engine) -> None:
    words = ("They walk up to each other and shake hands.", "They talk.", "They part.")
    request = SceneRequest(beats=tuple(Beat(each, seconds=4.0) for each in words), seed=0)
    jolts = np.linalg.norm(np.diff(positions(run(shipped, request)), 2, axis=1), axis=-1).max(axis=(0, 2))
    usual = np.quantile(jolts, 0.99)
    for seam in (120, 240):
        assert jolts[seam - 6 : seam + 6].max() < 1.5 * usual


def test_one_beat_is_what_plain_generation_gives(engine: Engine) -> None:
    """But for the finish of a scene, in which people who stand shift their weight."""
    plainly = {"seed": 5, "cleanup": False, **QUICK}
    scene = run(engine, SceneRequest(beats=BEATS[:1], **plainly))
    plain = run(engine, GenerateRequest(prompt="They wave.", seconds=2.0, **plainly))
    np.testing.assert_allclose(positions(scene), positions(plain), atol=1e-5)


def test_a_window_that_another_follows_is_made_longer_and_cut(engine: Engine, monkeypatch: pytest.MonkeyPatch) -> None:
    lengths, pipeline = [], engine.pipeline("intergen")
    inner = pipeline.sample

    def sample_and_note(settings: Any, words: Any, scene: Any, *rest: Any, **more: Any) -> Any:
        lengths.append(scene.frames)
        return inner(settings, words, scene, *rest, **more)

    monkeypatch.setattr(pipeline, "sample", sample_and_note)
    found = run(engine, SceneRequest(beats=(*BEATS[:2], Beat("They bow.", seconds=9.0)), seed=99, **QUICK))
    tail = 8
    assert lengths == [60 + tail, 48 + 75 + tail, 48 + 135 + tail, 48 + 135]
    assert positions(found).shape[1] == 60 + 75 + 270


def test_parts_that_did_not_change_are_not_made_again(engine: Engine, story: Result) -> None:
    changed = SceneRequest(beats=(*BEATS[:2], Beat("They shake hands.", seconds=1.5)), **QUICK)
    steps = [e.step for e in engine.run(changed) if e.__class__.__name__ == "Progress" and e.stage == "sample"]
    assert min(steps) == 2 * QUICK["steps"] + 1
    again = run(engine, changed)
    # The finish of a scene looks a few frames ahead, and arms swing as is usual over a stride and two.
    arms = {*ARMS[0][1:], *ARMS[1][1:]}
    rest = [joint for joint in range(SMPL22.num_joints) if joint not in arms]
    for joints, until in ((rest, 135), (range(SMPL22.num_joints), 60)):
        before, after = (positions(each)[:, :until][:, :, list(joints)] for each in (story, again))
        np.testing.assert_allclose(after, before, atol=1e-4)
    other = run(engine, SceneRequest(beats=(BEATS[0], replace(BEATS[1], seed=8), BEATS[2]), **QUICK))
    # arms and feet give way smoothly, also to what comes next
    np.testing.assert_allclose(positions(other)[:, :60], positions(story)[:, :60], atol=1e-2)
    assert np.abs(positions(other)[:, 60:135] - positions(story)[:, 60:135]).max() > 0.01


def test_a_short_window_is_not_taken_for_a_shorter_one(engine: Engine) -> None:
    for seconds in (0.6, 0.8):
        made = run(engine, SceneRequest(beats=(Beat("They wave.", seconds=seconds),), planned=False, **QUICK))
        assert positions(made).shape[1] == round(30 * seconds)


def test_a_pose_at_the_very_end_is_met(engine: Engine, story: Result) -> None:
    pose = Pose("a", 2.0, positions(story)[0, 30])
    made = run(engine, SceneRequest(beats=BEATS[:1], poses=(pose,), **QUICK))
    np.testing.assert_allclose(positions(made)[0, -1], pose.positions, atol=0.03)


def test_the_things_of_a_given_motion_are_said_to_be_gone(engine: Engine) -> None:
    seated = run(engine, GenerateRequest(prompt="A sits down on a chair.", seconds=3.0, **QUICK)).duets[0]
    assert isinstance(seated, Duet) and seated.things
    went_on = run(engine, SceneRequest(beats=(Beat("They wave.", seconds=1.0),), motion=seated, **QUICK))
    assert any("things of the given motion" in note for note in went_on.notes)


def test_what_is_measured_of_a_sentence_that_is_given_whole_is_what_is_shown(engine: Engine) -> None:
    asked = GenerateRequest(prompt="Two people hug.", seconds=2.0, split=False, planned=False, **QUICK)
    made = run(engine, asked)
    assert isinstance(duet := made.duets[0], Duet)
    assert made.readouts[0]["after"] == compare(None, duet)["after"]


def test_a_kept_window_is_not_taken_for_one_elsewhere(engine: Engine) -> None:
    """In the network's frame both are the same; where they lie in the world is not."""

    def asked(x: float, z: float) -> SceneRequest:
        path = FloorPath("a", (FloorPoint(x, z, 0.0), FloorPoint(x, z + 1.0, 1.9)))
        return SceneRequest(beats=BEATS[:1], paths=(path,), seed=12, **QUICK)

    first, moved = (positions(run(engine, asked(*place))) for place in ((0.0, 0.0), (3.0, -2.0)))
    np.testing.assert_allclose(moved, first + np.float32([3.0, 0.0, -2.0]), atol=1e-3)


@pytest.mark.parametrize(("start", "end"), [(2.0, 4.0), (0.0, 1.0), (5.0, 6.0)])
def test_outside_a_remade_span_nothing_changes(engine: Engine, story: Result, start: float, end: float) -> None:
    motion = story.duets[0]
    request = SceneRequest(beats=(Beat("They hug."),), motion=motion, start=start, end=end, **QUICK)
    made, first, last = positions(run(engine, request)), round(30 * start), round(30 * end)
    np.testing.assert_array_equal(made[:, :first], positions(story)[:, :first])
    np.testing.assert_array_equal(made[:, last:], positions(story)[:, last:])
    assert np.abs(made[:, first:last] - positions(story)[:, first:last]).max() > 0.01
    # Made again from the result alone.
    again = run(engine, SceneRequest.from_dict(request.to_dict(), run(engine, request).duets[0]))
    np.testing.assert_array_equal(positions(again), made)


def test_futures_share_the_past_and_differ(engine: Engine, story: Result) -> None:
    motion = story.duets[0]
    request = SceneRequest(beats=(Beat(seconds=2.0),), motion=motion, start=3.0, samples=2, **QUICK)
    result = run(engine, request)
    one, other = positions(result, 0), positions(result, 1)
    assert one.shape[1] == 150
    np.testing.assert_array_equal(one[:, :90], other[:, :90])
    np.testing.assert_array_equal(one[:, :90], positions(story)[:, :90])
    assert np.abs(one[:, 90:] - other[:, 90:]).max() > 0.01


def test_paths_and_poses_are_met_in_every_window(engine: Engine, story: Result) -> None:
    points = tuple(FloorPoint(1 + 0.3 * t, 0.5 * t, float(t)) for t in range(6))
    pose = Pose("b", 5.5, positions(story)[1, 20].astype(np.float64))
    result = run(engine, SceneRequest(beats=BEATS, paths=(FloorPath("a", points),), poses=(pose,), **QUICK))
    found = positions(result)
    places = found[0, [30 * t for t in range(6)], 0][:, [0, 2]]
    np.testing.assert_allclose(places, [(p.x, p.z) for p in points], atol=0.02)
    np.testing.assert_allclose(found[1, 165], pose.positions, atol=1e-4)


@pytest.mark.parametrize("beats", [BEATS, BEATS[:1]])
def test_a_loop_meets_its_beginning(engine: Engine, beats: tuple[Beat, ...]) -> None:
    found = positions(run(engine, SceneRequest(beats=beats, loop=True, **QUICK)))
    closing = np.diff(np.concatenate([found[:, -2:], found[:, :2]], axis=1), n=2, axis=1)
    assert np.linalg.norm(closing, axis=-1).max() < 0.01
    assert np.linalg.norm(closing.sum(1), axis=-1).max() < 0.01
    assert np.ptp(found, axis=1).max() > 0.1, "elsewhere people move"


def test_what_was_finished_before_a_cancellation_stays(engine: Engine) -> None:
    request = SceneRequest(beats=BEATS, seed=77, **QUICK)
    cancel, seen = CancelToken(), []
    with pytest.raises(Cancelled):
        for event in engine.run(request, cancel=cancel):
            if isinstance(event, SceneProgress):
                seen.append(event)
                cancel.cancel()
    assert len(seen) == 1 and seen[0].motion.num_frames == 60 and seen[0].beat == 0
    steps = [e.step for e in engine.run(request) if e.__class__.__name__ == "Progress" and e.stage == "sample"]
    assert min(steps) == QUICK["steps"] + 1


def test_a_sentence_of_several_beats_is_split_by_plain_generation_too(engine: Engine) -> None:
    prompt = "First they wave, then they bow."
    made = run(engine, GenerateRequest(prompt=prompt, seconds=4.0, **QUICK))
    beats = (Beat("They wave.", seconds=1.9), Beat("They bow.", seconds=2.1))
    assert any("2 beats" in note for note in made.notes) and positions(made).shape[1] == 120
    split = as_scene(GenerateRequest(prompt=prompt, seconds=4.0, **QUICK))
    assert split is not None and [b.words for b in split.beats] == [b.words for b in beats]
    np.testing.assert_array_equal(positions(made), positions(run(engine, split)))
    whole = run(engine, GenerateRequest(prompt=prompt, seconds=4.0, split=False, **QUICK))
    assert np.abs(positions(whole) - positions(made)).max() > 0.01 and not any("beats" in n for n in whole.notes)


def test_a_network_that_reads_them_is_given_each_persons_own_words(reading_engine: Engine) -> None:
    pipeline = reading_engine.pipeline("intergen")
    beats = [Beat(a="waves with both hands"), Beat(b="waves with both hands"), Beat("They wave.")]
    first, second, neither = (pipeline.words("They wave.", Plan(), beat.alone, 4.3).condition for beat in beats)
    assert first[:, 1].any() and not first[:, 2].any()
    assert torch.equal(first[:, 1], second[:, 2]) and not second[:, 1].any()
    assert not neither[:, 1:].any() and torch.allclose(neither[:, 0], first[:, 0, : neither.shape[2]], atol=1e-5)
    motions = [
        positions(run(reading_engine, SceneRequest(beats=(beat,), **QUICK)))
        for beat in (Beat("They wave.", seconds=2.0), Beat("They wave.", b="waves slowly", seconds=2.0))
    ]
    assert np.abs(motions[0] - motions[1]).max() > 1e-3


def test_a_result_says_what_share_of_it_the_plan_lays_out(engine: Engine) -> None:
    def share(*beats: Beat, **fields: Any) -> float:
        (readout,) = run(engine, SceneRequest(beats=beats, seed=3, **QUICK, **fields)).readouts
        return float(readout["planned"])

    free, laid = (Beat(words, seconds=2.0) for words in ("They shake hands.", "They bow to each other."))
    assert share(free) == 0.0 == share(laid, planned=False), "the network is let alone"
    both = share(laid, free)
    assert 0.5 < share(laid) < 0.7, "a bow leaves the legs to the network"
    assert abs(both - share(laid) / 2) < 0.05
    assert share(laid, free) == both, "windows that are kept say the same"
    assert share(free, free, planned=False) == 0.0, "what a window sees of the one before is not planned"


def test_a_span_and_a_loop_are_left_to_the_network(engine: Engine, story: Result) -> None:
    given = story.duets[0]
    assert isinstance(given, Duet)
    words = Beat("They walk away from each other.")
    span = SceneRequest(beats=(words,), motion=given, start=2.0, end=5.0, **QUICK)
    np.testing.assert_array_equal(positions(run(engine, span)), positions(run(engine, replace(span, planned=False))))

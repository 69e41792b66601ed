"""What was planned for a result is kept in its manifest, and replayed without reading the words again."""

import copy
import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from motion import InputError
from webdemo.inference import Engine, GenerateRequest, SceneRequest
from webdemo.inference.known_parts import KnownFrames, KnownPath
from webdemo.inference.pipelines import intergen, scene_setting
from webdemo.inference.pipelines.scene import Parts
from webdemo.inference.plans import KeptPlan, WindowPlan, kept_plan
from webdemo.inference.story import Beat, FloorPath, FloorPoint, prompted, request, understood
from webdemo.inference.story.told import Told

from .test_scenes import positions, run

QUICK: dict[str, Any] = {"steps": 2, "seed": 4}
STORY = SceneRequest(
    beats=(
        Beat("Person A sits down.", seconds=2.0),
        Beat("Person B walks up to person A.", seconds=2.0),
        Beat(a="waves", b="picks the other up", seconds=2.0),
    ),
    samples=2,
    **QUICK,
)
DRAWN = SceneRequest(
    beats=(Beat("They wave.", seconds=2.0),),
    paths=(FloorPath("b", (FloorPoint(0.5, 1.0), FloorPoint(1.0, 2.0))),),
    **QUICK,
)
SPLIT = GenerateRequest(prompt="Person A sits down, then person B walks away.", seconds=4.0, **QUICK)
AS_IT_IS = GenerateRequest(prompt="Person A shakes person B by the hand.", seconds=2.0, split=False, **QUICK)


def changed_reader(monkeypatch: pytest.MonkeyPatch) -> None:
    """From now on the words of every beat are read in another way, or are not to be read at all."""

    def elsewhere(asked: Any, window: Any, scene: Any, placement: Any, taken: Any) -> list[Any]:
        place = np.array([[1.5, 1.0]])
        return [KnownPath(person, [window.past + 20], place) for person in (0, 1) if person not in taken]

    monkeypatch.setattr(scene_setting, "planned", elsewhere)
    monkeypatch.setattr(scene_setting, "wishes", lambda *_: ([], ["Not so."]))
    monkeypatch.setattr(scene_setting, "_anchor", lambda _: (3.0, 3.0, 1.0))
    alone = ("One person falls.", "One person jumps.")
    monkeypatch.setattr(understood, "of_each", lambda _: alone)
    for module in (request, prompted):
        monkeypatch.setattr(module, "told_by", lambda _: Told(alone=alone))
    monkeypatch.setattr(intergen.InterGenPipeline, "notes", lambda *_: ("Read again.",))
    monkeypatch.setattr(prompted, "_beats", lambda *_: (Beat("They hug."), Beat("They bow.")))


@pytest.mark.parametrize(
    "asked", [STORY, DRAWN, SPLIT, AS_IT_IS], ids=["story", "drawn", "split", "as it is"]
)
def test_a_replayed_plan_gives_the_same_bytes_whatever_the_words_now_mean(
    reading_engine: Engine, monkeypatch: pytest.MonkeyPatch, asked: Any
) -> None:
    first = run(reading_engine, asked)
    manifest = json.loads(json.dumps(first.manifest))
    monkeypatch.setattr(reading_engine.pipeline("intergen").scenes, "parts", Parts())
    changed_reader(monkeypatch)
    replayed = run(reading_engine, replace(asked, plan=kept_plan(manifest)))
    for sample in range(asked.samples):
        np.testing.assert_array_equal(positions(replayed, sample), positions(first, sample))
    assert replayed.manifest == first.manifest
    read_now = positions(run(reading_engine, asked))
    assert read_now.shape != positions(first).shape or np.abs(read_now - positions(first)).max() > 1e-3


def test_a_continuation_is_replayed_from_its_own_plan(
    engine: Engine, monkeypatch: pytest.MonkeyPatch
) -> None:
    given = run(engine, SceneRequest(beats=(Beat("They wave.", seconds=1.5),), **QUICK)).duets[0]
    asked = SceneRequest(beats=(Beat("Person A walks away.", seconds=2.0),), motion=given, start=1.0, **QUICK)
    first = run(engine, asked)
    monkeypatch.setattr(engine.pipeline("intergen").scenes, "parts", Parts())
    changed_reader(monkeypatch)
    stored = json.loads(json.dumps(first.manifest))
    again = SceneRequest.from_dict(stored["request"], first.duets[0], kept_plan(stored))
    np.testing.assert_array_equal(positions(run(engine, again)), positions(first))


def test_a_plan_of_another_scene_is_refused(engine: Engine) -> None:
    plan = kept_plan(run(engine, DRAWN).manifest)
    with pytest.raises(InputError, match="is of 1 windows, and this scene has 6"):
        run(engine, replace(STORY, plan=plan))


def test_manifests_of_before_have_no_plan() -> None:
    assert kept_plan({"request": STORY.to_dict()}) is None
    assert "plan" not in STORY.to_dict() and "plan" not in SPLIT.to_dict()


def test_a_held_pose_is_written_once_and_numbers_are_kept_to_a_hundredth_of_a_millimetre() -> None:
    pose = np.random.default_rng(0).normal(size=(22, 3))
    held = KnownFrames(1, [0, 3, 6, 9], np.stack([pose, pose, 2 * pose, pose]), [0, 4, 5], kept=True)
    path = KnownPath(0, [2, 5], np.array([[0.123456, 1.0], [2.0, -3.0]]), np.array([7.0, 6.5]), turned=True)
    plan = WindowPlan((0.1, 0.2, 0.3), (held, path), ("One person waves.", ""))
    written = plan.to_dict()
    assert len(written["parts"][0]["poses"]) == 2
    again = WindowPlan.from_dict(json.loads(json.dumps(written)))
    assert again.to_dict() == written and again.place == plan.place
    first, second = again.parts
    assert isinstance(first, KnownFrames) and isinstance(second, KnownPath) and first.kept
    np.testing.assert_allclose(first.positions[3][[0, 4, 5]], pose[[0, 4, 5]], atol=0.51e-5)
    assert second.places[0, 0] == 0.12346 and second.headings is not None and second.turned


def test_joints_beside_the_pelvis_are_kept_beside_it() -> None:
    """The pelvis of a hand that is given is not written, wherever the person stands."""
    given = np.full((2, 22, 3), (3.0, 0.9, -2.0))
    given[:, 20] += [0.1, 0.5, 0.2]
    window = WindowPlan((0.0, 0.0, 0.0), (KnownFrames(0, [4, 8], given, [20]),))
    (read,) = WindowPlan.from_dict(json.loads(json.dumps(window.to_dict()))).parts
    assert isinstance(read, KnownFrames)
    np.testing.assert_allclose(read.positions[:, 20] - read.positions[:, 0], [[0.1, 0.5, 0.2]] * 2, atol=1e-5)


def damaged(change: str) -> dict[str, Any]:
    poses = KnownFrames(0, [1, 2], np.zeros((2, 22, 3)))
    plan = KeptPlan(windows=(WindowPlan((0.0, 0.0, 0.0), (poses,)),)).to_dict()
    found: Any = copy.deepcopy(plan)
    exec(change, {"plan": found, "part": found["windows"][0]["parts"][0]})
    return found  # type: ignore[no-any-return]


@pytest.mark.parametrize(
    "change",
    [
        "plan['windows'] = {}", "plan['windows'] = [0]", "plan['windows'] *= 2000", "plan['beats'] = 'x'",
        "plan['alone'] = ['']", "plan['notes'] = [3]", "part['frames'] = [1, 1]", "part['frames'] = [-1, 2]",
        "part['frames'] = [True, 2]", "part['frames'] = []", "part['frames'] = list(range(9999))",
        "part['person'] = 2", "part['which'] = [0, 5]", "part['which'] = [0]", "part['joints'] = [22]",
        "part['joints'] = [1, 1]", "part['poses'] = [[0] * 65]", "part['poses'] = [[0.5] * 66]",
        "part['poses'] = [[10 ** 12] * 66]", "part['poses'] = [[float('nan')] * 66]", "part['places'] = [1]",
        "plan['windows'][0]['place'] = [0, 0]", "plan['windows'][0]['place'] = [0, 0, float('inf')]",
        "plan['windows'][0]['parts'] *= 100",
    ],
)  # fmt: skip
def test_a_damaged_plan_is_refused_in_one_sentence(change: str) -> None:
    with pytest.raises(InputError, match="plan that was kept with this result is damaged"):
        KeptPlan.from_dict(damaged(change))


def test_no_change_is_no_damage() -> None:
    assert len(KeptPlan.from_dict(damaged("pass")).windows) == 1

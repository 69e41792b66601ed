"""What was planned for a result is kept in its manifest, and replayed without reading the words again."""

import copy
import importlib
import json
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from acts.staging.score import Score
from acts.staging.window import KnownFrames, KnownPath
from motion import InputError
from motion.looks import UNSAID
from webdemo.inference import Engine, GenerateRequest, ReactRequest, SceneRequest
from webdemo.inference.pipelines import intergen, scene
from webdemo.inference.pipelines.scene import Parts
from webdemo.inference.requests.plans import KeptPlan, WindowPlan, kept_plan
from webdemo.inference.story import Beat, FloorPath, FloorPoint, request, sentences

from .people import waver
from .runs import positions, run

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


def reading(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The texts that the reader is given from now on."""
    texts: list[str] = []
    reader = importlib.import_module("acts.reading.read")
    attempts = reader._attempts

    def noted(text: str, known: Any) -> Any:
        texts.append(text)
        return attempts(text, known)

    monkeypatch.setattr(reader, "_attempts", noted)
    return texts


def forgotten_reader(monkeypatch: pytest.MonkeyPatch) -> None:
    """From now on no text can be read, whoever asks."""

    def know_nothing(text: str, known: Any) -> Any:
        raise AssertionError(f"“{text}” is read again.")

    monkeypatch.setattr(importlib.import_module("acts.reading.read"), "_attempts", know_nothing)


def changed_stage(monkeypatch: pytest.MonkeyPatch, pipeline: Any) -> None:
    """From now on every plan of acts is staged in another way."""

    def elsewhere(asked: Any, of: Any, made: Any, placement: Any, taken: Any) -> list[Any]:
        place = np.array([[1.5, 1.0]])
        return [KnownPath(person, [of.past + 20], place) for person in (0, 1) if person not in taken]

    monkeypatch.setattr(pipeline.scenes, "planner", elsewhere)
    monkeypatch.setattr(scene, "wishes", lambda *_: ([], ["Not so."]))
    monkeypatch.setattr(scene, "_anchor", lambda _: (3.0, 3.0, 1.0))
    alone = ("One person falls.", "One person jumps.")
    monkeypatch.setattr(intergen, "of_each", lambda *_: alone)
    monkeypatch.setattr(request, "scores_of", lambda story: tuple(Score(alone=alone) for _ in story))
    for module in (sentences, intergen):
        monkeypatch.setattr(module, "score_of", lambda _: Score(alone=alone))
    monkeypatch.setattr(sentences, "_beats", lambda *_: (Beat("They hug."), Beat("They bow.")))


@pytest.mark.parametrize("asked", [STORY, DRAWN, SPLIT, AS_IT_IS], ids=["story", "drawn", "split", "as it is"])
def test_a_replayed_plan_gives_the_same_bytes_whatever_the_words_now_mean(
    reading_engine: Engine, monkeypatch: pytest.MonkeyPatch, asked: Any
) -> None:
    first = run(reading_engine, asked)
    manifest = json.loads(json.dumps(first.manifest))
    monkeypatch.setattr(reading_engine.pipeline("intergen").scenes, "parts", Parts())
    with monkeypatch.context() as forgetful:
        forgotten_reader(forgetful)
        changed_stage(forgetful, reading_engine.pipeline("intergen"))
        replayed = run(reading_engine, replace(asked, plan=kept_plan(manifest)))
    for sample in range(asked.samples):
        np.testing.assert_array_equal(positions(replayed, sample), positions(first, sample))
    assert replayed.manifest == first.manifest
    changed_stage(monkeypatch, reading_engine.pipeline("intergen"))
    read_now = positions(run(reading_engine, asked))
    assert read_now.shape != positions(first).shape or np.abs(read_now - positions(first)).max() > 1e-3


SENTENCES = (
    "Two people shake hands.",
    "A girl waves at her mother.",
    "A boy throws a ball to his sister and she catches it.",
    "She hands him a cup and he drinks from it.",
    "A man punches another man, who falls down.",
    "A opens the window.",
    "They walk up to each other and hug, then they dance.",
    "They sit down at a table and talk.",
    "A mother and her little son wave, then he runs away.",
    "The old man sits down and reads a newspaper.",
    "He flurbles gravely.",
    "A kneels. B does not bow.",
)


def _asked() -> Iterator[Any]:
    """Twenty requests of all kinds that have words, as they are made from their fields."""
    for i, sentence in enumerate(SENTENCES):
        yield lambda sentence=sentence, i=i: GenerateRequest(prompt=sentence, seconds=2.0, seed=i, steps=1)
    yield lambda: replace(SPLIT, tries=2)
    yield lambda: replace(AS_IT_IS, samples=2)
    yield lambda: replace(SPLIT, planned=False)
    yield lambda: replace(SPLIT, paths=DRAWN.paths)
    yield lambda: SceneRequest(beats=(Beat("The girl sits down."), Beat(a="waves", b="claps")), **QUICK)
    yield lambda: SceneRequest(beats=(Beat("He jumps.", seconds=2.0),), loop=True, **QUICK)
    yield lambda: ReactRequest(actor=waver(), model="intergen", prompt="A pushes B, who falls.", **QUICK)
    yield lambda: ReactRequest(actor=waver(), model="intergen", role="b", prompt="She hugs him.", **QUICK)


def test_twenty_results_are_read_once_and_made_again_by_a_reader_that_knows_nothing(
    reading_engine: Engine, monkeypatch: pytest.MonkeyPatch
) -> None:
    kept = []
    with monkeypatch.context() as reader:
        for ask in _asked():
            texts = reading(reader)
            asked = ask()
            result = run(reading_engine, asked)
            sentences = {beat.sentence for beat in asked.beats} if isinstance(asked, SceneRequest) else {asked.prompt}
            assert sorted(texts) == sorted(sentences)
            kept.append((asked, result))
    assert len(kept) == 20 and sum(bool(result.duets[0].things) for _, result in kept) >= 4
    assert sum(result.duets[0].looks != UNSAID for _, result in kept) >= 5
    monkeypatch.setattr(reading_engine.pipeline("intergen").scenes, "parts", Parts())
    forgotten_reader(monkeypatch)
    for asked, first in kept:
        manifest = json.loads(json.dumps(first.manifest))
        own = replayed_fields(asked, manifest)
        again = run(reading_engine, replace(asked, plan=kept_plan(manifest), **own))
        for one, other in zip(first.duets, again.duets, strict=True):
            np.testing.assert_array_equal(one.positions, other.positions)
            assert one.looks == other.looks and one.grips == other.grips
            assert [(t.kind, t.name) for t in one.things] == [(t.kind, t.name) for t in other.things]
            for thing, same in zip(one.things, other.things, strict=True):
                np.testing.assert_array_equal(thing.places, same.places)
        assert again.manifest.get("checked") == manifest.get("checked") and again.manifest["plan"] == manifest["plan"]
        said = [note for note in first.notes if " tries" not in note]
        assert [note for note in again.notes if note in said] == said


def replayed_fields(asked: Any, manifest: dict[str, Any]) -> dict[str, Any]:
    """The seed and the tries of a result that is made again."""
    kept = manifest.get("tries") or {}
    return {"seed": kept["seed"], "tries": 1} if "seed" in kept else {}


def test_a_plan_of_another_scene_is_refused(engine: Engine) -> None:
    plan = kept_plan(run(engine, DRAWN).manifest)
    with pytest.raises(InputError, match="is of 1 windows, and this scene has 6"):
        run(engine, replace(STORY, plan=plan))


def kept(window: WindowPlan) -> tuple[dict[str, Any], WindowPlan]:
    """A window's plan as JSON, and read from there."""
    plan = KeptPlan(windows=(window,)).to_dict()
    return plan["windows"][0], KeptPlan.from_dict(json.loads(json.dumps(plan))).windows[0]


def test_a_held_pose_is_written_once_and_numbers_are_kept_to_a_hundredth_of_a_millimetre() -> None:
    pose = np.random.default_rng(0).normal(size=(22, 3))
    held = KnownFrames(1, [0, 3, 6, 9], np.stack([pose, pose, 2 * pose, pose]), [0, 4, 5], kept=True)
    path = KnownPath(0, [2, 5], np.array([[0.123456, 1.0], [2.0, -3.0]]), np.array([7.0, 6.5]), turned=True)
    plan = WindowPlan((0.1, 0.2, 0.3), (held, path), ("One person waves.", ""))
    written, again = kept(plan)
    assert len(written["parts"][0]["poses"]) == 2
    assert kept(again)[0] == written and again.place == plan.place
    first, second = again.parts
    assert isinstance(first, KnownFrames) and isinstance(second, KnownPath) and first.kept
    np.testing.assert_allclose(first.positions[3][[0, 4, 5]], pose[[0, 4, 5]], atol=0.51e-5)
    assert second.places[0, 0] == 0.12346 and second.headings is not None and second.turned


def test_joints_beside_the_pelvis_are_kept_beside_it() -> None:
    """The pelvis of a hand that is given is not written, wherever the person stands."""
    given = np.full((2, 22, 3), (3.0, 0.9, -2.0))
    given[:, 20] += [0.1, 0.5, 0.2]
    window = WindowPlan((0.0, 0.0, 0.0), (KnownFrames(0, [4, 8], given, [20]),))
    (read,) = kept(window)[1].parts
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
        "plan['windows'] = {}",
        "plan['windows'] = [0]",
        "plan['windows'] *= 2000",
        "plan['beats'] = 'x'",
        "plan['alone'] = ['']",
        "plan['notes'] = [3]",
        "plan['finishes'] = [{'held': 'c'}]",
        "part['frames'] = [1, 1]",
        "part['frames'] = [-1, 2]",
        "part['frames'] = [True, 2]",
        "part['frames'] = []",
        "part['frames'] = list(range(9999))",
        "part['person'] = 2",
        "part['which'] = [0, 5]",
        "part['which'] = [0]",
        "part['joints'] = [22]",
        "part['joints'] = [1, 1]",
        "part['poses'] = [[0] * 65]",
        "part['poses'] = [[0.5] * 66]",
        "part['poses'] = [[10 ** 12] * 66]",
        "part['poses'] = [[float('nan')] * 66]",
        "part['places'] = [1]",
        "plan['windows'][0]['place'] = [0, 0]",
        "plan['windows'][0]['place'] = [0, 0, float('inf')]",
        "plan['windows'][0]['parts'] *= 100",
    ],
)
def test_a_damaged_plan_is_refused_in_one_sentence(change: str) -> None:
    with pytest.raises(InputError, match="plan that was kept with this result is damaged"):
        KeptPlan.from_dict(damaged(change))

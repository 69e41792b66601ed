"""Tries with further seeds: the first that does all that is said, or the best, and what is said of it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from acts import Act, Plan, Relation
from motion import Duet, InputError
from tests.motion.metrics.figures import duet, put, shift, spin
from webdemo.inference import Cancelled, CancelToken, Engine, GenerateRequest, Progress, Result, SceneRequest
from webdemo.inference.requests.sampling import MAX_SEED
from webdemo.inference.story import Beat
from webdemo.inference.tries import run_tries
from webdemo.inference.verdicts import judged, note

SENTENCE = "A raises the left arm and turns around."


def raise_first(both: np.ndarray) -> None:
    """The left arm is up for the first third."""
    hanging = both.copy()
    put("left_wrist", (0.2, 0.9, 0.0))(both)
    later = both.shape[1] // 3
    both[:, later:] = hanging[:, later:]


UP = raise_first
STILL, ONE, ALL = duet(), duet(UP), duet(UP, spin(170))


def made(*motions: Any) -> Result:
    return Result(duets=tuple(Duet.from_positions(m.positions, fps=30.0) for m in motions), manifest={})


class Runs:
    """Gives motions by how far a request's seed is from the first, and keeps the requests."""

    def __init__(self, *motions: Any, first: int = 0) -> None:
        self.motions, self.first = motions, first
        self.asked: list[Any] = []

    def __call__(self, request: Any) -> Iterator[Progress | Result]:
        self.asked.append(request)
        number = len(self.asked) - 1
        yield Progress(stage="sample", step=1, total=2)
        yield made(*[self.motions[number]] * request.samples)


def tried(request: Any, runs: Runs, cancel: CancelToken | None = None) -> list[Progress | Result]:
    return list(run_tries(request, runs, cancel or CancelToken()))


def result(request: Any, runs: Runs) -> Result:
    *_, last = tried(request, runs)
    assert isinstance(last, Result)
    return last


REQUEST = GenerateRequest(prompt=SENTENCE, tries=4, seed=7)


def test_the_first_that_does_all_is_kept_and_ends_the_tries() -> None:
    runs = Runs(ONE, ALL, ALL)
    found = result(REQUEST, runs)
    assert [(asked.seed, asked.tries) for asked in runs.asked] == [(7, 1), (8, 1)]
    assert found.manifest["tries"] == {"asked": 4, "made": 2, "won": 2, "seed": 8}
    assert [row["done"] for row in found.manifest["checked"]] == [True, True]
    assert found.manifest["told"] == "Done: A raises the left arm; A turns around."
    assert found.duets[0].manifest["told"] == found.manifest["told"]  # type: ignore[index, union-attr]
    assert found.notes[0].startswith("Done on the 2nd of 4 tries: ")
    np.testing.assert_array_equal(found.duets[0].positions, ALL.positions.astype("f4"))


def test_where_none_does_all_the_best_is_kept_of_equals_the_first() -> None:
    found = result(REQUEST, Runs(STILL, ONE, STILL, ONE))
    assert found.manifest["tries"] == {"asked": 4, "made": 4, "won": 2, "seed": 8}
    assert found.notes[0].startswith("Best of 4 tries, 1 of 2 acts. Not seen: A turns")
    assert found.notes[0].endswith(" Done: A raises the left arm.")


def test_cancelling_ends_the_tries_between_two() -> None:
    cancel, runs = CancelToken(), Runs(STILL, STILL, STILL, STILL)
    with pytest.raises(Cancelled):
        for _ in run_tries(REQUEST, runs, cancel):
            cancel.cancel()  # at the first try's progress; the try itself does not look
    assert len(runs.asked) == 1


def test_seeds_go_on_from_zero_after_the_last() -> None:
    runs = Runs(STILL, ALL)
    assert result(replace(REQUEST, seed=MAX_SEED), runs).manifest["tries"]["seed"] == 0
    assert [asked.seed for asked in runs.asked] == [MAX_SEED, 0]


@pytest.mark.parametrize("tries", [0, 1.5])
def test_tries_are_one_to_four(tries: Any) -> None:
    with pytest.raises(InputError, match="Tries"):
        GenerateRequest(prompt=SENTENCE, tries=tries)


# ---- verdicts --------------------------------------------------------------------------------------------
def test_every_sample_has_its_own_verdicts_and_the_note_counts_them() -> None:
    found = judged(replace(REQUEST, samples=2), made(ONE, ALL))
    assert [d.manifest["checked"][1]["done"] for d in found.result.duets] == [False, True]  # type: ignore[union-attr, index]
    assert found.counts == (3, 4)
    assert "A turns around (in 1 of 2 samples)" in note(found.rows)


def test_each_beat_is_judged_on_its_own_frames() -> None:
    body = np.concatenate([STILL.positions[:, :60], duet(shift((0, 0, 0), (0, 0, -2))).positions], axis=1)
    motion = Result(duets=(Duet.from_positions(body, fps=30.0),), manifest={})
    first, second = Beat("A walks away from B.", seconds=2.0), Beat("A walks away from B.", seconds=4.0)
    rows = judged(SceneRequest(beats=(first, second)), motion).rows[0]
    assert [(row["beat"], row["done"]) for row in rows] == [(1, False), (2, True)]


def test_the_acts_of_a_plan_take_the_place_of_the_words() -> None:
    order = (Relation(kind="after", act="9"),)
    act = Act(id="1", act="raise-arm", agents=("a",), side="left", order=order)  # after an act of another beat
    beat = Beat("They wave.", seconds=4.0, acts=(act,))
    rows = judged(SceneRequest(beats=(beat,)), made(ONE)).rows[0]
    assert [(row["act"], row["done"]) for row in rows] == [("raise-arm", True)]
    plan = Plan(acts=(act.model_copy(update={"order": ()}),))
    rows = judged(GenerateRequest(prompt="They wave.", acts=plan), made(ONE)).rows[0]
    assert [(row["act"], row["done"]) for row in rows] == [("raise-arm", True)]


@pytest.mark.parametrize("left", [{"planned": False}, {"split": False}])
def test_a_plan_that_nobody_would_follow_is_refused(left: dict[str, bool]) -> None:
    plan = Plan(acts=(Act(id="1", act="bow", agents=("a",)),))
    with pytest.raises(InputError, match="leave the plan out"):
        GenerateRequest(prompt="They wave.", acts=plan, **left)


# ---- with a network --------------------------------------------------------------------------------------
QUICK = GenerateRequest(prompt="A falls down and B walks away.", seconds=2.0, steps=2, seed=3, tries=3)


def test_a_result_of_tries_is_that_of_its_seed(engine: Engine) -> None:
    *_, found = engine.run(QUICK)
    assert isinstance(found, Result)
    tries = found.manifest["tries"]
    assert found.manifest["request"]["tries"] == 3 and found.manifest["request"]["seed"] == 3
    *_, again = engine.run(replace(QUICK, seed=found.manifest["tries"]["seed"], tries=1))
    assert isinstance(again, Result)
    assert again.manifest["request"]["seed"] == tries["seed"]
    assert found.duets[0].positions.tobytes() == again.duets[0].positions.tobytes()
    assert found.manifest["checked"] == again.manifest["checked"]
    assert found.duets[0].manifest["checked"] == found.manifest["checked"]  # type: ignore[index, union-attr]


def test_a_scene_is_tried_as_a_whole(engine: Engine) -> None:
    beats = (Beat("A lies down.", seconds=1.0), Beat("B kneels.", seconds=1.0))
    events = list(engine.run(SceneRequest(beats=beats, steps=2, damping=0.0, tries=2, planned=False)))
    found = events[-1]
    assert isinstance(found, Result)
    assert found.manifest["tries"]["asked"] == 2
    assert {e.attempt for e in events if isinstance(e, Progress) and e.stage == "sample"} == set(
        range(1, found.manifest["tries"]["made"] + 1)
    )

"""The judge's rules on motion that is made to pass or to fail them, and the choice of sentences."""

import dataclasses
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch

from models.motion_tokens import TokenLayout, encode
from motion import SMPL22, Duet
from motion.transforms import turn
from training.evaluate import generation as evaluate
from training.evaluate.judge.draw import batches
from training.evaluate.judge.prompts import choose, everyday, tells_of_both
from training.evaluate.judge.report import score, table
from training.evaluate.judge.rules import Task, Verdict, action_time, judge, named_sides
from training.prepare import Scenes, save

FRAMES = TokenLayout().num_frames(12)
ARM = {side: [SMPL22.index(f"{side}_{j}") for j in ("elbow", "wrist")] for side in ("left", "right")}
SHOULDER = {side: SMPL22.index(f"{side}_shoulder") for side in ("left", "right")}
TRUNK = [SMPL22.index(n) for n in ("spine3", "neck", "head", "left_collar", "right_collar")]


def standing(distance: float = 1.2) -> np.ndarray:
    """(2, T, 22, 3) two people with hanging arms, face to face."""
    rest = SMPL22.rest_positions() + np.array([0.0, 0.98, 0.0])
    for side in ("left", "right"):
        rest[ARM[side]] = rest[SHOULDER[side]] - [[0.0, 0.26, 0.0], [0.0, 0.51, 0.0]]
    person = np.repeat(rest[None], FRAMES, axis=0)
    return np.stack([person, turn(person, np.pi) + np.array([0.0, 0.0, distance])])


def reach(pair: np.ndarray, person: int, side: str, goal: Any, start: int, stop: int) -> np.ndarray:
    """The same pair with a wrist taken to a place in the world between two frames, eased in and out."""
    pair = pair.copy()
    weight = np.interp(np.arange(FRAMES), [start - 10, start, stop, stop + 10], [0, 1, 1, 0])[:, None]
    elbow, wrist = ARM[side]
    pair[person, :, wrist] += weight * (np.asarray(goal) - pair[person, :, wrist])
    pair[person, :, elbow] = (pair[person, :, SHOULDER[side]] + pair[person, :, wrist]) / 2
    return pair


def raised(pair: np.ndarray, person: int, side: str, start: int, stop: int) -> np.ndarray:
    return reach(pair, person, side, pair[person, 0, SHOULDER[side]] + [0.0, 0.4, 0.0], start, stop)


def bowed(pair: np.ndarray, person: int, middle: int) -> np.ndarray:
    pair = pair.copy()
    depth = 0.4 * np.clip(1 - np.abs(np.arange(FRAMES) - middle) / 12, 0, 1)
    pair[person][:, TRUNK, 1] -= depth[:, None]
    return pair


def moved(pair: np.ndarray, person: int, metres: float) -> np.ndarray:
    pair = pair.copy()
    pair[person, :, :, 2] += np.linspace(0, metres, FRAMES)[:, None]
    return pair


def verdict(pair: np.ndarray, check: str, caption: str = "", family: str = "any", **events: Any) -> Verdict:
    duet = Duet.from_positions(pair, fps=30.0)
    return next(v for v in judge(duet, Task(caption, family, events)) if v.check == check)


# ---- rules -----------------------------------------------------------
@pytest.mark.parametrize(("person", "name"), [(0, "a"), (1, "b")])
@pytest.mark.parametrize("hand", ["left", "right"])
def test_side_is_the_hand_that_moves(person: int, name: str, hand: str) -> None:
    pair = raised(standing(), person, hand, 30, 60)
    for said in ("left", "right"):
        found = verdict(pair, "side", f"One waves with the {said} hand.", side={name: said})
        assert found.passed == (said == hand)


def test_a_pose_that_is_held_is_no_move_and_neither_is_standing() -> None:
    pair = standing()
    pair[0, :, ARM["left"][1], 1] += 0.6  # a hand on the chin all the time
    caption = "One waves with the right hand."
    assert not verdict(pair, "side", caption, side={"a": "right"}).passed
    assert verdict(raised(pair, 0, "right", 30, 60), "side", caption, side={"a": "right"}).passed


def test_walking_and_turning_move_no_hand() -> None:
    pair = moved(standing(), 0, -3.0)
    pair[0] = np.stack([turn(frame, k * 0.03) for k, frame in enumerate(pair[0])])
    assert not verdict(pair, "side", "with the left hand", side={"a": "left"}).passed


def test_both_hands_must_move() -> None:
    one = raised(standing(), 0, "left", 30, 60)
    assert not verdict(one, "side", "raises both arms", side={"a": "both"}).passed
    assert verdict(raised(one, 0, "right", 30, 60), "side", "raises both arms", side={"a": "both"}).passed


def test_where_hands_meet_the_side_is_the_hand_that_meets() -> None:
    pair = reach(reach(standing(0.9), 0, "right", (0, 1.1, 0.42), 40, 50), 1, "right", (0, 1.1, 0.48), 40, 50)
    pair = raised(pair, 0, "left", 10, 20)  # moves more, but elsewhere
    contact = [{"a": "right_wrist", "b": "right_wrist", "start": 40, "end": 50}]
    for side in ("left", "right"):
        events = {"side": {"a": side}, "contact": contact}
        assert verdict(pair, "side", f"with the {side} hand", **events).passed == (side == "right")


@pytest.mark.parametrize("turned", [False, True])
def test_a_side_to_go_to_is_a_way_and_no_hand(turned: bool) -> None:
    pair = standing()
    pair[1, :, :, 0] += np.linspace(0.0, 1.0, pair.shape[1])[:, None]  # b, who looks at a, goes to one side
    if turned:
        pair = pair * [-1.0, 1.0, -1.0]
    found = {
        side: verdict(pair, "side", f"b walks to the {side}.", side={"b": side}) for side in ("left", "right")
    }
    assert found["right"].passed and not found["left"].passed
    assert found["right"].value == pytest.approx(0.85, abs=1e-6)


def test_sides_count_only_where_the_words_name_them() -> None:
    assert named_sides("One waves.", {"side": {"a": "left"}}) == []
    assert named_sides("Both wave with their left hands.", {"side": {"a": "left", "b": "left"}}) == [
        ("left", ("a",)),
        ("left", ("b",)),
    ]
    assert named_sides("The other waves with the left hand.", {"side": {"a": "left", "b": "left"}}) == [
        ("left", ("a", "b"))
    ]
    assert named_sides("a right, b left", {"side": {"a": "right", "b": "left"}}) == [
        ("left", ("b",)),
        ("right", ("a",)),
    ]


@pytest.mark.parametrize(("gap", "passed"), [(0.08, True), (0.13, False)])
def test_hands_meet_within_ten_centimetres(gap: float, passed: bool) -> None:
    pair = reach(standing(0.9), 0, "right", (0, 1.1, 0.4), 40, 50)
    pair = reach(pair, 1, "left", (0, 1.1, 0.4 + gap), 40, 50)
    found = verdict(pair, "contact", contact=[{"a": "right_wrist", "b": "right_wrist"}])
    assert found.passed == passed
    assert found.value == pytest.approx(gap, abs=1e-5)


@pytest.mark.parametrize(("gap", "passed"), [(0.17, True), (0.25, False)])
def test_a_hand_on_a_body_is_within_twenty_centimetres_of_the_joint(gap: float, passed: bool) -> None:
    pair = standing(0.7)
    pair = reach(pair, 0, "left", pair[1, 0, SHOULDER["right"]] - [0, 0, gap], 40, 50)
    assert verdict(pair, "contact", contact=[{"a": "right_wrist", "b": "left_shoulder"}]).passed == passed


def test_a_hug_takes_both_hands() -> None:
    entries = [{"a": "left_wrist", "b": "spine3"}, {"a": "right_wrist", "b": "spine2"}]
    pair = standing(0.5)
    one = reach(pair, 0, "left", pair[1, 0, SMPL22.index("spine3")], 40, 50)
    assert not verdict(one, "contact", contact=entries).passed
    both = reach(one, 0, "right", pair[1, 0, SMPL22.index("spine2")], 40, 50)
    assert verdict(both, "contact", contact=entries).passed


@pytest.mark.parametrize(("metres", "kind"), [(0.9, "approach"), (-0.9, "part"), (0.1, "keep")])
def test_distance_falls_grows_or_stays(metres: float, kind: str) -> None:
    pair = moved(standing(2.0), 0, metres)
    passed = {k for k in ("approach", "part", "keep") if verdict(pair, "distance", distance=k).passed}
    assert passed == {kind}


def test_facing() -> None:
    assert verdict(standing(), "facing", facing=True).value == pytest.approx(0, abs=0.1)
    away = standing()
    away[1] = turn(away[1] - [0, 0, 1.2], np.pi) + np.array([0, 0, 1.2])
    assert not verdict(away, "facing", facing=True).passed


def test_order_of_a_bow_and_a_wave() -> None:
    pair = raised(bowed(standing(), 0, 20), 1, "left", 60, 75)
    assert verdict(pair, "order", order=["bow", "wave"]).passed
    assert not verdict(pair[::-1], "order", order=["wave", "bow"]).passed
    found = verdict(standing(), "order", order=["bow", "wave"])
    assert not found.passed and np.isnan(found.value)


def test_in_a_sequence_one_person_does_both() -> None:
    pair = raised(bowed(standing(), 0, 20), 0, "left", 60, 75)
    assert verdict(pair, "order", family="sequence", order=["bow", "wave"]).passed
    assert not verdict(pair, "order", family="sequence", order=["wave", "bow"]).passed
    assert action_time(pair[0], "bow", 30.0) == pytest.approx(20 / 30, abs=0.05)


def test_undecidable_checks_are_not_counted() -> None:
    assert Task("", "sequence", {"order": ["wave", "raise-hand"]}).checks == ()
    assert Task("", "ordered", {"order": ["wave", "raise-hand"]}).checks == ("order",)
    assert Task("", "whisper", {"contact": []}).checks == ()
    assert Task("", "ordered", {"order": ["bow", "kick"]}).checks == ()


# ---- sentences and scores -----------------------------------------------------------
@pytest.mark.parametrize(
    ("caption", "both"),
    [
        ("One person holds a hand down with the palm up.", False),
        ("A woman pats a man's back.", True),
        ("a short handshake", True),
        ("One person hugs the other.", True),
    ],
)
def test_sentences_that_tell_of_one_person_only(caption: str, both: bool) -> None:
    assert tells_of_both(caption) == both


def test_every_everyday_sentence_can_be_checked() -> None:
    tasks = everyday()
    assert len(tasks) > 60 and len({task.caption for task in tasks}) == len(tasks)
    for task in tasks:
        assert set(task.checks) == set(task.events), task.caption
        assert set(task.events.get("side", {})) <= {"a", "b"}
        assert 30 <= task.frames <= 300


@pytest.fixture
def scenes() -> Scenes:
    layout = TokenLayout()
    tokens = layout.num_tokens(FRAMES)
    control, rows = [], []
    for i in range(8):
        pair = moved(standing(2.0), 0, 0.9) if i % 2 else standing()
        positions = torch.from_numpy(pair).float()
        control.append(encode(positions, torch.ones(2, FRAMES, 4), layout).transpose(0, 1).half())
        rows.append(
            {
                "start": i * tokens * layout.knots_per_token,
                "tokens": tokens,
                "family": "approach" if i % 2 else "idle",
                "captions": [f"One person meets the other for time {i}.", "Two people. The same!"],
                "split": "train" if i < 2 else "test",
                "events": {"distance": "approach" if i % 2 else "keep"},
                "sources": [],
            }
        )
    assert layout.num_frames(tokens) == FRAMES
    return Scenes(torch.cat(control), rows, layout)


def test_sentences_are_new_and_spread_over_families(scenes: Scenes) -> None:
    found = choose(scenes, 4, seed=1)
    assert [t.caption for t, _ in found] == [t.caption for t, _ in choose(scenes, 4, seed=1)]
    assert sorted(task.family for task, _ in found) == ["approach", "approach", "idle", "idle"]
    everything = choose(scenes, 100)
    assert all(row["split"] == "test" for _, row in everything)
    captions = [task.caption for task, _ in everything]
    assert len(captions) == len(set(captions)) == 7  # six of their own and the shared one once


def test_batches_hold_every_task_once_and_one_length_each() -> None:
    tasks = [Task("", "any", {}, frames) for frames in [60, 61, 120, 59, 300, 310] * 5]
    found = batches(tasks, size=4)
    assert sorted(i for group in found for i in group) == list(range(len(tasks)))
    assert all(np.ptp([tasks[i].frames for i in group]) <= 30 for group in found)
    assert max(len(group) for group in found) == 4


def test_scores_count_by_check_and_family() -> None:
    tasks = [Task("", "approach", {"distance": "approach"}), Task("", "approach", {"distance": "approach"})]
    duets = [Duet.from_positions(p, fps=30.0) for p in (moved(standing(2.0), 0, 0.9), standing())]
    found = score(duets, tasks)
    assert found["checks"]["distance"] == {"passed": 1, "count": 2, "families": {"approach": [1, 2]}}
    assert found["checks"]["side"]["count"] == 0
    assert found["physical"]["bone_drift"] == pytest.approx(0, abs=1e-3)
    shown = table({"generated": found, "real": found, "other": found, "about": "Two."})
    assert "50 % (1/2; 9–91 %)" in shown and "by hand" not in shown
    page = table({"generated": found, "real": found, "other": found, "everyday": found, "about": "Two."})
    assert page.startswith(shown) and "| 2 sentences written by hand |" in page


def test_command_scores_real_motion_and_writes_both_files(
    scenes: Scenes, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    save(scenes, tmp_path / "scenes.safetensors")
    arguments = ["--scenes", str(tmp_path / "scenes.safetensors"), "--out", str(tmp_path / "scores.json")]
    evaluate.main([*arguments, "--table", str(tmp_path / "t.md"), "--real-only", "--prompts", "4"])
    found = json.loads((tmp_path / "scores.json").read_text())
    assert found["real"]["checks"]["distance"]["passed"] == 4
    assert found["other"]["checks"]["distance"]["passed"] < 4
    assert (tmp_path / "t.md").read_text().strip() == capsys.readouterr().out.strip()


def test_command_says_what_is_missing(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as stopped:
        evaluate.main(["--scenes", str(tmp_path / "no"), "--out", str(tmp_path / "scores.json")])
    assert stopped.value.code == 2
    error = capsys.readouterr().err
    assert "training.prepare" in error and "Traceback" not in error
    assert not (tmp_path / "scores.json").exists()


def test_scenes_without_events_are_refused(
    scenes: Scenes, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    bare = dataclasses.replace(scenes, rows=[row | {"events": None} for row in scenes.rows])
    save(bare, tmp_path / "scenes.safetensors")
    with pytest.raises(SystemExit):
        evaluate.main(["--scenes", str(tmp_path / "scenes.safetensors"), "--out", str(tmp_path / "s.json")])
    assert "no caption that can be checked" in capsys.readouterr().err

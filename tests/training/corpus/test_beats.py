"""Scenes of beats on a small made-up library: seams, order, touches, feet, layers, splits."""

from __future__ import annotations

import numpy as np
import pytest

from tests.training.corpus.recorded import SOURCES, J, bone_error, main, path, staged
from training.corpus import checks
from training.corpus.beats import script
from training.corpus.cues import STILL
from training.corpus.library import Library


@pytest.fixture(scope="module")
def library() -> Library:
    return Library(SOURCES, "train")


def test_free_scenes_are_sound(library: Library) -> None:
    made = jolts = 0
    for seed in range(8):
        try:
            scene = script.compose(np.random.default_rng(seed), library)
        except LookupError:
            continue
        made += 1
        frames = scene.positions.shape[1]
        assert 30 < frames <= script.MOST and np.isfinite(scene.positions).all()
        assert bone_error(scene.positions) < 1e-3
        jolts += checks.fault(scene) == "a joint jumps"
        starts = [beat["start"] for beat in scene.beats]
        assert starts == sorted(starts) and all(b["start"] < b["end"] <= frames for b in scene.beats)
        assert all(len(beat["captions"]) >= 1 for beat in scene.beats)
        assert len(scene.captions) >= 3 and min(map(len, scene.alone)) >= 1
        assert all(source.startswith("train") for source in scene.sources) and scene.split == "train"
    assert made >= 6 and jolts <= 1


def test_one_comes_the_other_stands_they_touch_and_one_leaves(library: Library) -> None:
    scene = staged(
        library,
        ("walk-up", "walk-up", STILL),
        ("shake-hands", "shake-hands", "shake-hands"),
        ("leave", "walk-away", STILL),
    )
    first, touch, last = main(scene)
    walker = first["acts"].index("walk-up")
    assert np.linalg.norm(path(scene, walker, first)[-1] - path(scene, walker, first)[0]) > 0.6
    assert np.ptp(path(scene, 1 - walker, first), axis=0).max() < 0.25
    (contact,) = scene.events["contact"]
    assert touch["start"] <= contact["start"] <= contact["end"] <= touch["end"] + 34
    held = slice(contact["start"] + 2, contact["end"] - 1)
    gap = np.linalg.norm(scene.positions[0, held, J(contact["a"])] - scene.positions[1, held, J(contact["b"])], axis=-1)
    assert gap.max() < 0.14
    assert last["acts"].index("walk-away") == walker
    ends = np.linalg.norm(path(scene, 0, last)[[0, -1]] - path(scene, 1, last)[[0, -1]], axis=-1)
    assert ends[1] > ends[0] + 0.8


def test_a_refused_hand_is_held_out_and_not_taken(library: Library) -> None:
    scene = staged(library, ("refused", "shake-hands?", STILL))
    beat = main(scene)[0]
    i = beat["acts"].index("shake-hands?")
    (side,) = [own.sides[i] for own in scene.played if not own.minor]
    hand = J(f"{side}_wrist")
    body = scene.positions[i, beat["start"] : beat["end"]]
    reach = np.linalg.norm((body[:, hand] - body[:, 0])[:, [0, 2]], axis=-1)
    assert reach.max() > reach[0] + 0.06 and body[:, hand, 1].max() > body[0, hand, 1] + 0.15
    other = scene.positions[1 - i, beat["start"] : beat["end"]][:, [J("left_wrist"), J("right_wrist")]]
    assert np.linalg.norm(other - body[:, None, hand], axis=-1).min() > 0.15
    assert all(touch["start"] > beat["end"] for touch in scene.events.get("contact", ()))


def test_hands_stay_joined_while_walking(library: Library) -> None:
    scene = staged(library, ("walk-hand-in-hand", "walk-hand-in-hand", "walk-hand-in-hand"))
    contact = scene.events["contact"][0]
    held = slice(contact["start"] + 2, contact["end"] - 1)
    one, other = scene.positions[0, held], scene.positions[1, held]
    assert np.linalg.norm(one[:, J(contact["a"])] - other[:, J(contact["b"])], axis=-1).max() < 0.2
    assert np.linalg.norm((one[-1, 0] - one[0, 0])[[0, 2]]) > 1.0


def test_feet_hold_where_people_walk_and_turn(library: Library) -> None:
    together = ("walk-together", "walk-together", "walk-together")
    for beat in (("walk-up", "walk-up", STILL), ("leave", "walk-away", STILL), together):
        scene = staged(library, beat)
        assert max(checks.slower_foot(person) for person in scene.positions) < 0.12, beat
    scene = staged(library, ("turn-to", "turn-to", STILL), heading=np.pi)
    assert max(checks.slower_foot(person) for person in scene.positions) < 0.08

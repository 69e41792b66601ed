"""Composed scenes on a small made-up library: bones, feet, blends, sides, order, splits, files."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from motion.kinematics import forward_kinematics
from tests.training.corpus.recorded import SOURCES, J, bone_error, bow, clips, gesture, standing, walk
from training.corpus import checks, compose
from training.corpus.cues import Scene
from training.corpus.library import Library, shorten


@pytest.fixture(scope="module")
def library() -> Library:
    return Library(SOURCES, "train")


def motion(positions: np.ndarray) -> compose.Motion:
    return compose.motion_from_positions(positions, sources=("one",))


def test_join_goes_on_where_the_first_ended_without_a_jump() -> None:
    first, second = motion(walk(120)), compose.steer(motion(gesture(90, "left")), np.full(90, 2.0))
    joined = compose.join(first, second, blend=12)
    positions = compose.realise(joined)
    assert len(joined) == 120 + 90 - 12
    assert bone_error(positions) < 1e-9
    assert np.abs(joined.headings[-1] - joined.headings[0]) < 0.05
    speeds = np.linalg.norm(np.diff(positions, axis=0), axis=-1).max(axis=-1) * 30
    own = max(np.linalg.norm(np.diff(p, axis=0), axis=-1).max() * 30 for p in (walk(120), gesture(90, "left")))
    assert speeds.max() < 2 * own
    assert np.linalg.norm(joined.root[-1] - joined.root[119]) < 0.2


def test_feet_rest_while_a_body_sways_and_step_where_it_is_carried_far() -> None:
    rotations, root = standing(120)
    root[:, 0] += 0.1 * np.sin(np.arange(120) / 15)
    carried = root.copy()
    carried[:, 2] += 0.5 * np.clip((np.arange(120) - 45) / 30, 0, 1)
    for path, steps in ((root, False), (carried, True)):
        made = compose.realise(compose.Motion(rotations, path))
        toes = made[:, [J("left_foot"), J("right_foot")]]
        moving = np.linalg.norm(np.diff(toes[..., [0, 2]], axis=0), axis=-1) * 30 > 0.1
        assert moving.any(axis=0).all() == steps and moving.all(axis=1).mean() < 0.1, "one foot stands at least"
        ankles = made[:, [J("left_ankle"), J("right_ankle")], 1]
        assert (np.ptp(ankles) > 0.03) == steps, "a foot that steps is lifted"
        assert bone_error(made) < 1e-9


def test_a_shortened_clip_still_shows_what_it_is_of() -> None:
    """The most alike moments of a bow are before and after it; the cut between them left a person standing."""
    still = forward_kinematics(*standing(60))
    bowing = motion(np.concatenate([still, bow(90) - bow(90)[:1, :1] + still[-1:, :1], still]))
    short = shorten(bowing, 70)
    heads = [realise_height(m) for m in (bowing, short)]
    assert len(short) < 0.75 * len(bowing)
    assert heads[1] > 0.9 * heads[0] > 0.1


def realise_height(clip: compose.Motion) -> float:
    """How far the head comes down."""
    height = forward_kinematics(clip.rotations, clip.root)[:, J("head"), 1]
    return float(height.max() - height.min())


@pytest.mark.parametrize("side", ["left", "right", "both"])
def test_library_performs_the_wanted_side(library: Library, side: str) -> None:
    for seed in range(6):
        take = library.take(np.random.default_rng(seed), "wave", side=side)
        wrists = compose.realise(take.motion)[:, [J("left_wrist"), J("right_wrist")], 1].max(axis=0)
        assert take.side == side
        assert [bool(height > 1.5) for height in wrists] == [side != "right", side != "left"]


def test_library_keeps_splits_apart(library: Library) -> None:
    test = Library(SOURCES, "test")
    for books, split in ((library, "train"), (test, "test")):
        take = books.take(np.random.default_rng(1), "wave")
        assert all(source.startswith(split) for source in take.motion.sources)
    with pytest.raises(LookupError, match="no 'kick'"):
        library.take(np.random.default_rng(0), "kick")
    few = [replace(clip, action="call", source="few", split="both") for clip in clips()[:1]]
    for split in ("train", "test"):
        assert Library(clips() + few, split).has("call")


def _scene(positions: np.ndarray) -> Scene:
    return Scene(positions, "idle", ("one",), "train", captions=["a", "b", "c"])


def test_checks_turn_bad_scenes_away() -> None:
    person = forward_kinematics(*standing(90))
    good = np.stack([person, person + np.array([0, 0, 1.5])])
    assert checks.fault(_scene(good)) is None
    jump = good.copy()
    jump[1, 40:] += [0.3, 0, 0]
    longer = good.copy()
    longer[0, :, J("left_wrist")] += [0.01, 0, 0]
    sliding = good.copy()
    sliding[0] += np.linspace(0, 1, 90)[:, None, None] * np.array([1.0, 0, 0])
    broken = good.copy()
    broken[0, 3, 3] = np.nan
    assert checks.fault(_scene(jump)) == "a joint jumps"
    assert checks.fault(_scene(longer)) == "bones drift"
    assert checks.fault(_scene(sliding)) == "feet slide"
    assert checks.fault(_scene(broken)) == "not finite"
    close = np.stack([person, person + np.array([0, 0, 0.1])])
    assert checks.fault(_scene(close)) == "trunks overlap"

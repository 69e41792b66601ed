"""Which motions stand beside each other, and how they are shown."""

from __future__ import annotations

import numpy as np
import pytest

from motion import Clip, Duet, InputError
from motion.transforms import turn
from tests.server.lab import stub_module
from webdemo.study import Stimulus, matched_pairs
from webdemo.study.pairs import FPS, MOST_PAIRS, as_shown, check_sources, shuffled

walking = stub_module().walking
MOTION: Duet = walking(1.0)


def made(*captions: str, first_seed: int | None = None) -> list[Stimulus]:
    return [
        Stimulus(caption, MOTION, None if first_seed is None else first_seed + i)
        for i, caption in enumerate(captions)
    ]


def test_motions_of_one_sentence_and_one_seed_stand_beside_each_other() -> None:
    ours = [
        Stimulus("They hug.", MOTION, 1),
        Stimulus("They hug.", MOTION, 2),
        Stimulus("They bow.", MOTION, 5),
    ]
    theirs = [
        Stimulus("They bow.", MOTION, 9),
        Stimulus("they hug", MOTION, 2),
        Stimulus("They wave.", MOTION, 1),
    ]
    pairs = matched_pairs([ours, theirs])
    assert [pair.motions for pair in pairs] == [(1, 4), (2, 3)]
    assert pairs[1].caption == "They bow." and not pairs[1].known


def test_three_sets_make_three_comparisons() -> None:
    pairs = matched_pairs([made("a", "b"), made("a"), made("b", "a")])
    assert [(pair.sets, pair.motions) for pair in pairs] == [
        ((0, 1), (0, 2)), ((0, 2), (0, 4)), ((0, 2), (1, 3)), ((1, 2), (2, 4)),
    ]  # fmt: skip


def test_recordings_are_found_by_the_names_of_their_files_and_show_the_sentence() -> None:
    recorded = [Stimulus("", MOTION, name="they-hug"), Stimulus("", MOTION, name="other")]
    (pair,) = matched_pairs([made("They hug."), recorded])
    assert (pair.motions, pair.caption) == ((0, 1), "They hug.")


def test_sets_without_a_common_sentence_are_paired_in_order_and_show_none() -> None:
    pairs = matched_pairs([made("a", "b"), [Stimulus("", MOTION, name=name) for name in ("x", "y", "z")]])
    assert [(pair.motions, pair.caption) for pair in pairs] == [((0, 2), ""), ((1, 3), "")]


@pytest.mark.parametrize(
    ("sets", "says"),
    [
        ([made("a")], "compares 2 to 6 sets of motions, not 1"),
        ([made("a")] * 7, "not 7"),
        ([made("a"), []], "make no pairs"),
        ([made(*["a"] * (MOST_PAIRS // 2 + 1))] * 3, "303 pairs: choose fewer"),
        ([made(*["a"] * 300)] * 2, "400 motions at most"),
        ([made("a"), [Stimulus("a", MOTION.a)]], "different joints or numbers of people"),
    ],
)
def test_what_makes_no_study_is_a_sentence(sets: list[list[Stimulus]], says: str) -> None:
    with pytest.raises(InputError, match=says):
        matched_pairs(sets)


def test_what_is_shown_does_not_tell_where_it_is_from() -> None:
    moved = turn(MOTION.positions, 1.1) + np.array([7.0, 0.0, -3.0])
    other = Duet.from_positions(
        moved, fps=MOTION.fps, roles=("actor", "reactor"), manifest={"model": "secret"}
    )
    one, two = as_shown(MOTION), as_shown(other)
    np.testing.assert_allclose(one.positions, two.positions, atol=1e-4)
    assert isinstance(two, Duet) and two.manifest is None and two.roles == ("a", "b")
    slow = Duet.from_positions(MOTION.positions[:, ::2], fps=MOTION.fps / 2)
    assert as_shown(slow).fps == FPS and abs(as_shown(slow).seconds - MOTION.seconds) < 0.1
    alone = as_shown(Clip(moved[0], MOTION.fps))
    np.testing.assert_allclose(alone.positions, as_shown(MOTION.a).positions, atol=1e-4)


def test_a_shuffled_copy_holds_the_same_poses_in_another_order() -> None:
    copy = shuffled(MOTION, seed=3)
    assert isinstance(copy, Duet) and copy.num_frames == MOTION.num_frames
    assert not np.array_equal(copy.positions, MOTION.positions)
    for before, after in zip(MOTION.people, copy.people, strict=True):
        np.testing.assert_array_equal(
            np.sort(before.positions.reshape(len(before.positions), -1), axis=0),
            np.sort(after.positions.reshape(len(after.positions), -1), axis=0),
        )
    np.testing.assert_array_equal(shuffled(MOTION, seed=3).positions, copy.positions)


def test_checks_are_drawn_from_all_pairs() -> None:
    pairs = matched_pairs([made("a", "b", "c"), made("a", "b", "c")])
    assert len({pair.motions for pair in check_sources(pairs, 3, seed=1)}) == 3
    assert len(check_sources(pairs, 5, seed=1)) == 5
    with pytest.raises(InputError, match="0 to 20 attention checks, not 21"):
        check_sources(pairs, 21, seed=1)

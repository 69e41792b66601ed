"""What the scores of scenes are made of: stories, rules in their own time, seams, paths."""

import numpy as np
import pytest

from motion import SMPL22, Duet
from motion.transforms import heading_matrix
from training.evaluate.scenes import (
    MEET,
    NEAR,
    PART,
    heading_error,
    jolt,
    obeyed,
    path_error,
    possible_frame,
    raised,
    seams,
    stories,
    table,
    turning_path,
    wave_path,
)
from webdemo.inference.story import Pose

REST = SMPL22.rest_positions() + np.array([0, 0.98, 0])


def apart(gaps: np.ndarray) -> Duet:
    """Two people who stand as far apart as the gaps (frames,) say, a at the origin."""
    a = np.repeat(REST[None], len(gaps), axis=0)
    b = a + gaps[:, None, None] * np.array([0, 0, 1.0])
    return Duet.from_positions(np.stack([a, b]), fps=30.0)


def test_stories_have_three_to_six_beats_and_differ() -> None:
    found = stories(60)
    assert {len(story) for story in found} == {3, 4, 5, 6} and found == stories(60)
    assert all(story[0] == MEET and story[-1] == PART and len(set(story)) == len(story) for story in found)
    assert {act for story in found for act in story} == {MEET, PART, *NEAR}


def test_a_beat_is_judged_in_its_own_time() -> None:
    come = apart(np.concatenate([np.linspace(4, 1.2, 90), np.full(90, 1.2)]))
    assert obeyed(come, (MEET,), (0, 90)) == [True]
    assert obeyed(come, (MEET, MEET), (0, 90, 180)) == [True, False]


def test_a_jolt_at_a_seam_is_seen() -> None:
    rng = np.random.default_rng(0)
    gaps = 1.2 + 0.002 * rng.normal(size=180).cumsum()
    calm = seams(apart(gaps), (0, 90, 180))
    gaps[90:] += 0.5
    jolt = seams(apart(gaps), (0, 90, 180))
    assert calm["ratio"][0] < 1 < jolt["ratio"][0]
    assert jolt["foot"][0] > 0.4 > calm["foot"][0]


def test_the_distance_from_a_path_is_measured() -> None:
    path = wave_path(4.0)
    times = np.arange(120) / 30
    duet = apart(np.full(120, 1.0))
    on = np.array([path.place(t) or (0, 0) for t in times])
    positions = duet.positions.copy()
    positions[0] += np.stack([on[:, 0], 0 * on[:, 0], on[:, 1]], -1)[:, None] - positions[0, :, :1] * [
        1,
        0,
        1,
    ]
    assert path_error(Duet.from_positions(positions, fps=30.0), path).max() < 1e-5
    positions[0, :, :, 0] += 0.2
    assert path_error(Duet.from_positions(positions, fps=30.0), path).mean() == pytest.approx(0.2, abs=1e-5)


def test_the_raised_arm_is_a_pose_that_a_story_takes() -> None:
    pose = raised(REST)
    Pose("a", 1.0, pose).check(2.0)
    assert pose[SMPL22.index("right_wrist"), 1] > REST[SMPL22.index("head"), 1] + 0.2
    parents, children = np.array(SMPL22.bones).T
    lengths = [np.linalg.norm(p[children] - p[parents], axis=-1) for p in (pose, REST)]
    np.testing.assert_allclose(*lengths)


def test_headings_are_compared_the_short_way_round() -> None:
    way = turning_path()
    positions = apart(np.full(200, 1.0)).positions.astype(np.float64)
    for point in way.points:
        turn = heading_matrix(np.radians((point.heading or 0.0) + 350))
        positions[0, round((point.seconds or 0.0) * 30)] = REST @ turn.T
    found = heading_error(Duet.from_positions(positions, fps=30.0), way)
    np.testing.assert_allclose(found, 10.0, atol=1e-3)


def test_a_jolt_is_found_beside_the_joins_of_a_loop_alone() -> None:
    positions = apart(np.full(180, 1.0)).positions.astype(np.float64)
    positions[0, 94, 20] += [0.2, 0.0, 0.0]  # back the next frame: the speed changes by 40 cm a frame
    assert jolt(positions, [0, 90]) == pytest.approx(0.4)
    assert jolt(positions, [0, 150]) == pytest.approx(0.0)
    assert jolt(np.roll(positions, 80, axis=1), [0, 90]) == pytest.approx(0.4), (
        "its last frame is beside its first"
    )


def test_a_pose_that_is_asked_for_is_one_that_people_take() -> None:
    """A knee that is bent forward around the frame that is looked for."""
    positions = np.repeat(REST[None], 200, axis=0)
    knee, ankle = SMPL22.index("left_knee"), SMPL22.index("left_ankle")
    positions[110:128, ankle] = positions[110:128, knee] + [0.0, 0.0, 0.4]
    assert possible_frame(positions) == 128
    positions[128:] = positions[120]
    assert possible_frame(positions) == 109


def test_the_table_counts() -> None:
    row = {"words": ["x", "y"], "obeyed": [True, False], "seconds": 6.0, "spent": 3.0, "ratio": [0.5], "foot": [0.1],
           "usual_foot": [0.08]}  # fmt: skip
    scores = {"settings": {"steps": 25}, "stories": [row, {**row, "obeyed": [True, True]}], "path_cm": [[1.0, 4.0]],
              "outside": [0.0], "span_jerk": [0.25, 1.5], "loop_cm": [[0.5, 0.6]], "heading_degrees": [[2.0, 4.0]],
              "loop_jolt_cm": [2.0, 5.0],
              "poses": [{"miss_cm": 0.5, "jerk": 1.2}, {"miss_cm": 1.5, "jerk": 2.2}]}  # fmt: skip
    shown = table(scores)
    assert "0.2 to 1.5 times" in shown and "3.5 and 5.0 cm a frame" in shown
    assert "3.0 and 4.0 degrees" in shown and "| 1.5 cm |" in shown and "1.2 to 2.2 times" in shown
    assert (
        "| x | 100 % (2/2" in shown and "75 % (3/4" in shown and "| 30 s |" in shown and "50 % (1/2" in shown
    )

"""What a scene may ask for, and the sentence where it asks for too much."""

import itertools
import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from acts.staging.window import AFTER, MOST_FRAMES, PAST
from motion import SMPL22, Duet, InputError
from webdemo.inference.requests.paths import meeting
from webdemo.inference.story import Beat, FloorPath, FloorPoint, Pose, SceneRequest
from webdemo.inference.story.request import window_seed, windows

REST = SMPL22.rest_positions() + np.array([0, 0.98, 0])
WAVE = Beat("They wave.", seconds=3.0)


def bent(joint: str, angle: float) -> np.ndarray:
    """The T-pose with a knee bent backwards, or an elbow, by an angle in radians."""
    pose, middle = REST.copy(), SMPL22.index(joint)
    first, end = SMPL22.parents[middle], SMPL22.children[middle][0]
    upper = pose[middle] - pose[first]
    axis = np.array([1.0, 0, 0]) if "knee" in joint else np.cross(upper, [0, 1.0, 0]) / np.linalg.norm(upper)
    aside = axis * (axis @ upper)
    turned = aside + np.cos(angle) * (upper - aside) + np.sin(angle) * np.cross(axis, upper)
    by = pose[middle] + turned * np.linalg.norm(pose[end] - pose[middle]) / np.linalg.norm(upper) - pose[end]
    for moved in (end, *SMPL22.children[end]):
        pose[moved] += by
    return pose


def still(frames: int = 150) -> Duet:
    return Duet.from_positions(
        np.stack([np.repeat(p[None], frames, axis=0) for p in (REST, REST + np.array([0, 0, 1.5]))]), fps=30.0
    )


def path(*points: tuple[float, ...], person: str = "a") -> FloorPath:
    return FloorPath(person, tuple(FloorPoint(x, z, s) for s, x, z in points))


@pytest.mark.parametrize(
    ("fields", "says"),
    [
        ({"beats": ()}, "The story is empty"),
        ({"beats": (WAVE,) * 500}, "500 beats"),
        ({"beats": (Beat(),)}, "Beat 1 has no words"),
        ({"beats": (Beat("x", seconds=30),) * 4, "samples": 8}, "960 s of motion"),
        ({"beats": (WAVE,), "start": 1.0}, "belongs to a given motion"),
        ({"beats": (WAVE,), "motion": still(), "start": 7.0}, "Start must be from 0 to 5"),
        ({"beats": (WAVE,), "motion": still(), "start": 0.0, "end": 5.0}, "whole motion"),
        ({"beats": (WAVE,) * 4, "motion": still(), "start": 1.0, "end": 2.0}, "4 beats do not fit"),
        ({"beats": (WAVE,), "paths": (path((0, 9, 0)),)}, "outside the floor"),
        ({"beats": (WAVE,), "paths": (path((0, 0, 0), (1, 6, 0)),)}, "6.0 m/s"),
        ({"beats": (WAVE,), "paths": (path((1, 0, 0)), path((1, 0, 0)))}, "two paths"),
        ({"beats": (WAVE,), "poses": (Pose("a", 1, REST), Pose("a", 1.5, REST + np.array([4.0, 0, 0])))}, "4.0 m"),
        ({"beats": (WAVE,), "poses": (Pose("a", 1, bent("left_knee", -np.pi / 2)),)}, "the left knee is bent forward"),
        ({"beats": (WAVE,), "poses": (Pose("a", 1, REST),), "paths": (path((0, 2, 0), (2, 2, 0)),)}, "off their path"),
        ({"beats": (WAVE,), "motion": still(), "start": 2.0, "end": 4.0, "paths": (path((1, 0, 0)),)}, "is kept"),
    ],
)
def test_what_cannot_be_made_is_refused_in_one_sentence(fields: dict[str, Any], says: str) -> None:
    with pytest.raises(InputError, match=says):
        SceneRequest(**fields)


def test_lengths_are_set_and_fill_a_span() -> None:
    assert SceneRequest(beats=(Beat("They shake hands."),)).beats[0].seconds == 3.5
    span = SceneRequest(beats=(WAVE, Beat("They bow.", seconds=6.0)), motion=still(), start=1.0, end=4.0)
    assert [beat.seconds for beat in span.beats] == [1.0, 2.0]
    assert (span.made, span.num_frames, span.total_seconds) == ((30, 120), 150, 5.0)


def test_a_request_comes_back_from_its_dictionary() -> None:
    pose = Pose("b", 2.0, REST + np.array([0, 0, 1.5]))
    request = SceneRequest(beats=(WAVE, Beat(a="bows")), paths=(path((0, 0, 0), (2, 1, 1)),), poses=(pose,), seed=3)
    written = json.loads(json.dumps(request.to_dict()))
    assert SceneRequest.from_dict(written).to_dict() == request.to_dict()
    span = SceneRequest(beats=(WAVE,), motion=still(), start=1.0, end=4.0)
    assert SceneRequest.from_dict(span.to_dict(), still()).to_dict() == span.to_dict()


def test_the_hash_of_a_given_motion_is_that_of_what_is_kept() -> None:
    changed = still().positions.copy()
    changed[:, 40:100] += 0.1
    one, other = (
        SceneRequest(beats=(WAVE,), motion=m, start=1.0, end=4.0).to_dict()["motion"]["sha256"]
        for m in (still(), Duet.from_positions(changed, fps=30.0))
    )
    assert one == other


def test_paths_that_cross_at_one_time_are_noticed() -> None:
    there, back = path((0, -2, 0), (4, 2, 0)), path((0, 2, 0), (4, -2, 0), person="b")
    found = meeting(there, back)
    assert found is not None and found[0] == pytest.approx(2.0, abs=0.1) and found[1] < 0.2
    assert meeting(there, path((0, 2, 1), (4, -2, 1), person="b")) is None


def test_windows_cover_the_beats_and_see_the_end_of_the_last() -> None:
    plan = windows(SceneRequest(beats=(WAVE, Beat("They dance.", seconds=20), WAVE)))
    assert (plan[0].start, plan[0].stop) == (0, 90) and plan[-1].stop == 780
    assert all(before.stop == after.start for before, after in itertools.pairwise(plan))
    assert all(w.past == PAST and w.past + w.stop - w.start <= MOST_FRAMES for w in plan[1:])
    assert len({window_seed(SceneRequest(beats=(WAVE,) * 3), 0, w) for w in plan}) == len(plan)


def test_a_span_sees_what_follows_and_a_loop_its_beginning() -> None:
    (one,) = windows(SceneRequest(beats=(WAVE,), motion=still(), start=1.0, end=4.0))
    assert (one.past, one.after) == (30, 30)
    first, last = windows(SceneRequest(beats=(WAVE,), loop=True))
    assert first.after == 0 and 0 < last.after <= min(AFTER, last.start)
    short, long = (replace(WAVE, seconds=seconds) for seconds in (0.5, 4.0))
    first, last = windows(SceneRequest(beats=(short, long), loop=True))
    assert last.after == last.start == first.stop < AFTER, "no frame before its own is seen twice"

"""Paths of a sentence: checked, kept in its manifest, walked, and stayed at where the words lead nobody on."""

from __future__ import annotations

import numpy as np
import pytest

from motion import InputError
from webdemo.inference import Engine, GenerateRequest
from webdemo.inference.requests.paths import FloorPath, FloorPoint
from webdemo.inference.story.sentences import as_scene

WAY = FloorPath("a", (FloorPoint(0.0, 0.0, 0.0), FloorPoint(1.0, -0.5)))


def test_a_request_keeps_its_paths_with_times() -> None:
    request = GenerateRequest(prompt="A waves to B.", paths=(WAY,))
    (path,) = request.paths
    assert path.points[1].seconds == pytest.approx(np.hypot(1, 0.5) / 1.2)
    again = {name: value for name, value in request.to_dict().items() if name != "kind"}
    assert GenerateRequest(**again) == request
    assert "paths" not in GenerateRequest(prompt="A waves to B.").to_dict()


@pytest.mark.parametrize(
    ("paths", "said"),
    [
        ((FloorPath("a", (FloorPoint(0, 0, 0.0), FloorPoint(7, 7, 1.0))),), "ask for 9.9 m/s"),
        ((WAY, WAY), "has two paths"),
        ((FloorPath("a", (FloorPoint(9, 0),)),), "outside the floor"),
    ],
)
def test_what_nobody_can_walk_is_refused(paths: tuple[FloorPath, ...], said: str) -> None:
    with pytest.raises(InputError, match=said):
        GenerateRequest(prompt="A waves to B.", paths=paths)


def test_a_sentence_with_a_path_is_made_as_a_scene_and_stays_at_its_end_unless_led_on() -> None:
    walks = "A walks away from B."
    for sentence, stays in (("A waves to B.", True), (walks, True), ("They hug.", False), ("A jumps.", False)):
        scene = as_scene(GenerateRequest(prompt=sentence, paths=(WAY,)))
        assert scene is not None
        assert (len(scene.walks[0].points) > 2) is stays, sentence
        assert scene.paths[0].points == GenerateRequest(prompt=sentence, paths=(WAY,)).paths[0].points


def test_the_motion_follows_the_path(shipped: Engine) -> None:
    """Also where the words would lead on: the path is the whole way."""
    request = GenerateRequest(prompt="Two people walk.", paths=(WAY,), seconds=4.0, steps=4)
    duet = list(shipped.run(request))[-1].duets[0]
    places = duet.positions[0, :, 0][:, [0, 2]]
    for point in request.paths[0].points:
        assert np.linalg.norm(places[round(point.seconds * 30)] - [point.x, point.z]) < 0.1
    assert np.linalg.norm(places[35:] - [1.0, -0.5], axis=1).max() < 0.25

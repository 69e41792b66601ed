"""Live streams: who gets one, when one ends, and what a stream answers."""

from __future__ import annotations

import asyncio
import threading
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from motion import InputError
from motion.things import Thing, shape
from tests.motion.video.filming import film, packed, stepping
from tests.server.clients import Clock
from tests.server.live.streaming import STUB, poses, streams
from tests.view.packed import unpack_positions
from webdemo.server.http.routes import Refused
from webdemo.server.live import stream as stream_module
from webdemo.server.live import streams as streams_module
from webdemo.server.live.stream import MOST_BYTES, MOST_FRAMES, MOST_PICTURES, LiveStream, Resampled, read_message
from webdemo.server.live.streams import StreamEnded
from webdemo.ui.visitor import Visitor

ADA, EVE = Visitor("ada", "ada"), Visitor("eve", "eve")


def answered(one: LiveStream, message: Any) -> dict[str, Any]:
    """A stream's answer, with all its steps done at once."""
    *frames, answer = one.answer(message)
    assert answer is not None and set(frames) <= {None}
    return answer


def stream() -> LiveStream:
    return LiveStream("id", "ada", "", STUB.Mirror(), clock=Clock())


def test_a_person_has_one_stream_and_a_server_has_so_many() -> None:
    some = streams()
    first = some.open(ADA, "agent")
    second = some.open(ADA, "agent")
    with pytest.raises(StreamEnded, match="Another live stream of yours"):
        some.find(first.id, ADA)
    assert some.find(second.id, ADA) is second
    for name in "xy":
        some.open(Visitor(name, name), "regennet")
    with pytest.raises(InputError, match="There are 3 live streams here"):
        some.open(EVE, "agent")
    some.open(ADA, "agent")  # in place of their own
    some.close(some.find(some.open(Visitor("x", "x"), "agent").id, Visitor("x", "x")))
    assert some.open(EVE, "agent")


def test_a_stream_is_its_persons_alone() -> None:
    some = streams()
    key = some.open(ADA, "agent").id
    with pytest.raises(Refused, match="does not know this live stream"):
        some.find(key, EVE)
    with pytest.raises(Refused, match="does not know this live stream"):
        some.find("no such stream", ADA)
    with pytest.raises(InputError, match="no live partner 'nobody'"):
        some.open(ADA, "nobody")
    assert some.find(key, ADA), "a stream goes on when another one is refused"


def test_one_address_cannot_take_all_places() -> None:
    some = streams()
    for name in ("a", "b"):
        some.open(Visitor(name, name, address="203.0.113.9"), "agent")
    with pytest.raises(InputError, match="your network have 2 live streams"):
        some.open(Visitor("c", "c", address="203.0.113.9"), "agent")
    assert some.open(Visitor("d", "d", address="203.0.113.10"), "agent")


def test_idle_and_old_streams_are_closed() -> None:
    some = streams()
    clock = some.clock
    idle = some.open(ADA, "agent")
    clock.now += streams_module.IDLE + 0.1
    assert some.count == 1
    busy = some.open(EVE, "agent")
    assert some.count == 1
    with pytest.raises(StreamEnded, match="Nothing came for 20 seconds"):
        some.find(idle.id, ADA)
    for _ in range(int(streams_module.LONGEST / 5) + 1):
        clock.now += 5
        busy.heard = clock.now
    with pytest.raises(StreamEnded, match="10 minutes at most"):
        some.find(busy.id, EVE)


def test_a_server_that_stops_ends_its_streams() -> None:
    some = streams()
    key = some.open(ADA, "agent").id
    some.stop()
    with pytest.raises(StreamEnded, match="stopping"):
        some.find(key, ADA)
    with pytest.raises(Refused, match="stopping"):
        some.open(ADA, "agent")
    late = streams()
    late.engine = SimpleNamespace(partner=lambda *_, **__: late.stop())
    with pytest.raises(Refused, match="stopping"):
        late.open(ADA, "agent")
    assert late.count == 0
    with pytest.raises(Refused, match="switched off"):
        streams(most=0).open(ADA, "agent")


def test_poses_at_any_pace_become_thirty_a_second() -> None:
    even = Resampled()
    made = [
        float(pose[0, 0])
        for time in (0.0, 0.1, 0.117, 0.3, 0.3, 0.2)
        for pose in even.add(time, np.full((22, 3), time))
    ]
    assert made == pytest.approx(np.arange(10) / 30)
    (after,) = even.add(5.0, np.full((22, 3), 5.0))  # a pause is not filled
    assert after[0, 0] == 5.0
    assert len(list(even.add(5.1, np.full((22, 3), 5.1)))) == 3


def test_a_stream_answers_each_frame_once() -> None:
    one = stream()
    first = answered(one, poses([0.0, 1 / 30], 0.5))
    second = answered(one, poses([2 / 30, 0.1], 0.5))
    assert one.frames == 4
    both = np.concatenate([unpack_positions(a["frames"]) for a in (first, second)], axis=1)
    assert both.shape == (2, 4, 22, 3)
    assert both[0, :, 0, 1] == pytest.approx(1.0 + 0.5 * np.arange(4) / 30, abs=2e-3)
    assert both[1] == pytest.approx(both[0] * [-1, 1, -1] + [0, 0, 1.5], abs=2e-3)
    assert first["belief"]["text"] == "The stub watches."
    assert first["belief"]["chances"] == [["wave", 0.75], ["bow", 0.2]]
    assert answered(one, b"{}")["frames"] is None
    assert one.frames == 4


def test_landmarks_become_the_persons_poses() -> None:
    filmed = film(stepping(1.5, heading=0.3), tilt=0, noise=0.01, face=0.0)
    one = stream()
    assert one.partner.gaze is None
    answers = []
    for picture, time in enumerate(filmed.times):
        chosen = replace(
            filmed,
            times=np.array([time]),
            frames=np.zeros(1, int),
            world=filmed.world[[picture]],
            image=filmed.image[[picture]],
            seen=filmed.seen[[picture]],
        )
        answers.append(answered(one, packed(chosen).encode()))
    frames = [unpack_positions(a["frames"]) for a in answers if a["frames"]]
    person = np.concatenate(frames, axis=1)[0]
    assert len(person) == pytest.approx(30 * 1.5 - 2 * 8, abs=3)
    assert 1.4 < person[..., 1].max() < 2.0 and abs(person[..., 1].min()) < 0.06
    assert one.partner.gaze is not None and one.partner.gaze.camera > 0.9, "the partner is told where the face points"
    one.clock.now += stream_module.LOST + 0.1
    empty = replace(
        filmed,
        times=np.array([3.0]),
        frames=np.zeros(0, int),
        world=filmed.world[:0],
        image=filmed.image[:0],
        seen=filmed.seen[:0],
    )
    assert "step into the picture" in answered(one, packed(empty).encode())["hint"]


def test_a_stream_that_ends_stops_in_the_middle_of_a_message() -> None:
    some = streams()
    steps: list[int] = []
    held, goes_on = threading.Event(), threading.Event()

    class Slow(STUB.Mirror):
        def step(self, pose: np.ndarray) -> np.ndarray:
            steps.append(1)
            held.set()
            goes_on.wait(20)
            return super().step(pose)

    some.engine.partner = lambda name, seed=0: Slow()
    one = some.open(ADA, "agent")

    async def close() -> None:
        answer = asyncio.create_task(some.answer(one.id, ADA, poses([0.0, 1.0, 2.0])))
        assert await asyncio.to_thread(held.wait, 20)
        some.close(one)
        goes_on.set()
        await answer

    with pytest.raises(StreamEnded):
        asyncio.run(close())
    assert len(steps) == 1


@pytest.mark.parametrize(
    "body",
    [
        b"[]",
        b"{" * 5000,
        b"\xff",
        b" " * (MOST_BYTES + 1),
        b'{"poses": "", "times": []}',
        b'{"poses": "AAAA", "times": [0]}',
        b'{"poses": "%%%", "times": [0]}',
        b'{"poses": 7, "times": [0]}',
        b'{"poses": "", "times": [NaN]}',
        b'{"landmarks": 2}',
        poses([0.2, 0.1]),
        poses([i / 30 for i in range(MOST_PICTURES + 1)]),
        poses([0.0]).replace(b"[0.0]", b'["0"]'),
        poses([0.0]).replace(b"[0.0]", b"[NaN]"),
        poses([0.0]).replace(b"[0.0]", b"[" + b"9" * 400 + b"]"),
    ],
)
def test_what_no_page_sends_is_refused_in_a_sentence(body: bytes) -> None:
    with pytest.raises(InputError, match="reload the page"):
        read_message(body)


def test_a_message_that_spans_half_a_minute_is_not_computed_whole() -> None:
    one = stream()
    answered(one, poses([float(second) for second in range(32)]))
    assert MOST_FRAMES <= one.frames < MOST_FRAMES + 30


def test_a_stream_gets_no_more_frames_than_time_has_passed() -> None:
    one = stream()
    for minute in range(3):
        answered(one, poses([60 * minute + 0.9 * i for i in range(32)]))
    assert one.frames == stream_module.AHEAD
    one.clock.now += 1.0
    answered(one, poses([600 + 0.9 * i for i in range(32)]))
    assert one.frames == stream_module.AHEAD + 30


def test_points_that_lie_in_one_place_do_no_harm() -> None:
    filmed = film(stepping(1.0))
    for part in (
        replace(filmed, image=np.full_like(filmed.image, 0.5), world=np.zeros_like(filmed.world)),
        replace(filmed, seen=np.zeros_like(filmed.seen), image=np.zeros_like(filmed.image)),
    ):
        answer = answered(stream(), packed(part).encode())
        assert answer["frames"] is None or np.isfinite(unpack_positions(answer["frames"])).all()


def test_things_are_sent_whole_with_the_first_frames_and_then_only_as_they_move() -> None:
    one = stream()
    place = np.array([0.5, 0.0, 1.0])
    still = Thing.at_rest("hi-fi", shape("hi-fi"), place, 0.0, 1)
    sash = [Thing.at_rest("sash", shape("sash"), place, yaw, 1) for yaw in (0.0, 0.0, 1.0)]
    answers = []
    for index, leaf in enumerate(sash):
        one.partner.things = (still, leaf)  # type: ignore[misc]
        one.clock.now += 0.1  # type: ignore[attr-defined]
        answers.append(answered(one, poses([0.1 * index])))
    assert [thing["kind"] for thing in answers[0]["things"]] == ["hi-fi", "sash"]
    assert "moved" not in answers[0] and not {"things", "moved"} & answers[1].keys()
    ((number, *pose),) = answers[2]["moved"]
    assert number == 1 and pose == pytest.approx([0.5, 0, 1, 0, np.sin(0.5), 0, np.cos(0.5)], abs=1e-3)
    assert "things" not in answers[2]

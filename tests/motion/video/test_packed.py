"""What the browser sends of a film is read exactly, and nothing else is."""

from __future__ import annotations

import base64
import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from motion import InputError
from motion.video import unpack_film

from .filming import film, packed, stepping

FILM = film(stepping(0.6))
FIELDS = json.loads(packed(FILM))


def test_a_film_comes_through_as_it_was_sent() -> None:
    landmarks, name = unpack_film(packed(FILM, name="walk/../x\n.mp4"))
    assert name == "walk..x.mp4"
    assert np.abs(landmarks.world - FILM.world).max() <= 0.0005
    assert np.abs(landmarks.pixels - FILM.pixels).max() < 0.1
    assert np.array_equal(landmarks.frames, FILM.frames)
    assert np.abs(landmarks.times - FILM.times).max() < 0.001


@pytest.mark.parametrize(
    "change",
    [
        {"landmarks": 2},
        {"width": 8},
        {"height": 10**9},
        {"counts": "////"},
        {"world": "not base64!"},
        {"image": FIELDS["image"][:-8]},
        {"times": base64.b64encode(np.zeros(len(FILM.times), "<u4").tobytes()).decode()},
        {"times": base64.b64encode((np.arange(len(FILM.times)) * 90_000).astype("<u4").tobytes()).decode()},
    ],
)
def test_other_fields_are_refused(change: dict) -> None:
    with pytest.raises(InputError):
        unpack_film(json.dumps({**FIELDS, **change}))


PLAIN = st.none() | st.booleans() | st.floats() | st.text(max_size=8)


@settings(max_examples=60, deadline=None)
@given(st.lists(PLAIN, max_size=3) | st.dictionaries(st.text(max_size=8), PLAIN, max_size=3) | PLAIN)
def test_any_json_is_refused_in_a_sentence(value: object) -> None:
    with pytest.raises(InputError):
        unpack_film(json.dumps(value))

"""The curve under a motion that is still being made: it grows as the second person's frames come."""

from __future__ import annotations

import numpy as np
import pytest

from motion import Clip
from tests.ui.stub_engine import walking
from webdemo.view.payload import pack_positions, player_payload

from .playing import until

pytestmark = pytest.mark.e2e
PLAYER = "window.__pasdedeux.player"


def test_the_distance_is_drawn_as_far_as_it_is_known(player):
    page = player()
    actor: Clip = walking(4.0).a
    page.evaluate(f"payload => {PLAYER}.load(payload)", {**player_payload(actor), "id": "one", "live": True})
    strip = page.locator(".pdd-strip")
    assert strip.is_hidden()
    other = actor.positions + np.float32([0.6, 0.3, 0.8])
    for start, stop in ((0, 30), (24, 60), (66, 80)):  # the last one follows a message that was missed
        message = {"id": "one", "start": start, "frames": pack_positions(other[None, start:stop]), "text": ""}
        page.evaluate(f"message => {PLAYER}.arrive(message)", message)
        known = page.evaluate(f"{PLAYER}.sample.curves.map(curve => curve.values)")
        assert len(known) == 1 and len(known[0]) == stop
        np.testing.assert_allclose(known[0], 1.0, atol=2e-3)  # over the floor: 0.6 and 0.8
        until(page, f"{PLAYER}.strip.painted === {stop}")
    assert strip.is_visible()
    assert page.locator(".pdd-values dd").all_text_contents() == ["1.00 m"]
    page.evaluate(f"{PLAYER}.arrive({{id: 'one', stop: true}})")
    assert page.evaluate(f"{PLAYER}.sample.frames") == 80
    assert page.locator(".pdd-values dd").all_text_contents() == ["1.00 m"]

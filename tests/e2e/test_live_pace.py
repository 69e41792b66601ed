"""A stream of somebody who moves now: where the processor draws, pictures are smaller and fewer while it goes on."""

from __future__ import annotations

import numpy as np
import pytest

from tests.ui.stub_engine import walking
from webdemo.view.payload import pack_positions, player_payload

from .playing import until

pytestmark = pytest.mark.e2e
PLAYER = "window.__pasdedeux.player"
FINENESS = f"{PLAYER}.scene.inside.glplot.pixelRatio"
BEGIN = """
async ([payload, frames]) => {
  const { Stream } = await import("/player/stream.js");
  window.stream = new Stream(window.__pasdedeux.player, payload, ["you", "partner"]);
  window.feed = setInterval(() => window.stream.add(frames, ""), 1000 / 15);
}
"""


def test_the_processor_is_spared_while_somebody_is_followed(player):
    page = player()
    assert page.evaluate(f"{PLAYER}.scene.software"), "browser tests run without a graphics card"
    actor = walking(4.0).a
    still = np.stack([actor.positions[:2], actor.positions[:2] + np.float32([0.6, 0, 0.8])])
    page.evaluate(BEGIN, [{**player_payload(actor), "id": "stream-1"}, pack_positions(still)])
    until(page, f"{PLAYER}.sparing && {FINENESS} === 0.75")
    until(page, f"{PLAYER}.sample.frames > 90")
    assert 5 < page.evaluate("window.__pasdedeux.fps") < 22
    page.evaluate(f"clearInterval(window.feed); window.stream.end(); {PLAYER}.clock.pause()")
    until(page, f"!{PLAYER}.sparing && {FINENESS} === 2")
    page.evaluate(f"{PLAYER}.act('play')")
    until(page, f"{FINENESS} === 1")

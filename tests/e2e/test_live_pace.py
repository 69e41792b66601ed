"""A live stream: where the processor draws, pictures are smaller and fewer while it goes on."""

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
WATCH = """
() => {
  const player = window.__pasdedeux.player, count = player.rate.count.bind(player.rate);
  let last = null;
  window.gaps = [];
  player.rate.count = (now) => {
    const live = player.sparing && player.clock.playing;
    if (live && last !== null) window.gaps.push(now - last);
    last = live ? now : null;
    count(now);
  };
}
"""
"""Notes the milliseconds between two pictures while somebody is followed."""
LEAST = 48
"""Milliseconds between two pictures then, as ``LIVE_PAUSE`` of the player says: some 20 a second."""


def test_the_processor_is_spared_while_somebody_is_followed(player):
    page = player()
    assert page.evaluate(f"{PLAYER}.scene.software"), "browser tests run without a graphics card"
    actor = walking(4.0).a
    still = np.stack([actor.positions[:2], actor.positions[:2] + np.float32([0.6, 0, 0.8])])
    page.evaluate(BEGIN, [{**player_payload(actor), "id": "stream-1"}, pack_positions(still)])
    until(page, f"{PLAYER}.sparing && {FINENESS} === 0.75")
    until(page, f"{PLAYER}.sample.frames > 90")
    page.evaluate(WATCH)
    until(page, "window.gaps.length >= 20")
    assert min(page.evaluate("window.gaps")) >= LEAST
    page.evaluate(f"clearInterval(window.feed); window.stream.end(); {PLAYER}.clock.pause()")
    until(page, f"!{PLAYER}.sparing && {FINENESS} === 2")
    page.evaluate(f"{PLAYER}.act('play')")
    until(page, f"{FINENESS} === 1")

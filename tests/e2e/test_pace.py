"""The pace of a stream in the player: little is in hand, and it does not run dry."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
from playwright.sync_api import Page

from .plain import serve

pytestmark = [pytest.mark.e2e]

SIMULATE = """
async ({ late, ahead, paced }) => {
  const { Clock } = await import("/player/clock.js");
  const { Pace } = await import("/player/pace.js");
  const clock = new Clock(), pace = new Pace();
  Object.assign(clock, { frames: 1e6, frame: 0, limit: ahead, playing: true, last: 0 });
  const lags = [];
  let known = ahead + 1, dry = 0;
  // Two frames every fifteenth of a second, every fourth message late; drawn sixty times a second, for 12 seconds.
  const arrivals = Array.from({ length: 180 }, (_, i) => (i + 1) * 1000 / 15 + (i % 4 === 3 ? late : 0));
  for (let tick = 1; tick < 720; tick++) {
    const now = (tick * 1000) / 60;
    clock.advance(now);
    while (arrivals.length && arrivals[0] <= now) {
      const hurry = pace.add(arrivals.shift(), known - 1 - clock.frame);
      if (paced) clock.hurry = hurry;
      known += 2;
      clock.limit = known - 1;
    }
    if (now < 6000) continue;
    lags.push(known - 1 - clock.frame);
    dry += clock.frame >= clock.limit;
  }
  return { lag: lags.reduce((a, b) => a + b) / lags.length, dry: dry / lags.length };
}
"""


@pytest.fixture(scope="module")
def page(chromium: Any) -> Iterator[Page]:
    with serve() as address:
        page = chromium.new_page()
        page.goto(address, wait_until="commit")
        yield page
        page.close()


def simulated(page: Page, *, late: float, ahead: int, paced: bool = True) -> dict[str, float]:
    """Mean frames in hand and the share of pictures with none, in the last six seconds of twelve."""
    return page.evaluate(SIMULATE, {"late": late, "ahead": ahead, "paced": paced})


@pytest.mark.parametrize("ahead", [1, 4, 7])
def test_frames_that_are_not_needed_are_caught_up_with(page: Page, ahead: int) -> None:
    found = simulated(page, late=0, ahead=ahead)
    assert found["lag"] < 2.2, "two frames come at once, so that at least one is in hand on average"
    assert found["dry"] < 0.15
    if ahead == 7:
        assert simulated(page, late=0, ahead=7, paced=False)["lag"] > 6, "without the pace it stays behind"


def test_where_messages_come_late_as_much_is_kept_in_hand_as_that_takes(page: Page) -> None:
    punctual, late = (simulated(page, late=ms, ahead=7) for ms in (0, 60))
    assert punctual["lag"] + 0.8 < late["lag"] < 4.5
    assert late["dry"] < 0.15

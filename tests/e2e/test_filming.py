"""The film look of the player: it can be taken back exactly, ends where a hand takes the camera, and respects rest."""

from __future__ import annotations

import numpy as np
import pytest

from .playing import drag, hook, pause, press, stage_pixels, until

SWITCH = "[data-act=film]"
RESTS = "window.__pasdedeux.loops === 0 && window.__pasdedeux.player.filming.settled"


def at(page, frame: int) -> list[float]:
    """The eye at a frame, once everything rests."""
    page.evaluate(f"window.__pasdedeux.player.seek({frame})")
    until(page, f"window.__pasdedeux.frame === {frame} && {RESTS}")
    return hook(page, "eye")


def test_a_second_press_brings_back_what_was_there(player) -> None:
    page = player()
    pause(page)
    before = at(page, 40)
    plain = stage_pixels(page)
    page.locator(SWITCH).click()
    until(page, f"document.querySelector('{SWITCH}').ariaPressed === 'true'")
    seen = at(page, 40)
    assert np.linalg.norm(np.subtract(seen, before)) > 0.1
    page.wait_for_timeout(600)
    film = stage_pixels(page)
    corners = [np.s_[:40, :40], np.s_[-40:, :40], np.s_[-40:, -40:]]
    assert all(film[corner].mean() < plain[corner].mean() - 8 for corner in corners)
    assert at(page, 100) != seen
    assert at(page, 40) == pytest.approx(seen, abs=0.01)
    page.locator(".pdd").focus()
    page.keyboard.press("c")
    until(page, f"document.querySelector('{SWITCH}').ariaPressed === 'false'")
    assert at(page, 40) == pytest.approx(before, abs=0.01)


def test_a_hand_on_the_camera_ends_it_where_it_is(player) -> None:
    page = player()
    pause(page)
    page.locator(SWITCH).click()
    at(page, 40)
    side = "Math.atan2(...[1, 0].map((i) => window.__pasdedeux.eye[i] - window.__pasdedeux.player.orbit.center[i]))"
    seen = page.evaluate(side)
    drag(page, 0, 1)  # hardly anything
    until(page, f"document.querySelector('{SWITCH}').ariaPressed === 'false' && {RESTS}")
    assert page.evaluate(side) == pytest.approx(seen, abs=0.01)


def test_what_is_there_at_first_has_it(player) -> None:
    page = player(None)
    assert page.locator(".pdd[data-state=empty].pdd-film").count(), "nor is the empty stage plain"
    press(page, "arrival")
    until(page, "window.__pasdedeux.frame > 0 && window.__pasdedeux.player.filming.on")
    press(page, "load")
    until(page, "window.__pasdedeux.player.data?.samples[0].frames === 150")
    assert not page.evaluate("window.__pasdedeux.player.filming.on")


def test_the_camera_stays_where_rest_is_wanted(player) -> None:
    page = player()
    page.emulate_media(reduced_motion="reduce")
    pause(page)
    before = at(page, 40)
    page.locator(SWITCH).click()
    until(page, f"document.querySelector('{SWITCH}').ariaPressed === 'true' && {RESTS}")
    assert at(page, 40) == pytest.approx(before, abs=0.01)
    assert page.locator(".pdd-film").count()

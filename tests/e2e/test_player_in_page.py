"""The player among its surroundings: themes, closed tabs, screens, fingers, browsers that lack something."""

from __future__ import annotations

import pytest
from playwright.sync_api import expect

from .playing import has_color, hook, pause, press, stage_pixels, until, yaw

pytestmark = pytest.mark.e2e


def test_themes_full_screen_hidden_players_and_closed_tabs(player_in_page):
    page = player_in_page()
    light = stage_pixels(page)[5:40, 200:400].mean()
    page.evaluate("document.body.classList.add('dark')")
    until(page, "document.querySelector('.pdd').dataset.theme === 'dark'")
    page.wait_for_timeout(500)
    dark = stage_pixels(page)
    assert light > 200 and dark[5:40, 200:400].mean() < 60
    assert has_color(dark, blue=True) and has_color(dark, blue=False)
    page.evaluate("document.body.classList.remove('dark')")
    until(page, "document.querySelector('.pdd').dataset.theme === 'light'")

    height = "document.querySelector('.pdd-stage').clientHeight"
    before = page.evaluate(height)
    page.locator("[data-act=fullscreen]").click()
    until(page, f"{height} > {before} + 40")
    until(page, "window.__pasdedeux.player.scene.inside.glplot.canvas.clientHeight === " + height)
    page.locator("[data-act=fullscreen]").click()
    until(page, f"{height} === {before}")

    press(page, "hide")
    page.wait_for_selector(".pdd", state="detached")
    until(page, "window.__pasdedeux.loops === 0 && window.__pasdedeux.count === 0")
    press(page, "show")
    until(page, "window.__pasdedeux.frame > 0 && window.__pasdedeux.playing")
    assert hook(page, "count") == 1 and hook(page, "loops") <= 1
    pause(page)

    press(page, "load second")
    page.get_by_role("tab", name="second").click()
    until(page, "window.__pasdedeux.player.stage.closest('#late') && window.__pasdedeux.frame > 5")
    page.wait_for_timeout(800)
    assert page.evaluate("window.__pasdedeux.player.orbit.distance") < 8
    assert has_color(stage_pixels(page), blue=True)
    assert hook(page, "loops") == 1


def test_touch_turns_the_scene(player_in_page):
    page = player_in_page("several", width=390, height=844, has_touch=True, is_mobile=True)
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    before = yaw(page)
    box = page.locator(".pdd-touch").bounding_box()
    session = page.context.new_cdp_session(page)
    x, y = box["x"] + 60, box["y"] + 120

    def touch(kind: str, at: float | None) -> None:
        points = [] if at is None else [{"x": at, "y": y}]
        session.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})

    touch("touchStart", x)
    for i in range(1, 8):
        touch("touchMove", x + 15 * i)
    touch("touchEnd", None)
    until(page, f"Math.abs(window.__pasdedeux.player.orbit.yaw - {before}) > 0.5")
    assert hook(page, "playing")


def test_a_motion_that_waits_for_the_3d_view_is_announced(open_page, player_url):
    held = []

    def hold_plotly(page):
        page.route("**/plotly*.js", lambda route: held.append(route))

    page = open_page(player_url, before=hold_plotly)
    press(page, "load")
    busy = page.locator(".pdd-busy-text").first
    page.wait_for_function("/3D view/.test(document.querySelector('.pdd-busy-text')?.textContent)")
    expect(busy).to_be_visible(timeout=60_000)
    assert not page.locator(".pdd-empty").first.is_visible(), "it does not ask for what is there"
    for route in held:
        route.continue_()
    until(page, "window.__pasdedeux?.frame > 0", 30)
    assert not busy.is_visible()


def test_says_so_without_webgl(open_page, player_url, expected_errors):
    expected_errors.append("This browser offers no WebGL")

    def no_webgl(page):
        page.add_init_script("""const original = HTMLCanvasElement.prototype.getContext;
            HTMLCanvasElement.prototype.getContext = function (kind, ...rest) {
                return /webgl/.test(kind) ? null : original.call(this, kind, ...rest);
            };""")

    page = open_page(player_url, before=no_webgl)
    page.wait_for_function("/WebGL/.test(document.querySelector('.pdd-empty-text')?.textContent)")

"""The player in a real browser: it plays, it can be turned, scrubbed and read."""

from __future__ import annotations

import numpy as np
import pytest
from PIL import Image

from .harness import people
from .playing import drag, has_color, hook, pause, press, stage_pixels, until, yaw

pytestmark = pytest.mark.e2e


def test_plays_both_people(player):
    page = player()
    assert hook(page, "count") == 1
    assert hook(page, "playing")
    first, frame = np.array(hook(page, "positions")), hook(page, "frame")
    assert first.shape == (2, 22, 3)
    until(page, f"Math.abs(window.__pasdedeux.frame - {frame}) > 20")
    moved = np.linalg.norm(np.array(hook(page, "positions")) - first, axis=-1).max(axis=1)
    assert (moved > 0.05).all(), f"metres each person moved: {moved}"
    pixels = stage_pixels(page)
    assert has_color(pixels, blue=True)
    assert has_color(pixels, blue=False)


def test_shows_what_was_sent(player):
    page = player()
    pause(page)
    page.locator(".pdd").focus()
    page.keyboard.press("Home")
    until(page, "window.__pasdedeux.frame === 0 && window.__pasdedeux.loops === 0")
    sent = people().positions
    assert np.abs(np.array(hook(page, "positions")) - sent[:, 0]).max() < 2e-4
    page.keyboard.press("End")
    until(page, "window.__pasdedeux.frame === 149 && window.__pasdedeux.loops === 0")
    assert np.abs(np.array(hook(page, "positions")) - sent[:, -1]).max() < 2e-4


def test_balls_are_as_wide_as_asked(player):
    page = player()
    pause(page)
    ball = """async () => {
        const { scene, orbit, stage } = window.__pasdedeux.player;
        const { balls, Lens } = await import("/player/figure.js");
        const lens = new Lens(orbit.view(), stage.querySelector(".pdd-pane").clientHeight);
        const p = orbit.view().center;
        for (const name of scene.names) scene.hide(name);
        scene.setTriangles("joints", balls([{ p, color: [1, 0, 0], radius: lens.metres(60, p) }], lens, scene.scale));
        scene.draw();
    }"""
    for _ in range(20):  # the player may draw its frame once more, after a pause or a change of size
        page.evaluate(ball)
        page.wait_for_timeout(300)
        pixels = stage_pixels(page)
        red = (pixels[..., 0] > 200) & (pixels[..., 1] < 60)
        if red.any():
            break
    across, down = red.any(axis=0).sum(), red.any(axis=1).sum()
    assert (across, down) == (pytest.approx(120, abs=8), pytest.approx(120, abs=8))


def test_scrub_strip_and_contact_marks(player):
    page = player()
    pause(page)
    slider = page.locator(".pdd-range")
    slider.fill("100")
    until(page, "window.__pasdedeux.frame === 100")
    assert "frame 101 of 150" in page.locator(".pdd-time").inner_text()
    strip = page.locator(".pdd-curve").bounding_box()
    page.mouse.click(strip["x"] + 0.25 * strip["width"], strip["y"] + strip["height"] / 2)
    until(page, "Math.abs(window.__pasdedeux.frame - 37) <= 1")
    tick = page.locator(".pdd-tick").first
    assert "hand on hand" in tick.get_attribute("aria-label")
    tick.click()
    until(page, "window.__pasdedeux.frame > 40 && window.__pasdedeux.frame < 70")
    values = page.locator(".pdd-values dd").all_inner_texts()
    assert all(value.endswith(" m") for value in values)


def test_dragging_turns_the_camera_while_playing(player):
    page = player()
    before, frame = np.array(hook(page, "player.orbit.eye")), hook(page, "frame")
    turned = yaw(page)
    drag(page, 260, 0, steps=40)
    after = np.array(hook(page, "player.orbit.eye"))
    assert hook(page, "playing")
    assert hook(page, "frame") != frame
    assert abs(yaw(page) - turned) > 0.8
    assert np.linalg.norm(after - before) > 1.0


def test_keyboard(player):
    page = player()
    page.locator(".pdd").focus()
    page.keyboard.press("Space")
    until(page, "!window.__pasdedeux.playing")
    page.keyboard.press("Home")
    until(page, "window.__pasdedeux.frame === 0")
    page.keyboard.press("ArrowRight")
    until(page, "window.__pasdedeux.frame === 1")
    page.keyboard.press("Shift+ArrowRight")
    until(page, "window.__pasdedeux.frame === 11")
    page.keyboard.press("ArrowLeft")
    until(page, "window.__pasdedeux.frame === 10")
    page.keyboard.press("End")
    until(page, "window.__pasdedeux.frame === 149")
    seen = []
    for key in "123456":
        page.keyboard.press(key)
        until(page, "window.__pasdedeux.loops === 0")
        seen.append(tuple(round(v, 2) for v in hook(page, "player.orbit.eye")))
    assert len(set(seen)) == 6
    assert page.locator("[data-camera=b]").get_attribute("aria-pressed") == "true"
    for key, act in (("f", "follow"), ("g", "ghosts"), ("l", "loop")):
        control = page.locator(f"[data-act={act}]")
        before = control.get_attribute("aria-pressed")
        page.keyboard.press(key)
        until(page, f"document.querySelector('[data-act={act}]').getAttribute('aria-pressed') !== '{before}'")
    page.keyboard.press("?")
    assert page.locator(".pdd-help").is_visible()
    page.keyboard.press("Escape")
    assert page.locator(".pdd-help").is_hidden()
    page.keyboard.press("ArrowUp")
    assert page.locator(".pdd-speed select").input_value() == "1.5"
    assert page.locator("[data-act=loop]").get_attribute("aria-pressed") == "false"
    page.locator(".pdd-range").fill("135")
    page.keyboard.press("Space")
    until(page, "!window.__pasdedeux.playing && window.__pasdedeux.frame === 149")


def test_when_the_loop_begins_anew_both_are_in_view_at_once(player):
    page = player()
    pause(page)
    page.locator(".pdd-range").fill("140")  # they stand close, and the camera with them
    until(page, "window.__pasdedeux.frame === 140 && window.__pasdedeux.loops === 0")
    page.evaluate("""() => {
        const player = window.__pasdedeux.player, paint = player.paint;
        player.paint = function (pose) {
            paint.call(this, pose);
            if (this.clock.frame < 100) window.off ??= this.framing.wanted().distance - this.orbit.distance;
        };
    }""")
    page.locator(".pdd-play").click()
    until(page, "window.off !== undefined")
    assert abs(page.evaluate("window.off")) < 0.01


def test_everything_has_a_name_and_can_be_reached(player):
    page = player()
    nameless = page.evaluate("""() => [...document.querySelectorAll('.pdd button, .pdd input, .pdd select')]
        .filter((e) => !(e.ariaLabel || e.textContent.trim() || e.labels?.[0]?.textContent.trim())).length""")
    assert nameless == 0
    page.locator(".pdd").focus()
    reached = set()
    for _ in range(24):
        page.keyboard.press("Tab")
        reached.add(page.evaluate("document.activeElement.dataset.act || document.activeElement.className"))
    assert {"play", "fullscreen", "help", "pdd-range"} <= reached


def test_the_onion_skin_is_drawn(player):
    page = player()
    pause(page)
    page.locator(".pdd-range").fill("60")
    page.wait_for_timeout(800)
    plain = stage_pixels(page)
    page.keyboard.press("g")
    page.wait_for_timeout(800)
    ghosts = stage_pixels(page)

    def changed(a, b):
        return int((np.abs(a[:, :-60] - b[:, :-60]).max(axis=-1) > 24).sum())

    assert changed(plain, ghosts) > 1000


def test_meshes_are_drawn_by_shaders_of_our_own(player):
    page = player()
    linked = page.evaluate("""() => {
        const { objects, gl: { gl } } = window.__pasdedeux.player.scene;
        return Object.values(objects).filter((each) => each.triShader).map(({ triShader }) => {
            triShader.bind();
            return gl.getProgramParameter(gl.getParameter(gl.CURRENT_PROGRAM), gl.LINK_STATUS);
        });
    }""")
    assert linked == [True] * 5, "the ground, two bodies, things and joints"
    assert page.evaluate("window.__pasdedeux.player.scene.gl.gl.getError()") == 0


def test_several_samples_share_the_clock(player):
    page = player("several")
    pause(page)
    page.locator(".pdd-range").fill("40")
    until(page, "window.__pasdedeux.frame === 40")
    first = np.array(hook(page, "positions"))
    tabs = page.locator("#player").get_by_role("tab")
    assert tabs.count() == 4
    tabs.nth(2).click()
    until(page, "document.querySelectorAll('.pdd [role=tab]')[2].getAttribute('aria-selected') === 'true'")
    until(page, "window.__pasdedeux.loops === 0")
    assert hook(page, "frame") == 40
    assert np.abs(np.array(hook(page, "positions")) - first).max() > 0.02
    speed = page.evaluate("window.__pasdedeux.player.clock.speed")
    for key in ("ArrowDown", "ArrowLeft"):
        tabs.nth(2).press(key)
        until(page, "window.__pasdedeux.loops === 0")
    assert (hook(page, "frame"), page.evaluate("window.__pasdedeux.player.clock.speed")) == (40, speed)


def test_user_text_stays_text(player):
    page = player("hostile")
    page.wait_for_timeout(500)
    assert page.evaluate("window.__hacked") is None
    assert page.locator(".pdd img").count() == 0
    labels = page.locator(".pdd-label").all_text_contents()
    assert labels[0].startswith("A · <img src=x onerror=")
    assert labels[1] == "B · ${window.__hacked=2}{{value}}"
    assert "${window.__hacked=2}" in page.locator(".pdd-title").inner_text()


def test_empty_busy_and_empty_again(player):
    page = player(None)
    assert "No motion is here" in page.locator(".pdd-empty-text").inner_text()
    assert "choose an example" in page.locator(".pdd-empty-more").inner_text()
    assert page.locator(".pdd-foot").is_hidden()
    press(page, "busy")
    page.wait_for_selector(".pdd-busy:visible")
    assert page.locator(".pdd-busy-text").inner_text() == "Step 12 of 50 ${1+1}"
    assert page.locator(".pdd-labels").first.is_hidden(), "what is not drawn gives labels no place"
    press(page, "load")
    until(page, "window.__pasdedeux.frame > 0")
    assert page.locator(".pdd-busy").is_hidden()
    assert page.locator(".pdd-empty").is_hidden()
    press(page, "clear")
    page.wait_for_selector(".pdd-empty:visible")
    until(page, "window.__pasdedeux.loops === 0")


def test_marks_what_was_given_and_what_was_predicted(player):
    page = player("predicted")
    pause(page)
    page.locator(".pdd-range").fill("10")
    page.wait_for_function("document.querySelector('.pdd-chip').textContent === 'given'")
    page.locator(".pdd-range").fill("100")
    page.wait_for_function("document.querySelector('.pdd-chip').textContent === 'predicted'")
    assert page.locator(".pdd-past").is_visible()


def test_saves_a_picture(player):
    page = player()
    pause(page)
    with page.expect_download() as download:
        page.locator("[data-act=help]").click()
        page.locator("[data-act=picture]").click()
    assert download.value.suggested_filename.startswith("pas-de-deux-1-frame-")
    image = np.asarray(Image.open(download.value.path()).convert("RGB"), dtype=np.int16)
    assert has_color(image, blue=True)
    assert has_color(image, blue=False)

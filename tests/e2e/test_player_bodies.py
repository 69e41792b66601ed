"""What the player shows: bodies as Python poses them, everybody in view, and nothing done for nothing."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from motion.body import load_body, skin
from motion.hands import angles
from motion.looks import UNSAID

from .harness import duet_with_a_child, duet_with_things, people
from .playing import hook, pause, press, stage_pixels, until

pytestmark = pytest.mark.e2e

DRESSED = "window.__pasdedeux.player.pane.figures.length === 2"


def shown_layers(page) -> dict[str, dict[str, float]]:
    """By mesh: how many triangles are drawn, and whether they are seen through."""
    return page.evaluate("""() => {
        const { objects } = window.__pasdedeux.player.scene;
        return Object.fromEntries(["bodyA", "bodyB", "ground"].map((name) =>
            [name, { triangles: objects[name].triangleCount, clear: objects[name].hasAlpha }]));
    }""")


def bones_drawn(page) -> bool:
    return page.evaluate("!window.__pasdedeux.player.scene.layers.get('bones').hidden")


@pytest.mark.parametrize(("button", "width"), [("load", 390), ("child", 1280)])
def test_bodies_stand_where_python_puts_them(player, button, width):
    page = player(button, width=width)
    until(page, DRESSED)
    pause(page)
    page.locator(".pdd-range").fill("93")
    until(page, "window.__pasdedeux.frame === 93 && window.__pasdedeux.loops === 0")
    duet = {"load": people, "child": duet_with_a_child}[button]()
    assert (duet.looks == UNSAID) == (button == "load")
    for person, name in enumerate(duet.looks):
        body = load_body(name, small=width < 700)
        drawn = page.evaluate(f"[...window.__pasdedeux.player.pane.figures[{person}].vertices]")
        drawn = np.reshape(drawn, (-1, 3))[:, [1, 2, 0]]  # the scene's axes are z, x, y
        expected = skin(body, duet.positions[person][93:94])[0]
        assert drawn.shape == expected.shape
        assert np.abs(drawn - expected).max() < 0.002, "metres; positions travel in steps of 0.1 mm"


def test_one_key_shows_bodies_then_skeletons_then_both_as_at_first(player):
    page = player()
    until(page, DRESSED)
    pause(page)
    page.locator(".pdd").focus()
    seen = []
    for state in ("both", "body", "skeleton", "both"):
        until(page, f"document.querySelector('.pdd').dataset.figure === '{state}'")
        until(page, "window.__pasdedeux.loops === 0")
        layers = shown_layers(page)
        assert (layers["bodyA"]["triangles"] > 1000) == (state != "skeleton")
        assert not layers["bodyB"]["clear"], "a translucent body makes plotly draw twice"
        assert bones_drawn(page) == (state != "body")
        assert layers["ground"]["triangles"] > 100
        seen.append(stage_pixels(page))
        page.keyboard.press("s")
    changed = [int((np.abs(a - b).max(axis=-1) > 24).sum()) for a, b in pairwise(seen)]
    assert min(changed) > 2000, "each of them is another picture"


def test_shadows_lie_under_feet(player):
    """The floor is darker where someone stands than beside, and as bright as ever far away."""
    page = player()
    until(page, DRESSED)
    pause(page)
    shade = page.evaluate("""() => {
        const { shadow } = window.__pasdedeux.player.pane.ground;
        const pose = window.__pasdedeux.player.pose[0];
        const at = (x, y) => {
            const pixel = (v, i) => Math.round(((v - shadow.origin[i]) / shadow.span) * shadow.size);
            const [px, py] = [pixel(x, 0), pixel(y, 1)];
            return shadow.pixels[4 * (shadow.size * py + px)];
        };
        return [at(pose[7][0], pose[7][1]), at(pose[7][0], pose[7][1] + 1.2), shadow.pixels[0]];
    }""")
    assert shade[0] < 225
    assert shade[0] < shade[1] - 15
    assert shade[2] == 255


@pytest.mark.parametrize("size", [(390, 844), (1280, 800)])
def test_everybody_is_in_view_over_the_whole_clip(player, size):
    page = player("far", width=size[0], height=size[1])
    pause(page)
    outside = page.evaluate("""() => {
        const player = window.__pasdedeux.player;
        const { orbit, clock } = player;
        const wrong = [];
        for (const camera of ["threequarter", "front", "side", "top"]) {
            clock.seek(0);
            player.framing.goTo(camera);
            for (let frame = 0; frame < clock.frames; frame++) {
                clock.seek(frame);
                orbit.step(1 / clock.fps, player.framing.wanted());
                if (frame % 10) continue;
                player.paint(player.everybody(frame));
                for (const pane of player.shown) {
                    const { clientWidth: width, clientHeight: height } = pane.host;
                    for (const [x, y, depth] of pane.spots.flat()) {
                        const inside = x > 8 && y > 25 && x < width - 8 && y < height - 4;
                        if (depth < 0.3 || !inside) wrong.push([camera, frame, x, y, width, height]);
                    }
                }
            }
        }
        return wrong;
    }""")
    assert outside == []


def test_nothing_is_drawn_while_nothing_changes(player):
    page = player()
    until(page, DRESSED)
    pause(page)
    page.wait_for_timeout(1500)  # a still picture is drawn once more, finer
    drawn = page.evaluate("""async () => {
        const { gl } = window.__pasdedeux.player.scene.gl;
        let count = 0;
        for (const name of ["clear", "drawArrays", "bufferData", "readPixels"]) {
            const act = gl[name].bind(gl);
            gl[name] = (...given) => { count++; return act(...given); };
        }
        await new Promise((done) => setTimeout(done, 1500));
        return count;
    }""")
    assert drawn == 0
    assert hook(page, "loops") == 0
    assert page.evaluate("window.__pasdedeux.player.scene.gl._stopped"), "plotly's own loop has ended"


def test_a_motion_nobody_asked_for_comes_to_rest(player):
    page = player("arrival")
    until(page, "!window.__pasdedeux.playing && window.__pasdedeux.loops === 0")
    page.locator(".pdd-play").click()
    until(page, "window.__pasdedeux.player.rounds >= 4")
    assert hook(page, "playing"), "asked for, it goes on"


def test_without_bodies_there_are_skeletons(open_page, plain_url, expected_errors):
    expected_errors.append("Failed to fetch")

    def without_bodies(page):
        page.route("**/bodies/*.json", lambda route: route.abort())

    page = open_page(plain_url, before=without_bodies)
    page.wait_for_selector(".pdd-styled", timeout=30_000)
    page.wait_for_function("window.__pasdedeux?.player", timeout=30_000)
    press(page, "load")
    until(page, "window.__pasdedeux.frame > 0")
    assert bones_drawn(page)


def test_things_and_hands_are_where_python_puts_them(player):
    things = "window.__pasdedeux.player.scene.objects.things.triangleCount"
    page = player()
    until(page, DRESSED)
    press(page, "things")
    until(page, f"{things} > 0")
    pause(page)
    page.locator(".pdd-range").fill("93")
    until(page, "window.__pasdedeux.frame === 93 && window.__pasdedeux.loops === 0")
    duet = duet_with_things()

    def drawn(figure: str) -> np.ndarray:
        """(vertices, 3) in the world's axes; the scene's are z, x, y."""
        found = page.evaluate(f"[...window.__pasdedeux.player.{figure}.vertices]")
        return np.reshape(found, (-1, 3))[:, [1, 2, 0]]

    for number, thing in enumerate(duet.things):
        assert np.abs(drawn(f"sample.things.figures[{number}]") - thing.at(93)).max() < 1e-3, thing.kind
    assert page.evaluate(things) == sum(len(thing.mesh.faces) for thing in duet.things)
    for person, name in enumerate(duet.looks):
        body, positions = load_body(name), duet.positions[person][93:94]
        shaped = skin(body, positions, angles(duet.grips, person, np.array([93.0]), duet.fps))[0]
        assert np.abs(drawn(f"pane.figures[{person}]") - shaped).max() < 0.002
        assert np.abs(shaped - skin(body, positions)[0]).max() > 0.01
    press(page, "several")
    until(page, f"{things} === 0")

"""What the player shows: bodies as Python poses them, everybody in view, and nothing done for nothing."""

from __future__ import annotations

import json
import runpy
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from motion.body import load_body, skin
from motion.character import character_body, packed_body
from motion.formats.glb_reader import read_character
from motion.looks import UNSAID
from motion.skeleton import SMPL22
from tests.motion.formats.characters import a_pose, glb_character
from webdemo.ui.components.film import READ_PLAYER

from .playing import has_color, hook, pause, press, stage_pixels, until

pytestmark = pytest.mark.e2e

HEAD = SMPL22.index("head")
DRESSED = "window.__pasdedeux.player.panes[0].figures.length === 2"


def shown_layers(page) -> dict[str, dict[str, float]]:
    """By mesh: how many triangles are drawn, and whether they are seen through."""
    return page.evaluate("""() => {
        const { objects } = window.__pasdedeux.player.scene;
        return Object.fromEntries(["bodyA", "bodyB", "ground"].map((name) =>
            [name, { triangles: objects[name].triangleCount, clear: objects[name].hasAlpha }]));
    }""")


def bones_drawn(page) -> bool:
    return page.evaluate("!window.__pasdedeux.player.scene.layers.get('bonesA').hidden")


@pytest.mark.parametrize(("button", "width"), [("load", 1280), ("load", 390), ("child", 1280)])
def test_bodies_stand_where_python_puts_them(player, button, width):
    page = player(button, width=width)
    until(page, DRESSED)
    pause(page)
    page.locator(".pdd-range").fill("93")
    until(page, "window.__pasdedeux.frame === 93 && window.__pasdedeux.loops === 0")
    made = {"load": "walking_duet", "child": "duet_with_a_child"}[button]
    duet = runpy.run_path(str(Path(__file__).with_name("harness.py")))[made]()
    assert (duet.looks == UNSAID) == (button == "load")
    for person, name in enumerate(duet.looks):
        body = load_body(name, small=width < 700)
        drawn = page.evaluate(f"[...window.__pasdedeux.player.panes[0].figures[{person}].vertices]")
        drawn = np.reshape(drawn, (-1, 3))[:, [1, 2, 0]]  # the scene's axes are z, x, y
        seen = duet.positions[1 - person][93:94, HEAD]
        expected = skin(body, duet.positions[person][93:94], seen=seen)[0]
        assert drawn.shape == expected.shape
        assert np.abs(drawn - expected).max() < 0.002, "metres; positions travel in steps of 0.1 mm"


def bodies_alone(page) -> None:
    """Takes the skeletons off."""
    page.evaluate("() => { const { player } = window.__pasdedeux; player.show.skeletons = false; player.refresh(); }")


def lit_over_shaded(pixels: np.ndarray) -> float:
    """How much brighter the left of the blue shirt is than its right, as a share; the key lamp stands on the left."""
    strength, bright = pixels[..., 2] - pixels[..., 0], pixels.sum(axis=-1)
    ends = []
    for row in range(len(pixels)):
        blue = np.flatnonzero(strength[row] > 50)
        if len(blue) > 24:
            third = len(blue) // 3
            ends.append((bright[row, blue[:third]].mean(), bright[row, blue[-third:]].mean()))
    assert len(ends) > 30, "the body is seen"
    left, right = np.mean(ends, axis=0)
    return float(left / right - 1)


def test_bodies_are_brighter_on_the_side_of_the_lamp(player):
    page = player()
    until(page, DRESSED)
    pause(page)
    bodies_alone(page)
    page.locator(".pdd-range").fill("93")
    until(page, "window.__pasdedeux.frame === 93 && window.__pasdedeux.loops === 0")
    lit = lit_over_shaded(stage_pixels(page))
    page.evaluate("""() => {
        const { player } = window.__pasdedeux;
        const [figure] = player.panes[0].figures;
        figure.shade = function (colors, lamps, lens, scale, alpha) {
            this.light.fill(0.7);
            this.shine.fill(0);
            this.expand(colors, scale, alpha);
        };
        player.refresh();
    }""")
    until(page, "window.__pasdedeux.loops === 0")
    flat = lit_over_shaded(stage_pixels(page))
    print(lit, flat)
    assert lit > 0.15 and abs(flat) < 0.05


def test_one_key_shows_bodies_then_skeletons_then_both_as_at_first(player):
    page = player()
    until(page, DRESSED)
    pause(page)
    figure = page.locator("[data-act=figure]")
    page.locator(".pdd").focus()
    seen = []
    for state in ("both", "body", "skeleton", "both"):
        until(page, f"document.querySelector('[data-act=figure]').dataset.figure === '{state}'")
        until(page, "window.__pasdedeux.loops === 0")
        layers = shown_layers(page)
        assert (layers["bodyA"]["triangles"] > 1000) == (state != "skeleton")
        assert not layers["bodyB"]["clear"], "a translucent body makes plotly draw twice"
        assert bones_drawn(page) == (state != "body")
        assert layers["ground"]["triangles"] > 100
        seen.append(stage_pixels(page))
        page.keyboard.press("s")
    assert figure.get_attribute("aria-label")
    changed = [int((np.abs(a - b).max(axis=-1) > 24).sum()) for a, b in pairwise(seen)]
    assert min(changed) > 2000, "each of them is another picture"


def test_shadows_lie_under_feet(player):
    """The floor is darker where someone stands than beside, and as bright as ever far away."""
    page = player()
    until(page, DRESSED)
    pause(page)
    shade = page.evaluate("""() => {
        const { shadow } = window.__pasdedeux.player.panes[0].ground;
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


@pytest.mark.parametrize("size", [(1280, 800), (390, 844), (1024, 700), (2560, 1440)])
@pytest.mark.parametrize("button", ["far", "beside"])
def test_everybody_is_in_view_over_the_whole_clip(player, button, size):
    page = player(button, width=size[0], height=size[1])
    views = 2 if button == "beside" else 1
    until(page, f"window.__pasdedeux.player.shown.length === {views}")
    pause(page)
    outside = page.evaluate("""() => {
        const player = window.__pasdedeux.player;
        const { orbit, clock } = player;
        const wrong = [];
        for (const camera of ["threequarter", "front", "side", "top"]) {
            clock.seek(0);
            player.framing.goTo(camera, null);
            for (let frame = 0; frame < clock.frames; frame++) {
                clock.seek(frame);
                orbit.step(0, 1 / clock.fps, player.framing.wanted());
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


def test_nothing_is_drawn_under_a_message(player):
    page = player()
    press(page, "busy")
    page.wait_for_selector(".pdd-busy:visible")
    until(page, "window.__pasdedeux.loops === 0")
    assert page.evaluate("document.querySelector('.pdd').getAnimations({ subtree: true }).length") == 0
    press(page, "load")
    frame = hook(page, "frame")
    until(page, f"window.__pasdedeux.frame !== {frame}")


def test_a_motion_nobody_asked_for_comes_to_rest(player):
    page = player("arrival")
    until(page, "!window.__pasdedeux.playing && window.__pasdedeux.loops === 0")
    page.locator(".pdd-play").click()
    until(page, "window.__pasdedeux.player.rounds >= 4")
    assert hook(page, "playing"), "asked for, it goes on"


def test_bodies_keep_their_colours_in_the_dark(player):
    page = player(theme="dark")
    until(page, DRESSED)
    pause(page)
    pixels = stage_pixels(page)
    assert has_color(pixels, blue=True)
    assert has_color(pixels, blue=False)
    assert pixels[5:40, 200:400].mean() < 60


def test_without_bodies_there_are_skeletons(open_page, plain_url, expected_errors):
    expected_errors.append("Failed to fetch")

    def without_bodies(page):
        page.route("**/bodies/*.json", lambda route: route.abort())

    page = open_page(plain_url, before=without_bodies)
    page.wait_for_selector(".pdd-styled", timeout=30_000)
    page.wait_for_function("window.__pasdedeux?.mode ?? null", timeout=30_000)
    press(page, "load")
    until(page, "window.__pasdedeux.frame > 0")
    assert bones_drawn(page)


def test_both_wear_an_uploaded_character_until_the_figure_button_takes_it_off(player):
    body = character_body(read_character(glb_character("unreal", places=a_pose()), name="x.glb"))
    page = player()
    until(page, DRESSED)
    pause(page)
    page.evaluate("body => window.__pasdedeux.player.clothes.wear(body)", {"id": "x", **packed_body(body)})
    page.locator(".pdd-range").fill("93")
    until(page, "window.__pasdedeux.frame === 93 && window.__pasdedeux.loops === 0")
    duet = runpy.run_path(str(Path(__file__).with_name("harness.py")))["walking_duet"]()
    for person in range(2):
        drawn = page.evaluate(f"[...window.__pasdedeux.player.panes[0].figures[{person}].vertices]")
        drawn = np.reshape(drawn, (-1, 3))[:, [1, 2, 0]]
        assert np.abs(drawn - skin(body, duet.positions[person][93:94])[0]).max() < 0.002
    assert shown_layers(page)["bodyA"]["triangles"] == len(body.faces)
    page.locator(".pdd").focus()
    for state in ("character", "body", "skeleton", "both", "character"):
        until(page, f"document.querySelector('[data-act=figure]').dataset.figure === '{state}'")
        until(page, "window.__pasdedeux.loops === 0")
        worn = page.evaluate("window.__pasdedeux.player.panes[0].figures[0].body.zones.includes('character')")
        assert worn == (state == "character")
        _, sent = page.evaluate(f"({READ_PLAYER})(null, '')")
        assert json.loads(sent)["character"] == worn, "a film shows it, too"
        page.keyboard.press("s")
    page.evaluate("window.__pasdedeux.player.clothes.wear(null)")
    until(page, "document.querySelector('[data-act=figure]').dataset.figure !== 'character'")


def test_ghosts_of_futures_wear_the_character_that_people_wear(player):
    body = character_body(read_character(glb_character("unreal", places=a_pose()), name="x.glb"))
    page = player()
    until(page, DRESSED)
    press(page, "futures")
    zones = "window.__pasdedeux.player.futures.ghosts.flat().map(({ body }) => body.zones[0])"
    worn = "window.__pasdedeux.player.clothes.character"
    stock = "window.__pasdedeux.player.clothes.bodies.get('man').zones[0]"
    until(page, f"({zones}).length === 6 && ({zones}).every((zone) => zone === {stock})")
    page.evaluate("body => window.__pasdedeux.player.clothes.wear(body)", {"id": "x", **packed_body(body)})
    until(page, f"({zones}).every((zone) => zone === 'character')")
    # Other futures come while it is worn; taken off, the ghosts have stock bodies again.
    page.evaluate("""() => {
        const { futures, clothes, data } = window.__pasdedeux.player;
        futures.ghosts = [];
        futures.load(data);
        clothes.dressFutures();
    }""")
    until(page, f"({zones}).length === 6 && ({zones}).every((zone) => zone === 'character')")
    pause(page)
    page.evaluate("window.__pasdedeux.player.seek(100)")
    until(page, "window.__pasdedeux.frame === 100 && window.__pasdedeux.loops === 0")
    faces = page.evaluate(f"{worn}.pale.faces.length") // 3
    assert page.evaluate("window.__pasdedeux.player.scene.objects.futures.triangleCount") == 4 * faces > 0
    page.evaluate("window.__pasdedeux.player.clothes.wear(null)")
    until(page, f"({zones}).every((zone) => zone === {stock})")


def test_a_coarser_body_keeps_its_shape_and_what_it_hangs_on(player):
    found = player(None).evaluate(
        """async () => {
            const { coarser, Figure } = await import("/player/body.js");
            const { loadBody } = await import("/player/loader.js");
            const body = await loadBody("man");
            const pale = coarser(body, 800);
            return {
                same: coarser(body, 5000) === body,
                whole: [...body.vertices], few: [...pale.vertices], faces: [...pale.faces],
                counts: [pale.normals.length, pale.sky.length, pale.bones.length, pale.weights.length].map(Number),
                zones: pale.faceZones.length, shares: [...pale.weights],
                posed: new Figure(pale).positions.length,
            };
        }"""
    )
    few, whole = (np.reshape(found[name], (-1, 3)) for name in ("few", "whole"))
    count, faces = len(few), np.reshape(found["faces"], (-1, 3))
    assert found["same"] and 400 < count <= 800
    assert found["counts"] == [3 * count, count, 4 * count, 4 * count] and found["zones"] == len(faces)
    assert found["posed"] == 9 * len(faces) and faces.max() < count
    np.testing.assert_allclose(np.reshape(found["shares"], (-1, 4)).sum(axis=1), 1, atol=0.01)
    assert (faces[:, 0] != faces[:, 1]).all() and len(faces) > 800
    np.testing.assert_allclose(few.min(axis=0), whole.min(axis=0), atol=0.06)
    np.testing.assert_allclose(few.max(axis=0), whole.max(axis=0), atol=0.06)

"""Things in the player: where Python puts them, and gone with the motion that has them."""

from __future__ import annotations

import runpy
from pathlib import Path

import numpy as np
import pytest

from motion.body import load_body, skin
from motion.hands import angles

from .playing import pause, press, until

pytestmark = pytest.mark.e2e

THINGS = "window.__pasdedeux.player.scene.objects.things.triangleCount"


def test_things_stand_and_fly_where_python_puts_them(player):
    page = player()
    press(page, "things")
    until(page, f"{THINGS} > 0")
    pause(page)
    page.locator(".pdd-range").fill("93")
    until(page, "window.__pasdedeux.frame === 93 && window.__pasdedeux.loops === 0")
    duet = runpy.run_path(str(Path(__file__).with_name("harness.py")))["duet_with_things"]()
    for number, thing in enumerate(duet.things):
        drawn = page.evaluate(f"[...window.__pasdedeux.player.sample.things.figures[{number}].vertices]")
        drawn = np.reshape(drawn, (-1, 3))[:, [1, 2, 0]]  # the scene's axes are z, x, y
        assert np.abs(drawn - thing.at(93)).max() < 1e-3, thing.kind
    assert page.evaluate(THINGS) == sum(len(thing.mesh.faces) for thing in duet.things)


def test_hands_take_the_shapes_that_python_gives_them(player):
    page = player()
    until(page, "window.__pasdedeux.player.panes[0].figures.length === 2")
    press(page, "things")
    until(page, f"{THINGS} > 0")
    pause(page)
    page.locator(".pdd-range").fill("93")
    until(page, "window.__pasdedeux.frame === 93 && window.__pasdedeux.loops === 0")
    duet = runpy.run_path(str(Path(__file__).with_name("harness.py")))["duet_with_things"]()
    for person, name in enumerate(duet.looks):
        drawn = page.evaluate(f"[...window.__pasdedeux.player.panes[0].figures[{person}].vertices]")
        drawn = np.reshape(drawn, (-1, 3))[:, [1, 2, 0]]
        body, positions = load_body(name), duet.positions[person][93:94]
        shaped = skin(body, positions, angles(duet.grips, person, np.array([93.0]), duet.fps))[0]
        assert np.abs(drawn - shaped).max() < 0.002
        assert np.abs(shaped - skin(body, positions)[0]).max() > 0.01


def test_things_go_with_their_motion(player):
    page = player()
    press(page, "things")
    until(page, f"{THINGS} > 0")
    press(page, "several")
    until(page, f"{THINGS} === 0")

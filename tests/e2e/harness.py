"""A page with nothing but the player, for tests and for looking at it: ``python tests/e2e/harness.py``."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

os.environ.setdefault("GRADIO_ANALYTICS_ENABLED", "False")
sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

import gradio as gr
import numpy as np

from motion import SMPL22, Duet
from motion.formats import read
from motion.hands import Grip
from motion.looks import UNSAID, size_of
from motion.sizes import at_sizes
from motion.things import Thing, shape
from webdemo.ui.components.player import MotionPlayer, busy, show
from webdemo.view.payload import build_payload, player_payload, sample_payload

FPS = 30.0
EXAMPLES = Path(__file__).resolve().parents[2] / "static" / "examples"
HOSTILE = ('<img src=x onerror="window.__hacked=1">', "${window.__hacked=2}{{value}}")


def people(name: str = "shake-hands") -> Duet:
    """Two people of ``static/examples``, five seconds, of whom nothing is said."""
    found = read(EXAMPLES / f"{name}.npz")
    assert isinstance(found, Duet)
    return replace(found, looks=UNSAID)


def duet_with_things() -> Duet:
    """The same two between a chair and a table, and a ball that flies from one to the other and turns."""
    duet = people()
    share = np.linspace(0, 1, duet.num_frames)
    zero = np.zeros_like(share)
    places = np.stack([zero + 0.6, 1 + 3 * share * (1 - share), 3 * share], axis=1)
    c, s = np.cos(6 * share), np.sin(6 * share)
    turns = np.stack([c, -s, zero, s, c, zero, zero, zero, zero + 1], axis=1).reshape(-1, 3, 3)
    things = (
        Thing.at_rest("chair", shape("chair"), np.array([-0.9, 0.0, 0.4]), 0.6, duet.num_frames),
        Thing.at_rest("table", shape("table"), np.array([-1.2, 0.0, 2.2]), 0.2, duet.num_frames),
        Thing.at_rest("cup", shape("cup"), np.array([-1.0, 0.785, 2.2]), 0.2, duet.num_frames),
        Thing("ball", shape("ball"), places, turns),
    )
    grips = (Grip(0, "right", "fist", 30, 120), Grip(1, "left", "point", 91, 140))
    return replace(duet, things=things, grips=grips, looks=("old-woman", "man"))


def duet_with_a_child() -> Duet:
    """The same two, of whom the second is a girl."""
    duet = people()
    small = at_sizes(duet.positions, (1.0, size_of("girl")))
    return replace(duet.with_positions(small), looks=("woman", "girl"))


def apart_duet() -> Duet:
    """The same two on a long way: they come from ten metres apart and pass the place where they meet."""
    positions = people().positions[:, :120].copy()
    t = np.linspace(1, -0.4, positions.shape[1])
    positions[0, :, :, 2] -= 4.0 * t[:, None]
    positions[1, :, :, 0] += 3.0 * t[:, None]
    return Duet.from_positions(positions, fps=FPS)


def samples(*duets: Duet, title: str = "", **more: Any) -> dict[str, Any]:
    """Several motions of one request, as tabs of the player."""
    made = [sample_payload(duet, label=str(i), **more) for i, duet in enumerate(duets, 1)]
    return build_payload(made, skeleton=SMPL22, title=title)


def ask_nobody() -> dict[str, object]:
    """A short motion that plays twice and then rests, as the one that is there before anything is asked."""
    return {**player_payload(people().cut(0, 30)), "rounds": 2}


UPDATES: dict[str, Callable[[], dict[str, Any]]] = {
    "load": lambda: show(player_payload(people(), title="two people walk up to each other and shake hands")),
    "several": lambda: show(samples(*map(people, ("shake-hands", "push", "wave", "push")), title="four takes")),
    "hostile": lambda: show(player_payload(replace(people(), roles=HOSTILE), title=" ".join(HOSTILE))),
    "predicted": lambda: show(samples(people(), ghost=people("wave"), past_until=60)),
    "busy": lambda: busy("Step 12 of 50 ${1+1}", progress=0.24),
    "clear": lambda: show(None),
    "far": lambda: show(player_payload(apart_duet())),
    "things": lambda: show(player_payload(duet_with_things())),
    "child": lambda: show(player_payload(duet_with_a_child())),
    "arrival": lambda: show(ask_nobody()),
}
"""What the harness' buttons do to the player, by their names."""


def build() -> gr.Blocks:
    with gr.Blocks(title="Player") as page:
        with gr.Tab("first"):
            player = MotionPlayer(elem_id="player")
        with gr.Tab("second"):
            late = MotionPlayer(elem_id="late")
        with gr.Row():
            for name, update in UPDATES.items():
                gr.Button(name).click(update, None, player)
            gr.Button("load second").click(lambda: show(player_payload(people())), None, late)
            gr.Button("hide").click(lambda: gr.update(visible=False), None, player)
            gr.Button("show").click(lambda: gr.update(visible=True), None, player)
    return page


if __name__ == "__main__":
    build().launch(server_port=int(sys.argv[1]) if len(sys.argv) > 1 else 7861)

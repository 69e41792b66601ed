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
from motion.hands import Grip
from motion.looks import size_of
from motion.sizes import at_sizes
from motion.things import Thing, shape
from webdemo.ui.components.player import MotionPlayer, busy, show
from webdemo.view.payload import build_payload, player_payload, sample_payload

FPS = 30.0
HOSTILE = ('<img src=x onerror="window.__hacked=1">', "${window.__hacked=2}{{value}}")


def walking_duet(seconds: float = 5.0, *, roles: tuple[str, str] = ("actor", "reactor"), phase: float = 0.0) -> Duet:
    """Two people who walk up to each other and hold out their right hands. Made by hand, not captured."""
    frames = int(seconds * FPS)
    t = np.arange(frames) / FPS
    arrive = 0.55 * seconds
    walked = np.clip(t / arrive, 0, 1)
    walked = walked * walked * (3 - 2 * walked)
    stride = np.clip((arrive - t) / 0.4, 0, 1)
    reach = np.clip((t - arrive) / 0.5, 0, 1) * np.clip((seconds - 0.3 - t) / 0.5, 0, 1)
    people = []
    for me in range(2):
        swing = np.sin(2 * np.pi * 0.95 * t + phase + 0.7 * me) * stride
        body = np.zeros((frames, 22, 3))
        rest = SMPL22.standing()
        body[:] = rest
        body[:, :, 1] += 0.025 * np.abs(swing)[:, None] - 0.02
        for side, sign in (("left", 1.0), ("right", -1.0)):
            leg, arm = 0.45 * sign * swing, -0.5 * sign * swing
            lift = reach if side == "right" else 0 * reach
            _turn(body, f"{side}_hip", [f"{side}_knee", f"{side}_ankle", f"{side}_foot"], leg)
            _turn(body, f"{side}_knee", [f"{side}_ankle", f"{side}_foot"], -0.7 * np.clip(-leg, 0, None))
            names = [f"{side}_elbow", f"{side}_wrist"]
            _hang(body, side, names)
            _turn(body, f"{side}_shoulder", names, arm + 0.75 * lift)
            _turn(body, f"{side}_elbow", names[1:], 0.25 + 0.75 * lift + 0.08 * lift * np.sin(14 * t))
        gap = 2.6 * (1 - walked) + 0.72
        if me == 1:
            body[:, :, [0, 2]] *= -1
        body[:, :, 2] += (gap if me == 1 else 0 * gap)[:, None] + (walked * 1.0)[:, None]
        people.append(body)
    # The hands meet in the middle; hand-made motion may stretch an arm a little.
    meet = 0.5 * (people[0][:, 0] + people[1][:, 0]) + np.array([0.0, 0.1, 0.0])
    for body, side in zip(people, (-1.0, 1.0), strict=True):
        for name, back in (("right_elbow", 0.24), ("right_wrist", 0.05)):
            joint = SMPL22.index(name)
            spot = meet + np.array([side * back * 0.6, 0.0, side * back])
            body[:, joint] += reach[:, None] * (spot - body[:, joint])
    return Duet.from_positions(np.stack(people).astype(np.float32), fps=FPS, roles=roles)


def _turn(body: np.ndarray, pivot: str, names: list[str], angle: np.ndarray) -> None:
    """Turns joints forward (towards +Z) about the X axis through a pivot."""
    centre = body[:, SMPL22.index(pivot)][:, None]
    joints = [SMPL22.index(n) for n in names]
    offset = body[:, joints] - centre
    c, s = np.cos(angle)[:, None], np.sin(angle)[:, None]
    y, z = offset[..., 1], offset[..., 2]
    body[:, joints] = centre + np.stack([offset[..., 0], c * y + s * z, -s * y + c * z], axis=-1)


def _hang(body: np.ndarray, side: str, names: list[str]) -> None:
    """Lowers an arm from the T-pose to the side."""
    shoulder = body[:, SMPL22.index(f"{side}_shoulder")]
    out = 0.08 if side == "left" else -0.08
    for name, length in zip(names, (0.26, 0.52), strict=True):
        body[:, SMPL22.index(name)] = shoulder + np.array([out * length / 0.26, -length, 0.0])


def duet_with_things() -> Duet:
    """The same two between a chair and a table, and a ball that flies from one to the other and turns."""
    duet = walking_duet()
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
    duet = walking_duet()
    small = at_sizes(duet.positions, (1.0, size_of("girl")))
    return replace(duet.with_positions(small), looks=("woman", "girl"))


def apart_duet(seconds: float = 4.0) -> Duet:
    """The same two on a long way: they come from ten metres apart and pass the place where they meet."""
    positions = walking_duet(seconds).positions.copy()
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
    return {**player_payload(walking_duet(1.0)), "rounds": 2}


UPDATES: dict[str, Callable[[], dict[str, Any]]] = {
    "load": lambda: show(player_payload(walking_duet(), title="two people walk up to each other and shake hands")),
    "several": lambda: show(samples(*(walking_duet(phase=0.8 * i) for i in range(4)), title="four takes")),
    "hostile": lambda: show(player_payload(walking_duet(roles=HOSTILE), title=" ".join(HOSTILE))),
    "predicted": lambda: show(samples(walking_duet(), ghost=walking_duet(phase=0.5), past_until=60)),
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
            gr.Button("load second").click(lambda: show(player_payload(walking_duet())), None, late)
            gr.Button("hide").click(lambda: gr.update(visible=False), None, player)
            gr.Button("show").click(lambda: gr.update(visible=True), None, player)
    return page


if __name__ == "__main__":
    build().launch(server_port=int(sys.argv[1]) if len(sys.argv) > 1 else 7861)

"""A motion as a plotly figure that plays by itself: in a notebook, or as one HTML file without a server.

Skeletons, the floor and names, with a play button and a slider. The page's player does not use it: it draws bodies,
and plotly redraws a 3D scene only some fifteen times a second.
"""

from __future__ import annotations

import html
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from motion.clip import Clip, Duet, stacked_positions
from motion.errors import InputError
from motion.formats.files import write_text
from motion.skeleton import SMPL22
from motion.vectors import Array

from .theme import THEMES, Colour, Theme

if TYPE_CHECKING:
    from plotly.graph_objects import Figure


SUFFIX = ".html"
FPS = 15.0
"""Frames a second by default: what browsers redraw of a 3D scene in time."""
MOST_FRAMES = 1200
LIMBS = ("middle", "left", "right")
_ABOVE_HEAD = 0.25
"""Metres."""
_MARGIN = 0.4
"""Metres of floor around the motion."""


def figure(motion: Clip | Duet, *, title: str = "", theme: str = "light", fps: float = FPS) -> Figure:
    """A :class:`plotly.graph_objects.Figure` of a motion, with a frame for each moment.

    Args:
        motion: one person or two.
        title: stands above; plain text.
        theme: "light" or "dark".
        fps: frames a second of the figure; it plays at the motion's own speed.

    Returns:
        traces of the floor, and for each person three of limbs (middle, left, right) and one of the name; its axes are
        those of the motion, in metres, Y up.

    Raises:
        InputError: for another theme, a rate that is not possible, or a motion with too many frames.
    """
    from plotly import graph_objects as go  # takes half a second, which the page's start is spared

    if theme not in THEMES:
        raise InputError(f"There is no theme {theme!r:.30}: choose one of {', '.join(THEMES)}.")
    if not 1 <= fps <= 60:
        raise InputError(f"{fps:g} frames a second are not possible: give 1 to 60.")
    moments = _moments(motion, fps)
    people = stacked_positions(motion).astype(np.float64)
    names = motion.roles if isinstance(motion, Duet) else (motion.name,)
    colours, moving = THEMES[theme], list(range(1, 1 + 4 * len(people)))
    still = _tracks(people[:, moments[0]])
    made = go.Figure(
        data=[
            _floor(people, colours),
            *(go.Scatter3d(**track, **style) for track, style in zip(still, _styles(names, colours), strict=True)),
        ],
        frames=[
            go.Frame(
                data=[go.Scatter3d(**track) for track in _tracks(people[:, moment])],
                traces=moving,
                name=f"{moment / motion.fps:.2f}",
            )
            for moment in moments
        ],
    )
    steps = [f"{moment / motion.fps:.2f}" for moment in moments]
    made.update_layout(**_layout(people, colours, title, steps, 1000.0 / fps))
    return made


def write_figure(
    motion: Clip | Duet, path: str | Path, *, title: str = "", theme: str = "light", fps: float = FPS
) -> Path:
    """Writes :func:`figure` as one HTML file of about 5 MB, plotly.js included, which needs no network.

    Raises:
        InputError: as :func:`figure`, or where the file cannot be written; no file is left.
    """
    path = Path(path)
    text = figure(motion, title=title, theme=theme, fps=fps).to_html(
        include_plotlyjs=True, full_html=True, auto_play=False, config={"displaylogo": False, "responsive": True}
    )
    write_text(path, text)
    return path


def _moments(motion: Clip | Duet, fps: float) -> list[int]:
    """The frames that are shown: the nearest to each of ``fps`` moments a second, the last one included."""
    last = (motion.num_frames - 1) / motion.fps
    times = np.append(np.arange(0.0, last, 1.0 / fps), last)
    if len(times) > MOST_FRAMES:
        raise InputError(
            f"The figure would have {len(times):,} frames, more than {MOST_FRAMES:,}: cut the motion or give fewer "
            "frames a second."
        )
    return np.unique(np.rint(times * motion.fps).astype(int)).tolist()


def _tracks(places: Array) -> list[dict[str, Array]]:
    """Where four traces of each person are at one moment; ``places`` is (people, 22, 3)."""
    tracks: list[Array] = []
    for joints in places:
        tracks += [_lines(joints, limb) for limb in LIMBS]
        tracks.append(joints[[np.argmax(joints[:, 1])]] + np.array([0.0, _ABOVE_HEAD, 0.0]))
    return [dict(zip("xyz", track.T, strict=True)) for track in tracks]


def _styles(names: tuple[str, ...], colours: Theme) -> list[dict[str, Any]]:
    """How these traces look: three limbs and a name."""
    styles: list[dict[str, Any]] = []
    for person, name in enumerate(names):
        shade = [_css(colour) for colour in colours.people[person % len(colours.people)]]
        for colour in shade:
            bone, joint = {"color": colour, "width": 7}, {"color": colour, "size": 3}
            styles.append({"mode": "lines+markers", "line": bone, "marker": joint})
        text = [html.escape(str(name)[:40])]
        styles.append({"mode": "text", "text": text, "textfont": {"color": shade[0], "size": 15}})
    return [{**style, "hoverinfo": "skip", "showlegend": False} for style in styles]


def _lines(joints: Array, limb: str) -> Array:
    """(3 · bones, 3): both ends of each bone of a limb, then a gap."""
    rows = [
        row
        for parent, child in SMPL22.bones
        if limb == next((side for side in LIMBS[1:] if SMPL22.joint_names[child].startswith(side)), LIMBS[0])
        for row in (joints[parent], joints[child], np.full(3, np.nan))
    ]
    return np.round(np.array(rows).reshape(-1, 3), 4)


def _floor(people: Array, colours: Theme) -> Any:
    from plotly import graph_objects as go

    (x, _, z), (far_x, _, far_z) = _bounds(people)
    return go.Mesh3d(
        x=[x, far_x, far_x, x],
        y=[0.0] * 4,
        z=[z, z, far_z, far_z],
        i=[0, 0],
        j=[1, 2],
        k=[2, 3],
        color=_css(colours.floor),
        opacity=1.0,
        hoverinfo="skip",
        lighting={"ambient": 1.0, "diffuse": 0.0},
        name="floor",
    )


def _bounds(people: Array) -> tuple[Array, Array]:
    places = people.reshape(-1, 3)
    low, high = places.min(axis=0) - _MARGIN, places.max(axis=0) + _MARGIN
    return np.minimum(low, [low[0], 0.0, low[2]]), high


def _css(colour: Colour) -> str:
    return "#" + "".join(f"{round(255 * part):02x}" for part in colour)


def _layout(people: Array, colours: Theme, title: str, steps: list[str], milliseconds: float) -> dict[str, Any]:
    low, high = _bounds(people)
    axis = {"showbackground": False, "gridcolor": _css(colours.grid), "zeroline": False, "color": _css(colours.ink)}
    at_once = {"frame": {"duration": milliseconds, "redraw": True}, "transition": {"duration": 0}}
    still = {"frame": {"duration": 0, "redraw": True}, "transition": {"duration": 0}, "mode": "immediate"}
    return {
        "title": {"text": html.escape(title[:200])},
        "paper_bgcolor": _css(colours.horizon),
        "font": {"color": _css(colours.ink)},
        "margin": {"l": 0, "r": 0, "t": 60 if title else 20, "b": 0},
        "scene": {
            "aspectmode": "data",
            "camera": {"up": {"x": 0, "y": 1, "z": 0}, "eye": {"x": 1.4, "y": 0.8, "z": 1.5}},
            **{
                name: {**axis, "range": [float(a), float(b)], "title": {"text": f"{name[0]} (m)"}}
                for name, a, b in zip(("xaxis", "yaxis", "zaxis"), low, high, strict=True)
            },
        },
        "updatemenus": [
            {
                "type": "buttons",
                "direction": "left",
                "x": 0.0,
                "y": 0.0,
                "xanchor": "left",
                "yanchor": "top",
                "pad": {"t": 20, "l": 10},
                "showactive": False,
                "buttons": [
                    {"label": "▶ Play", "method": "animate", "args": [None, {**at_once, "fromcurrent": True}]},
                    {"label": "❚❚ Pause", "method": "animate", "args": [[None], still]},
                ],
            }
        ],
        "sliders": [
            {
                "active": 0,
                "x": 0.2,
                "len": 0.78,
                "y": 0.0,
                "pad": {"t": 10},
                "currentvalue": {"suffix": " s", "xanchor": "right"},
                "steps": [{"label": step, "method": "animate", "args": [[step], still]} for step in steps],
            }
        ],
    }

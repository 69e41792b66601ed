"""A prediction as the player and a plot show it."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from motion import Clip, Duet, stacked_positions
from webdemo.inference.methods import label_of, methods
from webdemo.inference.requests.predict import PredictResult, with_people
from webdemo.view.payload import Curve, Payload, build_payload, sample_payload

from .show import with_shown_roles

if TYPE_CHECKING:
    import plotly.graph_objects as go

Array = NDArray[np.floating]
_GREY, _ORANGE = "#8e99aa", "#e07a10"
_METHOD_COLOURS = ("#2468d8", "#8b3fc4", "#1f9d72", "#c2410c", "#64748b")
_NO_TRUTH = "Nothing follows the marker to compare with."


def prediction_payload(result: PredictResult, *, title: str = "") -> Payload:
    """The player's value: the past marked as given, what really followed as a ghost, the error below.

    The futures of a result are samples, of which the others show as ghosts.
    """
    made = [_sample(result, place) for place in range(len(result.duets))]
    futures = {"futures": result.past_frames} if len(made) > 1 else {}
    return {**build_payload(made, skeleton=without_name(result.duets[0]).skeleton, title=title), **futures}


def _sample(result: PredictResult, place: int) -> dict[str, Any]:
    motion = with_shown_roles(without_name(result.duets[place]), result.manifest)
    curves = [
        Curve("error", "Error", "m", _padded(result.error, motion.num_frames, result.past_frames)),
        Curve("speed", "Speed", "m/s", _speed(motion)),
    ]
    return sample_payload(
        motion,
        label=str(place + 1),
        curves=curves if result.error else curves[1:],
        ghost=ghost_of(motion, result),
        past_until=result.past_frames,
    )


def method_name(result: PredictResult) -> str:
    """The page's name for the method of a result."""
    model = str(result.manifest.get("model", ""))
    return label_of(model) or "Prediction"


def without_name(motion: Clip | Duet) -> Clip | Duet:
    """The motion as the player's legend shows it: one person as "a", not by the name of a file."""
    return replace(motion, name="a") if isinstance(motion, Clip) else motion


def _padded(values: tuple[float, ...], frames: int, start: int) -> Array:
    """Millimetres a predicted frame → (frames,) metres: 0 before, the last value after."""
    whole = np.zeros(frames)
    known = np.asarray(values[: frames - start]) / 1000
    whole[start : start + len(known)] = known
    if len(known):
        whole[start + len(known) :] = known[-1]
    return whole


def _speed(motion: Clip | Duet) -> Array:
    people = stacked_positions(motion).astype(np.float64)
    steps = np.linalg.norm(np.diff(people, axis=1), axis=-1).mean(axis=(0, 2)) * motion.fps
    return np.concatenate([steps[:1], steps])


def ghost_of(motion: Clip | Duet, result: PredictResult) -> Clip | Duet | None:
    """The recorded continuation, as long as the shown motion; its last pose is held where the recording ends."""
    if result.truth is None:
        return None
    real = stacked_positions(result.given)[:, : motion.num_frames]
    missing = motion.num_frames - real.shape[1]
    held = np.concatenate([real, np.repeat(real[:, -1:], missing, axis=1)], axis=1)
    return with_people(motion, held)


def curves_figure(*results: PredictResult) -> go.Figure:
    """Error (MPJPE) and speed (MPJS) of each predicted frame, beside holding the last pose and the truth.

    Results of several methods for one past share the axes. Where the motion ends at the marker there is
    no error, and the speed is drawn alone.
    """
    import plotly.graph_objects as go  # 0.1 s, for a page that may never predict
    from plotly.subplots import make_subplots

    first = results[0]
    fps = first.duets[0].fps
    known = len(first.error)
    times = np.arange(1, len(first.speed) + 1) / fps
    titles = ["Error, mm", "Speed, m/s"] if known else [f"Speed, m/s. {_NO_TRUTH}"]
    # One above the other: side by side they are too narrow on a phone.
    figure = make_subplots(rows=len(titles), cols=1, subplot_titles=titles, vertical_spacing=0.22)

    def line(row: int, values: Array, name: str, colour: str, dash: str | None = None, *, listed: bool = True) -> None:
        figure.add_trace(
            go.Scatter(
                x=times[: len(values)],
                y=values,
                name=name,
                mode="lines",
                legendgroup=name,
                showlegend=listed,
                line={"color": colour, "width": 2, "dash": dash},
            ),
            row=row,
            col=1,
        )

    metres = fps / 1000
    for result, colour in zip(results, _METHOD_COLOURS, strict=False):
        name = method_name(result)
        if known:
            line(1, np.asarray(result.error), name, colour)
        line(len(titles), np.asarray(result.speed) * metres, name, colour, listed=not known)
    if known:
        baselines = {method.name for method in methods("predict") if method.weights is None}
        if all(result.manifest.get("model") not in baselines for result in results):
            line(1, still_error(first), "Last pose held", _GREY, "dot")
        line(len(titles), np.asarray(first.true_speed) * metres, "What really followed", _ORANGE)
    figure.update_xaxes(title_text="s after the marker", rangemode="tozero")
    figure.update_yaxes(rangemode="tozero")
    figure.update_layout(
        height=70 + 190 * len(titles),
        margin={"l": 48, "r": 12, "t": 36, "b": 44},
        template="plotly_white",
        legend={"orientation": "h", "y": -0.16, "yanchor": "top"},
        paper_bgcolor="rgba(0,0,0,0)",
        plot_bgcolor="rgba(0,0,0,0)",
    )
    return figure


def error_lines(*results: PredictResult) -> list[str]:
    """A sentence or two a result on how far off it was, and whether holding the last pose came nearer."""
    lines = []
    for result in results:
        if not result.error:
            lines.append(_NO_TRUTH)
            continue
        error, fps = np.asarray(result.error), result.duets[0].fps
        line = (
            f"Over {len(error) / fps:.1f} s the joints are {error.mean():.0f} mm off on average, "
            f"and {error[-1]:.0f} mm at the end."
        )
        still = still_error(result)[: len(error)].mean()
        if result.manifest.get("model") != "still":
            if still < error.mean():
                line += f" Holding the last pose would have been nearer: {still:.0f} mm."
            else:
                line += f" Holding the last pose would have been {still:.0f} mm off."
        lines.append(line)
    return lines


def still_error(result: PredictResult) -> Array:
    """(frames of truth,) error in millimetres of holding the last pose."""
    assert result.truth is not None
    last = stacked_positions(result.duets[0])[:, result.past_frames - 1]
    real = stacked_positions(result.truth).astype(np.float64)
    return 1000 * np.linalg.norm(real - last[:, None], axis=-1).mean(axis=(0, 2))

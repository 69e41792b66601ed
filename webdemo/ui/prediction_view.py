"""A prediction as the player and a plot show it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import plotly.graph_objects as go
from plotly.subplots import make_subplots

from webdemo.inference.predict_request import METHODS, PredictResult, people_of, with_people
from webdemo.motion import Clip, Duet
from webdemo.view.curves import Curve
from webdemo.view.payload import Payload, build_payload, sample_payload

_BLUE, _GREY, _ORANGE = "#2468d8", "#8e99aa", "#e07a10"


def prediction_payload(result: PredictResult, *, title: str = "") -> Payload:
    """The player's value: the past marked as given, what really followed as a ghost, the error below."""
    motion = without_name(result.duets[0])
    ghost = _ghost(motion, result)
    curves = [
        Curve("error", "Error", "m", _padded(result.error, motion.num_frames, result.past_frames)),
        Curve("speed", "Speed", "m/s", _speed(motion)),
    ]
    sample = sample_payload(
        motion, label="1", curves=curves if result.error else curves[1:], ghost=ghost,
        past_until=result.past_frames,
    )  # fmt: skip
    return build_payload([sample], skeleton=motion.skeleton, title=title)


def without_name(motion: Clip | Duet) -> Clip | Duet:
    """The motion as the player's legend shows it: one person as "a", not by the name of a file."""
    return replace(motion, name="a") if isinstance(motion, Clip) else motion


def _padded(values: tuple[float, ...], frames: int, start: int) -> np.ndarray:
    """Millimetres a predicted frame → (frames,) metres: 0 before, the last value after."""
    whole = np.zeros(frames)
    known = np.asarray(values[: frames - start]) / 1000
    whole[start : start + len(known)] = known
    if len(known):
        whole[start + len(known) :] = known[-1]
    return whole


def _speed(motion: Clip | Duet) -> np.ndarray:
    people = people_of(motion).astype(np.float64)
    steps = np.linalg.norm(np.diff(people, axis=1), axis=-1).mean(axis=(0, 2)) * motion.fps
    return np.concatenate([steps[:1], steps])


def _ghost(motion: Clip | Duet, result: PredictResult) -> Clip | Duet | None:
    """What really happened, as long as the shown motion: held where it is not known."""
    if result.truth is None:
        return None
    past = people_of(motion)[:, : result.past_frames]
    real = np.concatenate([past, people_of(result.truth)], axis=1)[:, : motion.num_frames]
    missing = motion.num_frames - real.shape[1]
    held = np.concatenate([real, np.repeat(real[:, -1:], missing, axis=1)], axis=1)
    return with_people(motion, held)


def curves_figure(result: PredictResult) -> go.Figure:
    """Error (MPJPE) and speed (MPJS) of each predicted frame, beside holding the last pose and the truth."""
    fps = result.duets[0].fps
    known = len(result.error)
    times = np.arange(1, len(result.speed) + 1) / fps
    figure = make_subplots(rows=1, cols=2, subplot_titles=("Error, mm", "Mean speed of a joint, m/s"))

    def line(col: int, values: np.ndarray, name: str, colour: str, dash: str | None = None) -> None:
        figure.add_trace(
            go.Scatter(
                x=times[: len(values)], y=values, name=name, mode="lines",
                line={"color": colour, "width": 2, "dash": dash},
            ),
            row=1, col=col,
        )  # fmt: skip

    model = str(result.manifest.get("model", ""))
    method = METHODS.get(model, model or "Prediction")
    if known:
        line(1, np.asarray(result.error), method, _BLUE)
        if model != "still":
            line(1, still_error(result), "Last pose held", _GREY, "dot")
    else:
        figure.add_annotation(
            text="Nothing follows the marker to compare with.", showarrow=False, x=0.5, y=0.5,
            xref="x domain", yref="y domain",
        )  # fmt: skip
    metres = fps / 1000
    line(2, np.asarray(result.speed) * metres, f"{method}, speed", _BLUE)
    if known:
        line(2, np.asarray(result.true_speed) * metres, "What really followed", _ORANGE)
    figure.update_xaxes(title_text="seconds after the marker", rangemode="tozero")
    figure.update_yaxes(rangemode="tozero")
    figure.update_layout(
        height=300, margin={"l": 48, "r": 12, "t": 36, "b": 44}, template="plotly_white",
        legend={"orientation": "h", "y": -0.28}, paper_bgcolor="rgba(0,0,0,0)", plot_bgcolor="rgba(0,0,0,0)",
    )  # fmt: skip
    return figure


def still_error(result: PredictResult) -> np.ndarray:
    """(frames of truth,) error in millimetres of holding the last pose."""
    assert result.truth is not None
    last = people_of(result.duets[0])[:, result.past_frames - 1]
    real = people_of(result.truth).astype(np.float64)
    return 1000 * np.linalg.norm(real - last[:, None], axis=-1).mean(axis=(0, 2))

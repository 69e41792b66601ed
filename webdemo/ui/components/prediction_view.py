"""A prediction as the player shows it, and how far off it was."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from motion import Clip, Duet, stacked_positions
from motion.vectors import Array
from webdemo.inference.requests.predict import PredictResult, with_people
from webdemo.inference.run import Result
from webdemo.view.payload import Curve, Payload, build_payload, sample_payload

from .player import result_payload, with_shown_roles


def payload_of(result: Result, *, title: str = "") -> Payload:
    """The player's value for any result."""
    if isinstance(result, PredictResult):
        return prediction_payload(result, title=title)
    return result_payload(result, title=title)


def prediction_payload(result: PredictResult, *, title: str = "") -> Payload:
    """The player's value: the past marked as given, what really followed as a ghost, the error below.

    Several futures of a result are samples.
    """
    made = [_sample(result, place) for place in range(len(result.duets))]
    return build_payload(made, skeleton=without_name(result.duets[0]).skeleton, title=title)


def _sample(result: PredictResult, place: int) -> dict[str, Any]:
    motion = with_shown_roles(without_name(result.duets[place]), result.manifest)
    curves = [
        Curve("Error", "m", _padded(result.error, motion.num_frames, result.past_frames)),
        Curve("Speed", "m/s", _speed(motion)),
    ]
    return sample_payload(
        motion,
        label=str(place + 1),
        curves=curves if result.error else curves[1:],
        ghost=ghost_of(motion, result),
        past_until=result.past_frames,
    )


def without_name(motion: Clip | Duet) -> Clip | Duet:
    """The motion as the player names its people: one person as "a", not by the name of a file."""
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


def error_lines(*results: PredictResult) -> list[str]:
    """A sentence or two a result on how far off it was, and whether holding the last pose came nearer."""
    lines = []
    for result in results:
        if not result.error:
            lines.append("The motion ends here, so there is nothing to compare with.")
            continue
        error, fps = np.asarray(result.error), result.duets[0].fps
        line = (
            f"Over {len(error) / fps:.1f} s the joints are {error.mean() / 10:.1f} cm off on average, "
            f"and {error[-1] / 10:.1f} cm at the end."
        )
        still = still_error(result)[: len(error)].mean()
        if result.manifest.get("model") != "still":
            if still < error.mean():
                line += f" Holding the last pose would have been closer: {still / 10:.1f} cm."
            else:
                line += f" Holding the last pose would have been {still / 10:.1f} cm off."
        lines.append(line)
    return lines


def still_error(result: PredictResult) -> Array:
    """(frames of truth,) error in millimetres of holding the last pose."""
    assert result.truth is not None
    last = stacked_positions(result.duets[0])[:, result.past_frames - 1]
    real = stacked_positions(result.truth).astype(np.float64)
    return 1000 * np.linalg.norm(real - last[:, None], axis=-1).mean(axis=(0, 2))

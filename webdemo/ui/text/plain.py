"""The read-outs for newcomers: a sentence or two, and what each figure means."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from motion.metrics import MEASURES

from .words import number, text

_FEET = ((10.0, "standing feet stay in place"), (20.0, "standing feet slide a little"), (None, "standing feet slide"))
_OVERLAP = (
    (1.0, "the bodies do not overlap"),
    (5.0, "the bodies overlap a little"),
    (None, "the bodies run into each other"),
)
_SHAKING = ((40.0, "the motion is smooth"), (80.0, "the motion shakes a little"), (None, "the motion shakes"))
_VERDICTS = (("foot_skate", _FEET), ("penetration_max", _OVERLAP), ("jerk", _SHAKING))
"""The largest value for which each phrase holds. Recorded people, measured in the same way, have a foot skate of
about 12 cm/s and a jerk of 31 m/s³ (docs/scores.md)."""


def in_words(values: Mapping[str, float]) -> str:
    """A summary of :data:`motion.metrics.MEASURES` in the visitor's words; "" where nothing of it is known."""
    sentences = [_between(values), _quality(values)]
    return " ".join(sentence for sentence in sentences if sentence)


def lines_in_words(summaries: Mapping[str, Mapping[str, float]]) -> str:
    """The same as HTML, a line each, after what each is called where there are several."""
    lines = {name: in_words(values) for name, values in summaries.items()}
    return "".join(
        f'<p class="pd-in-words">{f"<b>{text(name)}</b> " if len(lines) > 1 else ""}{text(line)}</p>'
        for name, line in lines.items()
        if line
    )


def legend() -> str:
    """A folded legend of the figures."""
    items = "".join(
        f"<div><dt>{text(measure.label)}</dt><dd>{text(measure.meaning)}</dd></div>" for measure in MEASURES
    )
    head = "What the figures mean"
    return f'<details class="pd-legend"><summary>{head}</summary><dl>{items}</dl></details>'


def _between(values: Mapping[str, float]) -> str:
    if not {"distance", "distance_min", "contact_seconds"} <= values.keys():
        return ""
    touch = values["contact_seconds"]
    touching = f"touch for {number(touch, 1)} s" if touch >= 0.05 else "do not touch"
    mean, least = number(values["distance"], 1), number(values["distance_min"], 1)
    return f"The two are {mean} m apart on average, {least} m at the closest, and {touching}."


def _quality(values: Mapping[str, float]) -> str:
    parts = [_verdict(values[key], levels) for key, levels in _VERDICTS if key in values]
    line = ", ".join(parts)
    return f"{line[:1].upper()}{line[1:]}." if line else ""


def _verdict(value: float, levels: Sequence[tuple[float | None, str]]) -> str:
    return next(words for limit, words in levels if limit is None or value <= limit)

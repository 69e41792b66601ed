"""Futures of two people who know of each other, drawn by InterGen beside their past (InterGen, section 5.4).

The first moments are the predictor's, which is surer of them (docs/scenes.md, *Futures*): InterGen goes on from there.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from motion import FPS, Duet, stacked_positions
from webdemo.inference.requests.predict import PredictRequest, predicted
from webdemo.inference.run import CancelToken, Progress, Result, StageTimer
from webdemo.inference.story import Beat, SceneRequest
from webdemo.inference.story.beats import SHORTEST
from webdemo.inference.story.request import SceneProgress

from .intergen import InterGenPipeline
from .predictor import PredictorPipeline

FUTURES = 3
"""Futures of a request."""
_SEEN = 10.0
"""Seconds of the past that are given to the scene; a window sees less of it."""
_LEAD, _LEAD_SHARE = 15, 0.25
"""Frames that the predictor makes, at most, and its share of short futures."""


class TogetherPipeline:
    """Continues two people as a scene without words.

    Args:
        folder: of InterGen's weights.
        intergen: the pipeline that makes scenes.
        predictor: continues each person alone.
    """

    def __init__(self, folder: Path, intergen: InterGenPipeline, predictor: PredictorPipeline) -> None:
        self.name = "intergen-together"
        self.digest = hashlib.sha256(f"{intergen.digest}{predictor.digest}".encode()).hexdigest()
        self.intergen, self.predictor = intergen, predictor

    def run(self, request: PredictRequest, cancel: CancelToken, timer: StageTimer) -> Iterator[Progress | Result]:
        """Progress events, then one :class:`PredictResult` of :data:`FUTURES` futures, without a manifest."""
        past = request.past
        assert isinstance(past, Duet)  # the request sees to it
        frames = round(request.seconds * FPS)
        lead = min(_LEAD, round(_LEAD_SHARE * frames))
        begun = np.concatenate([past.positions, self.predictor.predict(past.positions, lead)], axis=1)
        seen = Duet.from_positions(begun[:, -round(_SEEN * FPS) :], fps=FPS)
        beats = (Beat("", seconds=max((frames - lead) / FPS, SHORTEST)),)
        asked = SceneRequest(beats=beats, motion=seen, samples=FUTURES, seed=request.seed)
        made: tuple[Duet, ...] = ()
        for event in self.intergen.scenes.run(asked, cancel, timer):
            if isinstance(event, Result):
                made = tuple(duet for duet in event.duets if isinstance(duet, Duet))
            elif not isinstance(event, SceneProgress):
                yield event
        ahead = slice(seen.num_frames - lead, seen.num_frames - lead + frames)
        futures = [stacked_positions(duet)[:, ahead].astype(np.float64) for duet in made]
        yield predicted(request, futures)

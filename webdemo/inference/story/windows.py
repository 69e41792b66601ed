"""The windows in which a scene is made: each is a beat or a part of one, and sees the end of the one before."""

from __future__ import annotations

import itertools

import numpy as np

from acts.staging.window import AFTER, MOST_FRAMES, PAST, Window

from .request import SceneRequest


def windows(request: SceneRequest) -> list[Window]:
    """The windows of a scene in the order in which they are made."""
    edges = request.edges
    found: list[Window] = []
    behind = min(AFTER, request.num_frames - edges[-1]) if request.end is not None else 0
    if request.loop:  # the scene's own beginning lies behind its end
        behind = min(AFTER, edges[-1] // 2)
    for beat, (start, stop) in enumerate(itertools.pairwise(edges)):
        after = behind if beat == len(edges) - 2 else 0
        most = MOST_FRAMES - PAST - after
        parts = -(-(stop - start) // most)
        if request.loop and len(request.beats) == 1:
            parts = max(parts, 2)  # the last window needs a beginning to return to
        cuts = np.linspace(start, stop, parts + 1).round().astype(int).tolist()
        for part, (first, last) in enumerate(itertools.pairwise(cuts)):
            known = min(after, first) if request.loop else after
            found.append(Window(beat, part, first, last, known if part == parts - 1 else 0))
    return found


def window_seed(request: SceneRequest, sample: int, window: Window) -> int:
    """The seed of a window's noise; the first window of a story has the story's own, as plain generation would."""
    own = request.beats[window.beat].seed
    if own is None and sample == window.beat == window.part == 0 and request.motion is None:
        return request.seed
    first = request.seed if own is None else own
    return int(np.random.SeedSequence([first, sample, window.beat, window.part]).generate_state(1)[0])

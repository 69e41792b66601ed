"""Runs of a history once more, and whether they came out the same."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import fields
from typing import Any

import numpy as np

from motion import Duet, InputError
from webdemo.inference.requests import GenerateRequest, ReactRequest, SamplingRequest, replayed
from webdemo.inference.requests.actor import ROLES
from webdemo.inference.requests.plans import kept_plan
from webdemo.inference.requests.predict import PredictRequest, PredictResult
from webdemo.inference.run import Result
from webdemo.inference.story import SceneRequest
from webdemo.ui.components.actors import Source

from .history import Entry, Opened

Request = SamplingRequest | PredictRequest
_KINDS: dict[str, type[Request]] = {
    "generate": GenerateRequest,
    "react": ReactRequest,
    "predict": PredictRequest,
    "scene": SceneRequest,
}


def request_of(opened: Opened) -> Request:
    """The request that a kept run was made from, with the plan of its result: the words are not read again.

    Raises:
        InputError: for a kind that keeps too little of what it was made from, or fields that no longer fit.
    """
    asked = replayed(opened.entry.request, opened.result.manifest)
    if asked.get("live"):
        raise InputError(
            "A live stream cannot be run again: its partner answered as it happened. React to its actor in the tab "
            "React, or stream once more."
        )
    kind = _KINDS.get(opened.entry.kind)
    if kind is None:
        raise InputError(f"A run of the kind {opened.entry.kind!r} cannot be run again from here: use its tab.")
    if kind is SceneRequest:
        kept = opened.result.duets[0]  # what was made of it is not read again
        motion = kept if "motion" in asked and isinstance(kept, Duet) else None
        return SceneRequest.from_dict(asked, motion, kept_plan(opened.result.manifest))
    given: dict[str, Any] = {f.name: asked[f.name] for f in fields(kind) if f.name in asked}
    if kind is GenerateRequest:
        older = {"split": False, "planned": False}  # of a time before sentences were split or planned
        given = {**older, **given}
    if kind is not PredictRequest:
        given["plan"] = kept_plan(opened.result.manifest)
    if kind is ReactRequest:
        given["actor"] = actor_source(opened).people[0]
    if kind is PredictRequest:
        if not isinstance(opened.result, PredictResult):
            raise InputError("This prediction was kept without its marker: use its tab.")
        given["motion"] = opened.result.given
    return kind(**given)


def request_of_unfinished(entry: Entry) -> Request:
    """The request of a run that has no result.

    Raises:
        InputError: where it was made from somebody's motion, which is kept with a result alone.
    """
    if entry.kind == "scene" and "motion" not in entry.request:
        return SceneRequest.from_dict(entry.request)
    if entry.kind != "generate":
        raise InputError("This run ended before its motion was kept: send the file again in its tab.")
    asked = entry.request
    given = {f.name: asked[f.name] for f in fields(GenerateRequest) if f.name in asked}
    return GenerateRequest(**{"split": False, "planned": False, **given})


def actor_source(opened: Opened) -> Source:
    """The given person of a kept reaction, whom its result holds unchanged."""
    asked = opened.entry.request
    place = ROLES.index(asked.get("role", ROLES[0]))
    duet = opened.result.duets[0]
    assert isinstance(duet, Duet)  # as every reaction is
    return Source(asked.get("actor", {}).get("name") or opened.entry.title, (duet.people[place],))


def verdict(old: Result, new: Result) -> str:
    """One sentence: the same bytes, or which part differs and by how much."""
    pairs = list(zip(old.duets, new.duets, strict=False))
    if len(old.duets) == len(new.duets) and all(np.array_equal(a.positions, b.positions) for a, b in pairs):
        return "Run again: the same motion, bit for bit."
    changed = _changed(old.manifest, new.manifest)
    if any(a.positions.shape != b.positions.shape for a, b in pairs):
        apart = "the motions differ in length"
    else:
        largest = max(float(np.abs(a.positions - b.positions).max()) for a, b in pairs)
        apart = f"joints differ by up to {1000 * largest:.3g} mm"
    if changed:
        return f"Run again: another motion ({apart}), because of {'; '.join(changed)}."
    return f"Run again: {apart}, with the same weights and versions; it ran on another machine."


def _changed(old: Mapping[str, Any], new: Mapping[str, Any]) -> list[str]:
    """Lists the differences between two manifests, in words."""
    found = []
    if old.get("model") != new.get("model"):
        found.append(f"the model ({old.get('model')} → {new.get('model')})")
    if old.get("weights_sha256") != new.get("weights_sha256"):
        before, after = (str(m.get("weights_sha256", "unknown"))[:8] for m in (old, new))
        found.append(f"the weights ({before} → {after})")
    before, after = old.get("versions", {}), new.get("versions", {})
    found += [
        f"{name} ({before.get(name, 'none')} → {after.get(name, 'none')})"
        for name in sorted({*before, *after})
        if before.get(name) != after.get(name)
    ]
    asked = (replayed(m.get("request") or {}, m) for m in (old, new))
    if len({json.dumps(request, sort_keys=True) for request in asked}) > 1:
        found.append("the request")
    return found

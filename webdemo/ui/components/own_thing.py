"""One's own thing in a result that the page shows."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any

from motion import InputError
from motion.formats.thing_files import SUFFIXES
from webdemo.inference.finish.looks import with_own_thing
from webdemo.inference.requests import GenerateRequest, replayed
from webdemo.inference.requests.plans import kept_plan
from webdemo.inference.run import Result
from webdemo.inference.story import SceneRequest
from webdemo.ui.places import READING

from .exports import Record

FILE_TYPES = list(SUFFIXES)


def bring(record: Record | None, path: str | None) -> Result:
    """The result of a record with the thing of an uploaded file in it.

    Raises:
        InputError: if there is no such result or no such thing.
    """
    if not path:
        raise InputError("There is no thing: choose a .glb, .obj, .stl or .ply file.")
    if record is None or record.compared:
        raise InputError("A thing is for one result: make a motion first, not several side by side.")
    with READING.place():
        return with_own_thing(record.result, _request(record.result.manifest), Path(path))


def _request(manifest: Mapping[str, Any]) -> Any:
    """The request of a result whose words name things; None for one that has no words, or keeps too little of them."""
    asked = replayed(manifest.get("request") or {}, manifest)
    try:
        if asked.get("kind") == "generate":
            given = {f.name: asked[f.name] for f in fields(GenerateRequest) if f.name in asked}
            return GenerateRequest(**given, plan=kept_plan(manifest))
        if asked.get("kind") == "scene" and "motion" not in asked:
            return SceneRequest.from_dict(asked, None, kept_plan(manifest))
    except InputError:  # made by an earlier version, or with a model that is gone
        return None
    return None

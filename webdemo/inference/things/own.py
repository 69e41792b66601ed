"""One's own thing in a finished result: the shape of the first thing that its words name."""

from __future__ import annotations

import hashlib
from dataclasses import replace
from pathlib import Path
from typing import Any

from motion import InputError
from motion.formats.thing_files import read_thing
from webdemo.inference.requests.acting import plans_of
from webdemo.inference.run import Result

from .furnishing import furnished


def with_own_thing(result: Result, request: Any, file: Path) -> Result:
    """A result in which the first thing of its words, or one beside the people, looks like that of a file.

    Args:
        result: of two people.
        request: that it was made from.
        file: .glb, .obj, .stl or .ply.

    Raises:
        InputError: if the file cannot be read, or the result has no two people on SMPL22.
    """
    mesh = read_thing(file)
    given = getattr(request, "motion", None) is not None
    made = furnished(result, list(plans_of(request)), mesh, given=given)
    if "things" not in made.manifest:
        raise InputError("There are no two people here for whom a thing could be: leave the file out.")
    named = {"file": file.name[:100], "sha256": hashlib.sha256(file.read_bytes()).hexdigest()}
    return replace(made, manifest={**made.manifest, "own_thing": named})

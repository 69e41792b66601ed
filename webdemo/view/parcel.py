"""Drawing jobs as plain bytes for another process: an ``.npz`` file of arrays and one line of JSON.

Nothing in a parcel is code: only the classes that :data:`KINDS` names are made from it, so that no process has to
unpickle what another one sent.
"""

from __future__ import annotations

import io
import json
from dataclasses import dataclass, fields, is_dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from motion.clip import Clip, Duet
from motion.hands import Grip
from motion.skeleton import Skeleton
from motion.things.thing import Mesh, Thing

from .camera import Camera
from .stage import Pane, Style


@dataclass(frozen=True)
class Job:
    """All that a process needs to draw some pictures of a film.

    Attributes:
        panes: the motions, from left to right and from top to bottom.
        style: how people are drawn.
        size: width and height of the whole picture in pixels.
        times: (N,) the moments in seconds.
        views: the cameras of each pane, one a moment.
        title: stands at the lower edge, with the time.
        planar: the pictures are made as a video's planes (YUV 4:2:0), of which there are fewer bytes to pass on.
    """

    panes: tuple[Pane, ...]
    style: Style
    size: tuple[int, int]
    times: NDArray[np.floating]
    views: list[list[Camera]]
    title: str
    planar: bool = False

    def part(self, first: int, step: int) -> Job:
        """Every ``step``-th picture."""
        views = [each[first::step] for each in self.views]
        return replace(self, times=self.times[first::step], views=views)

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of a picture: (height, width, 4), or of planes (3/2 height, width)."""
        width, height = self.size
        return (3 * height // 2, width) if self.planar else (height, width, 4)


KINDS: dict[str, type] = {
    kind.__name__: kind for kind in (Job, Pane, Style, Clip, Duet, Mesh, Thing, Grip, Skeleton, Camera)
}
"""The classes that a parcel may hold, by name."""


def packed(job: Job) -> bytes:
    """A job as :func:`unpacked` reads it.

    Raises:
        TypeError: where it holds something that is neither an array, nor plain data, nor one of :data:`KINDS`.
    """
    arrays: list[NDArray[Any]] = []

    def tree(value: Any) -> Any:
        if isinstance(value, np.ndarray) and value.dtype != object:
            arrays.append(value)
            return {"array": f"arr_{len(arrays)}"}
        if isinstance(value, np.generic):
            return value.item()
        if is_dataclass(value) and KINDS.get(type(value).__name__) is type(value):
            parts = {part.name: tree(getattr(value, part.name)) for part in fields(value) if part.init}
            return {"kind": type(value).__name__, "parts": parts}
        if isinstance(value, dict):  # such as the manifest of a motion
            return {"mapping": [[tree(key), tree(each)] for key, each in value.items()]}
        if isinstance(value, tuple | list):
            return {type(value).__name__: [tree(each) for each in value]}
        if value is None or isinstance(value, str | int | float):
            return value
        raise TypeError(f"A drawing job cannot hold {type(value).__name__}.")

    written = np.frombuffer(json.dumps(tree(job)).encode(), np.uint8)
    buffer = io.BytesIO()
    np.savez(buffer, written, *arrays)
    return buffer.getvalue()


def unpacked(data: bytes) -> Job:
    """The job of a parcel.

    Raises:
        ValueError: for anything else.
    """
    with np.load(io.BytesIO(data), allow_pickle=False) as parcel:

        def value(node: Any) -> Any:
            if not isinstance(node, dict):
                return node
            if "kind" in node:
                return KINDS[node["kind"]](**{name: value(part) for name, part in node["parts"].items()})
            if "array" in node:
                return parcel[node["array"]]
            if "mapping" in node:
                return {value(key): value(each) for key, each in node["mapping"]}
            ((shape, members),) = node.items()
            return {"tuple": tuple, "list": list}[shape](value(each) for each in members)

        try:
            job = value(json.loads(parcel["arr_0"].tobytes()))
        except (KeyError, TypeError) as error:
            raise ValueError("This is no drawing job.") from error
    if not isinstance(job, Job):
        raise ValueError("This is no drawing job.")
    return job

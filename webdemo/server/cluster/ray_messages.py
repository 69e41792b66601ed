"""Messages between a Ray Serve replica and the page's process, other than a run's own events."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Began:
    """The first message of a replica about a request: the id of its process."""

    pid: int


class ReplicaError(Exception):
    """A run ended with an internal error; the message names its type and the process whose log has it."""

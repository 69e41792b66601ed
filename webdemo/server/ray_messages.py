"""What a replica on Ray Serve and the page's process say to each other, besides a run's own events."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Began:
    """The first thing that a replica says of a request: which process has it."""

    pid: int


class ReplicaError(Exception):
    """A run ended in an error of the program's; says of which kind, and where its log is."""

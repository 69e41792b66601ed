"""The refusal of a request."""

from __future__ import annotations


class Refused(Exception):
    """A refused request.

    Attributes:
        status: the HTTP status.
        sentence: the message for the client.
        reason: its label in the metrics.
    """

    def __init__(self, status: int, sentence: str, reason: str) -> None:
        super().__init__(sentence)
        self.status, self.sentence, self.reason = status, sentence, reason

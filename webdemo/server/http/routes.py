"""The paths of the server: what each is, and those that no request may name; and the refusal of a request."""

from __future__ import annotations

import re

PUBLIC = ("/login", "/logout", "/healthz", "/metrics")
"""Paths that need no sign-in; /metrics has its own rule."""
EMBED = "/embed/"
"""Path of pages that other sites may show in a frame."""
_PUBLIC_PAGES = ("/share/", EMBED)
_SHOWN = "/shown/"
"""Path of the files that public pages load."""
API = "/gradio_api/"
PROGRESS = f"{API}upload_progress"
"""Path of the streams that say how much of an upload has come."""
LIVE = "/live/"
"""Path of the messages of live streams."""

_CLOSED = re.compile(
    r"/(monitoring|docs|redoc|openapi\.json|gradio_api/(openapi\.json|proxy=|vibe|undo-vibe|run-history|runs|deep_link|dev/"
    r"|stream/|process_recording|custom_component|file=\w+:|file/\w+:))",
    re.IGNORECASE,
)
"""Gradio's routes that this page does not use: proxies, code editing, monitoring, other hosts' files."""
_LONGEST_URL = 4096
NOTHING = "There is nothing here."


def path_below(root: str, path: str, query: bytes) -> str:
    """The path below the base path ``root``; raises Refused for one that tries tricks or is closed."""
    if len(path) + len(query) > _LONGEST_URL:
        raise Refused(414, "The address is too long.", "bad path")
    if root and (path == root or path.startswith(f"{root}/")):
        path = path[len(root) :] or "/"
    if "\0" in path or "\\" in path or "//" in path or ".." in path.split("/") or not path.isprintable():
        raise Refused(404, NOTHING, "bad path")
    if _CLOSED.match(path):
        raise Refused(404, NOTHING, "closed")
    return path


def is_public_page(path: str) -> bool:
    """True for pages that need no sign-in since their address is a secret."""
    return path.startswith(_PUBLIC_PAGES)


def needs_no_sign_in(path: str) -> bool:
    """True for what a stranger may ask for."""
    return path in PUBLIC or path.startswith(("/login/", _SHOWN, *_PUBLIC_PAGES))


def is_upload(path: str) -> bool:
    """True for the paths that take files."""
    return path.startswith(f"{API}upload")


# ---- refusals ------------------------------------------------------------------------------------


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

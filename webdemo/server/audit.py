"""The audit log: one JSON line for each sign-in, opened link, import, deletion and act of an administrator.

Anything in the server writes a line by :func:`audit`. Lines hold names, addresses, ids and counts, never a password, a
cookie, a link or what somebody wrote.
"""

from __future__ import annotations

import hashlib
import json
import logging
import os
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from logging.handlers import RotatingFileHandler
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import quote

from gradio.context import LocalContext

from motion import InputError
from webdemo.server.logs import REFERENCE
from webdemo.ui.visitor import visitor

if TYPE_CHECKING:
    from webdemo.server.settings import Settings

log = logging.getLogger(__name__)
_lines = logging.getLogger("webdemo.audit")

SENDER: ContextVar[tuple[str, str]] = ContextVar("sender", default=("", ""))
"""The person and the address behind the request that is being answered."""
LONGEST = 300
"""Characters of a value."""
SHELL = "(shell)"
"""The person behind the commands of a shell."""
FOLDER = "audit"
"""In the data folder; each process writes a file of its own there."""


def audit(act: str, *, ok: bool = True, person: str = "", **details: str | float | None) -> None:
    """Writes one line.

    Args:
        act: in a few words with hyphens, such as "sign-in" or "link-opened"; those of administrators begin with
            "admin-".
        ok: False where it was refused or failed.
        person: by default the person whose request or event this thread answers.
        details: further plain values. Give :func:`fingerprint` in place of anything that opens a door.
    """
    someone, somewhere, reference = _sender()
    line = {
        "act": act, "ok": ok, "person": person or someone, "address": somewhere, "request": reference,
        **{k: v[:LONGEST] if isinstance(v, str) else v for k, v in details.items() if v is not None},
    }  # fmt: skip
    _lines.info("audit", extra={"audit": line})


def fingerprint(secret: str) -> str:
    """Twelve characters that stand for a secret, so that lines about the same one can be told, and no more."""
    return hashlib.sha256(secret.encode()).hexdigest()[:12]


def _sender() -> tuple[str, str, str]:
    """The person, the address and the id of the request that this thread answers."""
    event = LocalContext.request.get(None)
    client = getattr(
        getattr(event, "request", None), "client", None
    )  # an event of the page, perhaps in a queue
    if client is not None:
        who = visitor()
        return who.account or who.person, client.host, who.reference
    return *SENDER.get(), REFERENCE.get()


class _AuditLines(logging.Formatter):
    def format(self, record: logging.LogRecord) -> str:
        moment = f"{time.strftime('%Y-%m-%dT%H:%M:%S', time.gmtime(record.created))}.{int(record.msecs):03d}Z"
        return json.dumps({"time": moment, **getattr(record, "audit", {})}, ensure_ascii=True, default=str)


class _PrivateFile(RotatingFileHandler):
    """A rotated file that only its owner reads. A full disk loses lines, and says so in the ordinary log."""

    def _open(self) -> Any:
        return open(
            self.baseFilename, "a", encoding="utf-8", opener=lambda p, flags: os.open(p, flags, 0o600)
        )

    def handleError(self, record: logging.LogRecord) -> None:  # noqa: N802  # logging's own name
        log.error("A line of the audit log could not be written.", exc_info=True)


def set_up_audit(where: str, data: Path, node: str, *, megabytes: float, files: int) -> None:
    """Sends the lines of this process where the settings say.

    Args:
        where: "file", "log" (stderr, among the other lines) or "off".
        data: the data folder.
        node: this process's own name.
        megabytes: size at which a file is put aside.
        files: earlier files that are kept.

    Raises:
        InputError: if the file cannot be written.
    """
    _close()
    _lines.propagate = where == "log"
    _lines.setLevel(logging.CRITICAL if where == "off" else logging.INFO)
    if where != "file":
        return
    folder = data / FOLDER
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        handler = _PrivateFile(
            folder / f"{quote(node, safe='')}.jsonl", maxBytes=round(megabytes * 2**20), backupCount=files
        )
    except OSError as error:
        raise InputError(
            f"The audit log in {folder} cannot be written ({error.strerror}): "
            "make the folder writable, or set PASDEDEUX_AUDIT=log."
        ) from None
    handler.setFormatter(_AuditLines())
    _lines.addHandler(handler)


@contextmanager
def audited_shell(settings: Settings) -> Iterator[None]:
    """Writes what a command does until its end as the server would, as the person :data:`SHELL`.

    Raises:
        InputError: if the file cannot be written.
    """
    set_up_audit(
        settings.audit, settings.data, "shell", megabytes=settings.audit_megabytes, files=settings.audit_files
    )
    if settings.audit == "log":  # a command sets up no logs
        handler = logging.StreamHandler(sys.stderr)
        handler.setFormatter(_AuditLines())
        _lines.addHandler(handler)
    token = SENDER.set((SHELL, ""))
    try:
        yield
    finally:
        SENDER.reset(token)
        _close()


def _close() -> None:
    for handler in list(_lines.handlers):
        _lines.removeHandler(handler)
        handler.close()


def audited(data: Path, most: int) -> list[dict[str, Any]]:
    """The latest lines of all processes, newest first; lines that cannot be read are left out."""
    files = sorted(
        (data / FOLDER).glob("*.jsonl*"), key=lambda path: int(path.suffix[1:].replace("jsonl", "0"))
    )
    lines = [line for path in files for line in _lines_of(path, most)]  # of one moment: the newest first
    return sorted(lines, key=lambda line: str(line.get("time")), reverse=True)[:most]


def _lines_of(path: Path, most: int) -> Iterator[dict[str, Any]]:
    try:
        with open(path, "rb") as file:
            file.seek(max(0, path.stat().st_size - most * 1000))
            last = file.read().splitlines()[: -most - 1 : -1]
    except OSError:
        return
    for line in last:
        try:
            found = json.loads(line)
        except ValueError:  # cut off where the reading began
            continue
        if isinstance(found, dict):
            yield found

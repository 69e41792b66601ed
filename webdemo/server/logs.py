"""Logs as one JSON object a line, without what people wrote or uploaded unless the settings ask for it."""

from __future__ import annotations

import json
import logging
import sys
import time
import traceback
from contextvars import ContextVar
from typing import Any

REFERENCE: ContextVar[str] = ContextVar("reference", default="")
"""Id of the request that is being answered; every line written meanwhile holds it."""

_PLAIN = set(vars(logging.makeLogRecord({}))) | {"message", "asctime", "taskName", "color_message"}
_OURS = ("webdemo", "uvicorn")


class JsonLines(logging.Formatter):
    """Formats a record as JSON: a line break or quote in a value cannot begin a line of its own.

    Args:
        content: also write what other programs' messages and an error's text say, which may quote a prompt.
    """

    def __init__(self, *, content: bool = False) -> None:
        super().__init__()
        self.content = content

    def format(self, record: logging.LogRecord) -> str:
        """The record as one line of JSON."""
        ours = record.name.partition(".")[0] in _OURS
        line: dict[str, Any] = {
            "time": time.strftime("%Y-%m-%dT%H:%M:%S", time.gmtime(record.created)) + f".{int(record.msecs):03d}Z",
            "level": record.levelname.lower(),
            "logger": record.name,
            # Another package's message may quote what a user sent; its template does not.
            "message": record.getMessage() if ours or self.content else str(record.msg),
        }
        if reference := REFERENCE.get():
            line["request"] = reference
        line |= {name: value for name, value in vars(record).items() if name not in _PLAIN}
        if record.exc_info and record.exc_info[0] is not None:
            line["error"] = record.exc_info[0].__name__
            # Where it happened, without the source lines and the values that an error's text may quote.
            line["where"] = [
                f"{frame.filename}:{frame.lineno} {frame.name}"
                for frame in traceback.extract_tb(record.exc_info[2])[-12:]
            ]
            if self.content:
                line["error_text"] = str(record.exc_info[1])
        return json.dumps(line, ensure_ascii=True, default=str)


def log_instead_of_printing(limit: Any = None, file: Any = None, chain: bool = True) -> None:
    """Stands for :func:`traceback.print_exc`, by which Gradio prints an error with what the user had sent."""
    if file is not None:
        traceback.print_exception(*sys.exc_info(), limit=limit, file=file, chain=chain)
    else:
        logging.getLogger("webdemo.gradio").error("An event failed.", exc_info=True)


def set_up_logs(level: str, *, content: bool) -> None:
    """Sends all logs to stderr as JSON lines, and what libraries would print of errors as well."""
    traceback.print_exc = log_instead_of_printing
    handler = logging.StreamHandler(sys.stderr)
    handler.setFormatter(JsonLines(content=content))
    root = logging.getLogger()
    root.handlers[:] = [handler]
    root.setLevel("WARNING" if level == "info" else level.upper())
    for name in _OURS:
        logger = logging.getLogger(name)
        logger.handlers.clear()
        logger.propagate = True
        logger.setLevel(level.upper())

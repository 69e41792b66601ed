"""The shared inference layer: requests, the engine that runs them, results.

Importing this package imports no torch; :class:`Engine` does when it is first asked for.
"""

from typing import TYPE_CHECKING, Any

from .requests import GenerateRequest, ReactRequest
from .requests.predict import PredictRequest, PredictResult
from .run import Cancelled, CancelToken, Progress, Result
from .story.request import SceneRequest

if TYPE_CHECKING:
    from .engine import Engine

__all__ = [
    "CancelToken",
    "Cancelled",
    "Engine",
    "GenerateRequest",
    "PredictRequest",
    "PredictResult",
    "Progress",
    "ReactRequest",
    "Result",
    "SceneRequest",
]


def __getattr__(name: str) -> Any:
    if name == "Engine":
        from .engine import Engine

        return Engine
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")

"""What may be asked of the :class:`~webdemo.inference.engine.Engine`.

These dataclasses import no torch, so the page, the shell and the API build them before any network loads.
"""

from .sampling import GenerateRequest, ReactRequest, SamplingRequest

__all__ = ["GenerateRequest", "ReactRequest", "SamplingRequest"]

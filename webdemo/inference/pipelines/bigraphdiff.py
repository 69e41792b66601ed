"""The shipped BiGraphDiff: generates two people from the name of a class."""

from __future__ import annotations

from pathlib import Path

import torch

from models.bigraphdiff.compact import CompactBiGraphDiff, load_folder
from motion import InputError
from webdemo.inference.requests import GenerateRequest, ReactRequest

from .two_person import Conditioning, TwoPersonPipeline


class BiGraphDiffPipeline(TwoPersonPipeline[CompactBiGraphDiff]):
    """The compact BiGraphDiff, for which a request's prompt is the name of a class.

    Raises WeightsError (an InputError) if files are missing or altered.
    """

    def __init__(self, folder: Path) -> None:
        model, source = load_folder(folder)
        super().__init__(source, model)

    def conditioning(self, request: GenerateRequest | ReactRequest) -> Conditioning:
        """The class' vector and touch; raises InputError for a class that is not known."""
        labels = self.model.config.labels
        known = {label.casefold(): label for label in labels}
        label = known.get(" ".join(request.prompt.split()).casefold())
        if label is None:
            raise InputError(f"There is no class {request.prompt.strip()!r:.60}: choose one of: {'; '.join(labels)}.")
        with torch.no_grad():
            condition = self.model.condition([label])
        return Conditioning(condition, request.guidance, self.model.touches(label))

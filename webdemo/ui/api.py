"""The page's endpoints for programs."""

from __future__ import annotations

import uuid

import gradio as gr

from webdemo.inference.requests import Cancelled, GenerateRequest, Result

from .context import PageContext
from .exports import write_files
from .words import error_line


class GenerateEndpoint:
    """``/generate``: text → motion files.

    Args:
        page: what tabs and endpoints share.
    """

    def __init__(self, page: PageContext) -> None:
        self.page = page

    def publish(self) -> None:
        """Adds the endpoint to the page that is being built."""
        gr.api(self.generate, api_name="generate", concurrency_limit=None)

    def generate(
        self,
        prompt: str,
        seconds: float = 5.0,
        seed: int = 0,
        samples: int = 1,
        guidance: float = 2.5,
        steps: int = 50,
        damping: float = 0.7,
        sampler: str = "ddim",
    ) -> tuple[dict, list[gr.FileData]]:
        """Two people from one sentence.

        prompt: what the two people do, in English, up to 500 characters.
        seconds: length of the motion, 1 to 10.
        seed: 0 to 4294967295; the same request with the same seed gives the same motion.
        samples: how many motions to draw, 1 to 8.
        guidance: scale of classifier-free guidance, 0 to 10; 1 is none.
        steps: denoising steps, 1 to 1000.
        damping: threshold as a fraction of the diffusion's T, 0 to 1; 0 is the plain sampler.
        sampler: "ddim" or "dpm++".

        Returns a dictionary with manifest, readouts, timings, notes and the names of the files by kind; and
        the files: for every sample a two-person .npz, two .bvh (and .glb where installed), a contact sheet
        .png, and one manifest .json. Errors are one sentence that says what to change.
        """
        try:
            request = GenerateRequest(
                prompt=prompt, seconds=seconds, seed=seed, samples=samples, guidance=guidance, steps=steps,
                damping=damping, sampler=sampler,
            )  # fmt: skip
            result = self._run(request)
            files = write_files(result, self.page.shelf.folder(), prompt=prompt)
        except Cancelled:
            raise gr.Error("The run was cancelled: send the request again.", print_exception=False) from None
        except Exception as error:
            raise gr.Error(error_line(error), print_exception=False) from None
        answer = {
            "manifest": result.manifest,
            "readouts": list(result.readouts),
            "timings": result.timings,
            "notes": list(result.notes),
            "files": {key: [path.name for path in paths] for key, paths in files.items()},
        }
        return answer, [gr.FileData(path=str(path)) for paths in files.values() for path in paths]

    def _run(self, request: GenerateRequest) -> Result:
        for event in self.page.runs.run(f"api-{uuid.uuid4().hex}", request):
            if isinstance(event, Result):
                return event
        raise Cancelled("The run ended without a result.")

"""The page's endpoints for programs."""

from __future__ import annotations

import uuid
from typing import Any

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
        """Adds the endpoint to the page that is being built.

        Its components are never shown. They are here because they, unlike ``gr.api``, hand files over to a
        client on another machine; their limits are the request's, so that every error is its sentence.
        """
        start = GenerateRequest(prompt="-")
        with gr.Row(visible=False):
            inputs = [
                gr.Textbox(label="what the two people do, in English, up to 500 characters"),
                gr.Number(start.seconds, label="length of the motion in seconds, 1 to 10"),
                gr.Number(start.seed, label="0 to 4294967295; the same seed gives the same motion"),
                gr.Number(start.samples, label="how many motions to draw, 1 to 8"),
                gr.Number(start.guidance, label="scale of classifier-free guidance, 0 to 10; 1 is none"),
                gr.Number(start.steps, label="denoising steps, 1 to 1000"),
                gr.Number(start.damping, label="damping threshold as a share of T, 0 to 1; 0 is none"),
                gr.Textbox(start.sampler, label="ddim or dpm++"),
            ]  # fmt: skip
            outputs = [
                gr.JSON(label="result: manifest, readouts, timings, notes, names of files"),
                gr.File(label="the files", file_count="multiple"),
            ]
            trigger = gr.Button()
        trigger.click(
            self.generate,
            inputs=inputs,
            outputs=outputs,
            api_name="generate",
            concurrency_limit=None,  # runs wait in the line that they share with the page's
        )

    def generate(
        self,
        prompt: str,
        seconds: float,
        seed: float,
        samples: float,
        guidance: float,
        steps: float,
        damping: float,
        sampler: str,
    ) -> tuple[dict[str, Any], list[str]]:
        """Two people from one sentence.

        Returns the manifest, read-outs, timings, notes and file names; and the files: for every sample a
        two-person .npz, two .bvh (and a .glb where the server writes them), a contact sheet .png, and one
        manifest .json. An error is one sentence that says what to change.
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
        return answer, [str(path) for paths in files.values() for path in paths]

    def _run(self, request: GenerateRequest) -> Result:
        for event in self.page.runs.run(f"api-{uuid.uuid4().hex}", request):
            if isinstance(event, Result):
                return event
        raise Cancelled("The run ended without a result.")

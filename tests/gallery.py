"""Makes the thumbnails of the drawer's examples anew with the shipped networks: ``python -m tests.gallery``."""

from __future__ import annotations

import json

from webdemo.inference import Engine, GenerateRequest
from webdemo.inference.run import Result
from webdemo.ui.components.gallery import Gallery
from webdemo.view.thumbnail import thumbnail

SCENES = Gallery.template.with_name("scenes.json")


def main() -> None:
    """Writes ``static/gallery/scenes.json``, a scene a line."""
    engine, lines = Engine(), []
    for scene in json.loads(SCENES.read_text(encoding="utf-8"))["scenes"]:
        asked = GenerateRequest(prompt=scene["prompt"], seconds=scene["seconds"], seed=scene["seed"])
        *_, result = engine.run(asked)
        assert isinstance(result, Result)
        lines.append(json.dumps(scene | {"thumbnail": thumbnail(result.duets[0])}, ensure_ascii=False))
    SCENES.write_text('{"scenes": [\n' + ",\n".join(lines) + "\n]}\n", encoding="utf-8")


if __name__ == "__main__":
    main()

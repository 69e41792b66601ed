"""Makes ``static/camera/mediapipe/pose_landmarker_lite.task``: ``python -m training.pose_task --wheel W --pose P``.

npm ``@mediapipe/tasks-vision`` reads a pose detector and a landmark network from one bundle, with metadata on how a
picture becomes their input. The networks are inside the wheel of PyPI ``mediapipe`` 0.10.21 (``pip download --no-deps
--python-version 3.12 --only-binary :all: mediapipe==0.10.21``) and the archive of npm ``@mediapipe/pose``
0.5.1675469404 (``npm pack``). It needs ``mediapipe`` 0.10.21 itself (Python 3.12 or older), for its metadata writer.
"""

from __future__ import annotations

import argparse
import tarfile
import zipfile
from collections.abc import Sequence
from pathlib import Path

from motion.formats.files import replacing

OUT = Path(__file__).resolve().parents[1] / "static" / "camera" / "mediapipe" / "pose_landmarker_lite.task"
DETECTOR = "mediapipe/modules/pose_detection/pose_detection.tflite"
LANDMARKS = "package/pose_landmark_lite.tflite"


def with_input(network: bytes, *, mean: float, deviation: float) -> bytes:
    """A network with metadata that says: the input is a picture, of which ``mean`` is taken and divided."""
    from mediapipe.tasks.metadata import schema_py_generated
    from mediapipe.tasks.python.metadata.metadata_writers import metadata_writer

    writer = metadata_writer.MetadataWriter.create(bytearray(network))
    writer.add_image_input([mean], [deviation])
    outputs = schema_py_generated.Model.GetRootAsModel(network, 0).Subgraphs(0).OutputsLength()
    for number in range(outputs):
        writer.add_feature_output(
            f"o{number}", "x"
        )  # names that nobody reads, but one for each output is needed
    made, _ = writer.populate()
    return bytes(made)


def make(wheel: Path, pose: Path, out: Path = OUT) -> Path:
    """Writes the bundle.

    Args:
        wheel: of PyPI ``mediapipe`` 0.10.21.
        pose: archive of npm ``@mediapipe/pose``.
        out: the file to write.
    """
    from mediapipe.tasks.python.metadata.metadata_writers import model_asset_bundle_utils

    with zipfile.ZipFile(wheel) as archive:
        detector = archive.read(DETECTOR)
    with tarfile.open(pose) as archive:
        landmarks = archive.extractfile(LANDMARKS).read()  # type: ignore[union-attr]
    networks = {
        "pose_detector.tflite": with_input(detector, mean=127.5, deviation=127.5),
        "pose_landmarks_detector.tflite": with_input(landmarks, mean=0.0, deviation=255.0),
    }
    with replacing(out) as temporary:
        model_asset_bundle_utils.create_model_asset_bundle(networks, str(temporary))
    return out


def main(argv: Sequence[str] | None = None) -> None:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--wheel", type=Path, required=True, help="mediapipe-0.10.21-….whl")
    parser.add_argument("--pose", type=Path, required=True, help="mediapipe-pose-0.5.1675469404.tgz")
    parser.add_argument("--out", type=Path, default=OUT)
    given = parser.parse_args(argv)
    print(make(given.wheel, given.pose, given.out))


if __name__ == "__main__":
    main()

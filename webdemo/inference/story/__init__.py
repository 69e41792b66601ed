"""A story of two people: beats along a time line, paths, poses, and the request that turns it into motion.

Importing this package imports no torch.
"""

from webdemo.inference.requests.paths import FloorPath, FloorPoint

from .beats import Beat
from .poses import Pose
from .request import SceneProgress, SceneRequest
from .sentences import in_time, split_sentence
from .toml import read_story, read_words

__all__ = [
    "Beat",
    "FloorPath",
    "FloorPoint",
    "Pose",
    "SceneProgress",
    "SceneRequest",
    "in_time",
    "read_story",
    "read_words",
    "split_sentence",
]

"""Motion of people: skeletons, clips of one person, duets of two, and the geometry on them.

This package stands on nothing else of the project and imports no torch.
"""

from .clip import FPS, Clip, Duet, stacked_positions
from .errors import InputError
from .skeleton import SKELETONS, SMPL22, Skeleton

__all__ = ["FPS", "SKELETONS", "SMPL22", "Clip", "Duet", "InputError", "Skeleton", "stacked_positions"]

"""The used parts of free one-person clips, and their actions; those of the larger sets are listed in ``cuts.toml``.

Mesh2Motion's clips are animated by hand: their shapes are good, their timing is ideal, so they are smoothed
and slowed to what a body does (:func:`humanly`). The other sets are recordings.
"""

from __future__ import annotations

import lzma
import tarfile
import tomllib
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d

from motion import InputError
from motion.cleaning import foot_contacts, plant_feet
from motion.formats.bvh import read_bvh
from motion.formats.glb_motion import animations_in, read_glb_people
from motion.kinematics import project_to_skeleton
from motion.retarget import retarget
from motion.rigs import RigMotion
from motion.skeleton import SMPL22
from motion.transforms import resample

from .deepmimic import read_deepmimic

Array = NDArray[np.floating]

ANIMATED = "mesh2motion"
"""The data set whose clips are animated by hand."""
MOST_SPEED, MOST_ACCELERATION = 6.5, 150.0
"""What a wrist or ankle of a made clip may reach, in metres a second and metres a second squared: recorded
gestures, jumps and dances of the other sets stay below it."""


@dataclass(frozen=True)
class Cut:
    """A part of a file.

    Attributes:
        clip: the file's stem, or the animation's name in a .glb.
        action, side: as in :class:`training.corpus.scene.SourceClip`; side None where none leads.
        start, stop: seconds, ``stop`` 0 for the end.
        style: the actor's manner.
        backwards: played from its end, as one lies down who was recorded getting up.
    """

    clip: str
    action: str
    side: str | None = None
    start: float = 0.0
    stop: float = 0.0
    style: str = "normal"
    backwards: bool = False


CUTS: dict[str, tuple[Cut, ...]] = {
    "mesh2motion": (
        Cut("Sitting_Enter", "sit-down"),
        Cut("Sitting_Idle_Loop", "sitting"),
        Cut("Sitting_Talking_Loop", "sitting-talk"),
        Cut("Sitting_Exit", "stand-up"),
        Cut("Idle_Talking_Loop", "talking"),
        Cut("Fixing_Kneeling", "kneel"),
        Cut("Death01", "fall"),
        Cut("PickUp_Table", "pick-up-table", "left"),
        Cut("Interact", "reach-out", "left"),
        Cut("Angry", "rage"),
        Cut("Bow", "bow-hand"),
        Cut("Confused", "scratch-head", "right"),
        Cut("Consume Item", "drink", "left"),
        Cut("Dance Body Roll", "dance-show"),
        Cut("Dance Charleston", "dance-show"),
        Cut("Dance Reach Hip", "dance-show"),
        Cut("Defend", "guard"),
        Cut("Greeting", "greet", "right"),
        Cut("Jumping Jacks", "jumping-jacks"),
        Cut("Pushup", "push-up"),
        Cut("Crawl RM", "crawl-low"),
        Cut("Reject", "reject", "right"),
        Cut("Throw Object", "throw", "right"),
        Cut("Victory", "victory"),
        Cut("Victory Fist Pump", "fist-pump", "right"),
        Cut("Meditate", "meditate"),
        Cut("Kneeling Tired", "kneel-tired"),
    ),
    "deepmimic": (
        Cut("humanoid3d_crawl", "crawl"),
        Cut("humanoid3d_roll", "roll"),
        Cut("humanoid3d_getup_facedown", "get-up-front"),
        Cut("humanoid3d_getup_facedown", "lie-down-front", backwards=True),
        Cut("humanoid3d_getup_faceup", "get-up-back"),
        Cut("humanoid3d_getup_faceup", "lie-down-back", backwards=True, start=1.5),
        Cut("humanoid3d_jump", "jump"),
        Cut("humanoid3d_cartwheel", "cartwheel"),
        Cut("humanoid3d_backflip", "backflip"),
        Cut("humanoid3d_spin", "spin-leap"),
        Cut("humanoid3d_spinkick", "spin-kick"),
        Cut("humanoid3d_dance_a", "dance-show"),
        Cut("humanoid3d_dance_b", "dance-show"),
        Cut("humanoid3d_long_zombie", "zombie"),
        Cut("humanoid3d_stealthy_walk0", "sneak"),
        Cut("humanoid3d_stealthy_walk1", "sneak"),
    ),
    "cmu-iclone": (
        Cut("001_01", "jump", start=5.0, stop=11.0),
        Cut("002_04", "jump", stop=3.6),
        Cut("002_05", "shadow-box", start=0.5),
        Cut("002_06", "pick-up", start=0.8, stop=9.0),
        Cut("002_06", "pick-up", start=9.6, stop=17.5),
        Cut("002_10", "wash", start=1.0),
        Cut("002_01", "walk"),
        Cut("002_02", "walk"),
        Cut("005_01", "walk"),
        Cut("006_01", "walk"),
        *(Cut(f"007_{number:02}", "walk") for number in (1, 2, 3, 6, 7, 8, 9, 10, 11)),
        Cut("007_04", "walk", style="slow"),
        Cut("007_05", "walk", style="slow"),
        Cut("007_12", "walk", style="brisk"),
        Cut("005_02", "ballet"),
        Cut("005_03", "ballet"),
        Cut("005_04", "ballet", start=5.0),
        Cut("005_07", "ballet"),
        Cut("005_09", "ballet"),
        Cut("005_12", "ballet"),
        Cut("005_13", "ballet"),
        Cut("006_14", "basketball"),
        Cut("006_15", "basketball"),
    ),
    "perfume": (Cut("A_test", "formation-a"), Cut("B_test", "formation-b"), Cut("C_test", "formation-c")),
}
_LISTED = tomllib.loads(Path(__file__).with_name("cuts.toml").read_text(encoding="utf-8"))
CUTS |= {dataset: tuple(Cut(**cut) for cut in listed["cuts"]) for dataset, listed in _LISTED.items()}
_TIPS = [SMPL22.index(f"{side}_{joint}") for side in ("left", "right") for joint in ("wrist", "ankle")]


def read_vocabulary(root: Path, *, fps: float = 30.0) -> Iterator[tuple[tuple[str, str, str | None, str, str], Array]]:
    """((action, style, side, source, dataset), (T, 22, 3) metres) of every cut whose file is there.

    Files that are missing or unreadable are left out; :func:`training.corpus.sources.load_sources` says so.
    """
    for dataset, cuts in CUTS.items():
        clips = _clips(root / dataset, dataset, {cut.clip for cut in cuts})
        for cut in cuts:
            rig = clips.get(cut.clip)
            if rig is None:
                continue
            positions = retarget(rig, fps=fps).positions.astype(np.float64)
            start, stop = round(cut.start * fps), round(cut.stop * fps) or len(positions)
            positions = positions[start:stop]
            if cut.backwards:
                positions = positions[::-1]
            if dataset == ANIMATED:
                positions = humanly(positions, fps)
            source = f"{dataset}_{cut.clip.replace(' ', '-')}"
            yield (cut.action, cut.style, cut.side, source, dataset), positions


def files(root: Path) -> list[Path]:
    """The files below a data folder that :func:`read_vocabulary` reads; of a set that is still packed, its archives."""
    return [
        path
        for dataset in CUTS
        for path in _clip_files(root / dataset, dataset) or sorted((root / dataset).glob("*.tar.xz"))
    ]


def _clip_files(folder: Path, dataset: str) -> list[Path]:
    suffixes = {"mesh2motion": "*-animations.glb", "deepmimic": "*.txt"}
    return sorted(folder.rglob(suffixes.get(dataset, "*.bvh")))


def _clips(folder: Path, dataset: str, wanted: set[str]) -> dict[str, RigMotion]:
    """The rigs of a data set's files by clip; a file that cannot be read is as good as missing."""
    found: dict[str, RigMotion] = {}
    with unpacked(folder, dataset) as place:
        for path in _clip_files(place, dataset):
            try:
                if dataset == "mesh2motion":
                    for name in wanted & set(animations_in(path).names):
                        found[name] = upright(read_glb_people(path, animation=name)[0])
                elif path.stem in wanted and dataset == "deepmimic":
                    found[path.stem] = read_deepmimic(path.read_bytes(), name=path.name)
                elif path.stem in wanted:
                    rig = without_first(read_bvh(path))
                    found[path.stem] = upright(rig) if dataset in _LISTED else rig
            except InputError:
                continue
    return found


@contextmanager
def unpacked(folder: Path, dataset: str) -> Iterator[Path]:
    """The folder of a data set, or one with the files of its ``.tar.xz`` archives for as long as they are read."""
    archives = [] if _clip_files(folder, dataset) else sorted(folder.glob("*.tar.xz"))
    if not archives:
        yield folder
        return
    with TemporaryDirectory() as place:
        for archive in archives:
            try:
                with tarfile.open(archive, "r:xz") as packed:
                    packed.extractall(place, filter="data")
            except (tarfile.TarError, lzma.LZMAError, EOFError, OSError):
                continue
        yield Path(place)


def upright(rig: RigMotion) -> RigMotion:
    """The rig with Y up, which nobody has to guess where a body lies or crawls all the time."""
    return replace(rig, up="y")


def without_first(rig: RigMotion) -> RigMotion:
    """Without the T-pose in the first frame."""
    return replace(rig, positions=rig.positions[1:])


def humanly(positions: Array, fps: float = 30.0) -> Array:
    """A made clip (T, 22, 3) as a body could move: corners rounded, and slowed as a whole where it is too
    fast (:data:`MOST_SPEED`, :data:`MOST_ACCELERATION` of wrists and ankles against the pelvis)."""
    smooth = project_to_skeleton(gaussian_filter1d(positions, 1.2, axis=0, mode="nearest"))[0]
    tips = smooth[:, _TIPS] - smooth[:, :1]
    speed = np.linalg.norm(np.diff(tips, axis=0), axis=-1).max(initial=0.0) * fps
    push = np.linalg.norm(np.diff(tips, n=2, axis=0), axis=-1).max(initial=0.0) * fps**2
    slow = max(1.0, speed / MOST_SPEED, float(np.sqrt(push / MOST_ACCELERATION)))
    if slow > 1.0:
        smooth = project_to_skeleton(resample(smooth, fps, fps * slow))[0]
    return project_to_skeleton(plant_feet(smooth, foot_contacts(smooth, fps, speed=0.25)))[0]

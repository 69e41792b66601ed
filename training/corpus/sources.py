"""The single-person recordings that the corpus is made of, on one skeleton, read once and cached.

Each data set is a folder below the data folder, unpacked or as ``.tar.xz`` archives. The files of :data:`NAMED` say in
their names what they show; of the other sets ``cuts.toml`` lists the parts that are used. Mesh2Motion's clips are
animated by hand: their shapes are good, their timing is ideal, so they are smoothed and slowed to what a body does
(:func:`humanly`).
"""

from __future__ import annotations

import hashlib
import json
import logging
import lzma
import os
import re
import tarfile
import tomllib
import zipfile
from collections import defaultdict
from collections.abc import Callable, Collection, Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass, replace
from pathlib import Path, PurePosixPath
from tempfile import TemporaryDirectory
from typing import Any, TypeVar

import numpy as np
from scipy.ndimage import gaussian_filter1d
from scipy.spatial.transform import Rotation, Slerp

from motion import FPS, InputError
from motion.cleaning import foot_contacts, plant_feet
from motion.formats.bvh import read_bvh
from motion.formats.files import replacing
from motion.formats.glb_motion import animations_in, read_glb
from motion.kinematics import forward_kinematics, project_to_skeleton
from motion.retarget import retarget
from motion.rigs import RigMotion
from motion.skeleton import SMPL22, Skeleton
from motion.transforms import canonicalize, resample
from motion.vectors import Array

from .cues import SourceClip

Described = tuple[str, str, str | None, str, str]
"""Action, style, side, source and data set of a recording, as in :class:`SourceClip`."""
logger = logging.getLogger(__name__)

MAX_FRAMES = 600
TEST_SHARE = 0.08
MIN_CLIPS_FOR_TEST = 6
_CACHE_VERSION = 10  # raise when the reader or the retargeting changes its results

NAMED = ("bandai-namco", "reactidle")
ANIMATED = "mesh2motion"
FILES = {ANIMATED: "*-animations.glb", "deepmimic": "*.txt"}
"""Pattern of the files of a data set that is not in BVH."""
MOST_SPEED, MOST_ACCELERATION = 6.5, 150.0
"""What a wrist or ankle of a made clip may reach, in metres a second and metres a second squared: recorded
gestures, jumps and dances of the other sets stay below it."""
_TIPS = [SMPL22.index(f"{side}_{joint}") for side in ("left", "right") for joint in ("wrist", "ankle")]
_ACTIONS = {"byebye": "bye", "dance-short": "dance"}
_STYLES = {"masculinity": "masculine", "acted": "normal", "genuine": "normal"}
_SIDED = re.compile(r"(wave|raise-up|walk-turn)-(left|right|both)(?:-hands?)?")


@dataclass(frozen=True)
class Cut:
    """A part of a file.

    Attributes:
        clip: the file's stem, or the animation's name in a .glb.
        action, side: as in :class:`training.corpus.cues.SourceClip`; side None where none leads.
        start, stop: seconds, ``stop`` 0 for the end.
        style: the actor's manner.
        backwards: played from its end.
    """

    clip: str
    action: str
    side: str | None = None
    start: float = 0.0
    stop: float = 0.0
    style: str = "normal"
    backwards: bool = False

    def described(self, dataset: str) -> Described:
        """What it shows."""
        return self.action, self.style, self.side, f"{dataset}_{self.clip.replace(' ', '-')}", dataset

    def of(self, positions: Array, dataset: str) -> Array:
        """The part of a whole file's positions (T, 22, 3)."""
        positions = positions[round(self.start * FPS) : round(self.stop * FPS) or None][:: -1 if self.backwards else 1]
        return humanly(positions) if dataset == ANIMATED else positions


_LISTED = tomllib.loads(Path(__file__).with_name("cuts.toml").read_text(encoding="utf-8"))
CUTS = {dataset: tuple(Cut(**cut) for cut in listed["cuts"]) for dataset, listed in _LISTED.items()}


def load_sources(data_dir: str | Path, *, cache_dir: str | Path | None = None) -> list[SourceClip]:
    """All usable recordings below a data folder.

    Clips longer than 20 s are cut into equal pieces that share their source. Files that cannot be read,
    hold NaN or a single frame are left out and counted in the log. About 8 % of the sources of every action
    and side are the test split, chosen by the hash of their names; the few recordings of an action with fewer
    than six belong to ``both`` splits, so that no action is without a test scene.

    Args:
        data_dir: the folder of the data sets; those that are missing are left out.
        cache_dir: where the read clips are kept; by default ``~/.cache/pas-de-deux``.

    Raises:
        InputError: where the folder holds no recordings, a damaged archive or mostly damaged recordings.
    """
    root = Path(data_dir)
    sets = [root / dataset for dataset in (*NAMED, *CUTS)]
    files = [path for folder in sets for path in _files(folder) or sorted(folder.glob("*.tar.xz"))]
    if not files:
        raise InputError(f"{root} holds no motion recordings: put {' or '.join(NAMED)} there, or their .tar.xz.")
    cache = Path(cache_dir or Path(os.environ.get("XDG_CACHE_HOME", "~/.cache")).expanduser() / "pas-de-deux")
    state = [(path.relative_to(root).as_posix(), path.stat().st_size, path.stat().st_mtime_ns) for path in files]
    digest = hashlib.sha256(json.dumps([_CACHE_VERSION, repr(CUTS), state]).encode()).hexdigest()[:16]
    return kept(cache / f"sources-{digest}.npz", SourceClip, lambda: _read(root))


def _read(root: Path) -> list[SourceClip]:
    """All usable recordings below a data folder."""
    read = sorted(_read_all(root), key=lambda item: item[0][3])
    if not read:
        raise InputError(f"No recording in {root} can be read: unpack its archives again.")
    splits = _splits([described for described, _ in read])
    return [
        SourceClip(canonicalize(piece).astype(np.float32), *described, splits[described[3]])
        for described, positions in read
        for piece in np.array_split(positions, -(-len(positions) // MAX_FRAMES))
    ]


def describe_source(name: str) -> Described:
    """What a recording of :data:`NAMED` shows, from its path.

    >>> describe_source("data/dataset-2_wave-left-hand_active_003.bvh")
    ('wave', 'active', 'left', 'dataset-2_wave-left-hand_active_003', 'bandai-namco-2')
    """
    stem = PurePosixPath(name).stem
    match = re.fullmatch(r"dataset-(\d)_([a-z-]+)_([a-z-]+)_(\d+)", stem)
    if match is None:
        return "idle", "normal", None, f"reactidle_{stem}", "reactidle"
    content, style = match[2], _STYLES.get(match[3], match[3])
    action, side = _ACTIONS.get(content, content), None
    if sided := _SIDED.fullmatch(content):
        action, side = {"raise-up": "raise-hand"}.get(sided[1], sided[1]), sided[2]
    elif content in ("walk-left", "walk-right"):
        side = content.removeprefix("walk-")
    return action, style, side, stem, f"bandai-namco-{match[1]}"


def _files(folder: Path, pattern: str | None = None) -> list[Path]:
    """The files of a data set's unpacked folder."""
    return sorted(folder.rglob(pattern or FILES.get(folder.name, "*.bvh")))


@contextmanager
def unpacked(folder: Path, pattern: str | None = None) -> Iterator[list[Path]]:
    """The files of a data set's folder, or of its ``.tar.xz`` archives for as long as they are read.

    Args:
        pattern: of the files' names, if not the one of :data:`FILES`.

    Raises:
        InputError: where an archive is damaged.
    """
    archives = [] if _files(folder, pattern) else sorted(folder.glob("*.tar.xz"))
    with TemporaryDirectory() as place:
        there = Path(place) / folder.name if archives else folder
        for archive in archives:
            try:
                with tarfile.open(archive, "r:xz") as packed:
                    packed.extractall(there, filter="data")
            except (tarfile.TarError, lzma.LZMAError, EOFError, OSError) as error:
                raise InputError(f"The archive {archive} is damaged ({error}): download it again.") from None
        yield _files(there, pattern)


def _read_all(root: Path) -> Iterator[tuple[Described, Array]]:
    """What each recording shows that is there and can be read, and (T, 22, 3) metres of it.

    Raises:
        InputError: where most recordings of :data:`NAMED` are damaged.
    """
    read, dropped = 0, dict[str, InputError]()
    for dataset in (*NAMED, *CUTS):
        cuts = defaultdict[str, list[Cut]](list)
        for cut in CUTS.get(dataset, ()):
            cuts[cut.clip].append(cut)
        with unpacked(root / dataset) as files:
            for path in files:
                try:
                    for clip, rig in _rigs(path, dataset, cuts):
                        positions = retarget(rig, fps=FPS).positions.astype(np.float64)
                        if len(positions) < 2:
                            raise InputError("It has a single frame.")
                        read += dataset in NAMED
                        if dataset in NAMED:
                            yield describe_source(path.name), positions
                        for cut in cuts[clip]:
                            yield cut.described(dataset), cut.of(positions, dataset)
                except InputError as error:
                    if dataset in NAMED:
                        dropped[path.name] = error
    if dropped:
        first, reason = next(iter(dropped.items()))
        said = f"{len(dropped)} of {len(dropped) + read} recordings were left out, the first {first}: {reason}"
        logger.warning(said)
        if len(dropped) > read:
            raise InputError(f"{said} Unpack or download the data again.")


def _rigs(path: Path, dataset: str, wanted: Collection[str]) -> Iterator[tuple[str, RigMotion]]:
    """The clips of a file that are wanted, Y up; all of :data:`NAMED`."""
    if dataset == ANIMATED:
        for name in set(wanted) & set(animations_in(path).names):
            yield name, replace(read_glb(path, animation=name)[0][0], up="y")
    elif dataset in NAMED:
        yield path.stem, read_bvh(path)[0]
    elif path.stem in wanted:
        yield path.stem, read_deepmimic(path.read_bytes(), name=path.name) if dataset in FILES else read_upright(path)


def read_upright(path: Path) -> RigMotion:
    """A BVH file of CMU or ACCAD without the T-pose in its first frame; Y is up, which nobody has to guess where a body
    lies or crawls all the time."""
    rig = read_bvh(path)[0]
    return replace(rig, positions=rig.positions[1:], up="y")


def humanly(positions: Array) -> Array:
    """A made clip (T, 22, 3) as a body could move: corners rounded, and slowed as a whole where it is too
    fast (:data:`MOST_SPEED`, :data:`MOST_ACCELERATION` of wrists and ankles against the pelvis)."""
    smooth = project_to_skeleton(gaussian_filter1d(positions, 1.2, axis=0, mode="nearest"))[0]
    tips = smooth[:, _TIPS] - smooth[:, :1]
    speed = np.linalg.norm(np.diff(tips, axis=0), axis=-1).max(initial=0.0) * FPS
    push = np.linalg.norm(np.diff(tips, n=2, axis=0), axis=-1).max(initial=0.0) * FPS**2
    slow = max(1.0, speed / MOST_SPEED, float(np.sqrt(push / MOST_ACCELERATION)))
    if slow > 1.0:
        smooth = project_to_skeleton(resample(smooth, FPS, FPS * slow))[0]
    return project_to_skeleton(plant_feet(smooth, foot_contacts(smooth, FPS, speed=0.25)))[0]


def _splits(described: list[Described]) -> dict[str, str]:
    """The split of every source: in each action and side those whose names hash lowest are for testing.

    Where there are fewer than :data:`MIN_CLIPS_FOR_TEST`, all are in ``both`` splits.
    """
    groups: dict[tuple[str, str | None], list[str]] = defaultdict(list)
    for action, _, side, source, _ in described:
        groups[action, side].append(source)
    splits = {}
    for sources in groups.values():
        ranked = sorted(set(sources), key=lambda source: hashlib.sha256(source.encode()).hexdigest())
        few, held_out = len(ranked) < MIN_CLIPS_FOR_TEST, max(1, round(TEST_SHARE * len(ranked)))
        splits |= {s: "both" if few else "test" if rank < held_out else "train" for rank, s in enumerate(ranked)}
    return splits


Clip = TypeVar("Clip")


def kept(path: Path, kind: Callable[..., Clip], make: Callable[[], list[Any]]) -> list[Clip]:
    """The clips that ``make`` gives, read from ``path`` where they were made before and the file is not damaged.

    Args:
        kind: their dataclass, with an array ``positions``; JSON can hold its other fields.
    """
    if path.exists():
        try:
            with np.load(path, allow_pickle=False) as stored:
                rows = json.loads(str(stored["rows"]))
                return [kind(positions=stored[str(number)], **row) for number, row in enumerate(rows)]
        except (zipfile.BadZipFile, EOFError, OSError, ValueError, KeyError, TypeError):
            logger.warning("%s is damaged; its clips are made again.", path)
    made = make()
    rows = [asdict(clip) for clip in made]
    arrays = {str(number): row.pop("positions") for number, row in enumerate(rows)}
    try:
        with replacing(path) as temporary, open(temporary, "wb") as file:
            np.savez(file, rows=np.array(json.dumps(rows)), **arrays)
    except InputError as error:
        logger.warning("The clips are made again next time: %s", error)
    return made


# ---- DeepMimic's clips (Peng et al. 2018): JSON rows of a root path and joint rotations ----------

_JOINTS = _LISTED["deepmimic"]["joints"]
WIDTH = 1 + 3 + sum(joint["width"] for joint in _JOINTS)


def read_deepmimic(data: bytes, *, name: str = "") -> RigMotion:
    """Reads one clip; knees and elbows are angles about the axis to the right, the rest quaternions w x y z.

    Raises:
        InputError: where the rows are not :data:`WIDTH` finite numbers each, with seconds above 0.
    """
    try:
        rows = np.array(json.loads(data)["Frames"], dtype=np.float64)
    except (ValueError, KeyError, TypeError, UnicodeDecodeError) as error:
        raise InputError(f"{name} is not a DeepMimic motion ({error}): it needs JSON with 'Frames'.") from error
    if rows.ndim != 2 or rows.shape[1] != WIDTH or len(rows) < 2 or not np.isfinite(rows).all():
        raise InputError(f"{name} is not a DeepMimic motion: it needs two rows or more of {WIDTH} numbers.")
    if not (rows[:-1, 0] > 0).all():
        raise InputError(f"{name} has a frame that lasts no time: give every row its seconds.")
    times = np.concatenate([[0.0], np.cumsum(rows[:-1, 0])])
    grid = np.minimum(np.arange(0.0, times[-1] + 1e-6, 1 / FPS), times[-1])
    root = np.stack([np.interp(grid, times, rows[:, column]) for column in (1, 2, 3)], axis=-1)
    names, parents, offsets, widths = (tuple(j[key] for j in _JOINTS) for key in ("name", "parent", "offset", "width"))
    rotations = np.tile(np.eye(3), (len(grid), len(names), 1, 1))
    for joint, part in enumerate(np.split(rows[:, 4:], np.cumsum(widths)[:-1], axis=1)):
        if widths[joint]:
            bent, turned = part[:, :1] * np.array([[0.0, 0.0, 1.0]]), np.roll(part, -1, axis=1)
            turn = Rotation.from_rotvec(bent) if widths[joint] == 1 else Rotation.from_quat(turned)
            rotations[:, joint] = Slerp(times, turn)(grid).as_matrix()
    body = Skeleton("deepmimic", names, parents, np.array(offsets))
    places = forward_kinematics(rotations, root, body)
    return RigMotion(names, parents, body.offsets, places, FPS, name=name, up="y")

"""The single-person recordings that the corpus is made of, on one skeleton, read once and cached.

The data folder holds ``bandai-namco/`` (Bandai Namco Research Motion datasets 1 and 2, CC BY-NC 4.0) and
``reactidle/`` (ReActIdle, MIT), each unpacked or as a ``.tar.xz``; archives are read in place. The sets of
:mod:`training.corpus.vocabulary` widen what a body can do, where they are there.
"""

from __future__ import annotations

import hashlib
import json
import logging
import lzma
import os
import re
import tarfile
import zipfile
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path, PurePosixPath

import numpy as np

from motion import InputError
from motion.formats.bvh import read_bvh
from motion.formats.files import replacing
from motion.retarget import retarget
from motion.transforms import canonicalize, heading

from . import vocabulary
from .scene import SourceClip

logger = logging.getLogger(__name__)

FPS = 30.0
MAX_FRAMES = 600
TEST_SHARE = 0.08
MIN_CLIPS_FOR_TEST = 6
_CACHE_VERSION = 8  # raise when the reader or the retargeting changes its results

_FOLDERS = ("bandai-namco", "reactidle")
_ACTIONS = {"byebye": "bye", "dance-short": "dance"}
_STYLES = {"masculinity": "masculine", "acted": "normal", "genuine": "normal"}
_SIDED = re.compile(r"(wave|raise-up|walk-turn)-(left|right|both)(?:-hands?)?")


def load_sources(data_dir: str | Path, *, cache_dir: str | Path | None = None) -> list[SourceClip]:
    """All usable recordings below a data folder.

    Clips longer than 20 s are cut into equal pieces that share their source. Files that cannot be read,
    hold NaN or a single frame are left out and counted in the log. About 8 % of the sources of every action
    and side are the test split, chosen by the hash of their names; the few recordings of an action with fewer
    than six belong to ``both`` splits, so that no family is without a test scene.

    Args:
        data_dir: the folder with ``bandai-namco`` and ``reactidle``; either may be missing, not both.
        cache_dir: where the read clips are kept; by default ``~/.cache/pas-de-deux``.

    Raises:
        InputError: where the folder is missing, holds no recordings or mostly damaged ones.
    """
    root = Path(data_dir)
    if not root.is_dir():
        raise InputError(f"The data folder {root} does not exist: give the folder that holds {' and '.join(_FOLDERS)}.")
    found = _find_files(root)
    free = vocabulary.files(root)
    if not found + free:
        raise InputError(
            f"{root} holds no motion recordings: put {' or '.join(_FOLDERS)} there (.bvh files or a .tar.xz)."
        )
    cache = _cache_path(root, found + free, cache_dir)
    if cache.exists():
        try:
            return _load_cache(cache)
        except (zipfile.BadZipFile, EOFError, OSError, ValueError, KeyError):
            logger.warning("The cache %s is damaged; the recordings are read again.", cache)
    clips = _read_all(root, found)
    if not clips:
        raise InputError(f"No recording in {root} can be read: unpack its archives again.")
    _save_cache(cache, clips)
    return clips


def describe_source(name: str) -> tuple[str, str, str | None, str, str]:
    """(action, style, side, source, dataset) from a recording's path.

    >>> describe_source("data/dataset-2_wave-left-hand_active_003.bvh")
    ('wave', 'active', 'left', 'dataset-2_wave-left-hand_active_003', 'bandai-namco-2')
    """
    path = PurePosixPath(name)
    match = re.fullmatch(r"dataset-(\d)_([a-z-]+)_([a-z-]+)_(\d+)", path.stem)
    if match:
        content, style = match[2], _STYLES.get(match[3], match[3])
        sided = _SIDED.fullmatch(content)
        if sided:
            action = {"raise-up": "raise-hand"}.get(sided[1], sided[1])
            return action, style, sided[2], path.stem, f"bandai-namco-{match[1]}"
        side = content.removeprefix("walk-") if content in ("walk-left", "walk-right") else None
        return _ACTIONS.get(content, content), style, side, path.stem, f"bandai-namco-{match[1]}"
    return "idle", "normal", None, f"reactidle_{path.stem}", "reactidle"


def _find_files(root: Path) -> list[Path]:
    files = []
    for folder in _FOLDERS:
        inside = sorted((root / folder).rglob("*.bvh")) if (root / folder).is_dir() else []
        files += inside or sorted((root / folder).glob("*.tar.xz"))
    return files


def _recordings(files: list[Path]) -> Iterator[tuple[str, bytes]]:
    """(name, bytes) of every .bvh, whether it lies in a folder or in an archive."""
    for path in files:
        if path.suffix == ".bvh":
            yield path.as_posix(), path.read_bytes()
            continue
        try:
            with tarfile.open(path, "r:xz") as archive:
                for member in archive:
                    if member.isfile() and member.name.endswith(".bvh"):
                        yield member.name, archive.extractfile(member).read()  # type: ignore[union-attr]
        except (tarfile.TarError, lzma.LZMAError, EOFError, OSError) as error:
            raise InputError(f"The archive {path} is damaged ({error}): download it again.") from None


def _read_all(root: Path, files: list[Path]) -> list[SourceClip]:
    read: list[tuple[tuple[str, str, str | None, str, str], np.ndarray]] = []
    dropped: dict[str, str] = {}
    for name, data in _recordings(files):
        described = describe_source(name)
        try:
            positions = retarget(read_bvh(data, name=PurePosixPath(name).name), fps=FPS).positions
            if len(positions) < 2:
                raise InputError("It has a single frame.")
        except InputError as error:
            dropped[name] = str(error)
            continue
        read.append((described, positions))
    for name, reason in list(dropped.items())[:5]:
        logger.warning("Left out %s: %s", name, reason)
    if dropped:
        logger.warning("%d of %d recordings were left out.", len(dropped), len(dropped) + len(read))
    read += vocabulary.read_vocabulary(root)
    if len(dropped) > len(read):
        raise InputError(
            f"{len(dropped)} of {len(dropped) + len(read)} recordings in {root} cannot be used, the first: "
            f"{next(iter(dropped.values()))} Unpack or download the data again."
        )
    read.sort(key=lambda item: item[0][3])
    splits = _splits([described for described, _ in read])
    return [
        SourceClip(
            canonicalize(piece).astype(np.float32),
            *described,
            splits[described[3]],
            (float(piece[0, 0, 0]), float(piece[0, 0, 2]), float(heading(piece[0]))),
        )
        for described, positions in read
        for piece in np.array_split(positions, -(-len(positions) // MAX_FRAMES))
    ]


def _splits(described: list[tuple[str, str, str | None, str, str]]) -> dict[str, str]:
    """The split of every source: in each action and side those whose names hash lowest are for testing.

    Where there are fewer than :data:`MIN_CLIPS_FOR_TEST`, all are in ``both`` splits.
    """
    groups: dict[tuple[str, str | None], list[str]] = defaultdict(list)
    for action, _, side, source, _ in described:
        groups[action, side].append(source)
    splits = {}
    for sources in groups.values():
        ranked = sorted(set(sources), key=lambda source: hashlib.sha256(source.encode()).hexdigest())
        if len(ranked) < MIN_CLIPS_FOR_TEST:
            splits |= dict.fromkeys(ranked, "both")
            continue
        held_out = max(1, round(TEST_SHARE * len(ranked)))
        splits |= {source: "test" if rank < held_out else "train" for rank, source in enumerate(ranked)}
    return splits


def _cache_path(root: Path, files: list[Path], cache_dir: str | Path | None) -> Path:
    folder = Path(cache_dir or Path(os.environ.get("XDG_CACHE_HOME", "~/.cache")).expanduser() / "pas-de-deux")
    state = [(path.relative_to(root).as_posix(), path.stat().st_size, path.stat().st_mtime_ns) for path in files]
    digest = hashlib.sha256(json.dumps([_CACHE_VERSION, repr(vocabulary.CUTS), state]).encode()).hexdigest()[:16]
    return folder / f"sources-{digest}.npz"


def _save_cache(path: Path, clips: list[SourceClip]) -> None:
    rows = [[c.action, c.style, c.side, c.source, c.dataset, c.split, c.place, c.num_frames] for c in clips]
    positions = np.concatenate([clip.positions for clip in clips])
    try:
        with replacing(path) as temporary, open(temporary, "wb") as file:
            np.savez(file, rows=np.array(json.dumps(rows)), positions=positions)
    except InputError as error:
        logger.warning("The recordings are read again next time: %s", error)


def _load_cache(path: Path) -> list[SourceClip]:
    with np.load(path, allow_pickle=False) as stored:
        rows, positions = json.loads(str(stored["rows"])), stored["positions"]
    clips, start = [], 0
    for *described, place, frames in rows:
        clips.append(SourceClip(positions[start : start + frames], *described, tuple(place)))
        start += frames
    return clips

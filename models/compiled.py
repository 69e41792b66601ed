"""Networks run by OpenVINO: the same weights and, to rounding, the same numbers, in about half the time.

PyTorch's matrix products of a few hundred rows reach half of the machine's speed, and its threads synchronise after
each of them. OpenVINO lays out the weights once and fuses the operations between the products. The two halves of the
guidance run in parallel on one core each, and so do the requests of two people. PyTorch traces the network and
OpenVINO translates the trace, so no network is written twice. A translation takes two seconds; a cache folder keeps
it for the next start.

A compiled network gives each row of a batch the same result, to the last bit, as if the row were alone.

PyTorch's own threads are set with each run (:func:`take_threads`). One is as fast as two for all that is small, which
is everything but a denoiser that OpenVINO does not run. Several wait for each other, spinning, after every product:
beside a busy core a pass of two threads takes four times as long as one of one.
"""

from __future__ import annotations

import hashlib
import importlib
import io
import logging
import os
import queue
import shutil
import sys
import tempfile
import threading
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import Any, Literal

import numpy as np
import torch
from torch import Tensor, nn

from models.weights_io import let_go, mapped
from motion.cores import usable_cores

log = logging.getLogger(__name__)

Precision = Literal["f32", "bf16"]
TOLERANCE: dict[Precision, float] = {"f32": 1e-4, "bf16": 5e-2}
"""Largest accepted difference from the plain network, relative to the largest output; measured: 5e-6 in float32."""
CORES = min(torch.get_num_threads(), usable_cores())
"""PyTorch's default number of threads, one per core or ``OMP_NUM_THREADS``; no more than the process may use."""
THREADS = min(CORES, 8)
"""Threads of a pass: PyTorch's default, up to 8; more do not help with products of a few hundred rows."""
STREAMS = min(THREADS, 2)
"""Passes that run in parallel, each with a share of the threads. A single pass of several rows is split into as many
parts: these synchronise once, at the end, while threads that share each product synchronise a hundred times."""
FILE = "network.blob"
"""A compiled network in its folder of the cache."""
KEPT = 6
"""Translations in the cache folder, of 60 MB each; the least recently used are removed first."""


_LOAD = Path("/proc/loadavg")
"""Linux' file; its fourth field is ``running/all`` threads, the one that reads among those that run."""


def free_cores() -> int:
    """Cores that nothing else uses at this moment, one at least; all of them where the system does not tell."""
    try:
        running = int(_LOAD.read_text().split()[3].partition("/")[0])
    except (OSError, ValueError, IndexError):
        return CORES
    return max(1, min(CORES, CORES - (running - 1)))


def take_threads(*, plain_denoiser: bool) -> None:
    """Sets PyTorch's threads for a run that begins in this thread.

    Args:
        plain_denoiser: the run has a large network that PyTorch runs.
    """
    torch.set_num_threads(free_cores() if plain_denoiser else 1)


def cache_folder() -> Path:
    """The folder of compiled networks: ``$XDG_CACHE_HOME/pas-de-deux/compiled``, by default in ``~/.cache``."""
    return Path(os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache")) / "pas-de-deux" / "compiled"


def has_bfloat16() -> bool:
    """True if this processor multiplies matrices of bfloat16 numbers itself (AVX512-BF16 or AMX)."""
    capabilities = torch.cpu.get_capabilities()
    return bool(capabilities.get("avx512_bf16") or capabilities.get("amx_bf16"))


def compile_network(network: nn.Module, key: str, cache: Path | None = None, *, precision: Precision = "f32") -> bool:
    """Lets OpenVINO run a network's ``forward`` from now on.

    The network's own weights are let go, so nothing but ``forward`` and what calls it can be used afterwards, and
    it has no gradients.

    Args:
        network: a :class:`models.diffusion.TwoPersonDenoiser` in eval mode.
        key: names its weights, such as :attr:`models.weights_io.WeightsFolder.digest`.
        cache: where translations are kept; :func:`cache_folder` by default. It need not be writable.
        precision: of the matrix products.

    Returns:
        whether it is compiled. Where OpenVINO is not installed, cannot translate the network or gives other
        numbers on this processor, the network stays as it is.
    """
    try:
        openvino = _openvino()
    except ImportError:
        return False
    try:
        folder = (cache or cache_folder()) / _name(network, key, openvino, precision)
        compiled = _cached(openvino, network, folder, precision) or _translated(openvino, network, folder, precision)
    except Exception as error:  # whatever a translator may raise: the plain network does the same job
        log.warning("%s runs without OpenVINO: %s", type(network).__name__, error)
        return False
    network.to("meta")
    network.forward = compiled
    return True


class Compiled:
    """A compiled ``forward``; safe to share between threads.

    Args:
        network: whose ``forward`` it is.
        model: its translation: a model that OpenVINO has compiled.
        weights: the memory that the model's weights lie in, if they are mapped from a file.
        precision: see :func:`compile_network`.
    """

    def __init__(self, network: Any, model: Any, weights: Any = None, precision: Precision = "f32") -> None:
        self.filled, self.model, self.weights = network.filled, model, weights
        self._requests: queue.SimpleQueue[Any] = queue.SimpleQueue()
        self._lock, self._under_way = threading.Lock(), 0
        example = network.example()
        with torch.no_grad():
            expected = network(*example)
            off = float((self(*example) - expected).abs().max() / expected.abs().max().clamp_min(1.0))
        if not off <= TOLERANCE[precision]:  # NaN, too
            raise ArithmeticError(f"the compiled network is off by {off:.1e}")
        let_go()  # OpenVINO has laid out a copy for itself

    def __call__(self, *args: Any, **kwargs: Any) -> Tensor:
        """As the network's own ``forward``; without gradients."""
        inputs = [np.ascontiguousarray(value.numpy()) for value in self.filled(*args, **kwargs)]
        with ExitStack() as stack:
            alone = stack.enter_context(self._counted()) == 1
            parts = min(STREAMS, len(inputs[0])) if alone else 1
            requests = [stack.enter_context(self._request()) for _ in range(parts)]
            for request, *rows in zip(requests, *(np.array_split(value, parts) for value in inputs), strict=True):
                request.start_async(rows, share_inputs=True)
            for request in requests:
                request.wait()
            return torch.from_numpy(np.concatenate([request.get_output_tensor(0).data for request in requests]))

    @contextmanager
    def _counted(self) -> Iterator[int]:
        """Number of running passes, including this one."""
        with self._lock:
            self._under_way += 1
            count = self._under_way
        try:
            yield count
        finally:
            with self._lock:
                self._under_way -= 1

    @contextmanager
    def _request(self) -> Iterator[Any]:
        """One of OpenVINO's requests, which hold the memory of a run: as many as there were runs at once."""
        try:
            request = self._requests.get_nowait()
        except queue.Empty:
            request = self.model.create_infer_request()
        try:
            yield request
        finally:
            self._requests.put(request)


def _openvino() -> Any:
    """Imports OpenVINO with its telemetry disabled; by default it reports every import over the network.

    Raises:
        ImportError: if it is not installed.
    """
    if "openvino" not in sys.modules:
        sys.modules.setdefault("openvino_telemetry", None)  # type: ignore[arg-type]  # as if not installed
    return importlib.import_module("openvino")


def _options(precision: Precision) -> dict[str, Any]:
    """OpenVINO's options for a network."""
    return {
        "INFERENCE_PRECISION_HINT": "bf16" if precision == "bf16" else "f32",
        "NUM_STREAMS": STREAMS,
        "INFERENCE_NUM_THREADS": THREADS,
        "ENABLE_CPU_PINNING": False,  # a thread that is bound to a busy core waits there
    }


def _name(network: nn.Module, key: str, openvino: Any, precision: Precision) -> str:
    """The cache's name for a network's translation, which is for one kind of processor."""
    core = openvino.Core()
    processor = [str(core.get_property("CPU", name)) for name in ("FULL_DEVICE_NAME", "OPTIMIZATION_CAPABILITIES")]
    parts = (type(network).__qualname__, key, precision, openvino.get_version(), torch.__version__, *processor)
    return hashlib.sha256("\n".join(parts).encode()).hexdigest()[:24]


def _cached(openvino: Any, network: nn.Module, folder: Path, precision: Precision) -> Compiled | None:
    """Loads the network's cached translation; None if there is none, or if its outputs differ from the network's."""
    try:
        weights = mapped(folder / FILE)
        tensor = openvino.Tensor(np.frombuffer(weights, np.uint8), shared_memory=True)
        model = openvino.Core().import_model(tensor, "CPU", _options(precision))
        compiled = Compiled(network, model, weights, precision=precision)
    except (OSError, ValueError, RuntimeError, ArithmeticError) as error:
        if folder.exists():
            log.warning("The cached compilation of %s cannot be used: %s", type(network).__name__, error)
        return None
    with suppress(OSError):
        os.utime(folder)
    return compiled


def _translated(openvino: Any, network: nn.Module, folder: Path, precision: Precision) -> Compiled:
    """The network translated, and kept where that can be."""
    model = openvino.Core().compile_model(_translate(openvino, network), "CPU", _options(precision))
    try:
        _keep(model, folder)
    except (OSError, RuntimeError):  # a folder that cannot be written, a full disk
        return Compiled(network, model, precision=precision)
    return _cached(openvino, network, folder, precision) or Compiled(network, model, precision=precision)


def _translate(openvino: Any, network: Any) -> Any:
    """OpenVINO's model of a network."""

    class Whole(nn.Module):
        def __init__(self) -> None:
            super().__init__()
            self.network = network

        def forward(self, *inputs: Tensor) -> Tensor:
            return self.network(*inputs)

    example = network.example()
    with torch.no_grad():
        traced = torch.jit.freeze(torch.jit.trace(Whole().eval(), example, check_trace=False))
    types = {torch.float32: openvino.Type.f32, torch.int64: openvino.Type.i64, torch.bool: openvino.Type.boolean}
    inputs = [
        (openvino.PartialShape([-1 if i in axes else n for i, n in enumerate(value.shape)]), types[value.dtype])
        for value, axes in zip(example, network.varying.values(), strict=True)
    ]
    return openvino.convert_model(traced, input=inputs)


def _keep(model: Any, folder: Path) -> None:
    """Writes a compiled model whole or not at all, and drops those that were not used for longest."""
    folder.parent.mkdir(parents=True, exist_ok=True)
    made = Path(tempfile.mkdtemp(prefix=".new-", dir=folder.parent))
    try:
        stream = io.BytesIO()
        model.export_model(stream)
        (made / FILE).write_bytes(stream.getbuffer())
        shutil.rmtree(folder, ignore_errors=True)
        made.rename(folder)
    finally:
        shutil.rmtree(made, ignore_errors=True)
    kept = sorted(folder.parent.glob("[!.]*"), key=lambda kept: kept.stat().st_mtime)
    for old in kept[:-KEPT]:
        shutil.rmtree(old, ignore_errors=True)

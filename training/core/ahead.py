"""Batches drawn ahead by worker processes, so that a GPU need not wait for them."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from dataclasses import fields, is_dataclass, replace
from queue import Queue
from typing import TypeVar

import torch
from torch import Tensor
from torch.utils.data import DataLoader, Dataset

Drawn = TypeVar("Drawn")


class _Steps(Dataset[Drawn]):
    def __init__(self, draw: Callable[[int], Drawn]) -> None:
        self.draw = draw

    def __getitem__(self, step: int) -> Drawn:
        return self.draw(step)


def _one_thread(_: int) -> None:
    torch.set_num_threads(1)


def drawn_ahead(draw: Callable[[int], Drawn], steps: range, workers: int, device: str) -> Iterator[Drawn]:
    """``draw(step)`` of every step on a device, in order.

    Args:
        draw: must use the CPU alone and give the same for the same step.
        workers: processes that draw, each four steps ahead. A thread brings the next two steps to the device.
    """
    # Tensors are passed as files in memory: a process may not open as many descriptors as these need.
    torch.multiprocessing.set_sharing_strategy("file_system")
    loader = DataLoader(
        _Steps(draw),
        sampler=steps,
        batch_size=None,
        num_workers=workers,
        prefetch_factor=4,
        multiprocessing_context="fork",
        worker_init_fn=_one_thread,
    )
    ready: Queue[Drawn | Exception | None] = Queue(maxsize=2)

    def bring() -> None:
        try:
            for drawn in loader:
                ready.put(moved(drawn, device))
            ready.put(None)
        except Exception as error:  # of a worker: raised where the step is taken
            ready.put(error)

    threading.Thread(target=bring, daemon=True).start()
    while (drawn := ready.get()) is not None:
        if isinstance(drawn, Exception):
            raise drawn
        yield drawn


def moved(value: Drawn, device: str) -> Drawn:
    """The same tensor or dataclass with all tensors in it on a device."""
    if isinstance(value, Tensor):
        return value.to(device, non_blocking=True)
    if is_dataclass(value) and not isinstance(value, type):
        return replace(value, **{f.name: moved(getattr(value, f.name), device) for f in fields(value)})
    return value

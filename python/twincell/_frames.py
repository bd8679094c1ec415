"""Stacks of frames as lazy sequences of NumPy arrays."""
from __future__ import annotations

import os
import threading
from collections.abc import Sequence

import numpy as np

from . import _core


class Frames(Sequence):
    """The frames of a stack, read when they are used: len, index, slice, iterate.

    A frame is a read-only array (rows, columns) of uint8, uint16 or float32 with the grey values of the camera; row 0
    is the top. A slice is a sequence of the same kind. Frames in order are read once; a step back opens the stack
    again.
    """

    def __init__(self, path: str | os.PathLike, _range: range | None = None):
        self.path = os.fspath(path)
        self._source = None
        self._lock = threading.RLock()
        self._open()
        self._range = range(self._source.announced) if _range is None else _range

    def _open(self) -> None:
        self._source = _core.FrameSource(self.path)
        self._read = 0
        self._last = None

    @property
    def info(self) -> dict:
        """What the stack states: format, bits, frame rate, exposure, notes."""
        return self._source.info

    @property
    def _whole_stack(self) -> str | None:
        return self.path if self._range == range(self._source.announced) else None

    @property
    def shape(self) -> tuple[int, ...]:
        """(frames, rows, columns)."""
        return (len(self), *self[0].shape) if len(self) else (0, 0, 0)

    @property
    def dtype(self) -> np.dtype:
        """Type of the pixels of the first frame."""
        return self[0].dtype

    def __len__(self) -> int:
        return len(self._range)

    def _at(self, number: int) -> np.ndarray:
        with self._lock:
            if number < self._read - 1:
                self._open()
            while self._read <= number:
                frame = self._source.read()
                if frame is None:
                    raise IndexError(f"{self.path}: the stack has {self._read} frames, not {number + 1}.")
                self._last = frame
                self._read += 1
            return self._last

    def __getitem__(self, index):
        if isinstance(index, slice):
            return Frames(self.path, self._range[index])
        try:
            number = self._range[index]
        except IndexError:
            raise IndexError(f"frame {index} does not exist; there are {len(self)} frames.") from None
        return self._at(number)

    def __array__(self, dtype=None) -> np.ndarray:
        return np.stack([self[i] for i in range(len(self))]).astype(dtype or self.dtype, copy=False)

    def __repr__(self) -> str:
        return f"<twincell.Frames of {self.path}: {len(self)} frames, {self.info['format']}>"


def open_frames(path: str | os.PathLike) -> Frames:
    """The frames of a stack as a lazy sequence of arrays.

    path: a folder of pictures, a picture, a camera file, an HDF5 stack or a video (docs/frames.md). Raises InputError
    if there is nothing to read.
    """
    return Frames(path)

"""Stacks of frames as lazy sequences of NumPy arrays."""
from __future__ import annotations

import os
import re
import threading
from collections.abc import Sequence

import numpy as np

from . import _core


class Frame(np.ndarray):
    """A picture (rows, columns) that knows its number in the stack, `frame_no`."""

    frame_no: int | None = None

    def __array_finalize__(self, of) -> None:
        self.frame_no = getattr(of, "frame_no", None)

    def __array_wrap__(self, result, context=None, return_scalar=False):
        # A number, such as the mean of the picture, is no picture.
        return result[()] if result.ndim == 0 else super().__array_wrap__(result, context)


class Frames(Sequence):
    """The frames of a stack, read when they are used: len, index, slice, iterate.

    A frame is a read-only array (rows, columns) of uint8, uint16 or float32 with the grey values of the camera; row 0
    is the top; `frame_no` is its number in the stack. A slice is a sequence of the same kind, whose frames keep their
    numbers. Frames in order are read once; a step back opens the stack again.
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

    def _part_of_stack(self, frames: str) -> tuple[str, str] | None:
        """The name of the stack, and which of its frames these are as A:B:STEP; None for a reversed slice.

        frames: A:B or A:B:STEP of this sequence; empty: all.
        """
        part = self._range
        if frames:
            if not re.fullmatch(r"\d*:\d*(:0*[1-9]\d*)?", frames):
                return self.path, frames  # refused there with its sentence
            part = part[slice(*(int(n) if n else None for n in frames.split(":")))]
        if part == range(self._source.announced):
            return self.path, ""
        if part.step < 1 or len(part) == 0:
            return None
        return self.path, f"{part.start}:{part[-1] + 1}:{part.step}"

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
                self._last = frame.view(Frame)
                self._last.frame_no = self._read
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

"""Located beads as tables of pandas."""
from __future__ import annotations

import os
import tempfile
from pathlib import Path

import numpy as np

from . import _core
from ._program import _run


class _Numbered:
    """Pictures, and the numbers in their stack that they state as `frame_no`, as pictures of pims do."""

    def __init__(self, pictures):
        self._pictures = pictures
        self.numbers = []

    def __len__(self):
        return len(self._pictures) if hasattr(self._pictures, "__len__") else 0

    def __iter__(self):
        for picture in self._pictures:
            self.numbers.append(getattr(picture, "frame_no", None))
            yield picture


def _numbered(stack):
    """The pictures of `stack` with their numbers; `stack` itself if it is a name, a stack or an array of several."""
    if isinstance(stack, (str, os.PathLike)) or (hasattr(stack, "_part_of_stack") and stack._part_of_stack("")):
        return stack  # named, or read where it is named
    if isinstance(stack, np.ndarray):
        return _Numbered([stack]) if stack.ndim == 2 and getattr(stack, "frame_no", None) is not None else stack
    return _Numbered(stack)


def locate(stack, diameter=None, *, locator="vote", min_score=0.04, min_explained=0.5, refine="exact", bright=False,
           dark=False, flat="", background="", roi="", mask="", frames="", view=None, threads=0, callback=None):
    """The beads of a picture, a sequence of pictures or a stack as a DataFrame in the columns of trackpy.

    stack: the name of a stack, Frames, an array (rows, columns) or (frames, rows, columns), or any iterable over
    pictures. Frames, slices of it and pictures with a `frame_no` keep their numbers. diameter: px, or up to 8 diameters; None: determined from the first frame, as polarity and disc model are.
    view: page to write (HTML) with beads, dropped candidates and what other settings would keep; for a stack given by its
    name, which the program reads once more. The options are those of `twincell locate` (docs/locating.md).

    Returns y, x, mass, size, ecc, signal, raw_mass, ep, frame, radius, sigma_x, sigma_y, sigma_radius, score, tracer,
    edge, overlap, in px, one row per bead. `attrs` of the table has "settings" (locate(other, **settings) finds other
    frames with the same options), "settings_frame", "contrast", "picture_size" (width, height; `track` uses it), "left_out" (candidates left out, by reason) and
    "frames" (one dict per frame).
    """
    import pandas as pd

    options = {"diameter": diameter, "locator": locator, "min_score": min_score, "min_explained": min_explained,
               "refine": refine, "bright": bright, "dark": dark, "flat": flat, "background": background, "roi": roi,
               "mask": mask, "frames": frames, "threads": threads}
    if view is not None and not isinstance(stack, (str, os.PathLike)):
        raise _core.ConfigError("view: needs the name of a stack; pictures in memory have none.")
    pictures = _numbered(stack)
    columns, report = _core.locate(pictures, **options, callback=callback)
    table = pd.DataFrame(columns)
    numbers = getattr(pictures, "numbers", [])
    if numbers and None not in numbers:
        table["frame"] = np.asarray(numbers, dtype="int64")[table["frame"]]
        for frame in report["frames"]:
            frame["frame"] = numbers[frame["frame"]]
    table["tracer"] = table["tracer"].astype(bool)
    table["edge"] = table["edge"].astype(bool)
    table["overlap"] = table["overlap"].astype(bool)
    table.attrs.update(report)
    if view is not None:
        stated = {name: list(value) if name == "diameter" and hasattr(value, "__len__") else value
                  for name, value in options.items() if value != ""}
        with tempfile.TemporaryDirectory() as folder:
            beads = f"{folder}/beads.csv"
            _run("locate", (stack,), {**stated, "view": view, "output": beads}, None)
            page = Path(view)
            page.write_text(page.read_text().replace(beads, "beads.csv"))  # in the command line that the page shows
    return table

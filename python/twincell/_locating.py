"""Located beads as tables of pandas."""
from __future__ import annotations

import os
import tempfile
from pathlib import Path

from . import _core
from ._program import _run


def locate(stack, diameter=None, *, locator="vote", min_score=0.04, min_explained=0.5, refine="exact", bright=False,
           dark=False, flat="", background="", roi="", mask="", frames="", view=None, threads=0, callback=None):
    """The beads of a picture, a sequence of pictures or a stack as a DataFrame in the columns of trackpy.

    stack: the name of a stack, Frames, an array (rows, columns) or (frames, rows, columns), or any iterable over
    pictures. diameter: px, or up to 8 diameters; None: determined from the first frame, as polarity and disc model are.
    view: page to write (HTML) with beads, dropped candidates and what other settings would keep; for a stack given by its
    name, which the program reads once more. The options are those of `twincell locate` (docs/locating.md).

    Returns y, x, mass, size, ecc, signal, raw_mass, ep, frame, radius, sigma_x, sigma_y, sigma_radius, score, tracer,
    edge, overlap, in px, one row per bead. `attrs` of the table has "settings" (locate(other, **settings) finds other
    frames with the same options), "settings_frame", "contrast", "left_out" (candidates left out, by reason) and
    "frames" (one dict per frame).
    """
    import pandas as pd

    options = {"diameter": diameter, "locator": locator, "min_score": min_score, "min_explained": min_explained,
               "refine": refine, "bright": bright, "dark": dark, "flat": flat, "background": background, "roi": roi,
               "mask": mask, "frames": frames, "threads": threads}
    if view is not None and not isinstance(stack, (str, os.PathLike)):
        raise _core.ConfigError("view: needs the name of a stack; pictures in memory have none.")
    columns, report = _core.locate(stack, **options, callback=callback)
    table = pd.DataFrame(columns)
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

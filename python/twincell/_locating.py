"""Located beads as tables of pandas."""
from __future__ import annotations

from . import _core


def locate(stack, *, diameter=None, locator="vote", min_score=0.04, min_explained=0.5, refine="exact", bright=False,
           dark=False, flat="", background="", roi="", mask="", frames="", threads=0, callback=None):
    """The beads of a picture, a sequence of pictures or a stack as a DataFrame in the columns of trackpy.

    stack: the name of a stack, Frames, an array (rows, columns) or (frames, rows, columns), or any iterable over
    pictures. diameter: px, or up to 8 diameters; None: determined from the first frame, as polarity and disc model are.
    The options are those of `twincell locate` (docs/locating.md).

    Returns y, x, mass, size, ecc, signal, raw_mass, ep, frame, radius, sigma_x, sigma_y, sigma_radius, score, tracer,
    edge, in px, one row per bead. `attrs` of the table has "settings" (locate(other, **settings) finds other frames
    with the same options), "settings_frame", "contrast", "left_out" (candidates left out, by reason) and "frames" (one
    dict per frame).
    """
    import pandas as pd

    columns, report = _core.locate(
        stack, diameter=diameter, locator=locator, min_score=min_score, min_explained=min_explained, refine=refine,
        bright=bright, dark=dark, flat=flat, background=background, roi=roi, mask=mask, frames=frames, threads=threads, callback=callback)
    table = pd.DataFrame(columns)
    table["tracer"] = table["tracer"].astype(bool)
    table["edge"] = table["edge"].astype(bool)
    table.attrs.update(report)
    return table

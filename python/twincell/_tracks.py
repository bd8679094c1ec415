"""Linked beads as tables: the steps after locating by the names, columns and units of trackpy.

A table of tracks has the columns frame, particle, x, y and, in three dimensions, z, as those of `link` and of
`Trajectory.to_dataframe`. A Trajectory is taken as its table. Tables are not changed; a result is a new one.
"""
from __future__ import annotations

import numpy as np

from . import _core
from ._tables import require_linked


def link(beads, search_range=None, *, memory=3, diameter=None, columns=None, callback=None):
    """The identities of located beads: a copy of the table with the columns particle and ambiguous.

    beads: DataFrame with frame, x, y, such as that of `locate`, px. search_range: largest distance of a bead from its
    predicted position, px; None: two bead diameters. memory: frames for which a bead may be missing. diameter: px; None:
    the median of the column radius or diameter. columns: names of columns that are called otherwise, {"x": "X"}.
    callback: called with (done, total).

    particle is the number of the track, ambiguous whether the link to the frame before has a rival nearly as good. The
    linker is that of `track` (docs/tracking.md), which also takes the cell and the drive into account and returns a
    Trajectory.
    """
    table = beads.copy()
    frame = table[(columns or {}).get("frame", "frame")].to_numpy() if len(table) else np.array([])
    order = np.argsort(frame, kind="stable")  # of the beads that are linked
    particle, ambiguous = _core.link(beads, search_range=search_range, memory=memory, diameter=diameter,
                                     columns=columns or {}, callback=callback)
    for name, linked in (("particle", particle), ("ambiguous", ambiguous)):
        values = np.empty_like(linked)
        values[order] = linked
        table[name] = values
    return table


def _linked(tracks):
    """The table of tracks, whose index may have the name of a column, and the names of its coordinates."""
    if isinstance(tracks, _core.Trajectory):
        tracks = tracks.to_dataframe()
    require_linked(tracks)
    return tracks, [axis for axis in "xyz" if axis in tracks]


def filter_stubs(tracks, threshold=30):
    """The rows of the tracks that have at least `threshold` rows.

    tracks: table of tracks, or a Trajectory.
    """
    tracks, _ = _linked(tracks)
    _, code, count = np.unique(tracks["particle"], return_inverse=True, return_counts=True)
    return tracks[count[code] >= threshold]


class _Steps:
    """Displacements of the beads of a table of tracks over a number of frames."""

    def __init__(self, tracks, longest, unit=1.0):
        tracks, self.axes = _linked(tracks)
        frame = tracks["frame"].to_numpy()
        if not np.array_equal(frame, np.floor(frame)):
            raise _core.ConfigError("frame: holds numbers that are not whole.")
        self.particles, code = np.unique(tracks["particle"], return_inverse=True)
        frame = frame.astype(np.int64)
        first, last = (frame.min(), frame.max()) if frame.size else (0, 0)
        self.longest = min(int(longest), int(last - first))
        # One number per row that tells bead and frame; `longest` frames apart from those of the next bead.
        key = code * (last - first + 1 + self.longest) + (frame - first)
        order = np.argsort(key)
        self._key, self._code, self._frame = key[order], code[order], frame[order]
        self._places = unit * tracks[self.axes].to_numpy(dtype=float)[order]

    def over(self, lag):
        """Index in `particles`, later frame, and displacement, of each pair of rows of a bead `lag` frames apart."""
        later = np.searchsorted(self._key, self._key + lag)
        earlier = np.flatnonzero(np.append(self._key, -1)[later] == self._key + lag)
        later = later[earlier]
        return self._code[later], self._frame[later], self._places[later] - self._places[earlier]

    def extent(self):
        """Rows of each bead, and frames from its first to its last."""
        begin = np.searchsorted(self._code, np.arange(len(self.particles)))
        end = np.append(begin[1:], len(self._code))
        return end - begin, self._frame[end - 1] - self._frame[begin] + 1


def compute_drift(tracks, smoothing=0):
    """The drift: the sum of the mean steps of all beads, a DataFrame with x and y (and z) by frame.

    tracks: table of tracks, or a Trajectory. Steps are those of beads that are in two successive frames. smoothing: frames of
    a rolling mean over the steps; 0: none.
    """
    import pandas as pd

    steps = _Steps(tracks, 1)
    _, frame, step = steps.over(1)
    mean = pd.DataFrame(step, columns=steps.axes).groupby(frame).mean()
    mean.index.name = "frame"
    return (mean.rolling(smoothing, min_periods=0).mean() if smoothing > 0 else mean).cumsum()


def subtract_drift(tracks, drift=None):
    """A copy of the tracks with positions relative to the drift.

    tracks: table of tracks, or a Trajectory. drift: that of `compute_drift`, or None: that of the tracks. Before its first
    frame it is 0; a frame that it lacks has that of the frame before.
    """
    drift = compute_drift(tracks) if drift is None else drift
    tracks, axes = _linked(tracks)
    tracks = tracks.copy()
    frame = tracks["frame"].to_numpy()
    known = drift.sort_index()
    at = np.searchsorted(known.index.to_numpy(), frame, side="right")
    for axis in axes:
        tracks[axis] = tracks[axis].to_numpy() - np.append(0.0, known[axis].to_numpy())[at]
    return tracks


def _statistics(tracks, mpp, fps, max_lagtime):
    """For each bead and lag: means of displacement and square, their sum msd, and the number of independent pairs N."""
    import pandas as pd

    steps = _Steps(tracks, max_lagtime, mpp)
    beads = len(steps.particles)
    rows, frames = steps.extent()
    parts = []
    for lag in range(1, steps.longest + 1):
        code, _, step = steps.over(lag)
        pairs = np.bincount(code, minlength=beads)
        here = np.flatnonzero(pairs)

        def mean(values):
            return np.bincount(code, values, minlength=beads)[here] / pairs[here]

        part = {"lag": lag, "particle": steps.particles[here]}
        part |= {f"<{axis}>": mean(step[:, k]) for k, axis in enumerate(steps.axes)}
        part |= {f"<{axis}^2>": mean(step[:, k] ** 2) for k, axis in enumerate(steps.axes)}
        part["msd"] = mean((step**2).sum(axis=1))
        part["N"] = _independent(frames[here] - lag, lag) * rows[here] / frames[here]
        parts.append(pd.DataFrame(part))
    if not parts:
        raise _core.ConfigError("tracks: no bead is in two frames.")
    table = pd.concat(parts, ignore_index=True)
    table["lagt"] = table["lag"] / float(fps)
    return table


def _independent(pairs, lag):
    """Effective number of independent ones among `pairs` overlapping pairs of positions of a random walk.

    Qian, Sheetz & Elson, Biophys. J. 60, 910 (1991), appendix B.
    """
    k, n = np.asarray(pairs, dtype=float), float(lag)
    few = 6 * k * n**2 / (6 * k * n**2 + k**3 - 4 * k**2 * n + 4 * n - k)
    many = 6 * k**2 * n / (4 * n**2 * k + 2 * k + n - n**3)
    return np.where(n > k, few, many)


def imsd(tracks, mpp, fps, max_lagtime=100, statistic="msd"):
    """Mean squared displacement of each bead: a DataFrame with a column for each particle, by lag time [s].

    tracks: table of tracks, or a Trajectory. mpp: length of a unit of x and y, such as micrometres per pixel; fps: frames
    per second. max_lagtime: longest lag, frames. statistic: "msd", or "<x>", "<x^2>" and so on. Means are over all pairs
    of positions of a bead that are so many frames apart; NaN where it has none.

    The `msd` of `analyze` is that of all beads relative to their mean displacement, with its interval.
    """
    table = _statistics(tracks, mpp, fps, max_lagtime)
    if statistic not in table or statistic in ("lag", "lagt", "particle"):
        raise _core.ConfigError(f"statistic: there is no '{statistic}'; there are msd, <x>, <x^2> and the like.")
    wide = table.pivot(index="lagt", columns="particle", values=statistic)
    wide.index.name = "lag time [s]"
    return wide


def emsd(tracks, mpp, fps, max_lagtime=100, detail=False):
    """Mean squared displacement of all beads: a Series by lag time, `lagt` in s.

    Arguments as for `imsd`. Each bead counts by the number of independent pairs of its positions (Qian, Sheetz & Elson 1991,
    for a random walk). detail: a DataFrame with <x>, <x^2> and so on, msd, and N, the sum of these numbers.

    The `msd` of `analyze` is relative to the mean displacement of the beads, with its interval.
    """
    table = _statistics(tracks, mpp, fps, max_lagtime)
    weight = table.pop("N")
    table = table.drop(columns=["particle", "lag"])
    sums = table.drop(columns="lagt").mul(weight, axis=0).groupby(table["lagt"]).sum()
    total = weight.groupby(table["lagt"]).sum()
    means = sums.div(total, axis=0)
    means["N"] = total
    return means if detail else means["msd"]

"""Trajectories as tables of pandas and universes of MDAnalysis."""
from __future__ import annotations

import warnings

import numpy as np

from . import _core


def _to_dataframe(self):
    """One row per bead and frame in which it is present, in the columns of trackpy: frame, particle, x, y.

    The columns are those of `twincell export --to csv`: lengths in bead diameters, y downwards from the mean height of the
    plate, as in trackpy's pictures; in three dimensions z is the depth. Further columns: step, time, and those that the
    trajectory has: phase, cycle, radius, bead_mass, tracer, vx, vy, sigma_x, sigma_y, in three dimensions also vz, sigma_z.
    """
    import pandas as pd

    parts = []
    time, step, phase, cycle = self.time, self.step, self.phase, self.cycle
    for t in range(len(self)):
        r = self.positions[t]
        here = np.flatnonzero(np.isfinite(r[:, 0]))
        deep = self.box.dimension == 3  # with a column z, trackpy links in three dimensions
        part = {"frame": np.full(here.size, t), "particle": here, "x": r[here, 0], "y": 0 - r[here, 2]}
        if deep:
            part["z"] = r[here, 1]
        part |= {"step": np.full(here.size, step[t]), "time": np.full(here.size, time[t])}
        if phase is not None:
            part |= {"phase": np.full(here.size, phase[t]), "cycle": np.full(here.size, cycle[t])}
        if self.radii is not None:
            part["radius"] = self.radii[here]
        if self.masses is not None:
            part["bead_mass"] = self.masses[here]
        if self.tracers is not None:
            part["tracer"] = self.tracers[here].astype(bool)
        if self.velocities is not None:
            v = self.velocities[t]
            part |= {"vx": v[here, 0], "vy": 0 - v[here, 2]} | ({"vz": v[here, 1]} if deep else {})
        if self.position_sigma is not None:
            s = self.position_sigma[t]
            part |= {"sigma_x": s[here, 0], "sigma_y": s[here, 2]} | ({"sigma_z": s[here, 1]} if deep else {})
        parts.append(pd.DataFrame(part))
    return pd.concat(parts, ignore_index=True) if parts else pd.DataFrame(columns=["frame", "particle", "x", "y"])


def _of_each(table, column, key, what):
    """The numbers of a column, one for each value of `key`. Raises ConfigError where they differ."""
    if column not in table:
        return None
    of_key = table.groupby(key)[column]
    differs = of_key.nunique(dropna=False) > 1
    if differs.any():
        raise _core.ConfigError(f"{column}: differs among the rows of {what} {differs.index[differs][0]}.")
    return of_key.first().to_numpy()


def require_linked(table):
    """Raises ConfigError for a table that is not that of linked beads: frame, particle, x, y, each bead once in a frame."""
    missing = [name for name in ("frame", "particle", "x", "y") if name not in table]
    if missing:
        raise _core.ConfigError(f"table: has no column {missing[0]}.")
    if table[["frame", "particle"]].isna().any(axis=None):
        raise _core.ConfigError("table: has a row without a frame or a particle; linked beads are needed.")
    if table.duplicated(["frame", "particle"]).any():
        raise _core.ConfigError("table: has a particle twice in a frame.")


def _from_dataframe(table, *, box=None, drive=None, phases_per_cycle=0, source="unknown", unwrap=True):
    """The trajectory of a table in the columns of `to_dataframe`, whose inverse it is: frame, particle, x, y, ...

    y is downwards, z of a three-dimensional table is the depth; lengths in bead diameters. Beads are numbered in the order
    of `particle`, frames in that of `frame`; without a column step the step is `frame`. Further columns are left out. box,
    drive, phases_per_cycle, source and unwrap as in `from_arrays`.
    """
    require_linked(table)
    frame, t = np.unique(table["frame"], return_inverse=True)
    particle, i = np.unique(table["particle"], return_inverse=True)
    deep = "z" in table

    def vectors(prefix, sign):
        names = [prefix + axis for axis in ("xzy" if deep else "xy")]
        if not all(name in table for name in names):
            return None
        filled = np.full((len(frame), len(particle), len(names)), np.nan)
        filled[t, i] = table[names].to_numpy(dtype=float)
        filled[:, :, -1] = sign * filled[:, :, -1] + 0.0
        return filled

    numbers = {name: _of_each(table, name, "frame", "frame") for name in ("step", "time", "phase", "cycle")}
    if numbers["step"] is None and np.array_equal(frame, np.floor(frame)):
        numbers["step"] = frame
    tracers = _of_each(table, "tracer", "particle", "particle")
    return _core.Trajectory.from_arrays(
        vectors("", -1), velocities=vectors("v", -1), position_sigma=vectors("sigma_", 1),
        radii=_of_each(table, "radius", "particle", "particle"), masses=_of_each(table, "bead_mass", "particle", "particle"),
        tracers=None if tracers is None else tracers.astype(float), box=box, drive=drive, phases_per_cycle=phases_per_cycle,
        source=source, unwrap=unwrap, **numbers)


def _to_mdanalysis(self):
    """The trajectory as an MDAnalysis Universe in memory, one atom per slot, lengths in bead diameters.

    Positions are copied, because MDAnalysis keeps 32-bit numbers. The type of a tracer is "tracer", of any other bead
    "bead"; times are in t0, from that of the first frame on, with the time step of the first two.
    """
    import MDAnalysis as mda
    from MDAnalysis.coordinates.memory import MemoryReader

    universe = mda.Universe.empty(self.n_beads, trajectory=True)
    tracers = self.tracers if self.tracers is not None else np.zeros(self.n_beads)
    universe.add_TopologyAttr("types", np.where(tracers, "tracer", "bead"))
    if self.masses is not None:
        universe.add_TopologyAttr("masses", self.masses)
    if self.radii is not None:
        universe.add_TopologyAttr("radii", self.radii)
    time = self.time
    size = np.subtract(self.box.upper, self.box.lower)
    box = np.array([*size, 90, 90, 90], dtype=np.float32)
    options = {"dt": float(time[1] - time[0])} if len(time) > 1 else {}
    if len(time) > 0:
        options["time_offset"] = float(time[0])
    if len(time) > 2 and np.ptp(np.diff(time)) > 1e-6 * options["dt"]:
        warnings.warn("MDAnalysis has one time step for all frames; the times of this trajectory are not evenly spaced and "
                      "are in its `time`.", stacklevel=2)
    velocities = np.asarray(self.velocities, dtype=np.float32) if self.velocities is not None else None
    universe.load_new(np.asarray(self.positions, dtype=np.float32), format=MemoryReader, order="fac",
                      dimensions=box, velocities=velocities, **options)
    return universe


_core.Trajectory.to_dataframe = _to_dataframe
_core.Trajectory.from_dataframe = staticmethod(_from_dataframe)
_core.Trajectory.to_mdanalysis = _to_mdanalysis

#!/usr/bin/env python3
"""q6 of every bead, by Twincell and by NumPy with SciPy on the same positions: seconds of processor time for 10^6
bead-frames, and the largest difference of the two.

usage: order_peers.py BUILD [--json] [--beads N] [--frames N]

BUILD is the folder that holds bench/order_cost. Beds are hexagonal with a grain turned by 20 degrees and blurred, so
that all neighbourhoods occur. The peers are written here as one would write them: cKDTree.query_pairs for the cut-off;
scipy.spatial.Delaunay for the triangulation, whose edges are dropped where the circle round either triangle is wider
than Twincell's cell. Sums over bonds by np.bincount, no loop over beads.
"""

import argparse
import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

try:
    import numpy as np
    import scipy.spatial
except ImportError as why:
    sys.exit(f"order_peers.py: {why} (Debian: apt-get install python3-scipy)")

CUTOFF = 1.2
RADIUS = 0.9


def beds(frames, beads, seed=5):
    rng = np.random.default_rng(seed)
    width = 20
    rows = int(np.ceil(beads / width)) + 2
    flat = np.array([(i + 0.5 * (j % 2), j * np.sqrt(0.75)) for j in range(rows) for i in range(width)])[:beads] * 1.02
    c, s = np.cos(np.radians(20)), np.sin(np.radians(20))
    middle = flat.mean(0)
    inside = np.hypot(*(flat - middle).T) < 7
    flat[inside] = (flat[inside] - middle) @ np.array([[c, s], [-s, c]]) + middle
    return flat + rng.normal(0, 0.03, (frames, beads, 2))


def q6_of(pairs, r):
    """From bonds i -> j, both ways."""
    n = len(r)
    i = np.concatenate([pairs[:, 0], pairs[:, 1]])
    d = r[pairs[:, 1]] - r[pairs[:, 0]]
    e = d[:, 0] + 1j * d[:, 1]
    e2 = (e / np.abs(e)) ** 2  # the bond back has the same even powers
    bonds = np.bincount(i, minlength=n)
    total = np.full(n, (5 / 16) ** 2)
    with np.errstate(invalid="ignore", divide="ignore"):
        for power, weight in ((1, 105), (2, 126), (3, 231)):
            f = np.concatenate([e2**power] * 2)
            mean2 = (np.bincount(i, f.real, n) ** 2 + np.bincount(i, f.imag, n) ** 2) / bonds**2
            total += 2 * weight / 1024 * mean2
    return np.where(bonds < 2, np.nan, np.sqrt(total))


def cutoff(r):
    return q6_of(scipy.spatial.cKDTree(r).query_pairs(CUTOFF, output_type="ndarray"), r)


def delaunay(r):
    """Edges of the triangulation whose Voronoi edge comes nearer than RADIUS to the beads it parts."""
    t = scipy.spatial.Delaunay(r)
    a, b, c = (r[t.simplices[:, k]] for k in range(3))
    u, v = b - a, c - a
    twice = 2 * (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])
    u2, v2 = (u**2).sum(1), (v**2).sum(1)
    centre = a + np.stack([v[:, 1] * u2 - u[:, 1] * v2, u[:, 0] * v2 - v[:, 0] * u2], 1) / twice[:, None]
    pairs, ends = [], []
    for k in range(3):
        pair = t.simplices[:, [(k + 1) % 3, (k + 2) % 3]]
        other = t.neighbors[:, k]
        own = (other < 0) | (np.arange(len(other)) < other)  # each edge once
        p, q = r[pair[own, 0]], r[pair[own, 1]]
        middle, along = (p + q) / 2, q - p
        length = np.hypot(along[:, 0], along[:, 1])
        normal = np.stack([-along[:, 1], along[:, 0]], 1) / length[:, None]
        here = ((centre[own] - middle) * normal).sum(1)
        inward = ((r[t.simplices[own, k]] - middle) * normal).sum(1)
        outside = np.where(other[own] < 0, -np.sign(inward) * np.inf, ((centre[other[own]] - middle) * normal).sum(1))
        low, high = np.minimum(here, outside), np.maximum(here, outside)
        rim = np.sqrt(np.maximum(RADIUS**2 - length**2 / 4, 0))
        keep = np.minimum(high, rim) - np.maximum(low, -rim) > 1e-6
        pairs.append(pair[own][keep])
    return q6_of(np.concatenate(pairs), r)


def arguments_of(description):
    """The arguments of a benchmark of --frames frames of --beads beads."""
    arguments = argparse.ArgumentParser(description=description.splitlines()[0])
    arguments.add_argument("build", type=lambda path: Path(path).resolve())
    arguments.add_argument("--json", action="store_true")
    arguments.add_argument("--beads", type=int, default=1600)
    arguments.add_argument("--frames", type=int, default=625)
    return arguments


def main():
    options = arguments_of(__doc__).parse_args()
    r = beds(options.frames, options.beads)
    document = {"bead_frames": int(r.shape[0] * r.shape[1])}
    with tempfile.TemporaryDirectory() as temporary:
        table = Path(temporary) / "table.bin"
        with table.open("wb") as out:
            out.write(np.array(r.shape[:2], "<i8").tobytes() + r.astype("<f8").tobytes())
        for rule, peer in (("cutoff", cutoff), ("delaunay", delaunay), ("voronoi", None)):
            ran = subprocess.run([options.build / "bench/order_cost", table, rule, "3"], capture_output=True, text=True)
            if ran.returncode != 0:
                sys.exit(f"order_peers.py: {ran.stderr.strip()}")
            ours = json.loads(ran.stdout)["seconds"]
            document[f"{rule}.twincell_s"] = ours
            if peer is None:
                continue
            q6 = np.fromfile(f"{table}.{rule}.q6", "<f8").reshape(r.shape[:2])
            start = time.process_time()
            theirs = [peer(frame) for frame in r]
            seconds = time.process_time() - start
            both = np.stack(theirs)
            document[f"{rule}.scipy_s"] = seconds
            document[f"{rule}.ratio"] = seconds / ours
            document[f"{rule}.largest_difference"] = float(np.nanmax(np.abs(both - q6)))
            document[f"{rule}.only_one_has_a_value"] = int((np.isnan(both) != np.isnan(q6)).sum())
    if options.json:
        print(json.dumps(document, indent=2))
        return
    print(f"q6 of {document['bead_frames']} bead-frames, seconds of processor time")
    print(f"{'rule':<10}{'twincell':>10}{'scipy':>10}{'ratio':>8}{'largest difference of q6':>28}")
    for rule in ("cutoff", "delaunay", "voronoi"):
        row = [document.get(f"{rule}.{key}") for key in ("twincell_s", "scipy_s", "ratio", "largest_difference")]
        cells = ["-" if v is None else f"{v:.3g}" for v in row]
        print(f"{rule:<10}{cells[0]:>10}{cells[1]:>10}{cells[2]:>8}{cells[3]:>28}")


if __name__ == "__main__":
    main()

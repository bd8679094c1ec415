#!/usr/bin/env python3
"""`twincell analyze` of a shaken bed: seconds for 10^6 bead-frames, all observables and each of them, beside NumPy and
SciPy on the same positions for q6, g(r) and the areas of Voronoi cells.

usage: analyze_peers.py BUILD [--json] [--beads N] [--frames N] [--repetitions N]

BUILD is the folder that holds twincell. The bed of the first paper (Gamma = 2) is simulated once, in coarse steps.
"analyze.seconds" is the processor time of the analysis with all observables. The seconds of an observable are those of
its row in `analyze --profile`, by the clock on one thread; next to a peer they are those of a run with this observable
alone, because neighbours and cells belong to the first observable that needs them. The peers are written here as one
would write them, without a loop over beads: cKDTree for pairs, scipy.spatial.Delaunay for the cells; their seconds are
processor time. The values stand side by side: the mean of q6, the distance of the largest bin of g(r) (the peer's has
no correction for the edges of the bed, so only the bin can be compared), the mean area.
"""

import json
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import NamedTuple

try:
    import h5py
    import numpy as np
    import scipy.spatial
except ImportError as why:
    sys.exit(f"analyze_peers.py: {why} (Debian: apt-get install python3-scipy python3-h5py)")

import order_peers

PHASES = 25
SCENE = """
preset = "fortini-huang-2015"
[cell]
width = 40.0
[beads]
count = {beads}
[drive]
gamma = 2.0
[start]
kind = "crystal_a"
settle_limit = 2.0
[time]
steps_per_contact = 10
discard = 1
cycles = {cycles}
phases = {phases}
"""
RANGE, WIDTH = 4.0, 0.05  # of g(r), sigma
LARGEST = 0.9  # circumradius of the triangles of an enclosed cell, sigma


def q6(frames):
    """Mean over frames of the mean over beads."""
    return float(np.mean([np.nanmean(order_peers.cutoff(r)) for r in frames]))


def g_r(frames):
    """Distance of the largest bin."""
    edges = np.arange(WIDTH / 2, RANGE + WIDTH, WIDTH)  # around multiples of the width
    found = np.zeros(len(edges) - 1)
    for r in frames:
        pairs = scipy.spatial.cKDTree(r).query_pairs(edges[-1], output_type="ndarray")
        d = r[pairs[:, 0]] - r[pairs[:, 1]]
        found += np.histogram(np.hypot(d[:, 0], d[:, 1]), edges)[0]
    g = found / (edges[1:] ** 2 - edges[:-1] ** 2)
    return float(edges[np.argmax(g)] + WIDTH / 2)


def voronoi_area(frames):
    """Mean over frames of the mean area of enclosed cells. A triangle gives each of its beads the part of its area
    next to it: (|ab|^2 cot C + |ac|^2 cot B)/8 to bead a."""
    means = []
    for r in frames:
        t = scipy.spatial.Delaunay(r)
        p = r[t.simplices]
        opposite = np.roll(p, -1, 1) - np.roll(p, 1, 1)  # side k does not touch bead k
        square = (opposite**2).sum(2)
        twice = np.abs(opposite[:, 0, 0] * opposite[:, 1, 1] - opposite[:, 0, 1] * opposite[:, 1, 0])
        cot = (square.sum(1)[:, None] - 2 * square) / (2 * twice[:, None])
        weight = square * cot
        areas = np.bincount(t.simplices.ravel(), ((weight.sum(1)[:, None] - weight) / 8).ravel(), len(r))
        wide = np.sqrt(square.prod(1)) / (2 * twice) > LARGEST
        enclosed = np.ones(len(r), bool)
        enclosed[t.simplices[wide].ravel()] = False
        enclosed[t.convex_hull.ravel()] = False
        if enclosed.any():
            means.append(areas[enclosed].mean())
    return float(np.mean(means))


# Peer, the observable whose row it stands beside, the result that is compared.
PEERS = [(q6, "bond_order", "q6"), (g_r, "pair_correlation", "g_peak_distance"), (voronoi_area, "voronoi_area", "voronoi_area")]


class Profile(NamedTuple):
    processor: float  # s
    stages: dict  # s by name
    values: dict  # scalar results by name


def run(program, *words):
    ran = subprocess.run([program, *words], capture_output=True, text=True)
    if ran.returncode != 0:
        sys.exit(f"analyze_peers.py: {ran.stderr.strip()}")
    return ran.stdout


def profile_of(program, bed, *words):
    document = json.loads(run(program, "analyze", bed, "--profile", "--json", "-q", *words))
    profile = document["profile"]
    return Profile(profile["processor_seconds"], {row["stage"]: row["seconds"] for row in profile["stages"]},
                   {name: result.get("value") for name, result in document["results"].items()})


def main():
    arguments = order_peers.arguments_of(__doc__)
    arguments.add_argument("--repetitions", type=int, default=3)
    options = arguments.parse_args()
    program = options.build / "twincell"
    cycles = max(2, -(-options.frames // PHASES))
    with tempfile.TemporaryDirectory() as temporary:
        scene, bed = Path(temporary) / "scene.toml", Path(temporary) / "bed.h5"
        scene.write_text(SCENE.format(beads=options.beads, cycles=cycles, phases=PHASES))
        run(program, "simulate", scene, "-o", bed, "-q")
        whole = [profile_of(program, bed) for _ in range(options.repetitions)]
        alone = {result: [profile_of(program, bed, "--only", result) for _ in range(options.repetitions)]
                 for _, _, result in PEERS}
        with h5py.File(bed) as file:
            frames = file["particles/trajectory/position/value"][:][:, :, (0, 2)]

    bead_frames = frames.shape[0] * frames.shape[1]

    def seconds(profiles, stage):
        return 1e6 / bead_frames * statistics.median(p.stages[stage] for p in profiles)

    found = {"bead_frames": bead_frames,
             "analyze.seconds": 1e6 / bead_frames * statistics.median(p.processor for p in whole)}
    found.update({f"analyze.{stage}": seconds(whole, stage) for stage in whole[0].stages})
    for peer, stage, result in PEERS:
        begin = time.process_time()
        value = peer(frames)
        theirs = 1e6 / bead_frames * (time.process_time() - begin)
        ours = seconds(alone[result], stage)
        name = peer.__name__
        found.update({f"{name}.twincell": ours, f"{name}.scipy": theirs, f"{name}.ratio": theirs / ours,
                      f"{name}.value": alone[result][0].values[result], f"{name}.scipy_value": value})
    if options.json:
        print(json.dumps(found, indent=2))
        return
    print(f"seconds for 10^6 bead-frames, from {bead_frames}")
    for key, value in found.items():
        print(f"  {key:<36} {value if isinstance(value, int) else format(value, '.4g')}")


if __name__ == "__main__":
    main()

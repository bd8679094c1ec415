#!/usr/bin/env python3
"""Twincell's linker beside others on the same tables of positions: links per second of processor time, and wrong links.

usage: link_peers.py BUILD [--json] [--case NAME] [--fast]

BUILD is the folder that holds twincell and bench/link_cost. Cells are simulated here, so the truth is known; beads are
shuffled within a frame, their places blurred by noise, some left out. A link is a bead seen in two consecutive frames;
it is wrong if its two names differ. The other tables move a packing by a known step: together (a bed in flight, back
and forth so that no prediction helps), or each bead by itself.

Peers: trackpy where this machine has it; and cKDTree + linear_sum_assignment, the method of Crocker and Grier with
scipy's tree and scipy's assignment, solved in connected sub-networks, written here. It is no published program.

What cannot be measured is absent, with the reason under "absent".
"""

import argparse
import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

DIAMETER = 15.0  # px
NOISE = 0.05  # px, rms per coordinate

# Name, beads, start, Gamma, cycles[, seed]. The preset has omega = 1, so that the plate moves up to
# 2 pi Gamma / N_k sigma per frame. A crystal bounces; what began at random rearranges; Gamma = 2.5 is just above the
# onset of convection from a random start (2.2 at 20 layers); the beds at Gamma = 3.2 convect. Beds differ: those of
# seeds 11 to 31 are there because one bed says little about how many links go wrong; nothing was chosen on 31.
CELLS = [
    ("bouncing_1.5", 400, "crystal_a", 1.5, 5),
    ("bouncing_2.0", 400, "crystal_a", 2.0, 5),
    ("bouncing_1600", 1600, "crystal_a", 1.5, 2),
    ("random_1.5", 400, "random", 1.5, 5),
    ("random_2.0", 400, "random", 2.0, 5),
    ("random_2.5", 400, "random", 2.5, 5),
    ("random_3.2", 400, "random", 3.2, 5),
    ("random_3.2_seed_11", 400, "random", 3.2, 5, 11),
    ("random_3.2_seed_12", 400, "random", 3.2, 5, 12),
    ("random_3.2_seed_13", 400, "random", 3.2, 5, 13),
    ("random_3.2_seed_31", 400, "random", 3.2, 5, 31),
    ("convecting_3.2", 400, "crystal_a", 3.2, 5),
]
PHASES = [80, 40, 20]

SCENE = """
preset = "fortini-huang-2015"
[cell]
width = 20.0
[beads]
count = {count}
[drive]
gamma = {gamma}
[start]
kind = "{start}"
seed = {seed}
settle_limit = 20.0
[time]
integrator = "verlet"
steps_per_contact = 20
discard = 3
cycles = {cycles}
phases = 80
"""


class Absent(Exception):
    """Why a number cannot be had."""


def load():
    try:
        import h5py
        import numpy
        import scipy.optimize
        import scipy.spatial
    except ImportError as why:
        sys.exit(f"link_peers.py: {why} (Debian: apt-get install python3-h5py python3-scipy)")
    return h5py, numpy, scipy


h5py, np, scipy = load()


# --- tables: a list of (identity, places) per frame -------------------------------------------------------------------


def table(places, missing, seed):
    rng = np.random.default_rng(seed)
    frames = []
    for p in places:
        keep = np.flatnonzero(rng.random(len(p)) >= missing)
        seen = p[keep] + rng.normal(0, NOISE, (len(keep), 2))
        order = np.argsort(seen[:, 1])  # as a locator gives them
        frames.append((keep[order], seen[order]))
    return frames


def simulated(build, cell, folder):
    name, count, start, gamma, cycles, seed = cell if len(cell) == 6 else (*cell, 3)
    scene = folder / f"{name}.toml"
    scene.write_text(SCENE.format(count=count, start=start, gamma=gamma, cycles=cycles, seed=seed))
    ran = subprocess.run([build / "twincell", "simulate", scene, "-q", "-o", folder / f"{name}.h5"], capture_output=True, text=True)
    if ran.returncode != 0:
        raise Absent((ran.stderr.strip().splitlines() or ["simulate failed"])[-1])
    with h5py.File(folder / f"{name}.h5") as f:
        r = f["particles/trajectory/position/value"][:]
    return DIAMETER * np.stack([r[:, :, 0], -r[:, :, 2]], axis=-1)


def packing(kind, rng):
    """About 400 beads, touching in a hexagonal crystal, or disordered at 0.9 of the closest distance allowed."""
    if kind == "hexagonal":
        rows = [(i + 0.5 * (j % 2), j * np.sqrt(0.75)) for j in range(20) for i in range(20)]
        return DIAMETER * np.array(rows)
    spacing = {"dense": 1.08, "dilute": 2.0}[kind]
    points = DIAMETER * spacing * np.array([(i + 0.5 * (j % 2), j * np.sqrt(0.75)) for j in range(20) for i in range(20)])
    return points + rng.uniform(-1, 1, points.shape) * 0.3 * (spacing - 1) * DIAMETER


def collective(kind, step):
    """A packing that hops by a step in a new direction each frame: nothing before the frame foretells it."""
    rng = np.random.default_rng(3)
    start = packing(kind, rng)
    angle = rng.uniform(0, 2 * np.pi, 60)
    way = step * DIAMETER * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    way[0] = 0
    return [start + w for w in np.cumsum(way, axis=0)]


def independent(kind, step):
    rng = np.random.default_rng(4)
    start = packing(kind, rng)
    out = [start]
    for _ in range(40):
        angle = rng.uniform(0, 2 * np.pi, len(start))
        out.append(start + step * DIAMETER * np.stack([np.cos(angle), np.sin(angle)], axis=-1) * rng.random((len(start), 1)))
    return out


# --- linkers: names per frame, and seconds -----------------------------------------------------------------------------


def twincell(build, frames, folder, phases=0, fall=0.0, repetitions=3):
    path = folder / "table.bin"
    with path.open("wb") as out:
        out.write(np.int64(len(frames)).tobytes())
        for _, places in frames:
            out.write(np.int64(len(places)).tobytes() + places.astype("<f8").tobytes())
    ran = subprocess.run([build / "bench/link_cost", path, str(DIAMETER), str(phases), str(fall), "3", str(repetitions)],
                         capture_output=True, text=True)
    if ran.returncode != 0:
        raise Absent((ran.stderr.strip().splitlines() or ["link_cost failed"])[-1])
    report = json.loads(ran.stdout)
    records = np.fromfile(f"{path}.ids", "<i8").reshape(-1, 2)
    ends = np.cumsum([len(places) for _, places in frames])[:-1]
    return np.split(records[:, 0], ends), report["seconds"], np.split(records[:, 1], ends)


def crocker_grier(frames, reach=0.5 * DIAMETER, memory=3, largest=400):
    """Nearest within reach, sub-networks by linear_sum_assignment; no prediction, as trackpy's default is."""
    start = time.process_time()
    names, alive, count = [], [], 0  # alive: [name, place, missed]
    for _, places in frames:
        now = np.full(len(places), -1)
        if alive and len(places):
            old = np.array([a[1] for a in alive])
            pairs = scipy.spatial.cKDTree(old).sparse_distance_matrix(scipy.spatial.cKDTree(places), reach, output_type="coo_matrix")
            graph = scipy.sparse.bmat([[None, pairs], [pairs.T, None]]) if pairs.nnz else None
            if graph is not None:
                _, label = scipy.sparse.csgraph.connected_components(graph, directed=False)
                order = np.argsort(label[pairs.row], kind="stable")
                rows, columns, distances = pairs.row[order], pairs.col[order], pairs.data[order]
                cuts = np.flatnonzero(np.diff(label[rows])) + 1
                for r, c, d in zip(np.split(rows, cuts), np.split(columns, cuts), np.split(distances, cuts)):
                    if len(r) == 1:
                        now[c[0]] = r[0]
                        continue
                    ur, ir = np.unique(r, return_inverse=True)
                    uc, ic = np.unique(c, return_inverse=True)
                    if len(ur) > largest:
                        raise Absent(f"a sub-network of {len(ur)} beads")
                    cost = np.full((len(ur), len(uc) + len(ur)), 1e9)
                    cost[ir, ic] = d**2
                    cost[np.arange(len(ur)), len(uc) + np.arange(len(ur))] = reach**2
                    for i, j in zip(*scipy.optimize.linear_sum_assignment(cost)):
                        if j < len(uc) and cost[i, j] < 1e8:
                            now[uc[j]] = ur[i]
        following, given, kept = [], np.empty(len(places), dtype=np.int64), set()
        for k, a in enumerate(now):
            if a >= 0:
                kept.add(a)
                given[k] = alive[a][0]
            else:
                given[k] = count
                count += 1
            following.append([given[k], places[k], 0])
        for a, track in enumerate(alive):
            if a not in kept and track[2] < memory:
                following.append([track[0], track[1], track[2] + 1])
        alive = following
        names.append(given)
    return names, time.process_time() - start, None


def trackpy(frames, reach=0.5 * DIAMETER, memory=3):
    try:
        import pandas
        import trackpy as tp
    except ImportError:
        raise Absent("trackpy is not installed (it is no Debian package)") from None
    tp.quiet()
    rows = pandas.concat([pandas.DataFrame({"x": p[:, 0], "y": p[:, 1], "frame": f}) for f, (_, p) in enumerate(frames)], ignore_index=True)
    start = time.process_time()
    try:
        linked = tp.link(rows, reach, memory=memory)
    except tp.SubnetOversizeException as why:
        raise Absent(str(why).splitlines()[0]) from None
    seconds = time.process_time() - start
    return [linked.loc[linked.frame == f].sort_index().particle.to_numpy() for f in range(len(frames))], seconds, None


def score(frames, names, ambiguous):
    links = wrong = flagged = 0
    before = {}
    for f, (who, _) in enumerate(frames):
        now = dict(zip(who, names[f]))
        marks = dict(zip(who, ambiguous[f])) if ambiguous else {}
        for bead, name in now.items():
            if bead in before:
                links += 1
                if before[bead] != name:
                    wrong += 1
                    flagged += marks.get(bead, 0) > 0
        before = now
    return links, wrong, int(flagged)


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("build", type=lambda path: Path(path).resolve())
    arguments.add_argument("--json", action="store_true")
    arguments.add_argument("--case", help="only cases whose name contains this")
    arguments.add_argument("--fast", action="store_true", help="half of the cells, for a quick look")
    options = arguments.parse_args()
    document, absent = {}, {}

    def measure(case, frames, phases=0, fall=0.0, peers=True):
        if options.case and options.case not in case:
            return
        linkers = {"twincell": lambda: twincell(options.build, frames, folder, phases, fall)}
        if peers:
            linkers |= {"kdtree_assignment": lambda: crocker_grier(frames), "trackpy": lambda: trackpy(frames)}
        for name, link in linkers.items():
            try:
                names, seconds, marks = link()
            except Absent as why:
                absent[f"{case}.{name}"] = str(why)
                continue
            links, wrong, flagged = score(frames, names, marks)
            document[f"{case}.links"] = links
            document[f"{case}.{name}.wrong"] = wrong
            document[f"{case}.{name}.links_per_s"] = links / seconds
            if marks:
                document[f"{case}.{name}.ambiguous"] = int(sum(m.sum() for m in marks))
                document[f"{case}.{name}.wrong_flagged"] = flagged
        print(f"bench: {case}: " + ", ".join(f"{k.split(case + '.')[1]} {v:.4g}" for k, v in document.items() if k.startswith(case + ".")), file=sys.stderr)

    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        for cell in CELLS[:: 2 if options.fast else 1]:
            wanted = [n for n in PHASES if not options.case or options.case in f"cell_{cell[0]}_{n}_phases"]
            if not wanted:
                continue
            try:
                places = simulated(options.build, cell, folder)
            except Absent as why:
                absent[f"cell_{cell[0]}"] = str(why)
                continue
            for n in wanted:
                fall = (2 * np.pi / n) ** 2 * DIAMETER
                measure(f"cell_{cell[0]}_{n}_phases", table(places[:: 80 // n], 0, 1), n, fall)
                if n == 20:
                    measure(f"cell_{cell[0]}_{n}_phases_unlocked", table(places[:: 80 // n], 0, 1), peers=False)
                    measure(f"cell_{cell[0]}_{n}_phases_missing_1%", table(places[:: 80 // n], 0.01, 1), n, fall)
        for kind in ("hexagonal", "dense", "dilute"):
            for step in (0.1, 0.3, 0.45, 0.5, 0.7, 1.0):
                measure(f"together_{kind}_{step}d", table(collective(kind, step), 0, 1))
            measure(f"together_{kind}_0.45d_missing_5%", table(collective(kind, 0.45), 0.05, 1))
        for kind in ("dense", "dilute"):
            for step in (0.1, 0.2, 0.3, 0.4, 0.5):
                measure(f"apart_{kind}_{step}d", table(independent(kind, step), 0, 1))
            measure(f"apart_{kind}_0.3d_missing_5%", table(independent(kind, 0.3), 0.05, 1))

    if options.json:
        print(json.dumps({**document, "absent": absent}, indent=2))
        return
    linkers = ["twincell", "kdtree_assignment", "trackpy"]
    print("wrong links, of those: not said to be ambiguous (thousand links per second of processor time)")
    print(f"{'':<44}" + "".join(f"{n:>20}" for n in ["links", *linkers]))
    for case in dict.fromkeys(key.rsplit(".links", 1)[0] for key in document if key.endswith(".links")):
        cells = [str(document[f"{case}.links"])]
        for name in linkers:
            wrong = document.get(f"{case}.{name}.wrong")
            flagged = document.get(f"{case}.{name}.wrong_flagged")
            silent = "" if flagged is None else f", {wrong - flagged}"
            cells.append("-" if wrong is None else f"{wrong}{silent} ({document[f'{case}.{name}.links_per_s'] / 1e3:.0f})")
        print(f"{case:<44}" + "".join(f"{c:>20}" for c in cells))
    reasons = sorted(set(absent.values()))
    for why in reasons:
        print(f"  absent: {why}: {sum(v == why for v in absent.values())} numbers")


if __name__ == "__main__":
    main()

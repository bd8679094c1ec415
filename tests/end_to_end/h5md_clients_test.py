"""Other people's readers open our trajectories and see the same numbers.

usage: h5md_clients_test.py TRAJECTORY.h5 EXPECTED.csv CLIENT

CLIENT is h5py or mdanalysis. EXPECTED.csv, written by a C++ program from the numbers in memory, holds
frame,time,slot,x,y,z. Exit code 77 means that the client is not installed.
"""

import csv
import math
import sys
from collections import defaultdict

SKIPPED = 77


def expected_positions(path):
    times, positions = {}, defaultdict(dict)
    with open(path, newline="") as stream:
        for row in csv.DictReader(stream):
            frame = int(row["frame"])
            times[frame] = float(row["time"])
            positions[frame][int(row["slot"])] = tuple(float(row[axis]) for axis in "xyz")
    return times, positions


def differs(a, b, tolerance):
    if math.isnan(a) or math.isnan(b):
        return math.isnan(a) != math.isnan(b)
    return abs(a - b) > tolerance * max(1.0, abs(b))


def compare(name, n_frames, time_of, position_of, times, positions, tolerance):
    assert n_frames == len(times), f"{name}: {n_frames} frames, expected {len(times)}"
    worst = 0.0
    for frame, slots in positions.items():
        assert not differs(time_of(frame), times[frame], tolerance), f"{name}: time of frame {frame}"
        seen = position_of(frame)
        assert len(seen) == len(slots), f"{name}: {len(seen)} beads, expected {len(slots)}"
        for slot, truth in slots.items():
            for axis in range(3):
                assert not differs(float(seen[slot][axis]), truth[axis], tolerance), f"{name}: frame {frame} slot {slot}: {seen[slot]} != {truth}"
                if not math.isnan(truth[axis]):
                    worst = max(worst, abs(float(seen[slot][axis]) - truth[axis]))
    print(f"{name}: {n_frames} frames agree, largest difference {worst:.3g} sigma")


def with_h5py(path, times, positions):
    import h5py

    with h5py.File(path, "r") as f:
        assert list(f["h5md"].attrs["version"]) == [1, 1]
        group = f["particles/trajectory"]
        assert f["particles/trajectory/box"].attrs["dimension"] == 3
        assert all(b in (b"none", b"periodic") for b in f["particles/trajectory/box"].attrs["boundary"])
        edges = group["box/edges/value"]
        assert edges.shape == (len(times), 3, 3)
        for element in ("box/edges", "velocity", "id"):
            for shared in ("step", "time"):
                assert group[element][shared] == group["position"][shared], f"{element}/{shared} is not the same object"
        assert (group["id/value"][:, :][~(group["position/value"][:, :, 0] == group["position/value"][:, :, 0])] == -1).all()
        compare("h5py", group["position/value"].shape[0], lambda i: float(group["position/time"][i]),
                lambda i: group["position/value"][i], times, positions, 0.0)


def with_mdanalysis(path, times, positions):
    import warnings

    warnings.filterwarnings("ignore")
    import MDAnalysis

    universe = MDAnalysis.Universe.empty(len(positions[0]), trajectory=True)
    universe.load_new(path, format="H5MD", convert_units=False)
    trajectory = universe.trajectory
    box = list(trajectory[0].dimensions)
    assert all(abs(a - b) < 1e-5 for a, b in zip(box, (20, 1.15, 40, 90, 90, 90))), f"MDAnalysis sees the box {box}"
    compare("MDAnalysis", len(trajectory), lambda i: trajectory[i].time, lambda i: trajectory[i].positions.copy(), times, positions, 1e-6)
    assert abs(trajectory[5].data["plate_height"] - 1.5) < 1e-12, "a quarter of a cycle: the plate is at A = 1.5"


def main():
    path, table, client = sys.argv[1:4]
    times, positions = expected_positions(table)
    try:
        {"h5py": with_h5py, "mdanalysis": with_mdanalysis}[client](path, times, positions)
    except ImportError as missing:
        print(f"skipped: {missing}")
        sys.exit(SKIPPED)


main()

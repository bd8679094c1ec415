#!/usr/bin/env python3
"""Bead locators beside each other on rendered frames whose truth and Cramér–Rao bound are known.

usage: locate_peers.py BUILD [--json] [--frames N] [--case NAME]... [--snr S]... [--method NAME]...

BUILD is the folder that holds bench/locate_truth, which renders the frames (600 x 1500 px, 1600 opaque discs of
15 px, blur 0.8 px; sparse, hexagonal and random touching packings at four noise levels, and hard cases), computes
the bound, and measures this library and OpenCV's two Hough transforms. trackpy and scikit-image read the same
frames here, if this Python has them. All in one thread, timed in milliseconds of processor time; of several runs
the fastest.

rms and bias are per coordinate, in px; bound is the smallest standard deviation that an unbiased estimate of x and
y can have, rms over the beads; locking is the amplitude of the error's first harmonic in the sub-pixel place.
What cannot be measured is absent, with the reason under "absent".
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
import warnings
from pathlib import Path

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ[name] = "1"  # before numpy is loaded


class Absent(Exception):
    """Why a peer is not measured."""


def read_pgm(path):
    import numpy
    data = path.read_bytes()
    _, width, height, _ = data.split(maxsplit=4)[:4]
    return numpy.frombuffer(data[-int(width) * int(height):], numpy.uint8).reshape(int(height), int(width))


def trackpy_locate():
    """trackpy.locate with the bead's diameter, separation 0.8 of it; features below half the median mass dropped."""
    try:
        import trackpy
    except ImportError:
        raise Absent("trackpy is not installed (not in Debian; pip install trackpy)") from None
    trackpy.quiet()

    def find(picture, diameter):
        odd = 2 * int(diameter / 2) + 1
        features = trackpy.locate(255 - picture, odd, separation=0.8 * diameter)
        return features[features.mass > 0.5 * features.mass.median()]
    return find


def trackpy_leastsq():
    """The same, then trackpy's least-squares refinement, a bead at a time: touching beads make one cluster otherwise."""
    locate = trackpy_locate()
    import trackpy

    def find(picture, diameter):
        odd = 2 * int(diameter / 2) + 1
        return trackpy.refine_leastsq(locate(picture, diameter), 255 - picture, odd, separation=0.7 * diameter)
    return find


def skimage_hough():
    """skimage.transform.hough_circle on Canny edges, smoothed; the best peaks 0.8 diameters apart, sub-pixel by a parabola."""
    try:
        import numpy
        from scipy import spatial
        from skimage import feature, filters, transform
    except ImportError:
        raise Absent("scikit-image is not installed (Debian: apt-get install python3-skimage)") from None

    def find(picture, diameter):
        radii = numpy.arange(int(diameter / 2), int(diameter / 2) + 2)
        edges = feature.canny(picture, sigma=1.0)
        votes = filters.gaussian(transform.hough_circle(edges, radii).sum(axis=0), 1.0)
        peaks = feature.peak_local_max(votes, min_distance=3, threshold_rel=0.5, exclude_border=False)  # best first
        dropped = numpy.zeros(len(peaks), bool)
        for k, rivals in enumerate(spatial.cKDTree(peaks).query_ball_point(peaks, 0.8 * diameter)):
            if not dropped[k]:
                dropped[[j for j in rivals if j > k]] = True
        found = []
        for y, x in peaks[~dropped]:
            offset = [0.0, 0.0]
            for axis, (dy, dx) in enumerate(((0, 1), (1, 0))):
                if 0 < y < votes.shape[0] - 1 and 0 < x < votes.shape[1] - 1:
                    before, here, after = votes[y - dy, x - dx], votes[y, x], votes[y + dy, x + dx]
                    if before + after < 2 * here:
                        offset[axis] = 0.5 * (before - after) / (before - 2 * here + after)
            found.append((x + offset[0], y + offset[1]))
        return found
    return find


# Name, maker, noise levels at which it is worth its time (none: all).
PEERS = [
    ("trackpy", trackpy_locate, None),
    ("trackpy leastsq", trackpy_leastsq, [51.0]),
    ("scikit-image hough", skimage_hough, None),
]


def run_peers(frames, found, wanted_methods):
    """Lets every peer find the beads of every frame. Returns the reasons of those that cannot."""
    absent = {}
    index = json.loads((frames / "index.json").read_text())
    for name, make, levels in PEERS:
        if wanted_methods and not any(part in name for part in wanted_methods):
            continue
        try:
            find = make()
            for frame in index:
                if levels and (frame["snr"] not in levels or frame["number"] > 0):
                    continue
                picture = read_pgm(frames / f"{frame['frame']}.pgm")
                with warnings.catch_warnings():
                    warnings.simplefilter("ignore")
                    began = time.process_time()
                    beads = find(picture, frame["diameter"])
                    ms = 1000 * (time.process_time() - began)
                points = beads[["x", "y"]].to_numpy() if hasattr(beads, "to_numpy") else beads
                (found / name).mkdir(exist_ok=True)
                lines = [f"{ms}", *(f"{x},{y}" for x, y in points)]
                (found / name / f"{frame['frame']}.csv").write_text("\n".join(lines) + "\n")
            print(f"bench: {name}", file=sys.stderr)
        except Absent as why:
            absent[name] = str(why)
        except Exception as why:  # another program's fault must not cost us the table
            absent[name] = f"stopped: {type(why).__name__}: {why}"
    return absent


def worst(rows):
    """What the goals are about, per way of ours: over the three packings, all at 15 px. Goals: recall and precision 1 at SNR >= 18,
    rms at most 1.15 bounds (exact), bias below a tenth of rms, 25 ms per frame (exact) or 10 ms (fast)."""
    summary = {}
    for method in sorted({row["method"] for row in rows if row["method"].startswith("twincell")}):
        own = [row for row in rows if row["method"] == method and row["case"] in ("sparse", "hexagonal", "random")]
        clear = [row for row in own if row["snr"] >= 18]
        fitted = [row for row in own if "rms" in row]
        if clear and fitted:
            summary[method] = {
                "recall": min(row["recall"] for row in clear), "precision": min(row["precision"] for row in clear),
                "rms_over_bound": max(row["rms_over_bound"] for row in fitted),
                "bias_over_rms": max(row["bias"] / row["rms"] for row in fitted),
                "locking_over_rms": max(row["locking"] / row["rms"] for row in fitted),
                "ms_per_frame": max(row["ms_per_frame"] for row in own)}
    return summary


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("build", type=lambda path: Path(path).resolve())
    arguments.add_argument("--json", action="store_true")
    arguments.add_argument("--frames", type=int, default=3)
    arguments.add_argument("--case", action="append", default=[])
    arguments.add_argument("--snr", action="append", default=[])
    arguments.add_argument("--method", action="append", default=[], help="only methods with this in their name")
    options = arguments.parse_args()

    program = options.build / "bench/locate_truth"
    selection = ["--frames", str(options.frames)]
    for key, values in (("--case", options.case), ("--snr", options.snr), ("--method", options.method)):
        for value in values:
            selection += [key, value]
    with tempfile.TemporaryDirectory() as temporary:
        frames, found = Path(temporary) / "frames", Path(temporary) / "found"
        found.mkdir()
        subprocess.run([program, *selection, "--write", frames], check=True)
        absent = run_peers(frames, found, options.method)
        ran = subprocess.run([program, *selection, "--read", found], check=True, stdout=subprocess.PIPE, text=True)
    document = {**json.loads(ran.stdout), "absent": absent}
    document["worst"] = worst(document["rows"])
    if options.json:
        print(json.dumps(document, indent=1))
        return

    def number(row, key, form):
        return format(row[key], form) if key in row else "-"

    above = None
    for row in document["rows"]:
        if (row["case"], row["snr"]) != above:
            above = (row["case"], row["snr"])
            print(f"\n{row['case']}, SNR {row['snr']:g}: {row['what']}; Cramér–Rao bound {row['bound']:.5f} px")
            print(f"  {'':<24} recall  precision   rms px  rms/bound  bias px  locking px  ms/frame")
        print(f"  {row['method']:<24} {row['recall']:.4f}     {row['precision']:.4f}  {number(row, 'rms', '.5f'):>7}"
              f"  {number(row, 'rms_over_bound', '.2f'):>9}  {number(row, 'bias', '.5f'):>7}"
              f"  {number(row, 'locking', '.5f'):>10}  {row['ms_per_frame']:8.1f}")
    if document["worst"]:
        print("\nworst of sparse, hexagonal and random (recall and precision: at SNR >= 18)")
        print(f"  {'':<24} recall  precision  rms/bound  bias/rms  locking/rms  ms/frame")
    for method, w in document["worst"].items():
        print(f"  {method:<24} {w['recall']:.4f}     {w['precision']:.4f}  {w['rms_over_bound']:9.2f}  {w['bias_over_rms']:8.3f}"
              f"  {w['locking_over_rms']:11.3f}  {w['ms_per_frame']:8.1f}")
    print()
    for name, why in absent.items():
        print(f"{name}: absent, {why}")


main()

#!/usr/bin/env python3
"""The second paper's gases at W = 50: beads that fly from contact to contact, the same moved by steps, and LAMMPS.

usage: gas_peers.py BUILD [--json] [--repetitions N] [--job NAME]

As sim_peers.py, whose pieces and rules these are: all three run the same whole periods of the same gas, in turn;
LAMMPS from the state that ours has reached, with the steps that the scene asks for. Printed are milliseconds of
processor time per period of the drive, and quotients.

fig2: all of the second paper's Fig. 2 (`twincell reproduce p2-fig2 --budget`, four systems at 38 frequencies until the
standard error of T_z is 1 %): minutes from nothing to the figure, on all processors.
"""

import contextlib
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from sim_peers import SCENE, Absent, Ours, lammps_cpu_seconds, read_options, show

GAS = """
preset = "bhateja-2016-{system}"
[drive]
k_m = 50.0
[start]
settle_limit = 2.0
[time]
integrator = "verlet"
steps_per_contact = 50
stepping = "{stepping}"
discard = 50
cycles = {cycles}
phases = 4
"""
JOBS = ["rough-2d", "smooth-2d", "rough-3d", "smooth-3d", "fig2"]
CURVES = ["2D rough", "3D rough", "2D smooth", "3D smooth"]  # of Fig. 2
PERIODS = 100  # a piece, of ours
LAMMPS_PERIODS = 5


def measure(build, system, repetitions):
    """Milliseconds per period by who runs it, and reasons of what is absent."""
    spent = {"flights": [], "steps": [], "lammps": []}
    absent = {}
    with tempfile.TemporaryDirectory() as temporary, contextlib.ExitStack() as running:
        folder = Path(temporary)

        def engine(stepping):
            own = folder / stepping
            own.mkdir()
            scene = GAS.replace("{system}", system).replace("{stepping}", stepping)
            (own / SCENE).write_text(scene.replace("{cycles}", str(PERIODS * repetitions)))
            return own, running.enter_context(Ours(build, SCENE, PERIODS, own))

        (own, flights), (_, steps) = engine("event-driven"), engine("steps")
        for _ in range(repetitions):
            piece = flights.answer()
            steps.answer()
            # Everybody waits now: what is timed runs alone.
            spent["flights"].append(1e3 * flights.run() / PERIODS)
            spent["steps"].append(1e3 * steps.run() / PERIODS)
            if "lammps" not in absent:
                try:
                    count = piece["steps"] * LAMMPS_PERIODS // PERIODS
                    spent["lammps"].append(1e3 * lammps_cpu_seconds(build, piece["state"], count, own) / LAMMPS_PERIODS)
                except Absent as why:
                    absent["lammps"] = str(why)
    numbers = {f"{who}_ms": statistics.median(times) for who, times in spent.items() if times}
    numbers["beads"] = piece["beads"]
    numbers["ratio_steps"] = statistics.median(b / a for a, b in zip(spent["flights"], spent["steps"]))
    if "lammps" not in absent:
        numbers["ratio_lammps"] = statistics.median(b / a for a, b in zip(spent["flights"], spent["lammps"]))
    return numbers, absent


def figure_2(build):
    """How long Fig. 2 takes, and what of it is known how well."""
    with tempfile.TemporaryDirectory() as temporary:
        begin, before = time.monotonic(), os.times().children_user
        done = subprocess.run([build / "twincell", "reproduce", "p2-fig2", "--budget", "60", "-o", Path(temporary) / "p2-fig2",
                               "--json"], stdout=subprocess.PIPE, check=False)
        minutes = (time.monotonic() - begin) / 60
        processor_minutes = (os.times().children_user - before) / 60
    if done.returncode != 0:
        raise Absent(f"twincell reproduce ended with {done.returncode}")
    points = [p for p in json.loads(done.stdout)["measured"] if p["curve"] in CURVES]
    return {
        "minutes": minutes,
        "processor_minutes": processor_minutes,
        "processors": len(os.sched_getaffinity(0)),
        "points": len(points),
        "points_as_precise_as_asked": sum(p["until"]["reached"] for p in points),
        "periods": sum(p["cycles"] for p in points),
    }


def main():
    options = read_options(__doc__, JOBS)
    document, absent = {}, {}
    for job in JOBS:
        if options.job and job not in options.job:
            continue
        print(f"bench: {job}", file=sys.stderr)
        try:
            if job == "fig2":
                numbers, reasons = figure_2(options.build), {}
            else:
                numbers, reasons = measure(options.build, job, options.repetitions)
        except Absent as why:
            absent[job] = str(why)
            continue
        absent.update({f"{job}.{key}": why for key, why in reasons.items()})
        document.update({f"{job}.{key}": value for key, value in numbers.items()})
    show("milliseconds of processor time per period at W = 50, and quotients by the time of flights", document, absent,
         options.json)


main()

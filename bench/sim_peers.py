#!/usr/bin/env python3
"""Twincell beside LAMMPS on the same pieces of the same runs, in particle-steps per second of processor time.

usage: sim_peers.py BUILD [--json] [--repetitions N] [--job NAME]

BUILD is the folder that holds twincell and bench/period_cost. Every piece begins in a state that Twincell
reached; both programs start from it and run the same whole periods of the drive, in turn. Set-up is not counted:
ours is measured between two steps, LAMMPS's is its loop time times its use of the processor. Numbers are medians
over the repetitions, ratios medians of the quotients of one repetition. A row per job is appended to
bench/results/MACHINE.csv.

At equal accuracy of the whole impact: `twincell cost sim` finds how many steps per contact velocity Verlet, LAMMPS's
integrator, needs for the spin of a bed's impacts to be right to 1 %, rms, and how few our split steps need to be no
less accurate than that in e, v_t' and w'. The quotient is of the times of the same periods so. LAMMPS's is
extrapolated: what it takes at n = 50 and at n = 150, along a line in n, since its work is per step but for its lists.

The beds at rest (rest_1600, rest_20k, rest_100k) lie on a plate that barely moves, so that every listed pair touches:
the rate should not fall with the number of beads. speedup_2 is their rate by the clock with 2 threads divided by that
with 1, lammps_speedup_2 the same of LAMMPS on 2 ranks and 1; both ask for two free processors.

What cannot be measured is absent, with the reason under "absent".
"""

import argparse
import contextlib
import csv
import datetime
import json
import os
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parent.parent
SCENE = "scene.toml"  # in the folder of a job
CHEAPER = "cheaper.toml"  # the same, as accurate in fewer steps
STEPS = 50  # per contact
FINER = 3  # times as many, for the line along which LAMMPS's time is extrapolated

# The first paper's bed at Gamma = 2, loose from the start so that it has defects, after five driven periods.
SHAKER = """
preset = "fortini-huang-2015"
[cell]
width = 20.0
[beads]
count = {count}
[drive]
gamma = 2.0
[start]
kind = "random"
settle_limit = 20.0
[time]
integrator = "verlet"
steps_per_contact = 50
discard = 5
cycles = {cycles}
phases = 4
"""

# The second paper's gas of rough spheres, at W = 50 and wider where there are more than its hundred.
GAS = """
preset = "bhateja-2016-rough-3d"
[cell]
width = {width}
depth = {width}
[drive]
k_m = 50.0
[start]
settle_limit = 2.0
[time]
integrator = "verlet"
steps_per_contact = 50
stepping = "steps"
discard = {discard}
cycles = {cycles}
phases = 4
"""

# The first paper's beads in a crystal on a plate that moves by 2.5e-7 sigma; a period is some 700 steps.
# Samples of the temperature would divide so short a period into calls of two steps.
REST = """
preset = "fortini-huang-2015"
[cell]
width = {width}
[beads]
count = {count}
[drive]
gamma = 0.01
omega = 200.0
[start]
kind = "crystal_a"
settle_limit = 0.5
[time]
integrator = "verlet"
steps_per_contact = 50
discard = 1
cycles = {cycles}
phases = 4
samples = 0
"""


class Job(NamedTuple):
    name: str
    scene: str
    periods: int  # in a piece
    equal_accuracy: bool = False  # also at equal accuracy
    threads: int = 1  # also with so many threads, in elapsed time


JOBS = [
    Job("shaker_1600", SHAKER.replace("{count}", "1600"), 1, equal_accuracy=True),
    Job("shaker_1600_unequal", SHAKER.replace("{count}", '1600\nspread = "uniform"\nspread_width = 0.1'), 1),
    Job("shaker_400", SHAKER.replace("{count}", "400"), 1),
    Job("gas_3d", GAS.replace("{width}", "5.0").replace("{discard}", "50"), 50),
    Job("gas_3d_1600", GAS.replace("{width}", "20.0").replace("{discard}", "20"), 3),
    Job("rest_1600", REST.replace("{width}", "40.0").replace("{count}", "1600"), 20, threads=2),
    Job("rest_20k", REST.replace("{width}", "100.0").replace("{count}", "20000"), 4, threads=2),
    Job("rest_100k", REST.replace("{width}", "250.0").replace("{count}", "100000"), 1, threads=2),
]


class Absent(Exception):
    """Why a number cannot be had."""


def said(stderr, code):
    """The one sentence of a program that refused."""
    return (stderr.strip().splitlines() or [f"exit code {code}"])[-1]


class Ours:
    """period_cost, a piece at a time; its states are in a folder beside the scene."""

    def __init__(self, build, scene, periods, folder, threads=1):
        states = folder / f"{scene.removesuffix('.toml')}_{threads}"
        states.mkdir()
        self.process = subprocess.Popen([build / "bench/period_cost", scene, str(periods), states, str(threads)], cwd=folder,
                                        stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.kill()
        self.process.wait()

    def answer(self):
        line = self.process.stdout.readline()
        if not line:
            raise Absent(said(self.process.stderr.read(), self.process.wait()))
        return json.loads(line)

    def run(self, clock="cpu_s"):
        self.process.stdin.write("\n")
        self.process.stdin.flush()
        return self.answer()[clock]


def lammps_cpu_seconds(build, state, steps, folder, finer=1):
    """Processor seconds of one piece in LAMMPS; in `finer` times as many steps."""
    elapsed, use = lammps_loop(build, state, steps, folder, finer)
    return elapsed * use


def lammps_loop(build, state, steps, folder, finer=1, ranks=1):
    """Elapsed seconds and use of the processor of one piece in LAMMPS from the deck that we export, without its dump."""
    if not shutil.which("lmp"):
        raise Absent("LAMMPS is not installed (Debian: apt-get install lammps)")
    deck = folder / "deck"
    shutil.rmtree(deck, ignore_errors=True)
    exported = subprocess.run([build / "twincell", "export", SCENE, "--to", "lammps", "-q", "-o", "deck", "--from", state,
                               "--set", "time.cycles=1", "--set", "time.discard=0",
                               "--set", f"time.steps_per_contact={STEPS * finer}"], cwd=folder, capture_output=True, text=True)
    if exported.returncode != 0:
        raise Absent(said(exported.stderr, exported.returncode))
    text = (deck / "in.twincell").read_text()
    text = re.sub(r"(?m)^dump.*\n", "", text)
    text, runs = re.subn(r"(?m)^run .*$", f"run {steps * finer}", text)
    assert runs == 1, "a deck has one run"
    (deck / "in.twincell").write_text(text)
    if ranks > 1 and not shutil.which("mpirun"):
        raise Absent("mpirun is not installed (Debian: apt-get install openmpi-bin)")
    launcher = ["mpirun", "-np", str(ranks)] if ranks > 1 else []
    ran = subprocess.run([*launcher, "lmp", "-in", "in.twincell", "-log", "none"], cwd=deck, capture_output=True, text=True,
                         env={**os.environ, "OMP_NUM_THREADS": "1", "OMPI_ALLOW_RUN_AS_ROOT": "1",
                              "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"})
    loop = re.search(rf"Loop time of (\S+) on {ranks} procs", ran.stdout)
    use = re.search(r"([\d.]+)% CPU use", ran.stdout)
    if ran.returncode != 0 or not loop or not use:
        raise Absent("LAMMPS stopped: " + (re.findall(r"(?m)^ERROR.*", ran.stdout) or [said(ran.stderr, ran.returncode)])[0])
    return float(loop[1]), float(use[1]) / 100


def equal_impacts(build):
    """Steps per contact of Verlet and of split for one accuracy of a bed's impacts."""
    ran = subprocess.run([build / "twincell", "cost", "sim", "--quick", "--json", "-q"], capture_output=True, text=True)
    if ran.returncode != 0:
        raise Absent(f"`twincell cost sim` does not say how many steps are as accurate: {said(ran.stderr, ran.returncode)}")
    try:
        found = json.loads(ran.stdout)["equal_impacts"]
        return float(found["verlet"]["n"]), float(found["split"]["n"])
    except (KeyError, TypeError, ValueError) as why:
        raise Absent(f"`twincell cost sim --json` has no key {why}") from None


def in_split_steps(scene, n):
    return re.sub(r"(?m)^steps_per_contact = .*$", f"steps_per_contact = {n}", scene.replace('"verlet"', '"split"'))


def speedup(build, job, folder, repetitions, unless_absent):
    """How many times as fast a job runs by the clock with its threads as with one: ours, and LAMMPS's with ranks."""
    ours, lammps = [], []
    with contextlib.ExitStack() as running:
        one, many = (running.enter_context(Ours(build, SCENE, job.periods, folder / f"threads_{n}", n)) for n in (1, job.threads))
        for _ in range(repetitions):
            piece = one.answer()
            many.answer()
            alone = one.run("elapsed_s")
            ours.append(alone / many.run("elapsed_s"))
            lammps.append(unless_absent(f"lammps_speedup_{job.threads}", lambda: (
                lammps_loop(build, piece["state"], piece["steps"], folder)[0]
                / lammps_loop(build, piece["state"], piece["steps"], folder, ranks=job.threads)[0])))
    found = {f"speedup_{job.threads}": statistics.median(ours)}
    if None not in lammps:
        found[f"lammps_speedup_{job.threads}"] = statistics.median(lammps)
    return found


def measure(build, job, repetitions):
    """Numbers of one job by key, and reasons of those that are absent. Absent if Twincell's own are."""
    name, scene, periods, equal_accuracy, threads = job
    ours, lammps, finer, cheaper = [], [], [], []  # seconds of the processor, a piece each
    absent = {}

    def unless_absent(key, measured):
        if key not in absent:
            try:
                return measured()
            except Absent as why:
                absent[key] = str(why)
        return None

    with tempfile.TemporaryDirectory() as temporary, contextlib.ExitStack() as running:
        folder = Path(temporary)

        def engine(file, text):
            (folder / file).write_text(text)
            return running.enter_context(Ours(build, file, periods, folder))

        scene = scene.replace("{cycles}", str(periods * repetitions))
        first = engine(SCENE, scene)
        second = None
        if equal_accuracy:
            equal = unless_absent("ratio_equal_accuracy", lambda: equal_impacts(build))
            if equal:
                second = unless_absent("ratio_equal_accuracy", lambda: engine(CHEAPER, in_split_steps(scene, equal[1])))
        for _ in range(repetitions):
            piece = first.answer()
            if second:
                unless_absent("ratio_equal_accuracy", second.answer)
            # Everybody waits now: what is timed runs alone.
            ours.append(first.run())
            lammps.append(unless_absent("lammps", lambda: lammps_cpu_seconds(build, piece["state"], piece["steps"], folder)))
            if second:
                cheaper.append(unless_absent("ratio_equal_accuracy", second.run))
                finer.append(unless_absent("ratio_equal_accuracy",
                                           lambda: lammps_cpu_seconds(build, piece["state"], piece["steps"], folder, FINER)))

        # The others wait at their last piece and cost nothing.
        faster = {}
        if threads > 1:
            for n in (1, threads):
                (folder / f"threads_{n}").mkdir()
                (folder / f"threads_{n}" / SCENE).write_text(scene)
            faster = speedup(build, job, folder, repetitions, unless_absent)

    work = piece["beads"] * piece["steps"]
    numbers = {"beads": piece["beads"], "steps": piece["steps"], "twincell": work / statistics.median(ours), **faster}
    if "lammps" not in absent:
        numbers["lammps"] = work / statistics.median(lammps)
        numbers["ratio_lammps"] = statistics.median(b / a for a, b in zip(ours, lammps))
        if equal_accuracy and "ratio_equal_accuracy" not in absent:
            numbers["verlet_steps_at_1_percent"], numbers["split_steps_at_1_percent"] = equal
            slow = [b + (c - b) * (equal[0] - STEPS) / (STEPS * (FINER - 1)) for b, c in zip(lammps, finer)]
            numbers["ratio_equal_accuracy"] = statistics.median(b / a for a, b in zip(cheaper, slow))
    return numbers, {f"{name}.{key}": why for key, why in absent.items()}


def machine():
    model = re.search(r"model name\s*:\s*(.*)", Path("/proc/cpuinfo").read_text())
    return re.sub(r"[^a-z0-9]+", "-", (model[1] if model else "unknown").lower()).strip("-")


def commit():
    ran = subprocess.run(["git", "describe", "--always", "--dirty"], cwd=ROOT, capture_output=True, text=True)
    return ran.stdout.strip() or "unknown"


COLUMNS = ["date", "commit", "job", "beads", "steps", "repetitions", "twincell", "lammps", "ratio_lammps", "ratio_equal_accuracy", "speedup_2",
           "lammps_speedup_2"]


def append_row(row):
    path = ROOT / "bench/results" / f"{machine()}.csv"
    path.parent.mkdir(exist_ok=True)
    new = not path.exists()
    with path.open("a", newline="") as stream:
        table = csv.DictWriter(stream, COLUMNS, extrasaction="ignore", lineterminator="\n")
        if new:
            table.writeheader()
        table.writerow({key: f"{value:.4g}" if isinstance(value, float) else value for key, value in row.items()})


def read_options(description, jobs):
    """The command line that benches against peers share."""
    arguments = argparse.ArgumentParser(description=description.splitlines()[0])
    arguments.add_argument("build", type=lambda path: Path(path).resolve())
    arguments.add_argument("--json", action="store_true")
    arguments.add_argument("--repetitions", type=int, default=3)
    arguments.add_argument("--job", action="append", choices=jobs, help="only this job")
    return arguments.parse_args()


def show(heading, document, absent, as_json):
    """Numbers by key, and the reasons of those that are absent."""
    if as_json:
        print(json.dumps({**document, "absent": absent}, indent=2))
        return
    print(heading)
    for key, value in document.items():
        print(f"  {key:<36} {value if isinstance(value, int) else format(value, '.4g')}")
    for key, why in absent.items():
        print(f"  {key:<36} absent: {why}")


def main():
    options = read_options(__doc__, [job.name for job in JOBS])
    document, absent = {}, {}
    for job in JOBS:
        name = job.name
        if options.job and name not in options.job:
            continue
        print(f"bench: {name}", file=sys.stderr)
        try:
            numbers, reasons = measure(options.build, job, options.repetitions)
        except Absent as why:
            absent[name] = str(why)
            continue
        absent.update(reasons)
        append_row({"date": datetime.date.today().isoformat(), "commit": commit(), "job": name,
                    "repetitions": options.repetitions, **numbers})
        document.update({f"{name}.{key}": value for key, value in numbers.items()})
    show("particle-steps per second of processor time, and their quotients", document, absent, options.json)


if __name__ == "__main__":
    main()

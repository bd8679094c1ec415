#!/usr/bin/env python3
"""Twincell beside LAMMPS on the same pieces of the same runs, in particle-steps per second of processor time.

usage: sim_peers.py BUILD [--json] [--repetitions N]

BUILD is the folder that holds twincell and bench/period_cost. Every piece begins in a state that Twincell
reached; both programs start from it and run the same whole periods of the drive, in turn. Set-up is not counted:
ours is measured between two steps, LAMMPS's is its loop time times its use of the processor. Numbers are medians
over the repetitions, ratios medians of the quotients of one repetition. A row per job is appended to
bench/results/MACHINE.csv.

What cannot be measured is absent, with the reason under "absent".
"""

import argparse
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

ROOT = Path(__file__).resolve().parent.parent
SCENE = "scene.toml"  # in the folder of a job

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
steps_per_contact = 50
discard = 5
cycles = {cycles}
phases = 4
"""

# The second paper's gas of 100 rough spheres at W = 50: a period is 20 000 steps, so a piece is many of them.
GAS = """
preset = "bhateja-2016-rough-3d"
[drive]
k_m = 50.0
[time]
steps_per_contact = 50
discard = 50
cycles = {cycles}
phases = 4
"""

# Name, scene, periods in a piece.
JOBS = [
    ("shaker_1600", SHAKER.replace("{count}", "1600"), 1),
    ("shaker_400", SHAKER.replace("{count}", "400"), 1),
    ("gas_3d", GAS, 50),
]


class Absent(Exception):
    """Why a number cannot be had."""


def said(stderr, code):
    """The one sentence of a program that refused."""
    return (stderr.strip().splitlines() or [f"exit code {code}"])[-1]


class Ours:
    """period_cost, a piece at a time."""

    def __init__(self, build, periods, folder):
        self.process = subprocess.Popen([build / "bench/period_cost", SCENE, str(periods), "."], cwd=folder,
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

    def run(self):
        self.process.stdin.write("\n")
        self.process.stdin.flush()
        return self.answer()["cpu_s"]


def lammps_cpu_seconds(build, state, steps, folder):
    """One piece in LAMMPS from the deck that we export, without its dump."""
    deck = folder / "deck"
    exported = subprocess.run([build / "twincell", "export", SCENE, "--to", "lammps", "-q", "-o", "deck", "--from", state,
                               "--set", "time.cycles=1", "--set", "time.discard=0"], cwd=folder, capture_output=True, text=True)
    if exported.returncode != 0:
        raise Absent(said(exported.stderr, exported.returncode))
    text = (deck / "in.twincell").read_text()
    text = re.sub(r"(?m)^dump.*\n", "", text)
    text, runs = re.subn(r"(?m)^run .*$", f"run {steps}", text)
    assert runs == 1, "a deck has one run"
    (deck / "in.twincell").write_text(text)
    ran = subprocess.run(["lmp", "-in", "in.twincell", "-log", "none"], cwd=deck, capture_output=True, text=True,
                         env={**os.environ, "OMP_NUM_THREADS": "1"})
    loop = re.search(r"Loop time of (\S+) on 1 procs", ran.stdout)
    use = re.search(r"([\d.]+)% CPU use", ran.stdout)
    if ran.returncode != 0 or not loop or not use:
        raise Absent("LAMMPS stopped: " + (re.findall(r"(?m)^ERROR.*", ran.stdout) or [said(ran.stderr, ran.returncode)])[0])
    return float(loop[1]) * float(use[1]) / 100


def equal_accuracy_step_ratio(build):
    """Steps LAMMPS needs for each of ours at the same largest error of the restitution over entry phases."""
    ran = subprocess.run([build / "twincell", "cost", "sim", "--json"], capture_output=True, text=True)
    if ran.returncode != 0:
        raise Absent(f"the ratio of steps at equal accuracy is unknown: {said(ran.stderr, ran.returncode)}")
    ratio = json.loads(ran.stdout).get("equal_accuracy_step_ratio")
    if ratio is None:
        raise Absent("`twincell cost sim --json` has no key equal_accuracy_step_ratio")
    return float(ratio)


def measure(build, name, scene_text, periods, repetitions):
    """Numbers of one job by key, and reasons of those that are absent."""
    numbers, absent = {}, {}
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        (folder / SCENE).write_text(scene_text.replace("{cycles}", str(periods * repetitions)))
        ours, lammps = [], []
        try:
            with Ours(build, periods, folder) as engine:
                for _ in range(repetitions):
                    piece = engine.answer()
                    work = piece["beads"] * piece["steps"]
                    ours.append(work / engine.run())
                    if "lammps" in absent:
                        continue
                    try:
                        if not shutil.which("lmp"):
                            raise Absent("LAMMPS is not installed (Debian: apt-get install lammps)")
                        lammps.append(work / lammps_cpu_seconds(build, piece["state"], piece["steps"], folder))
                    except Absent as why:
                        absent["lammps"] = str(why)
        except Absent as why:
            return {}, {name: str(why)}
    numbers["beads"], numbers["steps"] = piece["beads"], piece["steps"]
    numbers["twincell"] = statistics.median(ours)
    if "lammps" not in absent:
        numbers["lammps"] = statistics.median(lammps)
        numbers["ratio_lammps"] = statistics.median(a / b for a, b in zip(ours, lammps))
        try:
            numbers["ratio_equal_accuracy"] = numbers["ratio_lammps"] * equal_accuracy_step_ratio(build)
        except Absent as why:
            absent["ratio_equal_accuracy"] = str(why)
    return numbers, {f"{name}.{key}": why for key, why in absent.items()}


def machine():
    model = re.search(r"model name\s*:\s*(.*)", Path("/proc/cpuinfo").read_text())
    return re.sub(r"[^a-z0-9]+", "-", (model[1] if model else "unknown").lower()).strip("-")


def commit():
    ran = subprocess.run(["git", "describe", "--always", "--dirty"], cwd=ROOT, capture_output=True, text=True)
    return ran.stdout.strip() or "unknown"


COLUMNS = ["date", "commit", "job", "beads", "steps", "repetitions", "twincell", "lammps", "ratio_lammps", "ratio_equal_accuracy"]


def append_row(row):
    path = ROOT / "bench/results" / f"{machine()}.csv"
    path.parent.mkdir(exist_ok=True)
    new = not path.exists()
    with path.open("a", newline="") as stream:
        table = csv.DictWriter(stream, COLUMNS, lineterminator="\n")
        if new:
            table.writeheader()
        table.writerow({key: f"{value:.4g}" if isinstance(value, float) else value for key, value in row.items()})


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("build", type=lambda path: Path(path).resolve())
    arguments.add_argument("--json", action="store_true")
    arguments.add_argument("--repetitions", type=int, default=3)
    arguments.add_argument("--job", action="append", choices=[name for name, _, _ in JOBS], help="only this job")
    options = arguments.parse_args()

    document, absent = {}, {}
    for name, scene, periods in JOBS:
        if options.job and name not in options.job:
            continue
        print(f"bench: {name}", file=sys.stderr)
        numbers, reasons = measure(options.build, name, scene, periods, options.repetitions)
        absent.update(reasons)
        if not numbers:
            continue
        append_row({"date": datetime.date.today().isoformat(), "commit": commit(), "job": name,
                    "repetitions": options.repetitions, **numbers})
        document.update({f"{name}.{key}": value for key, value in numbers.items()})
    if options.json:
        print(json.dumps({**document, "absent": absent}, indent=2))
        return
    print("particle-steps per second of processor time, and their quotients")
    for key, value in document.items():
        print(f"  {key:<36} {value if isinstance(value, int) else format(value, '.4g')}")
    for key, why in absent.items():
        print(f"  {key:<36} absent: {why}")


main()

"""Runs every command of docs/first_hour.md as printed, in order, and checks what the page promises.

usage: first_hour_test.py TWINCELL SOURCE_FOLDER SCRATCH_FOLDER
"""
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

program, source, scratch = sys.argv[1:4]
page = pathlib.Path(source, "docs/first_hour.md").read_text()
commands = re.findall(r"^    (twincell .+)$", page, re.M)
assert len(commands) >= 7, commands

with tempfile.TemporaryDirectory(dir=scratch) as folder:
    os.symlink(pathlib.Path(source, "data_samples"), pathlib.Path(folder, "data_samples"))
    os.mkdir(pathlib.Path(folder, "bin"))
    os.symlink(program, pathlib.Path(folder, "bin", "twincell"))
    where = dict(os.environ, PATH=str(pathlib.Path(folder, "bin")) + ":" + os.environ["PATH"])
    said = {}
    for command in commands:
        # What the page tells to be made beforehand is nothing: outputs go into new folders.
        ran = subprocess.run(command, shell=True, cwd=folder, env=where, stdin=subprocess.DEVNULL,
                             capture_output=True, text=True, timeout=280)
        print("$", command, ran.stdout, ran.stderr, sep="\n", flush=True)
        assert ran.returncode == 0, command
        said[command.split()[1]] = ran.stdout
    home = pathlib.Path(folder)
    for made in ["first/CELL.png", "hour/cells/gamma-0.9.png", "hour/twins/report/report.html",
                 "hour/twins/report/figures/boundaries.svg"]:
        assert (home / made).stat().st_size > 1000, made
    assert "Same phase on both sides at 2 of 2 drive strengths." in said["match"]
    assert "Onset of bouncing: Gamma 1.25" in said["match"] and "compatible" in said["match"]
    results = json.loads((home / "hour/twins/report/results.json").read_text())
    assert [m["verdict"] for m in results["matches"]] == ["same", "same"], results["matches"]

"""Runs every command of docs/first_hour.md as printed, in order, and checks what the page promises.

usage: first_hour_test.py TWINCELL SOURCE_FOLDER SCRATCH_FOLDER
"""
import json
import os
import pathlib
import pty
import re
import subprocess
import sys
import tempfile
import threading

program, source, scratch = map(os.path.abspath, sys.argv[1:4])
page = pathlib.Path(source, "docs/first_hour.md").read_text()
commands = re.findall(r"^    ((?:twincell|mkdir) .+)$", page, re.M)
assert len(commands) >= 7, commands

with tempfile.TemporaryDirectory(dir=scratch) as folder:
    os.symlink(pathlib.Path(source, "data_samples"), pathlib.Path(folder, "data_samples"))
    os.mkdir(pathlib.Path(folder, "bin"))
    os.symlink(program, pathlib.Path(folder, "bin", "twincell"))
    where = dict(os.environ, PATH=str(pathlib.Path(folder, "bin")) + ":" + os.environ["PATH"])
    said = {}
    for command in commands:
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

    # On a terminal `new` asks. A wrong answer is asked for again; an empty one stays open.

    def asked(name, answers):
        master, slave = pty.openpty()
        heard = []

        def listen():
            try:
                while True:
                    heard.append(os.read(master, 1000))
            except OSError:  # the last writer has closed the terminal
                pass

        listener = threading.Thread(target=listen)
        process = subprocess.Popen([program, "new", "data_samples/demo/gamma-0.9", "-o", name], cwd=folder, stdin=slave,
                                   stderr=slave, stdout=subprocess.PIPE, text=True)
        os.close(slave)
        listener.start()
        os.write(master, answers)
        out = process.communicate(timeout=200)[0]
        listener.join()
        os.close(master)
        assert process.returncode == 0, out
        return b"".join(heard).decode(), out, (home / name).read_text()

    heard, out, text = asked("asked.toml", b"two\n2\n11.15\n")
    assert "Diameter of a bead in mm" in heard and "Frequency of the shaker in Hz" in heard, heard
    assert "A number above 0 is needed" in heard, heard
    assert "FILL IN" not in text and "sigma_mm = 2 " in text and "frequency_hz = 11.15" in text, text
    heard, out, text = asked("open.toml", b"\n\n")
    assert "Gamma" in heard and "2 values are still needed" in out, heard + out
    assert 'sigma_mm = "FILL IN: ' in text, text

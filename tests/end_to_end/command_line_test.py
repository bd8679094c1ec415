"""Help, version, misspelled words, manual pages and completion of the program.

usage: command_line_test.py TWINCELL FOLDER
"""

import os
import pathlib
import pty
import re
import shutil
import subprocess
import sys

program, folder = sys.argv[1], pathlib.Path(sys.argv[2]) / "command_line"
source = pathlib.Path(__file__).resolve().parents[2]


def run(*words, code=0):
    done = subprocess.run([program, *words], capture_output=True, text=True)
    assert done.returncode == code, f"{words}: exit code {done.returncode}: {done.stderr}"
    return done


def verbs():
    """Every verb, and the verbs of each group, from the lists in --help."""
    def below(path):
        text = run(*path, "--help").stdout
        listed = text.partition("\nSubcommands:\n")[2].partition("\n\n")[0]
        return [path + [name] for name in re.findall(r"^  ([a-z]+) ", listed, re.M)]
    found = []
    level = below([])
    while level:
        found += level
        level = [deeper for path in level for deeper in below(path)]
    return found


def test_help():
    for path in ([], ["track"], ["sweep", "run"]):
        assert run("help", *path).stdout == run(*path, "--help").stdout, path


def test_width_of_help():
    for path in [[], *verbs()]:
        for line in run(*path, "--help").stdout.splitlines():
            is_code = line.startswith(("Usage: ", "  twincell ", "  -"))  # commands, and options with their values
            assert len(line) <= 100 or is_code, f"{path}: {line}"


def test_version():
    lines = run("--version").stdout.splitlines()
    assert re.fullmatch(r"twincell \d+\.\d+\.\d+ \(.+\)", lines[0]), lines
    for library in ("OpenCV", "HDF5", "Ceres", "Eigen"):
        assert re.search(library + r" \d+\.\d+", lines[2]), lines


def test_misspelled_words():
    for words, sentence in {
        ("help", "trck"): "there is no verb 'trck'; did you mean 'track'?",
        ("sweep", "rnu"): "there is no verb 'sweep rnu'; did you mean 'sweep run'?",
        ("track", "x", "--diametr=3"): "there is no option '--diametr'; did you mean '--diameter'?",
        ("simulate", "--quite"): "there is no option '--quite'; did you mean '--quiet'?",
        ("locate", "x", "--zzzzzzzz"): "there is no option '--zzzzzzzz'; --help shows the options.",
        ("match", "x", "--drive-freq", "5"): "there is no option '--drive-freq'; similar options: --drive-hz.",
        ("simulate", "x", "--roi", "1,2,3,4"): "there is no option '--roi'; it is an option of locate, track, match.",
    }.items():
        assert run(*words, code=2).stderr == f"twincell: {sentence}\n", words


def test_next_steps():
    """Errors name the nearest file or word, or the command that makes what is missing."""
    folder.mkdir(exist_ok=True)
    frames, scene = folder / "frames", folder / "scene.toml"
    frames.mkdir(exist_ok=True)
    scene.write_text('preset = "fortini-huang-2015"\n')
    plan = folder / "plan.toml"
    plan.write_text('scene = "scene.toml"\nresults = ["s_b"]\n[axes]\ndrive.gamma = [1.2, 1.4]\n')
    out = folder / "out.h5"
    minimal = folder / "minimal.toml"
    minimal.write_text("[drive]\ngamma = 1.5\n")
    dump = folder / "run.LAMMPSTRJ"
    dump.write_text("ITEM: TIMESTEP\n0\n")
    for words, code, sentence in (
        (("info", folder / "framse"), 3, f"{folder}/framse: does not exist; did you mean '{folder}/frames'?"),
        (("explain", folder / "scnee.toml"), 3,
         f"{folder}/scnee.toml: the file does not exist; did you mean '{scene}'?"),
        (("info", "~/frames"), 3,
         "~/frames: does not exist; the shell expands ~ only at the beginning of a word and outside of quotes."),
        (("track", frames, "--cell", folder / "CELL.toml", "-o", out), 3,
         f"{folder}/CELL.toml: the file does not exist; twincell new STACK -o {folder}/CELL.toml writes a cell file of this name."),
        (("track", frames, "--cell", minimal, "-o", out), 2,
         f"{minimal}: drive: two of amplitude, omega, frequency, gamma, k_m, peak_velocity are needed, only gamma is given; "
         "twincell new STACK -o CELL.toml measures the drive."),
        (("analyze", scene), 3, f"; twincell simulate {scene} -o scene.h5 makes a trajectory of a scene."),
        (("analyze", dump), 3, f"; twincell import {dump} -o run.h5 makes a trajectory of a file of another program."),
        (("analyze", frames), 3, f"; twincell track {frames} -o frames.h5 makes a trajectory of a stack of frames."),
        (("explain", plan), 2, "this file looks like a plan of a sweep, which twincell sweep run reads."),
        (("sweep", "run", scene), 2, "this file looks like a scene, which twincell simulate reads."),
        (("track", frames, "--cell", scene, "-o", out), 2, "this file looks like a scene, which twincell simulate reads."),
        (("explain", frames), 3, "; explain reads a scene file (TOML); for a stack of frames see twincell new."),
        (("explain", scene, "--set", "drive.gamma=1,5"), 2,
         "a number is needed, not a string; a decimal number is written with a point: 1.5."),
        (("explain", scene, "--set", "gamma=1.5"), 2, "there is no such key; did you mean 'drive.gamma'?"),
        (("track", frames), 2, "--output is required; example: twincell track frames/ -o exp.h5"),
        (("export", scene, "--to", "lamps", "-o", out), 2, "'lamps' is not lammps, xyz,"),
        (("export", scene, "--to", "lamps", "-o", out), 2, "; did you mean 'lammps'?"),
        (("simulate", scene, "-o", folder / "run.csv"), 2,
         "the output is a trajectory (HDF5) and cannot end in .csv; name a .h5 file, from which twincell export"),
        (("sweep", "plan.toml"), 2, "there is no verb 'sweep plan.toml'; sweep has plan, run, "),
        (("calibrate",), 2, "calibrate needs a word that says what: camera, walls, plate, beads or contacts."),
    ):
        said = run(*words, code=code).stderr
        assert sentence in said and said.count("\n") == 1, f"{words}: {said}"


def test_verbose_says_what_it_adds():
    assert "Print every detail: beads, edge blur and time of every frame" in run("locate", "--help").stdout
    assert "Print every detail; this verb always does" in run("info", "--help").stdout


def test_manual():
    run("man", "-q", "-o", str(folder / "man1"))
    names = {page.stem for page in (folder / "man1").glob("*.1")}
    assert names == {"twincell"} | {"-".join(["twincell", *path]) for path in verbs()}
    page = (folder / "man1/twincell-track.1").read_text()
    assert "\\-\\-diameter" in page and ".SH SYNOPSIS" in page
    groff = shutil.which("groff")
    for name in sorted(names) if groff else []:
        done = subprocess.run([groff, "-man", "-ww", "-z", folder / f"man1/{name}.1"], capture_output=True, text=True)
        assert done.returncode == 0 and not done.stderr, f"{name}: {done.stderr}"


def test_keys():
    assert run("keys", "--markdown").stdout == (source / "docs/keys.md").read_text(), "docs/keys.md is not what `twincell keys --markdown` prints"
    text = run("keys").stdout
    assert max(map(len, text.splitlines())) <= 100
    for file, key in (("cell", "camera.bright"), ("scene", "contact.mu"), ("plan", "search.width"), ("camera", "blur")):
        part = run("keys", file).stdout
        assert part in text and f"\n  {key} = " in part, file
    run("keys", "cel", code=2)


def test_completion():
    script = run("completion", "bash").stdout
    (folder / "completion.bash").write_text(script)
    def complete(*words):
        typed = " ".join(f"'{word}'" for word in ("twincell", *words))
        return subprocess.run(["bash", "-c", f"source '{folder / 'completion.bash'}'; COMP_WORDS=({typed}); "
                               f"COMP_CWORD={len(words)}; _twincell; echo \"${{COMPREPLY[@]}}\""],
                              capture_output=True, text=True, check=True).stdout.split()
    assert complete("tr") == ["track"]
    assert complete("sweep", "r") == ["run"]
    assert complete("calibrate", "contacts", "bo") == ["bounce"]
    assert set(complete("export", "run.h5", "--to", "")) >= {"lammps", "xyz", "gsd", "csv"}
    assert complete("track", "--phase-l") == ["--phase-lock"]
    assert complete("completion", "z") == ["zsh"]
    for shell in ("zsh", "fish"):
        (folder / shell).write_text(run("completion", shell).stdout)
        if shutil.which(shell):
            subprocess.run([shell, "-n", folder / shell], check=True)
    run("completion", "tcsh", code=2)


def test_a_reader_that_stops_is_no_error():
    for words in ("help reproduce", "keys"):
        done = subprocess.run(f"set -o pipefail; '{program}' {words} | head -n 1", shell=True, executable="/bin/bash",
                              capture_output=True, text=True)
        assert done.returncode == 0 and not done.stderr and len(done.stdout.splitlines()) == 1, words


def test_lines_on_a_terminal_have_at_most_100_columns():
    terminal, end = pty.openpty()
    scene = source / "data_samples/example/scene.toml"
    with subprocess.Popen([program, "explain", scene], stdout=end, stderr=subprocess.DEVNULL) as process:
        os.close(end)
        text = b""
        try:
            while part := os.read(terminal, 4096):
                text += part
        except OSError:  # the program has ended
            pass
    assert process.returncode == 0
    lines = text.decode().splitlines()
    assert len(lines) > 20 and max(map(len, lines)) <= 100, max(lines, key=len)
    assert max(map(len, run("explain", str(scene)).stdout.splitlines())) > 100, "in a file each line stays whole"


shutil.rmtree(folder, ignore_errors=True)
folder.mkdir(parents=True)
for test in [value for name, value in list(globals().items()) if name.startswith("test_")]:
    test()
    print(test.__name__)

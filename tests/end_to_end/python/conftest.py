"""What the tests of the Python module share: the program next to the module, and small inputs."""
import json
import os
import re
import subprocess
from pathlib import Path

import pytest

import twincell

ROOT = Path(__file__).resolve().parents[3]
DEMO = ROOT / "data_samples/demo/gamma-1.6"
SCENE = {"preset": "fortini-huang-2015", "cell": {"width": 10.0}, "beads": {"count": 60}, "drive": {"gamma": 1.6},
         "start": {"kind": "random", "seed": 1}, "time": {"discard": 1, "cycles": 4, "phases": 10}}


def program(*words, **options):
    """Runs the program; the finished process."""
    return subprocess.run([os.environ["TWINCELL_PROGRAM"], *map(str, words)], capture_output=True, text=True,
                          check=False, **options)


def document(*words, **options):
    """The --json document of a verb."""
    done = program(*words, "--json", "-q", **options)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def sentence(*words):
    """The sentence with which the program refuses, with options as Python names them."""
    done = program(*words)
    assert done.returncode != 0
    said = done.stderr.strip().splitlines()[-1].removeprefix("twincell: ")
    return re.sub(r"(?<![\w-])--([a-z][a-z0-9-]*)", lambda option: option[1].replace("-", "_"), said), done.returncode


def sentence_of_option(*words):
    """The same for a sentence that begins with the refused option."""
    assert program(*words).stderr.strip().splitlines()[-1].startswith("twincell: --")
    return sentence(*words)


@pytest.fixture(scope="session")
def scene_file(tmp_path_factory):
    path = tmp_path_factory.mktemp("scene") / "scene.toml"
    path.write_text('preset = "fortini-huang-2015"\n[cell]\nwidth = 10.0\n[beads]\ncount = 60\n[drive]\ngamma = 1.6\n'
                    '[start]\nkind = "random"\nseed = 1\n[time]\ndiscard = 1\ncycles = 4\nphases = 10\n')
    return path


@pytest.fixture(scope="session")
def sim_file(scene_file):
    """The trajectory of the scene as the program writes it."""
    path = scene_file.parent / "sim.h5"
    assert program("simulate", scene_file, "-o", path, "-q").returncode == 0
    return path


@pytest.fixture(scope="session")
def tracked():
    """The shipped stack, tracked in Python."""
    return twincell.track(DEMO, cell=DEMO / "CELL.toml")

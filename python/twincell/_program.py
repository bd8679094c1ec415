"""Verbs that run as the program: new, match, compare, measure, info, validate, render, draw, export, import_, reproduce,
calibrate_*.

These verbs read and write files, and many take hours rather than microseconds. Each function runs the program `twincell` of
the same installation with the same options and returns its --json document. The numbers are therefore those of the verb.
A Trajectory or Scene in memory is written to a temporary file for it.
"""
import json
import os
import re
import shutil
import signal
import subprocess
import tempfile
import warnings
from pathlib import Path

from . import _core

_PROGRESS = re.compile(r"^(.*): (\d+) %(?:, about .* left)?$")
_CLASSES = {1: _core.RunError, 2: _core.ConfigError, 3: _core.InputError, 130: _core.Interrupted, 143: _core.Interrupted}


def _program():
    """The program: $TWINCELL_PROGRAM, that of the build tree or the prefix of this module, or that of PATH."""
    here = Path(__file__).resolve()
    places = [os.environ.get("TWINCELL_PROGRAM", ""), here.parents[2] / "twincell"]
    if len(here.parents) > 4:
        places.append(here.parents[4] / "bin" / "twincell")
    for place in (*places, shutil.which("twincell") or ""):
        if str(place) and Path(place).is_file() and os.access(place, os.X_OK):
            return str(place)
    raise _core.RunError("The program twincell is not installed: it is neither beside this module nor in PATH, and "
                         "TWINCELL_PROGRAM does not name it.")


def _words(options):
    """The words of options by name: True for a flag, a list for several words, a tuple for numbers with commas."""
    for name, value in options.items():
        if value is None or value is False:
            continue
        yield "--" + name.rstrip("_").replace("_", "-")
        if isinstance(value, dict):
            yield from (f"{key}={v if isinstance(v, str) else json.dumps(v)}" for key, v in value.items())
        elif isinstance(value, tuple):
            yield ",".join(map(str, value))
        elif isinstance(value, list):
            yield from map(str, value)
        elif value is not True:
            yield str(value)


def _in_file(value, folder):
    """The name of the file of a trajectory or a scene; one in memory is written into `folder`. Other values as they are."""
    if isinstance(value, (list, tuple)):
        return type(value)(_in_file(each, folder) for each in value)
    if isinstance(value, _core.Scene):
        path = Path(folder) / "scene.toml"
        path.write_text(value.text)
        return str(path)
    if not isinstance(value, _core.Trajectory):
        return value
    if value._file is not None:  # else the file was replaced since it was opened
        return str(value._file)
    before = len(list(Path(folder).glob("trajectory*")))
    path = Path(folder) / (f"trajectory-{before + 1}.h5" if before else "trajectory.h5")
    value.write(path)
    return str(path)


def _raise(code, sentence):
    made = _CLASSES.get(code, _core.Error)
    error = made(_core._with_python_names(sentence))
    error.exit_code = code
    raise error


def _run(verb, positional, options, callback):
    """Runs a verb; its document. Notes become warnings, progress goes to callback(done, 100)."""
    with tempfile.TemporaryDirectory() as folder:
        positional = [str(_in_file(word, folder)) for word in positional if word is not None]
        options = {name: _in_file(value, folder) for name, value in options.items()}
        return _run_words([_program(), *verb.split(), *positional, *_words(options), "--json"], callback, folder)


def _run_words(words, callback, folder):
    lines = []
    own = re.compile(re.escape(folder) + r"/([\w-]+)\.(?:h5|toml)")  # of the caller's objects, named by their kind
    with tempfile.TemporaryFile("w+") as result:  # a pipe that nobody reads would block the program
        often = {**os.environ, "TWINCELL_PROGRESS_S": "0"}
        process = subprocess.Popen(words, stdout=result, stderr=subprocess.PIPE, text=True, env=often)
        try:
            for line in process.stderr:
                progress = _PROGRESS.match(line.strip())
                if progress is None:
                    lines.append(own.sub(r"\1", line.strip()))
                elif callback is not None:
                    callback(int(progress.group(2)), 100)
            code = process.wait()
        except BaseException:  # also KeyboardInterrupt, and what the callback raises
            process.send_signal(signal.SIGINT)
            process.wait()
            raise
        finally:
            process.stderr.close()
        result.seek(0)
        text = result.read()
    if code < 0:
        _raise(128 - code, f"The program was stopped by signal {-code}.")
    if code != 0 or not text.strip():
        _raise(code, lines[-1].removeprefix("twincell: ") if lines else f"The program ended with the code {code}.")
    for line in lines:
        if line:
            sentence = line.removeprefix("twincell: ").removeprefix("note: ")
            warnings.warn(_core._with_python_names(sentence), stacklevel=4)
    return json.loads(text)


def match(*stacks_and_cells, output, callback=None, **options):
    """The twin of each filmed cell, and both sides compared: `twincell match` (docs/comparing.md).

    stacks_and_cells: stacks and cell files, as for the verb. output: folder for trajectories, scenes and report.
    Options have the names of the verb with _ for -: twins=2, scene="twin.toml", set={"drive.gamma": 1.8}, range_=2; True for a
    flag, a list for several words, a tuple for numbers that are joined by commas.
    callback: called with (percent, 100); what it raises stops the program.
    Returns a dict. Notes of the program are warnings, its errors the exceptions of this module with the same sentence.
    """
    return _run("match", stacks_and_cells, {"output": output, **options}, callback)


def new(*stacks, output, callback=None, **options):
    """A cell file from the frames, with a picture of what was measured: `twincell new` (docs/first_hour.md).

    stacks: one stack, or several of one cell, one for each strength. output: CELL.toml, for several stacks a folder. What the frames do not show
    stays open, to be filled in; `match` names it. Otherwise as `match`.
    """
    return _run("new", stacks, {"output": output, **options}, callback)


def measure(scene, *, callback=None, **options):
    """Runs a scene and analyses it without storing frames: `twincell measure` (docs/running.md).

    scene: Scene or scene file; only="T_g,h_cm" selects results. Otherwise as `match`.
    """
    return _run("measure", (scene,), options, callback)


def info(file, *, callback=None, **options):
    """What a file holds: `twincell info`. file: Trajectory, H5MD file, stack or film. Otherwise as `match`."""
    return _run("info", (file,), options, callback)


def validate(trajectory, *, callback=None, **options):
    """Whether a trajectory file keeps its format and its physical limits: `twincell validate` (docs/h5md.md).

    trajectory: Trajectory or H5MD file. InputError names the first fault. Otherwise as `match`.
    """
    return _run("validate", (trajectory,), options, callback)


def compare(*, output, callback=None, **options):
    """Experiments and simulations in one report: `twincell compare` (docs/comparing.md).

    experiment, simulation: lists of trajectories or files; stack, sweep: lists of files; output: folder for the report. Otherwise as `match`.
    """
    return _run("compare", [], {"output": output, **options}, callback)


def render(trajectory, *, callback=None, **options):
    """Frames of a trajectory as a camera would record them: `twincell render` (docs/camera.md).

    trajectory: Trajectory or H5MD file; output: folder for the frames; movie: film. Otherwise as `match`.
    """
    return _run("render", (trajectory,), options, callback)


class Picture(bytes):
    """A picture as the bytes of a PNG file, which a notebook shows."""

    def _repr_png_(self):
        return bytes(self)


def _value_table(numbers, folder):
    """The name of a table of an array (frames, beads) of numbers of beads; NaN: none."""
    import numpy as np

    numbers = np.asarray(numbers, dtype=float)
    if numbers.ndim != 2:
        raise _core.ConfigError(f"colour: has {numbers.ndim} dimensions; it must have two, (frames, beads).")
    path = Path(folder) / "colour.csv"
    frame, particle = np.nonzero(np.isfinite(numbers))
    np.savetxt(path, np.column_stack([frame, particle, numbers[frame, particle]]), fmt=("%d", "%d", "%.17g"), delimiter=",",
               header="frame,particle,value", comments="")
    return path


def draw(trajectory, *, output=None, callback=None, **options):
    """A trajectory as a picture, a film or a page that plays it, without a camera: `twincell draw` (docs/drawing.md).

    trajectory: Trajectory or H5MD file; output: .png, .mp4, .avi or .html; colour="speed", or an array (frames, beads) of numbers;
    tracks=5, vectors=True, contacts=True.
    Without output, the picture of the last frame is returned, which a notebook shows. Otherwise as `match`.
    """
    with tempfile.TemporaryDirectory() as folder:
        if hasattr(options.get("colour"), "__array__"):
            options["colour"] = _value_table(options["colour"], folder)
        if output is not None:
            return _run("draw", (trajectory,), {"output": output, **options}, callback)
        path = Path(folder) / "picture.png"
        _run("draw", (trajectory,), {"output": path, **options}, callback)
        return Picture(path.read_bytes())


def export(input, *, to, output, callback=None, **options):
    """A trajectory or a scene in the format of another program: `twincell export` (docs/formats.md, docs/lammps.md).

    input: Trajectory, Scene, H5MD file or scene file; to: "xyz", "lammps-dump", "csv", ... Otherwise as `match`.
    """
    return _run("export", (input,), {"to": to, "output": output, **options}, callback)


def import_(file, *, output, callback=None, **options):
    """The beads of another program as a trajectory file: `twincell import` (docs/formats.md).

    file: dump, table, XYZ, GSD or TrackMate file; output: H5MD file, which `Trajectory.open` reads. Otherwise as `match`.
    """
    return _run("import", (file,), {"output": output, **options}, callback)


def reproduce(name, *, callback=None, **options):
    """A figure or table of the papers: `twincell reproduce` (docs/reproduce.md). Otherwise as `match`."""
    return _run("reproduce", (name,), options, callback)


def _calibration(kind, what):
    def calibrate(*inputs, callback=None, **options):
        return _run("calibrate " + kind, inputs, options, callback)

    calibrate.__name__ = calibrate.__qualname__ = "calibrate_" + kind.replace(" ", "_")
    calibrate.__doc__ = (f"{what}: `twincell calibrate {kind}` (docs/calibrating.md).\n\n"
                         "inputs: as for the verb; options as for `match`. Returns a dict.")
    return calibrate


calibrate_camera = _calibration("camera", "Scale, origin, rotation and distortion of the picture")
calibrate_walls = _calibration("walls", "Width of the cell and tilts of its side walls")
calibrate_plate = _calibration("plate", "Drive, and phase of each frame, from the edge of the plate")
calibrate_beads = _calibration("beads", "Diameter and spread of the beads, and layers of the bed")
calibrate_contacts_bounce = _calibration("contacts bounce", "Restitution from a bouncing bead")
calibrate_contacts_collisions = _calibration("contacts collisions", "Contact law from collisions of two beads")
calibrate_contacts_infer = _calibration("contacts infer", "Contact parameters from measured observables")
calibrate_contacts_numbers = _calibration("contacts numbers", "Restitution and contact time to stiffness and damping")

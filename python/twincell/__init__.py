"""Vibrated bead cells: camera frames and simulations through one analysis.

The functions have the names and options of the verbs of the program `twincell`. What they compute is computed by
the same C++ functions. docs/python.md is a tutorial.
"""
from . import _core
from . import _results, _scenes, _tables  # noqa: F401  (they add methods to the classes of _core)
from ._core import (
    Box, ConfigError, Drive, Error, InputError, Interrupted, Result, Results, RunError, Scene, Simulation, Trajectory,
    Window, __version__, analyze, analyze_windows, bond_order, coordination, fit, hexatic_order, laws, neighbours, number_of_neighbours,
    preset_names, result_names, sweep, track, version, voronoi)
from ._functions import name_functions as _name_functions
from ._frames import Frames, open_frames
from ._locating import locate
from ._program import (
    calibrate_beads, calibrate_camera, calibrate_contacts_bounce, calibrate_contacts_collisions,
    calibrate_contacts_infer, calibrate_contacts_numbers, calibrate_plate, calibrate_walls, compare, draw, export, import_, info,
    match, measure, new, render, reproduce, validate)
from ._names import unknown as _unknown
from ._scenes import simulate
from ._tracks import compute_drift, emsd, filter_stubs, imsd, link, subtract_drift

_name_functions(globals())

__all__ = [
    "Box", "ConfigError", "Drive", "Error", "Frames", "InputError", "Interrupted", "Result", "Results", "RunError",
    "Scene", "Simulation", "Trajectory", "Window", "__version__", "analyze", "analyze_windows", "bond_order", "calibrate_beads",
    "calibrate_camera", "calibrate_contacts_bounce", "calibrate_contacts_collisions", "calibrate_contacts_infer",
    "calibrate_contacts_numbers", "calibrate_plate", "calibrate_walls", "compare", "compute_drift", "coordination", "draw", "emsd",
    "export", "filter_stubs", "fit", "hexatic_order", "import_", "imsd", "info", "laws", "link", "locate", "match", "measure",
    "neighbours", "new", "number_of_neighbours", "open_frames", "preset_names", "render", "reproduce", "result_names", "simulate",
    "subtract_drift", "sweep", "track", "validate", "version", "voronoi"]


def __getattr__(name):
    raise _unknown(name, __all__)

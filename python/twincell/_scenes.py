"""Scenes from words of Python, and their simulation."""
from __future__ import annotations

import json
import math

from . import _core


def _toml(value) -> str:
    """A value as TOML."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, dict):
        return "{" + ", ".join(f"{json.dumps(str(k), ensure_ascii=False)} = {_toml(v)}" for k, v in value.items()) + "}"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(_toml(v) for v in value) + "]"
    if hasattr(value, "item"):  # a number of NumPy
        return _toml(value.item())
    if isinstance(value, float):
        return repr(value) if math.isfinite(value) else str(value)
    if isinstance(value, int):
        return str(value)
    raise _core.ConfigError(f"{value!r} is of type {type(value).__name__}, which has no counterpart in a scene.")


def assignments(said) -> list[str]:
    """`set` as a list of "section.key=value"; it may also be a dict {"section.key": value}."""
    if isinstance(said, dict):
        return [f"{key}={_toml(value)}" for key, value in said.items()]
    return [said] if isinstance(said, str) else list(said)


def _from_dict(scene: dict, set=()):
    """The scene of nested dicts: {"preset": name, "drive": {"gamma": 2.0}, ...} (docs/scene.md lists the keys)."""
    text = "".join(f"{json.dumps(str(k), ensure_ascii=False)} = {_toml(v)}\n" for k, v in scene.items()
                   if not isinstance(v, dict))
    for name, table in scene.items():
        if isinstance(table, dict):
            text += f"[{json.dumps(str(name), ensure_ascii=False)}]\n" + "".join(
                f"{json.dumps(str(k), ensure_ascii=False)} = {_toml(v)}\n" for k, v in table.items())
    return _core.Scene.from_text(text, "dict", assignments(set))


def _preset(name: str, set=()):
    """The scene of a preset (preset_names()), with keys overridden by `set`."""
    return _core.Scene.from_text(f"preset = {_toml(name)}\n", "preset", assignments(set))


def _from_toml(path, set=()):
    return _core.Scene._from_toml(path, assignments(set))


def simulate(scene, output=None, *, set=(), relax=False, contacts=False, seed=None, threads=0, callback=None):
    """Runs a scene and returns its trajectory, in memory or, with `output`, in a file (H5MD): `twincell simulate`.

    scene: Scene, dict, or the name of a file. set: keys to override, {"section.key": value} or ["section.key=value"]; relax:
    push overlapping beads of the start apart; contacts: store the contacts with their forces; seed: of the random numbers of
    the start. threads: 0: chosen from the number of beads; the bits do not depend on it. callback: function of (done, total),
    called at most ten times a second. Ctrl-C stops the run; an unfinished file is removed.
    """
    overrides = assignments(set)
    overrides += [f"start.seed={seed}"] if seed is not None else []
    overrides += ["start.relax=true"] if relax else []
    overrides += ["time.contacts=true"] if contacts else []
    if isinstance(scene, _core.Scene):
        scene = _core.Scene.from_text(scene.text, "scene", overrides) if overrides else scene
    else:
        scene = (_from_dict if isinstance(scene, dict) else _from_toml)(scene, overrides)
    return _core.simulate(scene, output, threads=threads, callback=callback)


def _lacks(self, name):
    said = f"'Simulation' object has no attribute '{name}'"
    if name in ("drive", "set_drive", "gamma", "omega", "amplitude"):
        said += ("; the drive is that of the scene, Scene.drive, and changes during a run only as its drive.ramp, drive.schedule or "
                 "drive.file states.")
    raise AttributeError(said)


_core.Simulation.__getattr__ = _lacks
_core.Scene._from_toml = _core.Scene.from_toml
_from_toml.__doc__ = (_core.Scene.from_toml.__doc__ or "").partition("\n\n")[2]
_core.Scene.from_toml = staticmethod(_from_toml)
_core.Scene.from_dict = staticmethod(_from_dict)
_core.Scene.preset = staticmethod(_preset)

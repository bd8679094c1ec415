"""Scenes and simulations from Python against the program."""
import os
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import twincell
from conftest import SCENE, document, program, sentence

LONG = {**SCENE, "time": {**SCENE["time"], "cycles": 100000}}


def test_scenes_of_file_dict_and_preset_are_the_same(scene_file):
    of_file = twincell.Scene.from_toml(scene_file)
    of_dict = twincell.Scene.from_dict(SCENE)
    preset = twincell.Scene.preset("fortini-huang-2015", {
        f"{table}.{key}": value for table, keys in SCENE.items() if isinstance(keys, dict)
        for key, value in keys.items()})
    assert of_file.text == of_dict.text == preset.text
    assert of_file == of_dict == preset and hash(of_dict) == hash(preset)
    assert of_dict != twincell.Scene.from_dict({**SCENE, "beads": {"count": 61}}) and of_dict != SCENE
    assert of_dict.n_beads == 60 and of_dict.cycles == 4 and of_dict.drive.gamma == pytest.approx(1.6, abs=1e-12)
    said = document("explain", scene_file)
    mine = of_file.explain(0.02)
    for key in ("kernel", "dt", "steps", "effects", "time_limits", "beads", "has_chance", "particle_steps"):
        assert mine[key] == said[key], key


def test_simulate_is_the_verb_to_the_bit(sim_file, scene_file, tmp_path):
    verb = twincell.Trajectory.open(sim_file)
    mine = twincell.simulate(twincell.Scene.from_toml(scene_file))
    for column in ("positions", "velocities", "spins"):
        assert np.array_equal(np.asarray(getattr(verb, column)), np.asarray(getattr(mine, column))), column
    for column in ("time", "step", "phase", "cycle", "plate_height", "radii", "masses", "tracers"):
        assert np.array_equal(getattr(verb, column), getattr(mine, column)), column
    assert mine.provenance["plan"] == verb.provenance["plan"]
    written = twincell.simulate(twincell.Scene.from_dict(SCENE), tmp_path / "mine.h5", threads=2)
    assert np.array_equal(np.asarray(written.positions), np.asarray(mine.positions))
    assert program("validate", tmp_path / "mine.h5").returncode == 0
    assert twincell.analyze(mine, ["q6", "T_z"]).to_dict() == twincell.analyze(sim_file, ["q6", "T_z"]).to_dict()


def test_simulate_takes_files_dicts_and_the_options_of_the_verb(scene_file, tmp_path):
    path = tmp_path / "verb.h5"
    words = ("--set", "drive.gamma=1.2", "--seed", "7", "--contacts")
    assert program("simulate", scene_file, *words, "-o", path, "-q").returncode == 0
    verb = twincell.Trajectory.open(path)
    for scene in (scene_file, str(scene_file), SCENE, twincell.Scene.from_dict(SCENE)):
        mine = twincell.simulate(scene, set={"drive.gamma": 1.2}, seed=7, contacts=True)
        assert np.array_equal(np.asarray(mine.positions), np.asarray(verb.positions))
        assert np.allclose(mine.contacts[5]["normal_force"], verb.contacts[5]["normal_force"], rtol=1e-6)
    with pytest.raises(OSError, match="does not exist"):
        twincell.simulate(tmp_path / "none.toml")


def test_stepping_by_hand_is_the_same_run():
    whole = twincell.simulate(twincell.Scene.from_dict(SCENE))
    sim = twincell.Simulation(twincell.Scene.from_dict(SCENE))
    first = sim.run(1)
    state = sim.state
    assert len(first) == 10 and np.array_equal(first.positions[-1][:, 2], whole.positions[9][:, 2])
    assert state.dtype.names[:2] == ("x", "z") and not state.flags.owndata
    before = state["z"].copy()
    with pytest.raises(RuntimeError, match="5 cycles were requested, but the run has 3 of its 4 cycles left"):
        sim.run(5)
    rest = sim.run()
    assert len(rest) == 30 and len(sim.run()) == 0
    assert not np.array_equal(state["z"], before)  # a view: it shows the bed now
    assert np.array_equal(np.asarray(sim.trajectory.positions), np.asarray(whole.positions))
    assert np.shares_memory(sim.trajectory.positions[3], first.positions[3])
    with pytest.raises(RuntimeError, match="has reached its 4 cycles; a scene with a larger time.cycles runs longer"):
        sim.run(1)
    assert len(sim.trajectory) == 40
    assert sim.settled["reached"] and 0 <= sim.contact_fraction <= 1


def test_progress_is_reported():
    seen = []
    twincell.simulate(twincell.Scene.from_dict(SCENE), callback=lambda done, total: seen.append((done, total)))
    assert seen and seen[-1][0] == seen[-1][1] > 0


def test_an_exception_of_the_callback_stops_the_run():
    class Enough(Exception):
        pass

    def callback(done, total):
        raise Enough

    with pytest.raises(Enough):
        twincell.simulate(twincell.Scene.from_dict(LONG), callback=callback)


def test_other_threads_run_meanwhile():
    count, stop = [0], threading.Event()

    def tick():
        while not stop.is_set():
            count[0] += 1
            time.sleep(0.001)

    class Enough(Exception):
        pass

    # The run is never within Python here but for its callback, which ends it after a second thread has counted.
    begin = [None]

    def callback(done, total):
        begin[0] = count[0] if begin[0] is None else begin[0]
        if count[0] > begin[0] + 20:
            raise Enough

    thread = threading.Thread(target=tick)
    thread.start()
    try:
        with pytest.raises(Enough):
            twincell.simulate(twincell.Scene.from_dict(LONG), callback=callback)
    finally:
        stop.set()
        thread.join()
    assert count[0] > begin[0] + 20


def test_a_simulation_runs_in_one_thread_at_a_time():
    sim = twincell.Simulation(twincell.Scene.from_dict(LONG))
    running, stop = threading.Event(), threading.Event()

    def callback(done, total):
        running.set()
        if stop.is_set():
            raise KeyboardInterrupt

    def go():
        with pytest.raises(KeyboardInterrupt):
            sim.run(callback=callback)

    thread = threading.Thread(target=go)
    thread.start()
    try:
        assert running.wait(60)
        with pytest.raises(RuntimeError, match="another thread"):
            sim.run(1)
    finally:
        stop.set()
        thread.join()


def test_ctrl_c_stops_a_simulation_and_leaves_no_file(tmp_path):
    # A shell in the background starts its children with SIGINT ignored.
    code = ("import signal, twincell\n"
            "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
            f"scene = twincell.Scene.from_dict({LONG!r})\n"
            "print('ready', flush=True)\n"
            "try:\n"
            "    twincell.simulate(scene, 'out.h5', callback=lambda d, t: print('running', flush=True))\n"
            "except KeyboardInterrupt:\n"
            "    print('stopped')\n")
    process = subprocess.Popen([sys.executable, "-c", code], cwd=tmp_path, stdout=subprocess.PIPE, text=True,
                               env=os.environ)
    try:
        assert process.stdout.readline() == "ready\n" and process.stdout.readline() == "running\n"
        process.send_signal(signal.SIGINT)
        out, _ = process.communicate(timeout=60)
    finally:
        process.kill()
    assert out.endswith("stopped\n") and process.returncode == 0
    assert list(tmp_path.iterdir()) == []


def test_a_handler_that_does_not_raise_lets_the_run_go_on():
    hits = []
    before = signal.signal(signal.SIGINT, lambda *_: hits.append(1))
    try:
        timer = threading.Timer(0.1, os.kill, (os.getpid(), signal.SIGINT))
        timer.start()
        run = twincell.simulate(SCENE, set={"time.cycles": 30})
        timer.join()
        assert len(run) == 300
    finally:
        signal.signal(signal.SIGINT, before)
    assert hits == [1]


def test_an_interrupted_run_goes_on_to_the_same_bits():
    scene = twincell.Scene.from_dict(SCENE)
    sim = twincell.Simulation(scene)

    def callback(done, total):
        raise KeyboardInterrupt

    stops = 0
    for _ in range(3):
        try:
            sim.run(1, callback=callback)
        except KeyboardInterrupt:
            stops += 1
    assert stops == 3  # a callback is called at the beginning of each run
    while len(sim.trajectory) < 40:
        sim.run(1)
    assert np.array_equal(np.asarray(sim.trajectory.positions), np.asarray(twincell.simulate(scene).positions))


def test_wrong_scenes_have_the_sentence_of_the_program(scene_file, tmp_path):
    said, code = sentence("explain", scene_file, "--set", "drive.gama=2")
    with pytest.raises(ValueError) as raised:
        twincell.Scene.from_toml(scene_file, {"drive.gama": 2})
    assert str(raised.value) == said and raised.value.exit_code == code
    said, _ = sentence("simulate", scene_file, "-o", tmp_path / "x.h5", "--set", "beads.count=1000000", "--set",
                       "start.kind='crystal_a'", "--set", "cell.height=5")
    with pytest.raises(ValueError) as raised:
        twincell.simulate(twincell.Scene.from_toml(
            scene_file, {"beads.count": 1000000, "start.kind": "crystal_a", "cell.height": 5}))
    assert str(raised.value) == said
    with pytest.raises(ValueError, match="no counterpart"):
        twincell.Scene.from_dict({"drive": {"gamma": None}})


def test_the_drive_of_a_run_is_that_of_its_scene():
    sim = twincell.Simulation(twincell.Scene.from_dict(SCENE))
    for name in ("drive", "set_drive"):
        with pytest.raises(AttributeError, match=f"no attribute '{name}'; the drive is that of the scene.* drive.ramp"):
            getattr(sim, name)
    with pytest.raises(AttributeError, match="no attribute 'zzz'$"):
        sim.zzz
    assert sim.time == 0 and not hasattr(sim, "__array__")

"""Frames, trajectories and their analysis from Python."""
import pickle
import re

import numpy as np
import pytest

import twincell
from conftest import DEMO, document, program, sentence, sentence_of_option


def test_frames_are_lazy_and_those_of_another_reader():
    cv = pytest.importorskip("PIL.Image", reason="python3-pil is missing")
    frames = twincell.open_frames(DEMO)
    files = sorted(DEMO.glob("*.png"))
    assert len(frames) == len(files)
    assert frames.shape == (len(files), *frames[0].shape)
    for i in (0, 5, 3, -1):  # forwards, backwards, from the end
        assert np.array_equal(frames[i], np.asarray(cv.open(files[i]).convert("L")))
    some = frames[10:20:3]
    assert len(some) == 4
    assert np.array_equal(some[1], frames[13])
    assert np.array_equal(np.asarray(frames[:3])[2], frames[2])
    assert sum(1 for _ in frames[70:]) == len(files) - 70
    assert not frames[0].flags.writeable
    with pytest.raises(IndexError):
        frames[len(files)]


def test_frames_are_right_in_several_threads():
    from concurrent.futures import ThreadPoolExecutor
    frames = twincell.open_frames(DEMO)
    right = [frames[i].copy() for i in range(len(frames))]
    with ThreadPoolExecutor(4) as threads:
        got = list(threads.map(lambda i: frames[i].copy(), range(len(frames))))
    assert all(np.array_equal(a, b) for a, b in zip(right, got))


def test_columns_are_views_that_keep_their_memory_alive(sim_file):
    h5py = pytest.importorskip("h5py", reason="python3-h5py is missing")
    t = twincell.Trajectory.open(sim_file)
    with h5py.File(sim_file) as file:
        group = next(iter(file["particles"].values()))
        positions, velocities = group["position/value"][:], group["velocity/value"][:]
    assert np.array_equal(np.asarray(t.positions), positions)
    assert np.array_equal(np.asarray(t.velocities), velocities)
    first, again = t.positions[3], t.positions[3]
    assert np.shares_memory(first, again)  # no copy of the frame
    assert np.array_equal(t.positions[:, 4, 2], positions[:, 4, 2]) and np.array_equal(t.positions[1:5, 0], positions[1:5, 0])
    assert not first.flags.owndata and not first.flags.writeable
    radii = t.radii
    assert np.shares_memory(radii, t.radii)
    kept = first.copy()
    for other in range(len(t)):
        t.positions[other]
    del t, again
    assert np.array_equal(first, kept)  # the frame lives as long as the array
    assert np.array_equal(np.full(radii.shape, 0.5), radii)


def test_contacts_are_those_of_the_file(scene_file, tmp_path):
    h5py = pytest.importorskip("h5py", reason="python3-h5py is missing")
    path = tmp_path / "contacts.h5"
    assert program("simulate", scene_file, "--contacts", "-o", path, "-q").returncode == 0
    t = twincell.Trajectory.open(path)
    with h5py.File(path) as file:
        stored = file["twincell/contact_forces"]
        count, pairs, values = stored["count"][:], stored["pairs"][:], stored["values"][:]
    assert [len(c) for c in t.contacts] == count.tolist() and count.sum() > 0
    contacts = [t.contacts[k] for k in range(len(t))]
    every = np.concatenate(contacts)
    assert np.array_equal(np.stack([every["i"], every["j"]], axis=1), pairs)
    assert np.array_equal(every["normal_force"], values[:, 4].astype(float))
    k = int(np.argmax(count))
    here = contacts[k]
    assert not here.flags.owndata and not here.flags.writeable
    # Geometry: the normal points from j to i, the overlap is R_i + R_j minus the distance, the tangential force is
    # perpendicular; single precision in the file.
    of_beads = here[here["j"] >= 0]
    apart = t.positions[k][of_beads["i"]] - t.positions[k][of_beads["j"]]
    distance = np.linalg.norm(apart, axis=1)
    assert len(of_beads) > 0
    assert np.allclose(of_beads["normal"], apart / distance[:, None], atol=1e-6)
    assert np.allclose(of_beads["overlap"], 1 - distance, atol=1e-6)
    across = np.einsum("ka,ka->k", here["tangential_force"], here["normal"])
    assert np.all(np.abs(across) <= 1e-5 * (1 + np.abs(here["normal_force"])))
    assert len(t.walls) > 0 and here["j"].min() >= -len(t.walls)
    assert twincell.Trajectory.from_arrays(np.zeros((1, 2, 2))).contacts is None
    del t, contacts
    assert np.array_equal(here, every[count[:k].sum():count[:k + 1].sum()])  # the frame lives as long as the array


def test_a_million_beads_without_a_copy():
    points = np.zeros((1, 1_000_000, 3))
    points[0, :, 0] = np.arange(1_000_000)
    t = twincell.Trajectory.from_arrays(points)
    views = [t.positions[0] for _ in range(1000)]
    assert all(np.shares_memory(views[0], v) for v in views[1:])
    assert views[-1][-1, 0] == 999_999


def test_written_and_opened_again_are_the_same(tmp_path, tracked):
    path = tmp_path / "exp.h5"
    tracked.write(path)
    again = twincell.Trajectory.open(path)
    assert np.array_equal(np.asarray(again.positions), np.asarray(tracked.positions), equal_nan=True)
    assert np.array_equal(again.phase, tracked.phase) and np.array_equal(again.cycle, tracked.cycle)
    assert again.drive.gamma == tracked.drive.gamma and again.source == "experiment"
    assert program("validate", path).returncode == 0


def test_from_arrays_analyses_like_the_original(sim_file):
    t = twincell.Trajectory.open(sim_file)
    own = twincell.Trajectory.from_arrays(
        np.asarray(t.positions), velocities=np.asarray(t.velocities), radii=t.radii, masses=t.masses, phase=t.phase,
        cycle=t.cycle, time=t.time, step=t.step, plate_height=t.plate_height, box=t.box, drive=t.drive,
        phases_per_cycle=t.phases_per_cycle, tracers=t.tracers, source=t.source)
    # Not those that need what an array cannot carry: spins, and averages over the time between frames.
    assert twincell.analyze(own, "q6,psi6").keys() == twincell.analyze(own, ["q6", "psi6"]).keys() == ["q6", "psi6"]
    names = ["s_b", "s_c", "q6", "psi4", "holes", "phi_z", "h_cm", "phase"]
    assert twincell.analyze(own, names).to_dict() == twincell.analyze(t, names).to_dict()


def test_missing_beads_are_absent():
    points = np.array([[[0, 0], [1, 0], [0.5, 0.866]], [[0, 0], [np.nan, np.nan], [0.5, 0.866]]])
    t = twincell.Trajectory.from_arrays(points)
    assert np.isnan(t.positions[1][1]).all() and t.box.dimension == 2
    table = t.to_dataframe()
    assert table.groupby("frame").size().tolist() == [3, 2]
    assert table.query("frame == 1").particle.tolist() == [0, 2]


def test_the_table_is_that_of_the_verb(sim_file, tmp_path):
    pd = pytest.importorskip("pandas")
    assert program("export", sim_file, "--to", "csv", "-o", tmp_path / "t.csv", "-q").returncode == 0
    verb = pd.read_csv(tmp_path / "t.csv", float_precision="round_trip")
    mine = twincell.Trajectory.open(sim_file).to_dataframe()
    assert list(mine.columns) == list(verb.columns)
    for name in verb.columns:
        assert np.array_equal(mine[name].to_numpy(dtype=float), verb[name].to_numpy(dtype=float)), name


def test_analyze_is_the_verb_to_the_bit(sim_file):
    verb = document("analyze", sim_file, "--discard", 1, "--neighbours", "voronoi")["results"]
    mine = twincell.analyze(sim_file, discard=1, neighbours="voronoi")
    assert mine.to_dict() == verb
    assert list(mine)[0] in verb and len(mine) == len(verb)
    q6 = mine["q6"]
    assert q6.value == verb["q6"]["value"] and q6.unit == "1" and "Steinhardt" in q6.source
    assert mine["s_k"].value.tolist() == verb["s_k"]["value"]
    html = mine._repr_html_()
    assert html.count("<tr>") == len(mine) + 1 and f"{q6.value:.6g}" in html
    assert mine.to_dataframe().loc["q6", "value"] == q6.value


def test_windows_are_those_of_the_verb(tmp_path, scene_file):
    ramp = tmp_path / "ramp.h5"
    words = ("--set", "drive.ramp.gamma=3.0", "--set", "time.cycles=4", "--set", "time.phases=10")
    assert program("simulate", scene_file, "-o", ramp, "-q", *words).returncode == 0
    verb = document("analyze", ramp, "--window-cycles", 2, "--only", "q6,s_b")["windows"]
    mine = twincell.analyze_windows(ramp, 2, ["q6", "s_b"])
    assert len(mine) == len(verb) == 2
    for a, b in zip(mine, verb):
        assert (a.first_cycle, a.cycles, list(a.gamma), list(a.omega)) == (b["first_cycle"], b["cycles"], b["gamma"], b["omega"])
        assert a.results.to_dict() == b["results"]
    assert mine[1].gamma[1] == pytest.approx(3.0)
    with pytest.raises(twincell.ConfigError, match="the drive changes during the run"):
        twincell.analyze(ramp, ["q6"])


def test_results_pool_and_write_as_the_verb(tmp_path, scene_file):
    files = []
    for seed in (1, 2):
        files.append(tmp_path / f"{seed}.h5")
        assert program("simulate", scene_file, "-o", files[-1], "-q", "--seed", seed).returncode == 0
    verb = document("analyze", *files, "-o", tmp_path / "verb.h5", "--only", "q6,s_b")["results"]
    mine = twincell.analyze(files, ["q6", "s_b"])
    assert mine.to_dict() == verb
    mine.write(tmp_path / "mine.h5")
    h5py = pytest.importorskip("h5py", reason="python3-h5py is missing")
    with h5py.File(tmp_path / "mine.h5") as a, h5py.File(tmp_path / "verb.h5") as b:
        assert a["results/q6/value"][()] == b["results/q6/value"][()]


def test_observables_on_arrays():
    rows = 12
    i, j = np.meshgrid(np.arange(rows), np.arange(rows))
    lattice = np.column_stack([(i + 0.5 * (j % 2)).ravel(), (j * np.sqrt(3) / 2).ravel()])
    box = (rows, rows * np.sqrt(3) / 2)  # periodic
    psi = twincell.hexatic_order(lattice, box)
    assert np.allclose(psi, 1, atol=1e-12)  # rows along x
    turned = twincell.hexatic_order(lattice[:, ::-1], box[::-1])
    assert np.allclose(turned, -1, atol=1e-12)  # rows along z: 6 times 90 degrees
    assert (twincell.number_of_neighbours(lattice, box) == 6).all()
    assert (twincell.coordination(lattice, box) == 6).all()  # the earlier name
    assert (twincell.number_of_neighbours(lattice, box, neighbours="delaunay") == 6).all()
    order = twincell.bond_order(lattice, box)
    assert np.allclose(order["q6"], 0.74083, atol=1e-5)  # Steinhardt et al. 1983
    cells = twincell.voronoi(lattice, box)
    assert np.allclose(cells["edge"], 1 / np.sqrt(3), atol=1e-12) and cells["enclosed"].all()
    bonds = twincell.neighbours(lattice, box)
    assert len(bonds["i"]) == 6 * len(lattice) and np.allclose(np.linalg.norm(bonds["bond"], axis=1), 1)
    # Open sides: a corner bead has fewer neighbours.
    assert twincell.number_of_neighbours(lattice).min() in (2, 3)
    alone = twincell.hexatic_order(np.zeros((1, 2)))
    assert np.isnan(alone.real).all() and np.isnan(alone.imag).all()
    for words in ("abc", [[0, 0], [1]]):
        with pytest.raises(ValueError, match="points: is no array of numbers"):
            twincell.hexatic_order(words)
    with pytest.raises(ValueError, match="box: must be a Box, None, or the lengths"):
        twincell.hexatic_order(lattice, 10.0)


def test_mdanalysis_reads_the_same(tracked):
    pytest.importorskip("MDAnalysis", reason="python3-mdanalysis is missing")
    universe = tracked.to_mdanalysis()
    assert len(universe.trajectory) == len(tracked) and len(universe.atoms) == tracked.n_beads
    universe.trajectory[7]
    assert np.array_equal(universe.atoms.positions, tracked.positions[7].astype(np.float32), equal_nan=True)
    assert universe.trajectory.dt == pytest.approx(tracked.time[1] - tracked.time[0])


def test_mdanalysis_has_the_times(sim_file):
    pytest.importorskip("MDAnalysis", reason="python3-mdanalysis is missing")
    t = twincell.Trajectory.open(sim_file)
    assert t.time[0] > 1  # after the discarded cycle
    assert [ts.time for ts in t.to_mdanalysis().trajectory] == pytest.approx(list(t.time))
    uneven = twincell.Trajectory.from_arrays(np.zeros((4, 1, 2)), time=[0, 1, 5, 6])
    with pytest.warns(UserWarning, match="not evenly spaced"):
        uneven.to_mdanalysis()


@pytest.mark.parametrize("words, call, kind", [
    (("analyze", "/nowhere.h5"), lambda: twincell.analyze("/nowhere.h5"), OSError),
    (("analyze", __file__), lambda: twincell.Trajectory.open(__file__), OSError),
    (("locate", "/nowhere"), lambda: twincell.open_frames("/nowhere"), OSError),
    (("explain", "/nowhere.toml"), lambda: twincell.Scene.from_toml("/nowhere.toml"), OSError),
])
def test_errors_have_the_sentence_of_the_program(words, call, kind):
    said, code = sentence(*words)
    with pytest.raises(kind) as raised:
        call()
    # On the command line, advice that names verbs may follow after a semicolon.
    own = str(raised.value)
    assert said == own or said.startswith(own.rstrip(".") + "; twincell "), said
    assert raised.value.exit_code == code
    assert isinstance(raised.value, twincell.Error)


def test_errors_of_options_have_the_sentence_of_the_program(sim_file):
    said, code = sentence_of_option("analyze", sim_file, "--only", "q7")
    with pytest.raises(ValueError) as raised:
        twincell.analyze(sim_file, ["q7"])
    assert str(raised.value) == said and raised.value.exit_code == code
    with pytest.raises(ValueError, match=r"shape \(3, 4\)"):
        twincell.hexatic_order(np.zeros((3, 4)))
    with pytest.raises(ValueError, match="need more than 3.6"):
        twincell.voronoi(np.zeros((3, 2)), (3, 10))
    with pytest.raises(ValueError, match="2 frames of 3 beads"):
        twincell.Trajectory.from_arrays(np.zeros((2, 3, 2)), velocities=np.zeros((2, 4, 2)))
    with pytest.raises(IndexError, match="frame 99"):
        twincell.Trajectory.open(sim_file).positions[99]


@pytest.mark.parametrize("own, sentence", [
    ({"radii": [1e9, 0.5]}, "from_arrays: radius: 1e+09 of bead 0 is out of range"),
    ({"radii": [0.5, float("nan")]}, "from_arrays: radius: nan of bead 1"),
    ({"masses": [0, 1]}, "from_arrays: mass: 0 of bead 0"),
    ({"phase": [9], "cycle": [0], "phases_per_cycle": 4}, "its phase is 9; it must be below 4"),
    ({"phases_per_cycle": -3}, "phases_per_cycle: is -3"),
    ({"drive": twincell.Drive(float("nan"), 1)}, "parameters/drive/amplitude: is nan"),
    ({"positions": [[[0, 0], [1e12, 0]]]}, "cell: its x side goes from -0.5 to 1e+12"),
])
def test_numbers_that_no_file_can_hold_are_refused(own, sentence):
    with pytest.raises(ValueError) as e:
        twincell.Trajectory.from_arrays(own.pop("positions", np.zeros((1, 2, 2))), **own)
    assert isinstance(e.value, twincell.ConfigError)
    assert sentence in str(e.value)


@pytest.mark.parametrize("own, sentence", [
    ({"phase": [0, 0.5], "cycle": [0, 0]}, "phase: value 1 is 0.5; whole numbers"),
    ({"step": [0, 1.5]}, "step: value 1 is 1.5"),
    ({"tracers": [0, 256]}, "tracers: value 1 is 256"),
    ({"tracers": [0, float("nan")]}, "tracers: value 1 is nan"),
    ({"time": [0.0, float("nan")]}, "time: is nan in frame 1; times must be finite and increase"),
    ({"time": [1.0, 1.0]}, "time: is 1 in frame 1"),
    ({"time": ["a", "b"]}, "time: is no list of numbers"),
    ({"box": twincell.Box((0, 0, 0), (6, 6, 6)), "positions": np.arange(12.0).reshape(2, 2, 3) / 3},
     "box: is planar, but the positions are not"),
])
def test_arrays_that_say_something_else_are_refused(own, sentence):
    with pytest.raises(ValueError) as e:
        twincell.Trajectory.from_arrays(own.pop("positions", np.zeros((2, 2, 2))), **own)
    assert sentence in str(e.value)


PLANE = np.column_stack([np.random.default_rng(8).uniform(0, 20, size=(50, 2)), np.zeros(50)])  # (x, y, 0)


@pytest.mark.parametrize("call", [
    lambda: twincell.hexatic_order(PLANE, [20, 20]), lambda: twincell.hexatic_order(PLANE, [20, 20, 20]),
    lambda: twincell.hexatic_order(PLANE), lambda: twincell.bond_order(PLANE), lambda: twincell.voronoi(PLANE),
    lambda: twincell.coordination(PLANE), lambda: twincell.neighbours(PLANE), lambda: twincell.analyze(PLANE, ["psi6"]),
    lambda: twincell.analyze(np.stack([PLANE, PLANE]), ["psi6"], box=[20, 20, 20]),
    lambda: twincell.Trajectory.from_arrays(PLANE[None]),
    lambda: twincell.hexatic_order(PLANE, twincell.Box((0, 0, 0), (20, 20, 20), dimension=3)),
])
def test_points_of_the_plane_x_y_are_refused(call):
    with pytest.raises(ValueError, match=r"have z = 0: give .*:2\]\) for a two-dimensional system"):
        call()


def test_a_layer_in_three_dimensions_needs_a_box():
    box = twincell.Box((0, 0, -0.5), (20, 20, 0.5), ("periodic", "periodic", "open"), dimension=3)
    flat = twincell.coordination(PLANE[:, :2], [20, 20])
    assert np.array_equal(twincell.coordination(PLANE, box), flat)
    assert len(twincell.neighbours(PLANE, box)["i"]) == flat.sum()
    assert twincell.Trajectory.from_arrays(PLANE[None], box=box).box.dimension == 3
    row = np.zeros((5, 3))
    row[:, 0] = np.arange(5)  # beads in a row on the plate are no such plane
    assert twincell.coordination(row).tolist() == [1, 2, 2, 2, 1]


def test_periods_too_short_for_the_neighbours():
    pair = np.array([[0, 0.0], [1, 0]])
    for call in (twincell.coordination, twincell.hexatic_order, twincell.bond_order, twincell.neighbours):
        with pytest.raises(ValueError, match="box: has the period 2 along x; neighbours within 1.2 need more than 2.4"):
            call(pair, [2, 20])
        call(pair, [2.5, 20])
    with pytest.raises(ValueError, match="has the period 1 along y"):
        twincell.coordination(np.array([[0, 0.0, 0], [1, 0.5, 2]]), [20, 1, 20])
    with pytest.warns(UserWarning, match="the period along x, 2 sigma, is shorter than twice the reach of a neighbour"):
        twincell.analyze(pair, ["psi6"], box=[2, 20])


def test_infinite_and_partly_missing_points_are_refused():
    for number, words in ((np.inf, "is at infinity"), (-np.inf, "is at infinity"), (np.nan, "is NaN in some components only")):
        points = np.array([[0, 0], [1, number], [1, 0]])
        with pytest.raises(ValueError, match=f"points: bead 1 {words}"):
            twincell.coordination(points)
        with pytest.raises(ValueError, match=f"positions: bead 1 of frame 0 {words}"):
            twincell.Trajectory.from_arrays(points[None])
    missing = np.array([[0, 0], [np.nan, np.nan], [1, 0]])
    assert twincell.coordination(missing).tolist() == [1, 0, 1]


def test_columns_of_a_table_are_taken_by_name():
    pd = pytest.importorskip("pandas")
    rng = np.random.default_rng(2)
    points = rng.uniform(0, 6, size=(40, 2))
    psi = twincell.hexatic_order(points)
    for second in ("y", "z"):
        table = pd.DataFrame({second: points[:, 1], "x": points[:, 0]})
        assert np.array_equal(twincell.hexatic_order(table), psi, equal_nan=True)
    three = rng.uniform(0, 3, size=(40, 3))
    table = pd.DataFrame(three, columns=["x", "y", "z"])[["z", "x", "y"]]
    assert np.array_equal(twincell.coordination(table), twincell.coordination(three))


def test_wrapped_beads_are_unwrapped():
    rng = np.random.default_rng(3)
    walk = 5 + np.cumsum(rng.normal(0, 0.5, size=(40, 30, 2)), axis=0)
    box = twincell.Box((0, -0.5, 0), (10, 0.5, 10), ("periodic", "open", "periodic"))
    free = twincell.Trajectory.from_arrays(walk, box=box)
    wrapped = twincell.Trajectory.from_arrays(walk % 10, box=box)
    moved = [np.diff(np.asarray(t.positions), axis=0) for t in (free, wrapped)]
    assert np.allclose(moved[0], moved[1], atol=1e-12)
    assert np.abs(np.diff(walk % 10, axis=0)).max() > 5
    kept = twincell.Trajectory.from_arrays(walk % 10, box=box, unwrap=False)
    assert np.array_equal(np.asarray(kept.positions)[:, :, [0, 2]], walk % 10)
    msd = [twincell.analyze(walk % 10, ["msd"], box=[10, 10], unwrap=unwrap)["msd"].value[0] for unwrap in (True, False)]
    assert msd[0] < 1 < msd[1]


def test_a_foreign_file_is_not_replaced(tmp_path, sim_file):
    thesis = tmp_path / "thesis.h5"
    thesis.write_text("mine")
    with pytest.raises(twincell.ConfigError, match="not a trajectory of a simulation made by twincell; choose another name.$"):
        twincell.Trajectory.open(sim_file).write(thesis)
    assert thesis.read_text() == "mine"


def test_an_output_is_never_an_input(tmp_path, scene_file):
    start = tmp_path / "start.h5"
    trajectory = twincell.simulate(twincell.Scene.from_toml(scene_file), start)
    before = start.read_bytes()
    link = tmp_path / "link.h5"
    link.symlink_to(start)
    goes_on = twincell.Scene.from_toml(scene_file, set=["start.kind=trajectory", f"start.from={start}"])
    for output in (start, link):
        with pytest.raises(twincell.ConfigError, match="the output is an input of the same call"):
            twincell.simulate(goes_on, output)
        with pytest.raises(twincell.ConfigError, match="the output is an input of the same call"):
            trajectory.write(output)
    assert start.read_bytes() == before


def test_trajectories_and_scenes_are_pickled(tmp_path, sim_file, scene_file):
    """As multiprocessing does it: of a file the path, in memory all numbers."""
    of_file = twincell.Trajectory.open(sim_file)
    again = pickle.loads(pickle.dumps(of_file))
    assert again.name == str(sim_file.resolve())
    scene = twincell.Scene.from_toml(scene_file, set=["drive.gamma=1.3"])
    copied = pickle.loads(pickle.dumps(scene))
    assert copied.text == scene.text and copied.drive.gamma == scene.drive.gamma
    run = twincell.simulate(scene, contacts=True)
    same = pickle.loads(pickle.dumps(run))
    assert same.name == "memory" and len(same) == len(run) and same.provenance == run.provenance
    for t in (0, len(run) - 1):
        assert np.array_equal(same.positions[t], run.positions[t])
        assert np.array_equal(same.velocities[t], run.velocities[t])
        assert np.array_equal(same.contacts[t], run.contacts[t])
    assert twincell.analyze(same, ["s_b"])["s_b"].value == twincell.analyze(run, ["s_b"])["s_b"].value


def test_a_replaced_file_is_not_taken_for_the_trajectory(tmp_path, scene_file, monkeypatch):
    """A Trajectory is that of the file as it was opened, wherever the process stands."""
    monkeypatch.chdir(tmp_path)
    first = twincell.simulate(scene_file, "run.h5", set={"time.cycles": 2})
    kept = pickle.dumps(first)
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path / "elsewhere")
    twincell.simulate(scene_file, "run.h5", set={"time.cycles": 2, "beads.count": 35})
    assert twincell.export(first, to="csv", output="first.csv")["beads"] == 60
    assert pickle.loads(pickle.dumps(first)).n_beads == 60
    monkeypatch.chdir(tmp_path)
    twincell.simulate(scene_file, "run.h5", set={"time.cycles": 2, "beads.count": 40})
    assert twincell.export(first, to="csv", output="again.csv")["beads"] == 60
    assert pickle.loads(pickle.dumps(first)).n_beads == 60
    with pytest.raises(twincell.InputError, match="was replaced or changed since the trajectory was pickled"):
        pickle.loads(kept)


def test_contacts_have_the_numbers_of_the_verb(scene_file, tmp_path):
    """Also those of which a file keeps single precision."""
    in_memory = twincell.simulate(scene_file, contacts=True)
    path = tmp_path / "contacts.h5"
    assert program("simulate", scene_file, "-o", path, "-q", "--contacts").returncode == 0
    for name in ("contact_force", "pressure", "wall_force"):
        of_file = document("analyze", path, "--only", name)["results"][name]
        assert np.array_equal(twincell.analyze(in_memory, [name])[name].value, of_file["value"]), name


def test_results_and_boxes_are_pickled(sim_file):
    results = twincell.analyze(sim_file)
    again = pickle.loads(pickle.dumps(results))
    assert again.keys() == results.keys() and again.to_dict() == results.to_dict()
    assert again.provenance == results.provenance
    one = pickle.loads(pickle.dumps(results["T_g"]))
    assert one.value == results["T_g"].value and one.interval == results["T_g"].interval
    trajectory = twincell.Trajectory.open(sim_file)
    box, drive = trajectory.box, trajectory.drive
    assert pickle.loads(pickle.dumps(box)) == box and hash(pickle.loads(pickle.dumps(box))) == hash(box)
    assert box != twincell.Box((0, 0, 0), (1, 1, 1)) and box != "box"
    copied = pickle.loads(pickle.dumps(drive))
    assert (copied.amplitude, copied.omega, copied.formula) == (drive.amplitude, drive.omega, drive.formula)
    assert copied.displacement(0.3) == drive.displacement(0.3)


def test_functions_are_pickled_and_have_signatures():
    import inspect
    import multiprocessing
    frames = np.random.default_rng(4).uniform(0, 6, size=(3, 40, 2))
    with multiprocessing.Pool(2) as pool:
        many = pool.map(twincell.hexatic_order, frames)
    assert all(np.array_equal(a, twincell.hexatic_order(b), equal_nan=True) for a, b in zip(many, frames))
    for name in twincell.__all__:
        thing = getattr(twincell, name)
        if inspect.isfunction(thing):
            assert pickle.loads(pickle.dumps(thing)) is thing, name
            assert inspect.signature(thing).parameters or name in ("laws", "preset_names", "result_names", "version"), name
    assert list(inspect.signature(twincell.hexatic_order).parameters) == ["points", "box", "neighbours", "cutoff", "cell_radius"]
    assert inspect.signature(twincell.analyze).parameters["discard"].default == 0
    for method in (twincell.Trajectory.open, twincell.Trajectory.from_arrays):
        assert pickle.loads(pickle.dumps(method)) is method


def test_results_are_formatted_and_asked_by_name(sim_file):
    results = twincell.analyze(sim_file, ["q6", "phase"])
    assert f"{results['q6']:.3f}" == f"{results['q6'].value:.3f}"
    assert f"{results['phase']:>10}".strip() == results["phase"].value and str(results["q6"]) == f"{results['q6']}"
    assert results.get("q6").value == results["q6"].value and results.get("q7") is None and results.get("q7", 1) == 1
    absent = twincell.analyze(np.zeros((1, 1, 2)), ["voronoi_area"])["voronoi_area"]
    with pytest.raises(ValueError, match="voronoi_area: is absent"):
        f"{absent:.3f}"


def test_phases_per_cycle_follow_from_the_phases():
    t = twincell.Trajectory.from_arrays(np.zeros((3, 2, 2)), phase=[0, 2, 1], cycle=[0, 0, 1])
    assert t.phases_per_cycle == 3


def test_a_table_becomes_the_trajectory_again():
    pytest.importorskip("pandas")
    rng = np.random.default_rng(5)
    for dimension in (2, 3):
        points = rng.uniform(0, 5, size=(4, 6, dimension))
        points[2, 3] = np.nan
        t = twincell.Trajectory.from_arrays(
            points, velocities=rng.normal(size=points.shape), radii=rng.uniform(0.4, 0.5, 6), masses=np.arange(1.0, 7),
            tracers=[0, 1, 0, 0, 1, 0], phase=[0, 1, 0, 1], cycle=[0, 0, 1, 1], time=[0, 0.5, 1, 1.75], step=[3, 5, 8, 9])
        table = t.to_dataframe()
        again = twincell.Trajectory.from_dataframe(table.sample(frac=1, random_state=1), box=t.box)
        assert np.array_equal(np.asarray(again.positions), np.asarray(t.positions), equal_nan=True)
        here = np.isfinite(np.asarray(t.positions))
        assert np.array_equal(np.asarray(again.velocities)[here], np.asarray(t.velocities)[here])
        for column in ("time", "step", "phase", "cycle", "radii", "masses", "tracers"):
            assert np.array_equal(getattr(again, column), getattr(t, column)), column
        assert again.box == t.box and again.phases_per_cycle == 2
    table.loc[0, "radius"] = 0.1
    with pytest.raises(ValueError, match="radius: differs among the rows of particle 0"):
        twincell.Trajectory.from_dataframe(table)


def test_arrays_are_analysed():
    """Every observable on arrays alone; each frame counts as a cycle."""
    random = np.random.default_rng(3)
    steps = random.normal(scale=0.05, size=(40, 200, 2))
    points = random.uniform(0, 20, size=(200, 2)) + np.cumsum(steps, axis=0)
    results = twincell.analyze(points, ["msd", "g_r", "voronoi_area"], box=[20, 20])
    # A walk of N beads whose centre of mass is taken away: 4 D m (1 - 1/N).
    assert results["msd"].value[3] == pytest.approx(4 * 2 * 0.05**2, rel=0.06)
    assert np.isfinite(results["g_r"].value).any()
    alone = twincell.analyze(points[0], ["g_r"], box=[20, 20])["g_r"].value
    assert np.array_equal(alone, twincell.analyze(points[:1], ["g_r"], box=[20, 20])["g_r"].value, equal_nan=True)
    # A gas in a periodic box: the cells fill it.
    assert results["voronoi_area"].value == pytest.approx(400 / 200, abs=1e-9)
    # The same points as a trajectory without phases: its frames count as those of the array.
    t = twincell.Trajectory.from_arrays(points, box=[20, 20])
    assert twincell.analyze(t, ["msd"])["msd"].value == pytest.approx(results["msd"].value, nan_ok=True)
    with pytest.raises(ValueError, match="box: is that of an array of points"):
        twincell.analyze(twincell.Trajectory.from_arrays(points), box=[20, 20])
    for wrong in (None, 3):
        with pytest.raises(TypeError, match="a Trajectory or the name of its file is needed, not"):
            twincell.analyze(wrong)
    assert twincell.Trajectory.from_arrays(points, box=[20, 20]).box.boundary == ["periodic", "open", "periodic"]


def test_masked_numbers_are_missing():
    lattice = np.array([[x + 0.5 * (z % 2), z * 0.75**0.5] for z in range(6) for x in range(6)])
    masked = np.ma.masked_array(lattice, mask=np.zeros(lattice.shape, dtype=bool))
    masked.mask[14] = True
    missing = lattice.copy()
    missing[14] = np.nan
    assert np.array_equal(twincell.number_of_neighbours(masked), twincell.number_of_neighbours(missing))
    assert twincell.number_of_neighbours(masked)[15] < twincell.number_of_neighbours(lattice)[15]
    t = twincell.Trajectory.from_arrays(np.ma.stack([masked, masked]))
    assert np.isnan(t.positions[1][14]).all() and np.isfinite(t.positions[1][13]).all()


def test_frames_out_of_order_are_refused():
    with pytest.raises(ValueError, match="does not come after phase 1 of cycle 0 of frame 1"):
        twincell.Trajectory.from_arrays(np.zeros((3, 1, 2)), phase=[0, 1, 0], cycle=[0, 0, 0], phases_per_cycle=2)


def test_copies_are_not_writable(sim_file):
    t = twincell.Trajectory.open(sim_file)
    for column in (t.phase, t.cycle, t.time, t.step, t.plate_height):
        with pytest.raises(ValueError, match="read-only"):
            column[0] = 99


def test_docstrings_name_the_parameters_of_python():
    for name in ("analyze", "track", "analyze_windows", "bond_order"):
        head, _, text = getattr(twincell, name).__doc__.partition("\n")
        for stranger in ("null: not", "left_out:", "weight:", "progress:", "open:"):
            assert stranger not in text, (name, stranger)
    assert "(n_beads, 3)" in twincell.Trajectory.positions.__doc__


def test_docstrings_are_those_of_the_headers():
    from conftest import ROOT
    header = (ROOT / "analysis/neighbours/bond_orientational_order.hpp").read_text()
    assert "Steinhardt's q_6 with the plane's normal" in header
    assert "Steinhardt's q_6 with the plane's normal" in twincell.bond_order.__doc__
    for name in twincell.__all__:
        assert name.startswith("__") or getattr(twincell, name).__doc__, name


def test_stubs_name_everything():
    import ast
    from pathlib import Path
    import twincell._core as core
    tree = ast.parse((Path(core.__file__).parent / "_core.pyi").read_text())
    named = {node.name for node in tree.body if isinstance(node, (ast.ClassDef, ast.FunctionDef))}
    assert {n for n in vars(core) if not n.startswith("__")} <= named
    # Every name that a signature uses is defined.
    import builtins
    known = named | set(dir(builtins)) | {alias.name for node in tree.body if isinstance(node, ast.Import) for alias in node.names}
    for function in (node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)):
        annotations = [a.annotation for a in function.args.args + function.args.kwonlyargs] + [function.returns]
        for node in (n for a in annotations if a is not None for n in ast.walk(a)):
            assert not isinstance(node, ast.Name) or node.id in known, (function.name, node.id)
    stub = (Path(core.__file__).parent / "_core.pyi").read_text()
    assert stub.count("os.PathLike") == stub.count("str | os.PathLike[str]") > 0


@pytest.mark.parametrize("name, call", [
    ("run.dump", r'import_\("{0}", output="run.h5"\) makes a trajectory of a file of another program\.$'),
    ("run.gsd", r'import_\("{0}", output="run.h5"\)'), ("run.xyz", r'import_\('), ("run.csv", r'import_\('),
    ("scene.toml", r'simulate\("{0}"\) makes a trajectory of a scene\.$'), ("film", r'track\("{0}"\) makes a trajectory of a stack'),
])
def test_a_file_that_is_no_trajectory_names_the_function_for_it(tmp_path, name, call):
    path = tmp_path / name
    if "." in name:
        path.write_text("ITEM: TIMESTEP\n")
    else:
        path.mkdir()
    for opened in (twincell.Trajectory.open, twincell.analyze):
        with pytest.raises(OSError, match=call.format(re.escape(str(path)))):
            opened(path)
    with pytest.raises(OSError) as raised:
        twincell.Trajectory.open(tmp_path / f"no-{name}")
    assert "makes a trajectory" not in str(raised.value)

"""The verbs that run as the program, from Python against the command line: same options, same numbers to the bit."""
import shutil

import numpy as np
import pytest

import twincell
from conftest import SCENE, document, program, sentence


@pytest.fixture(scope="module")
def inputs(tmp_path_factory):
    """The folder that `twincell example` unpacks."""
    folder = tmp_path_factory.mktemp("inputs") / "ex"
    assert program("example", folder).returncode == 0
    return folder


def same(mine, verb):
    """Both documents without what names the run itself."""
    for d in (mine, verb):
        d.pop("provenance", None)
        d.pop("core_minutes", None)
    assert mine == verb


@pytest.mark.parametrize("kind", ["walls", "plate", "beads", "camera"])
@pytest.mark.filterwarnings("ignore")
def test_calibrate(inputs, kind):
    verb = document("calibrate", kind, inputs / "frames", "--cell", inputs / "frames/CELL.toml")
    same(getattr(twincell, "calibrate_" + kind)(inputs / "frames", cell=inputs / "frames/CELL.toml"), verb)


@pytest.mark.filterwarnings("ignore")
def test_calibrate_contacts(inputs):
    verb = document("calibrate", "contacts", "numbers", "--restitution", "0.9", "--contact-time", "2.2e-3")
    same(twincell.calibrate_contacts_numbers(restitution=0.9, contact_time=2.2e-3), verb)
    verb = document("calibrate", "contacts", "bounce", inputs / "bounce.csv")
    same(twincell.calibrate_contacts_bounce(inputs / "bounce.csv"), verb)


@pytest.mark.filterwarnings("ignore")
def test_render_and_compare(sim_file, tmp_path):
    words = ("render", sim_file, "-o", tmp_path / "film", "--pixels-per-sigma", "12", "--seed", "3")
    verb = document(*words)
    bytes_of_verb = (tmp_path / "film/frame_00003.png").read_bytes()
    shutil.rmtree(tmp_path / "film")
    seen = []
    mine = twincell.render(sim_file, output=tmp_path / "film", pixels_per_sigma=12, seed=3,
                           callback=lambda done, total: seen.append(done / total))
    same(mine, verb)
    assert (tmp_path / "film/frame_00003.png").read_bytes() == bytes_of_verb
    verb = document("compare", "--simulation", sim_file, "-o", tmp_path / "report")
    same(twincell.compare(simulation=[sim_file], output=tmp_path / "report"), verb)


def test_draw(sim_file, tmp_path):
    words = ("--colour", "speed", "--tracks", "3", "--frames", ":5")
    options = {"colour": "speed", "tracks": 3, "frames": ":5"}
    verb = document("draw", sim_file, "-o", tmp_path / "verb.png", *words)
    mine = twincell.draw(sim_file, output=tmp_path / "mine.png", **options)
    verb["output"] = mine["output"]
    same(mine, verb)
    bytes_of_verb = (tmp_path / "verb.png").read_bytes()
    assert (tmp_path / "mine.png").read_bytes() == bytes_of_verb
    shown = twincell.draw(twincell.Trajectory.open(sim_file), **options)
    assert shown == bytes_of_verb and shown._repr_png_() == bytes_of_verb and shown.startswith(b"\x89PNG")


def test_draw_shows_numbers_of_ones_own(sim_file, tmp_path):
    t = twincell.Trajectory.open(sim_file)
    z = np.asarray(t.positions)[:, :, 2]
    by_word = twincell.draw(t, output=tmp_path / "word.png", colour="height")
    mine = twincell.draw(t, output=tmp_path / "mine.png", colour=z)
    assert mine["colour"] == "value" and mine["range"] == by_word["range"] == [z[-1].min(), z[-1].max()]
    with pytest.raises(ValueError, match="colour: has 1 dimensions; it must have two"):
        twincell.draw(t, colour=z[0])


def test_new_measure_info_and_validate(inputs, sim_file, tmp_path):
    same(twincell.info(sim_file), document("info", sim_file))
    same(twincell.validate(sim_file), document("validate", sim_file))
    (tmp_path / "broken.h5").write_bytes(sim_file.read_bytes()[:4000])
    with pytest.raises(twincell.InputError):
        twincell.validate(tmp_path / "broken.h5")
    scene = twincell.Scene.from_dict(SCENE)
    mine = twincell.measure(scene, only="h_cm")
    (tmp_path / "scene.toml").write_text(scene.text)
    verb = document("measure", tmp_path / "scene.toml", "--only", "h_cm")
    assert mine["results"] == verb["results"]
    cell = twincell.new(inputs / "frames", output=tmp_path / "mine.toml", sigma_mm=2, drive_hz=11.15)
    verb = document("new", inputs / "frames", "-o", tmp_path / "verb.toml", "--sigma-mm", "2", "--drive-hz", "11.15")
    assert (tmp_path / "mine.toml").read_text().splitlines()[3:] == (tmp_path / "verb.toml").read_text().splitlines()[3:]
    assert cell.keys() == verb.keys()


def test_unknown_arguments_are_named(sim_file):
    with pytest.raises(TypeError, match=r"analyze\(\) has no argument 'discrad'; did you mean 'discard'\?"):
        twincell.analyze(sim_file, discrad=1)
    assert twincell.analyze(sim_file, ["h_cm"], discard_=1)["h_cm"].n == twincell.analyze(sim_file, ["h_cm"], discard=1)["h_cm"].n


def test_export_and_import(sim_file, tmp_path):
    assert program("export", sim_file, "--to", "csv", "-o", tmp_path / "verb.csv", "-q").returncode == 0
    twincell.export(sim_file, to="csv", output=tmp_path / "mine.csv")
    assert (tmp_path / "mine.csv").read_bytes() == (tmp_path / "verb.csv").read_bytes()
    scene = twincell.Scene.from_dict({**SCENE, "time": {**SCENE["time"], "integrator": "verlet"}})
    deck = twincell.export(scene, to="lammps", output=tmp_path / "deck")
    assert "--drive-amplitude 1.6" in deck["import"] and (tmp_path / "deck/in.twincell").exists()
    run = twincell.Trajectory.open(sim_file)
    beads = np.asarray(run.positions)[:3]
    in_memory = twincell.Trajectory.from_arrays(beads, radii=run.radii)
    twincell.export(in_memory, to="csv", output=tmp_path / "memory.csv")
    twincell.import_(tmp_path / "memory.csv", output=tmp_path / "again.h5", cell_origin=[0, 10])
    again = twincell.Trajectory.open(tmp_path / "again.h5")
    moved = np.asarray(again.positions) - beads
    assert np.allclose(moved[:, :, 0], 0, atol=1e-12) and np.allclose(moved[:, :, 2], 10, atol=1e-12)
    assert np.array_equal(again.radii, run.radii)


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("word, ending", [("csv", ".csv"), ("xyz", ".xyz"), ("gsd", ".gsd"), ("lammps-dump", ".lammpstrj")])
def test_unknown_velocities_are_read_back(word, ending, tmp_path):
    rng = np.random.default_rng(3)
    positions, velocities = rng.uniform(0, 8, size=(3, 5, 2)), rng.normal(size=(3, 5, 2))
    velocities[:, 2] = velocities[1, 4] = np.nan
    t = twincell.Trajectory.from_arrays(positions, velocities=velocities, box=[9, 9])
    twincell.export(t, to=word, output=tmp_path / f"t{ending}")
    twincell.import_(tmp_path / f"t{ending}", output=tmp_path / "t.h5", timestep=1.0)
    again = np.asarray(twincell.Trajectory.open(tmp_path / "t.h5").velocities)[:, :, [0, 2]]
    assert np.allclose(again, velocities, atol=1e-6, equal_nan=True) and np.isnan(again).sum() == 8


def test_a_three_dimensional_gsd_file_is_no_plane(tmp_path):
    points = np.random.default_rng(3).uniform(0, 8, size=(2, 5, 3))
    twincell.export(twincell.Trajectory.from_arrays(points, box=[9, 9, 9]), to="gsd", output=tmp_path / "t.gsd")
    with pytest.raises(OSError, match=r"not in the plane z = .*three-dimensional system \(dimension 3\)"):
        twincell.import_(tmp_path / "t.gsd", output=tmp_path / "t.h5", timestep=1.0)
    assert twincell.import_(tmp_path / "t.gsd", output=tmp_path / "t.h5", timestep=1.0, dimension=3)["beads"] == 5


def test_objects_in_memory_have_no_file_names(tmp_path):
    t = twincell.Trajectory.from_arrays(np.zeros((1, 2, 2)))
    with pytest.raises(ValueError, match="^trajectory: contacts: needs contacts .*time.contacts"):
        twincell.draw(t, contacts=True)


@pytest.mark.parametrize("name", ["beads.txt", "beads.tsv", "beads"])
def test_a_file_of_unknown_ending_needs_a_format(name, tmp_path):
    (tmp_path / name).write_text("frame,particle,x,y\n0,0,1,-1\n")
    with pytest.raises(ValueError, match="format: is needed, .*; give one of xyz, lammps-dump, gsd, csv, trackmate"):
        twincell.import_(tmp_path / name, output=tmp_path / "t.h5", timestep=1.0)
    assert twincell.import_(tmp_path / name, output=tmp_path / "t.h5", timestep=1.0, format="csv")["beads"] == 1
    (tmp_path / "beads.csv.gz").write_bytes(b"\x1f\x8b")
    with pytest.raises(OSError, match="the file is compressed; unpack it first"):
        twincell.import_(tmp_path / "beads.csv.gz", output=tmp_path / "t.h5", timestep=1.0)


@pytest.mark.filterwarnings("ignore")
def test_match(inputs, tmp_path):
    verb = document("match", inputs / "frames", "-o", tmp_path / "twin", "--twins", "1", "--set", "time.cycles=2")
    mine = twincell.match(inputs / "frames", output=tmp_path / "twin", twins=1, set={"time.cycles": 2})
    same(mine, verb)


@pytest.mark.filterwarnings("ignore")
def test_reproduce(tmp_path):
    verb = document("reproduce", "p1-table1", "-o", tmp_path / "rep")
    same(twincell.reproduce("p1-table1", output=tmp_path / "rep"), verb)


def test_refusals_are_the_sentences_of_the_program(inputs, tmp_path):
    for words, call in (
            (("calibrate", "walls", "no-folder"), lambda: twincell.calibrate_walls("no-folder")),
            (("compare", "-o", tmp_path / "r"), lambda: twincell.compare(output=tmp_path / "r")),
            (("reproduce", "p1-table1", "-o", tmp_path / "r", "--threds", "1"),
             lambda: twincell.reproduce("p1-table1", output=tmp_path / "r", threds=1))):
        said, code = sentence(*words)
        with pytest.raises(twincell.Error) as raised:
            call()
        # Options have the names of Python, such as threds for --threds.
        assert str(raised.value) == said and raised.value.exit_code == code
    with pytest.raises(OSError):
        twincell.calibrate_walls("no-folder")


def test_only_missing_beads_are_noted(tracked, tmp_path, recwarn):
    assert np.isfinite(np.asarray(tracked.positions)).all()
    twincell.export(tracked, to="xyz", output=tmp_path / "whole.xyz")
    assert not [w for w in recwarn if "beads are missing" in str(w.message)]
    positions = np.asarray(tracked.positions).copy()
    positions[3, 5] = np.nan
    with pytest.warns(UserWarning, match="beads are missing in some frames"):
        twincell.export(twincell.Trajectory.from_arrays(positions), to="xyz", output=tmp_path / "gaps.xyz")


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("dimension", [2, 3])
def test_complete_beads_keep_their_places_in_other_programs(tmp_path, dimension):
    mda = pytest.importorskip("MDAnalysis", reason="python3-mdanalysis is missing")
    x = np.add.outer(0.1 * np.arange(3), 1 + 2.0 * np.arange(5))
    r = np.stack([x] + [np.full_like(x, 0.5)] * (dimension - 1), axis=-1)
    r[0, 3] = r[1, 1] = np.nan  # frames 0 and 1 have four beads each, but not the same ones
    gaps = twincell.Trajectory.from_arrays(r)
    dump = {"format": "LAMMPSDUMP", "topology_format": "LAMMPSDUMP"}
    for word, end, options in (("xyz", "xyz", {}), ("lammps-dump", "dump", dump), ("gsd", "gsd", {})):
        path = tmp_path / f"run.{end}"
        said = twincell.export(gaps, to=word, output=path, complete=True)
        assert (said["beads"], said["left_out"]) == (3, 2)
        seen = np.array([ts.positions[:, 0].copy() for ts in mda.Universe(str(path), **options).trajectory])
        assert seen.shape == (3, 3)
        assert np.allclose(seen - seen[0, 0], x[:, [0, 2, 4]] - x[0, 0], atol=1e-5), word
        with pytest.warns(UserWarning, match="complete writes only the beads that are in all frames"):
            twincell.export(gaps, to=word, output=tmp_path / f"gaps.{end}")
    table = tmp_path / "run.csv"
    twincell.export(gaps, to="csv", output=table, complete=True)  # the numbers remain those of the trajectory
    assert sorted(set(np.loadtxt(table, delimiter=",", skiprows=1, usecols=1))) == [0, 2, 4]
    nobody = np.full((2, 2, 2), np.nan)
    nobody[0, 0] = nobody[1, 1] = 1
    with pytest.raises(OSError, match="complete: no bead is in all frames"):
        twincell.export(twincell.Trajectory.from_arrays(nobody), to="xyz", output=tmp_path / "none.xyz", complete=True)


def test_pairs_of_numbers_are_tuples(sim_file, tmp_path):
    dump = tmp_path / "beads.xyz"
    twincell.export(sim_file, to="xyz", output=dump)
    made = twincell.import_(dump, output=tmp_path / "moved.h5", cell_origin=(1.5, 0.25))
    assert made["beads"] == 60
    moved, as_it_was = (twincell.Trajectory.open(f).positions[0] for f in (tmp_path / "moved.h5", sim_file))
    assert np.allclose(moved[:, 0], as_it_was[:, 0] - 1.5, atol=1e-12)
    assert np.allclose(moved[:, 2], as_it_was[:, 2] - 0.25, atol=1e-12)


def test_what_a_callback_raises_stops_the_program(inputs, tmp_path):
    def stop(done, total):
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        twincell.match(inputs / "frames", output=tmp_path / "stopped", twins=1, callback=stop)
    assert not (tmp_path / "stopped/report").exists()


def test_a_missing_program_is_named(monkeypatch, tmp_path):
    monkeypatch.setattr(twincell._program, "__file__", str(tmp_path / "a/b/c/d/e.py"))
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("TWINCELL_PROGRAM")
    with pytest.raises(twincell.RunError, match="not installed"):
        twincell.reproduce("p1-table1", output=tmp_path / "rep")

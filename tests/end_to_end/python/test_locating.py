"""locate and track from Python against the program."""
import io
import os
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

pd = pytest.importorskip("pandas")

import twincell  # noqa: E402
from conftest import DEMO, document, program, sentence_of_option  # noqa: E402


@pytest.fixture(scope="module")
def verb(tmp_path_factory):
    folder = tmp_path_factory.mktemp("locate")
    said = document("locate", DEMO, "-o", folder / "beads.csv")
    return said, (folder / "beads.csv").read_text()


def test_locate_is_the_verb(verb):
    said, csv = verb
    beads = twincell.locate(DEMO)
    heads = csv.splitlines()[0].split(",")
    assert list(beads.columns) == heads  # trackpy's columns and order
    # The table of the program is rounded; rounded in the same way, the numbers are the same.
    decimals = {"raw_mass": 2, "ep": 5, "sigma_x": 5, "sigma_y": 5, "sigma_radius": 5}
    table = pd.read_csv(io.StringIO(csv), dtype=str)
    assert len(table) == len(beads)
    for name in heads:
        mine = (beads[name].astype(int).astype(str) if name in ("frame", "tracer", "edge", "overlap")
                else beads[name].map(lambda v, n=decimals.get(name, 4): f"{v:.{n}f}"))
        assert (mine == table[name]).all(), name
    settings = beads.attrs["settings"]
    assert settings["diameter"][0] == said["diameter_px"] and settings["refine"] == said["refine"]
    assert ("bright" in settings) == said["bright"] and beads.attrs["left_out"] == said["left_out"]
    assert [f["blur_px"] for f in beads.attrs["frames"]] == [f["blur_px"] for f in said["frames"]]


def test_arrays_iterables_and_files_give_the_same_beads():
    frames = twincell.open_frames(DEMO)[:3]
    beads = twincell.locate(frames)
    for same in (np.asarray(frames), [frames[0], frames[1], frames[2]], (f for f in frames)):
        pd.testing.assert_frame_equal(twincell.locate(same), beads)
    settings = beads.attrs["settings"]
    one = twincell.locate(frames[0], **settings)
    first = beads[beads.frame == 0]
    assert np.array_equal(one.x, first.x) and np.array_equal(one.ep, first.ep)
    as_float = twincell.locate(np.asarray(frames, dtype=float) / 255, **settings)
    assert np.allclose(as_float.x, beads.x, atol=1e-4)


def test_track_is_the_verb_to_the_bit(tmp_path, tracked):
    document("track", DEMO, "-o", tmp_path / "verb.h5", "--cell", DEMO / "CELL.toml")
    verb = twincell.Trajectory.open(tmp_path / "verb.h5")
    for column in ("positions", "position_sigma"):
        a, b = np.asarray(getattr(verb, column)), np.asarray(getattr(tracked, column))
        assert np.array_equal(a, b, equal_nan=True)
    for column in ("phase", "cycle", "step", "time", "plate_height", "radii", "tracers"):
        assert np.array_equal(getattr(verb, column), getattr(tracked, column)), column
    assert verb.tracking == tracked.tracking
    again = twincell.track(DEMO, tmp_path / "mine.h5", cell=DEMO / "CELL.toml", threads=1)
    assert again.name == str(tmp_path / "mine.h5")
    assert np.array_equal(np.asarray(again.positions), np.asarray(tracked.positions), equal_nan=True)


def test_located_beads_are_linked(tmp_path, tracked):
    beads = twincell.locate(DEMO, threads=1, **{"diameter": [12.0], "dark": True})
    beads["note"] = "text beside the numbers"
    mine = twincell.track(beads, cell=DEMO / "CELL.toml")
    assert np.array_equal(np.asarray(mine.positions), np.asarray(tracked.positions), equal_nan=True)
    assert np.array_equal(mine.tracers, tracked.tracers)
    # A selection, other names, and a file.
    some = beads[beads.frame < 20].rename(columns={"x": "X"})[["frame", "X", "y"]]
    names = {"diameter": 12.0, "columns": {"x": "X"}, "cell": DEMO / "CELL.toml"}
    with pytest.raises(ValueError, match="x: this column is missing"):
        twincell.track(some, diameter=12.0)
    few = twincell.track(some, **names)
    assert len(few) == 20 and few.position_sigma is None
    some.to_csv(tmp_path / "some.csv", index=False)
    again = twincell.track(tmp_path / "some.csv", **names)
    assert np.array_equal(np.asarray(few.positions), np.asarray(again.positions))
    with pytest.raises(ValueError, match="says how the beads of frames are located"):
        twincell.track(some, bright=True, **names)


def test_keys_of_the_cell_are_set_as_in_simulate():
    for keys in ({"cell.width": 12.5}, ["cell.width=12.5"], "cell.width=12.5"):
        box = twincell.track(DEMO, cell=DEMO / "CELL.toml", frames="0:40", set=keys).box
        assert box.upper[0] - box.lower[0] == 12.5


def test_wrong_options_have_the_sentence_of_the_program(tmp_path):
    out = tmp_path / "x.h5"
    said, _ = sentence_of_option("track", DEMO, "-o", out, "--phase-lock", "often")
    with pytest.raises(ValueError) as raised:
        twincell.track(DEMO, phase_lock="often")
    assert str(raised.value) == said
    said, _ = sentence_of_option("track", DEMO, "-o", out, "--cell", DEMO / "CELL.toml", "--range", 11)
    with pytest.raises(ValueError) as raised:
        twincell.track(DEMO, cell=DEMO / "CELL.toml", range=11)
    assert str(raised.value) == said
    with pytest.raises(ValueError, match="exclude each other"):
        twincell.locate(DEMO, bright=True, dark=True)
    with pytest.raises(ValueError, match="a picture is"):
        twincell.locate(np.zeros((2, 8, 8, 3), dtype=np.uint8))
    with pytest.raises(ValueError, match="int64"):
        twincell.locate(np.zeros((2, 8, 8), dtype=int))
    with pytest.raises(OSError, match="picture 1"):
        twincell.locate([np.zeros((40, 40), np.uint8), np.zeros((40, 41), np.uint8)], diameter=10, dark=True)


@pytest.mark.parametrize("stack, sentence", [
    (np.zeros((60, 80, 3), np.uint8), r"stack: has the shape \(60, 80, 3\), which is that of a colour picture"),
    ([], "pictures: holds no frame"),
    (np.zeros((0, 0), np.uint8), r"picture: has the shape \(0, 0\)"),
    ([np.zeros((20, 20), np.uint8), np.zeros((21, 20), np.uint8)], "picture 1: is 20 x 21 px, but the first"),
])
def test_what_is_no_stack_is_refused(stack, sentence):
    with pytest.raises(twincell.Error, match=sentence):
        twincell.locate(stack)


def test_view_is_the_page_of_the_verb(tmp_path):
    page = tmp_path / "page.html"
    options = {"frames": "10:13", "diameter": [12.0], "dark": True}
    table = twincell.locate(DEMO, view=page, **options)
    assert table.equals(twincell.locate(DEMO, **options))
    words = ("--frames", "10:13", "--diameter", "12.0", "--dark", "-o", "beads.csv", "--view", "verb.html", "-q")
    assert program("locate", DEMO, *words, cwd=tmp_path).returncode == 0
    assert page.read_text() == (tmp_path / "verb.html").read_text()
    with pytest.raises(ValueError, match="name of a stack"):
        twincell.locate(np.zeros((40, 40), np.uint8), view=page)


def test_options_are_those_of_the_verbs():
    import inspect
    import re
    verbs = {"locate": {"stack"}, "track": {"stack"}, "analyze": {"trajectory"}, "simulate": {"scene"}, "fit": {"table"},
             "sweep": {"plan"}}
    for verb, positional in verbs.items():
        function = getattr(twincell, verb)
        text = program(*(("sweep", "run") if verb == "sweep" else (verb,)), "--help").stdout
        options = {o.replace("-", "_") for o in re.findall(r"--([a-z][a-z-]*)", text)}
        try:
            mine = set(inspect.signature(function).parameters)
        except ValueError:  # a function of C++
            mine = set(re.findall(r"(\w+): ", function.__doc__.splitlines()[0]))
        assert mine > positional and mine - positional - {"callback", "box", "unwrap"} <= options, verb  # box, unwrap: of an array


def test_a_callback_is_told_of_frames_only():
    seen = []
    twincell.track(DEMO, cell=DEMO / "CELL.toml", frames="0:40", callback=lambda done, total: seen.append((done, total)))
    assert seen and all(0 <= done <= total and total > 0 for done, total in seen), seen


def test_slices_and_single_frames_keep_their_numbers():
    frames = twincell.open_frames(DEMO)
    by_option = twincell.locate(DEMO, frames="10:13")
    assert sorted(set(by_option["frame"])) == [10, 11, 12]
    for same in (twincell.locate(frames[10:13]), twincell.locate(frames[8:20], frames="2:5")):
        assert same.equals(by_option)
        assert [f["frame"] for f in same.attrs["frames"]] == [10, 11, 12]
    assert sorted(set(twincell.locate(frames[4:11:3])["frame"])) == [4, 7, 10]
    settings = twincell.locate(frames[10:13]).attrs["settings"]
    assert settings["frames"] == ""  # of other frames too
    for wrong in ("5", "-5:", "1:2:0"):  # as the option of the verb
        with pytest.raises(twincell.ConfigError, match="frames"):
            twincell.locate(frames[8:20], frames=wrong)
    assert frames[10].frame_no == 10 and frames[10:20][2].frame_no == 12
    for pictures in (frames[12], [frames[12]], reversed([frames[12]])):
        assert set(twincell.locate(pictures, **settings)["frame"]) == {12}
    backwards = twincell.locate(frames[12:9:-1], **settings)
    assert list(dict.fromkeys(backwards["frame"])) == [12, 11, 10]
    assert isinstance(float(frames[0].mean()), float) and not isinstance(frames[0].max(), np.ndarray)


def test_a_slice_is_tracked_with_its_phases():
    frames = twincell.open_frames(DEMO)
    part, option = (twincell.track(stack, cell=DEMO / "CELL.toml", **options)
                    for stack, options in ((frames[10:50], {}), (DEMO, {"frames": "10:50"})))
    assert list(part.phase[:3]) == [10, 11, 12] and np.array_equal(part.phase, option.phase)
    assert np.array_equal(part.time, option.time) and np.array_equal(part.cycle, option.cycle)


def test_masked_pixels_are_refused():
    picture = np.ma.masked_array(np.asarray(twincell.open_frames(DEMO)[0]))
    picture[:40, :] = np.ma.masked
    with pytest.raises(ValueError, match="picture: has masked pixels"):
        twincell.locate(picture)


def test_ctrl_c_stops_a_slow_fit_at_once():
    code = ("import signal, time, twincell\n"
            "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
            f"stack = {str(DEMO)!r}\n"
            "print('ready', flush=True)\n"
            "try:\n"
            "    twincell.locate(stack, refine='overlapping')\n"
            "except KeyboardInterrupt:\n"
            "    print('stopped', len(twincell.locate(stack, frames='0:1')) > 10)\n")
    process = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True, env=os.environ)
    try:
        assert process.stdout.readline() == "ready\n"
        time.sleep(1)
        process.send_signal(signal.SIGINT)
        out, _ = process.communicate(timeout=60)  # the whole stack takes minutes
    finally:
        process.kill()
    assert out == "stopped True\n"

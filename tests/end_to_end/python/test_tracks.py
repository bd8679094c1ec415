"""Tables of tracks against trackpy's definitions, and the names of other packages."""
import re

import numpy as np
import pytest

pd = pytest.importorskip("pandas")

import twincell  # noqa: E402
from conftest import DEMO, ROOT, program  # noqa: E402


@pytest.fixture(scope="module")
def beads():
    return twincell.locate(DEMO, diameter=[12.0], dark=True)


def walk(frames=40, beads=7, gone=0.0, seed=3):
    """Random walks with a common drift, as a table, of which rows are missing; and the positions."""
    rng = np.random.default_rng(seed)
    r = np.cumsum(rng.normal(size=(frames, beads, 2)) + [0.3, -0.2], axis=0) + 20 * np.arange(beads)[:, None]
    frame, particle = (a.ravel() for a in np.indices((frames, beads)))
    table = pd.DataFrame({"frame": frame, "particle": particle, "x": r[..., 0].ravel(), "y": r[..., 1].ravel()})
    return table[rng.random(len(table)) >= gone].sample(frac=1, random_state=seed), r


def test_link_is_track_of_a_table(beads, tmp_path):
    beads.to_csv(tmp_path / "beads.csv", index=False, float_format="%.17g")
    assert program("track", tmp_path / "beads.csv", "-o", tmp_path / "t.h5", "--csv", tmp_path / "t.csv", "-q").returncode == 0
    verb = pd.read_csv(tmp_path / "t.csv")
    mine = twincell.link(beads)
    assert list(mine.columns) == [*beads.columns, "particle", "ambiguous"] and mine.index.equals(beads.index)
    assert np.array_equal(mine["particle"], verb["particle"]) and np.array_equal(mine["ambiguous"], verb["ambiguous"] == 1)
    assert "particle" not in beads and mine["particle"].nunique() < 1.1 * len(beads[beads["frame"] == 0])
    # The order of the rows, the index and the names of columns do not matter.
    mixed = beads.sample(frac=1, random_state=1).rename(columns={"x": "X"})
    linked = twincell.link(mixed, columns={"x": "X"})
    assert linked.index.equals(mixed.index)
    for _, rows in mine.join(linked["particle"].rename("other")).groupby("particle"):
        assert rows["other"].nunique() == 1
    # The search range is in px: a bead diameter is 12 px.
    d = 2 * beads["radius"].median()
    same = twincell.link(beads, 2 * d)
    assert np.array_equal(same["particle"], mine["particle"])
    with pytest.warns(UserWarning, match="tracks are broken"):
        assert twincell.link(beads, 0.05 * d, memory=0)["particle"].nunique() > 1.5 * mine["particle"].nunique()
    with pytest.raises(ValueError, match="search_range: 500 is out of range; the value must be greater than 0 and at most 119.99"):
        twincell.link(beads, 500)
    with pytest.raises(OSError, match="state the bead diameter"):
        twincell.link(beads[["frame", "x", "y"]])
    by_size = twincell.link(beads[["frame", "x", "y"]], diameter=d)
    assert np.array_equal(by_size["particle"], mine["particle"])


def test_stubs_are_filtered():
    table, _ = walk(gone=0.4)
    rows = table["particle"].value_counts()
    threshold = int(rows.median())
    kept = twincell.filter_stubs(table, threshold)
    assert set(kept["particle"]) == set(rows[rows >= threshold].index) != set(rows.index)
    assert kept.equals(table[table["particle"].isin(kept["particle"])])
    by_frame = table.set_index("frame", drop=False)  # as trackpy returns it
    assert len(twincell.filter_stubs(by_frame, threshold)) == len(kept)


def test_drift_is_the_sum_of_the_mean_steps():
    table, r = walk()
    expected = np.cumsum(np.diff(r, axis=0).mean(axis=1), axis=0)
    drift = twincell.compute_drift(table)
    assert list(drift.columns) == ["x", "y"] and list(drift.index) == list(range(1, 40)) and drift.index.name == "frame"
    assert np.allclose(drift, expected, atol=1e-12)
    smooth = twincell.compute_drift(table, 5)
    assert np.allclose(smooth, pd.DataFrame(np.diff(r, axis=0).mean(axis=1)).rolling(5, min_periods=0).mean().cumsum())
    still = twincell.subtract_drift(table)
    assert still.index.equals(table.index) and not still["x"].equals(table["x"])
    moved = still.sort_values(["frame", "particle"])[["x", "y"]].to_numpy().reshape(r.shape)
    assert np.allclose(moved[0], r[0]) and np.allclose(moved[1:], r[1:] - expected[:, None])
    assert np.allclose(twincell.compute_drift(still), 0, atol=1e-11)
    # A frame whose beads have no step has the drift of the frame before.
    gap = table[table["frame"] != 20]
    drift = twincell.compute_drift(gap)
    assert not {20, 21} & set(drift.index)
    at = twincell.subtract_drift(gap, drift)
    assert np.allclose(at.loc[gap["frame"] == 21, "x"], gap.loc[gap["frame"] == 21, "x"] - drift.loc[19, "x"])


@pytest.mark.parametrize("gone", [0.0, 0.3])
def test_squared_displacements_are_those_of_every_pair(gone):
    table, r = walk(gone=gone)
    mpp, fps, longest = 0.5, 20.0, 12
    mine = twincell.imsd(table, mpp, fps, max_lagtime=longest)
    along = twincell.imsd(table, mpp, fps, max_lagtime=longest, statistic="<x>")
    assert np.allclose(mine.index, np.arange(1, longest + 1) / fps) and list(mine.columns) == list(range(7))
    sums, weights = np.zeros(longest), np.zeros(longest)
    for bead in range(7):
        here = table[table["particle"] == bead].set_index("frame").sort_index()[["x", "y"]]
        n = here.index[-1] - here.index[0] + 1
        places = here.reindex(range(here.index[0], here.index[0] + n)).to_numpy() * mpp
        for lag in range(1, longest + 1):
            step = places[lag:] - places[:-lag]
            assert np.isclose(mine.iloc[lag - 1, bead], np.nanmean((step**2).sum(axis=1)), rtol=1e-12)
            assert np.isclose(along.iloc[lag - 1, bead], np.nanmean(step[:, 0]), rtol=1e-9, atol=1e-12)
            # Qian, Sheetz & Elson 1991, for lag <= n/2, which holds here.
            weight = 6 * (n - lag)**2 * lag / (2 * n - lag + 4 * n * lag**2 - 5 * lag**3) * len(here) / n
            sums[lag - 1] += weight * np.nanmean((step**2).sum(axis=1))
            weights[lag - 1] += weight
    ensemble = twincell.emsd(table, mpp, fps, max_lagtime=longest)
    assert np.allclose(ensemble, sums / weights, rtol=1e-12) and ensemble.index.name == "lagt"
    detail = twincell.emsd(table, mpp, fps, max_lagtime=longest, detail=True)
    assert list(detail.columns) == ["<x>", "<y>", "<x^2>", "<y^2>", "msd", "N"]
    assert np.allclose(detail["msd"], detail["<x^2>"] + detail["<y^2>"]) and np.allclose(detail["N"], weights)


def test_independent_pairs_have_the_limits_of_the_formula():
    table, _ = walk(frames=11, beads=3)
    n = twincell.emsd(table, 1, 1, detail=True)["N"] / 3
    assert np.isclose(n.iloc[0], 10) and np.isclose(n.iloc[-1], 1)  # every step is independent; a single pair
    assert np.all(np.diff(n) < 0) and len(n) == 10


def test_squared_displacements_agree_with_analyze():
    """Relative to the drift, with every bead in every frame: those of `analyze` but for the degree of freedom."""
    _, r = walk(frames=60, beads=9)
    mine = twincell.emsd(twincell.subtract_drift(twincell.Trajectory.from_arrays(r)), 1, 1, max_lagtime=32)
    theirs = twincell.analyze(r, ["msd", "msd_lag"])
    assert np.allclose(theirs["msd_lag"].value, mine.index)
    assert np.allclose(theirs["msd"].value * 8 / 9, mine, rtol=1e-9)


def test_tracks_of_a_trajectory_and_in_space(tracked):
    assert twincell.imsd(tracked, 1, 1, max_lagtime=3).shape == (3, tracked.n_beads)
    rng = np.random.default_rng(1)
    r = np.cumsum(rng.normal(size=(20, 5, 3)), axis=0)
    deep = twincell.Trajectory.from_arrays(r)
    msd = twincell.emsd(deep, 1, 1, max_lagtime=1).iloc[0]
    assert np.isclose(msd, (np.diff(r, axis=0)**2).sum(axis=2).mean())
    assert list(twincell.compute_drift(deep).columns) == ["x", "y", "z"]


def test_tables_that_are_not_linked_are_refused(beads):
    table, _ = walk()
    for call in (twincell.filter_stubs, twincell.compute_drift, twincell.subtract_drift,
                 lambda t: twincell.imsd(t, 1, 1), lambda t: twincell.emsd(t, 1, 1)):
        with pytest.raises(ValueError, match="table: has no column particle"):
            call(beads)
        with pytest.raises(ValueError, match="has a particle twice in a frame"):
            call(pd.concat([table, table.iloc[:1]]))
    with pytest.raises(ValueError, match="no bead is in two frames"):
        twincell.imsd(table[table["frame"] == 3], 1, 1)
    with pytest.raises(ValueError, match="there is no 'rmsd'"):
        twincell.imsd(table, 1, 1, statistic="rmsd")


def table_of_names():
    """The rows of the table of names in docs/python.md: names there, code here."""
    section = (ROOT / "docs/python.md").read_text().partition("## Names in trackpy and freud")[2].partition("\n## ")[0]
    cells = [line.strip("| ").split(" | ") for line in section.splitlines() if line.startswith("| `")]
    return [(re.findall("`([^`]+)`", there), re.findall("`([^`]+)`", here)[0]) for there, here in cells]


@pytest.mark.parametrize("there, here", table_of_names(), ids=lambda value: value[0] if isinstance(value, list) else "")
@pytest.mark.filterwarnings("ignore")
def test_names_of_other_packages(there, here, beads, tracked, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    points = np.random.default_rng(1).uniform(0, 10, size=(5, 60, 2))
    known = {"twincell": twincell, "folder": DEMO, "frames": twincell.open_frames(DEMO), "beads": beads, "trajectory": tracked,
             "points": points, "tracks": twincell.link(beads)}
    assert eval(here, known) is not None
    function = re.match(r"twincell\.(\w+)", here)[1]
    for name in there:
        last = name.rpartition(".")[2]
        if not hasattr(twincell, last):
            with pytest.raises(AttributeError, match=rf"has no attribute '{last}'; here: .*\b{function}\("):
                getattr(twincell, last)


def test_unknown_names_are_hinted():
    with pytest.raises(AttributeError, match="no attribute 'hexatic_ordre'; did you mean 'hexatic_order'"):
        twincell.hexatic_ordre
    with pytest.raises(AttributeError, match="has no attribute 'zzz'$"):
        twincell.zzz
    for package in ("order", "locality", "density", "msd", "box", "diffraction"):
        with pytest.raises(AttributeError, match="; here: "):
            getattr(twincell, package)
    assert not hasattr(twincell, "__wrapped__") and set(twincell.__all__) <= set(dir(twincell))


@pytest.mark.parametrize("call, said", [
    (lambda b: twincell.locate(DEMO, 12, invert=True), "locate.. has no argument 'invert'; here: dark=True"),
    (lambda b: twincell.locate(DEMO, 12, minmass=200), "has no argument 'minmass'; here: min_score"),
    (lambda b: twincell.track(b, search_range=5), "has no argument 'search_range'; here: range, in bead diameters"),
    (lambda b: twincell.link(b, 5, t_column="t"), "has no argument 't_column'; here: columns="),
    (lambda b: twincell.link(b, 5, memry=2), "has no argument 'memry'; did you mean 'memory'"),
])
def test_options_of_other_packages_are_hinted(beads, call, said):
    with pytest.raises(TypeError, match=said):
        call(beads)

"""Other people's readers open what `twincell export` writes and see the numbers of the trajectory.

usage: export_clients_test.py TWINCELL SOURCE_DIR FOLDER CLIENT

CLIENT is mdanalysis, lammps, pandas, ase, gsd, vtk, xml or scipy. Exit code 77 means that the client is not installed.
"""

import math
import pathlib
import shutil
import subprocess
import sys

import h5py
import numpy as np

SKIPPED = 77
SCENE = "data_samples/fortini-huang-crystal/scene.toml"


def run(*command, folder, code=0):
    done = subprocess.run([str(c) for c in command], cwd=folder, capture_output=True, text=True)
    assert done.returncode == code, f"{command}: exit code {done.returncode}\n{done.stdout}\n{done.stderr}"
    return done


def trajectory(twincell, source, folder):
    """A crystal of 60 beads over one cycle, and its numbers: time, positions (x, z up), velocities, radius."""
    run(twincell, "simulate", source / SCENE, "--set", "beads.count=60", "--set", "cell.width=6", "--set", "time.discard=0",
        "--set", "time.cycles=1", "--contacts", "-o", "run.h5", "-q", folder=folder)
    with h5py.File(folder / "run.h5") as file:
        group = file["particles/trajectory"]
        return {"time": group["position/time"][()], "step": group["position/step"][()],
                "x": group["position/value"][:, :, 0], "z": group["position/value"][:, :, 2],
                "vx": group["velocity/value"][:, :, 0], "vz": group["velocity/value"][:, :, 2]}


def export(twincell, word, output, folder):
    run(twincell, "export", "run.h5", "--to", word, "-o", output, folder=folder)
    return folder / output


def same(what, seen, expected, tolerance):
    worst = np.max(np.abs(np.asarray(seen, dtype=float) - expected))
    assert worst <= tolerance, f"{what} differs by {worst:g}"
    print(f"{what}: {np.size(expected)} numbers, largest difference {worst:.1e}")


def mdanalysis(twincell, folder, truth):
    import MDAnalysis

    xyz = MDAnalysis.Universe(str(export(twincell, "xyz", "run.xyz", folder)))
    assert len(xyz.trajectory) == len(truth["time"])
    same("XYZ x", [ts.positions[:, 0].copy() for ts in xyz.trajectory], truth["x"], 1e-6)
    same("XYZ y", [ts.positions[:, 1].copy() for ts in xyz.trajectory], truth["z"], 1e-5)
    dump = MDAnalysis.Universe(str(export(twincell, "lammps-dump", "run.lammpstrj", folder)), format="LAMMPSDUMP",
                               topology_format="LAMMPSDUMP")
    low = -1.5  # MDAnalysis shifts positions by the lower corner of the box: here A below the plate's mean height
    same("dump x", [ts.positions[:, 0].copy() for ts in dump.trajectory], truth["x"], 1e-5)
    same("dump y", [ts.positions[:, 1].copy() + low for ts in dump.trajectory], truth["z"], 1e-5)
    # The trajectory itself, with the beads of the GSD file as topology: one call, no empty universe.
    shutil.copy(folder / "run.h5", folder / "run.h5md")
    own = MDAnalysis.Universe(str(export(twincell, "gsd", "run.gsd", folder)), str(folder / "run.h5md"), convert_units=False)
    same("H5MD x", [ts.positions[:, 0].copy() for ts in own.trajectory], truth["x"], 1e-6)
    same("H5MD z", [ts.positions[:, 2].copy() for ts in own.trajectory], truth["z"], 1e-5)
    same("H5MD time", [ts.time for ts in own.trajectory], truth["time"], 0)
    same("GSD radius", own.atoms.radii, 0.5, 0)
    same("GSD mass", own.atoms.masses, 1, 0)
    assert set(own.atoms.types) == {"bead", "tracer"}, set(own.atoms.types)


def lammps(twincell, folder, truth):
    program = shutil.which("lmp")
    if not program:
        sys.exit(SKIPPED)
    export(twincell, "lammps-dump", "run.lammpstrj", folder)
    last = truth["step"][-1]
    (folder / "in.read").write_text(
        "dimension 2\nunits lj\natom_style sphere\nboundary f f p\nregion box block -10 20 -10 50 -0.5 0.5\n"
        "create_box 2 box\npair_style zero 2.0\npair_coeff * *\n"
        f"read_dump run.lammpstrj {last} x y vx vy box yes add yes\n"
        "write_dump all custom again.dump id x y vx vy modify sort id format float %.17g\n")
    run(program, "-in", "in.read", "-log", "none", folder=folder)
    rows = np.loadtxt((folder / "again.dump").read_text().splitlines()[9:])
    for name, column in {"x": 1, "z": 2, "vx": 3, "vz": 4}.items():
        same(f"LAMMPS {name}", rows[:, column], truth[name][-1], 1e-12)


def pandas(twincell, folder, truth):
    import pandas

    table = pandas.read_csv(export(twincell, "csv", "run.csv", folder), float_precision="round_trip")
    assert list(table.columns[:4]) == ["frame", "particle", "x", "y"] and "z" not in table.columns
    shape = truth["x"].shape
    table = table.sort_values(["frame", "particle"])
    same("CSV x", table["x"].to_numpy().reshape(shape), truth["x"], 0)
    same("CSV y", -table["y"].to_numpy().reshape(shape), truth["z"], 0)
    same("CSV vy", -table["vy"].to_numpy().reshape(shape), truth["vz"], 0)
    same("CSV time", table["time"].to_numpy().reshape(shape)[:, 0], truth["time"], 0)


def ase(twincell, folder, truth):
    try:
        from ase.io import read
    except ImportError:
        sys.exit(SKIPPED)
    frames = read(export(twincell, "xyz", "run.xyz", folder), index=":")
    same("ASE x", [f.positions[:, 0] for f in frames], truth["x"], 1e-13)
    same("ASE y", [f.positions[:, 1] for f in frames], truth["z"], 1e-13)
    same("ASE velo", [f.arrays["velo"][:, 0] for f in frames], truth["vx"], 1e-13)
    same("ASE time", [f.info["Time"] for f in frames], truth["time"], 1e-13)
    dump = read(export(twincell, "lammps-dump", "run.lammpstrj", folder), index=":", format="lammps-dump-text")
    same("ASE dump x", [f.positions[:, 0] for f in dump], truth["x"], 1e-13)


def gsd(twincell, folder, truth):
    try:
        import gsd.hoomd
    except ImportError:
        sys.exit(SKIPPED)
    export(twincell, "gsd", "run.gsd", folder)
    with gsd.hoomd.open(str(folder / "run.gsd"), "rb") as frames:
        assert len(frames) == len(truth["time"])
        assert frames[0].configuration.dimensions == 2 and frames[0].particles.types == ["bead", "tracer"]
        centre = [f.log["configuration/centre"][0] for f in frames]
        same("GSD x", [f.particles.position[:, 0] + c[0] for f, c in zip(frames, centre)], truth["x"], 2e-6)
        same("GSD y", [f.particles.position[:, 1] + c[1] for f, c in zip(frames, centre)], truth["z"], 4e-6)
        same("GSD vx", [f.particles.velocity[:, 0] for f in frames], truth["vx"], 1e-6)
        same("GSD step", [f.configuration.step for f in frames], truth["step"], 0)
        same("GSD diameter", frames[0].particles.diameter, np.ones(60), 1e-6)
    # And what that library writes is imported.
    other = gsd.hoomd.Snapshot()
    other.particles.N = 2
    other.particles.position = [[-1, -2, 0], [1.5, 2.25, 0]]
    other.particles.velocity = [[0.5, 0, 0], [0, 0.25, 0]]
    other.configuration.box = [8, 6, 0, 0, 0, 0]
    other.configuration.dimensions = 2
    with gsd.hoomd.open(str(folder / "other.gsd"), "wb") as file:
        for step in (10, 20):
            other.configuration.step = step
            file.append(other)
    run(twincell, "import", "other.gsd", "-o", "other.h5", "--timestep", 0.5, "--cell-origin", -4, -3, "-q", folder=folder)
    with h5py.File(folder / "other.h5") as file:
        group = file["particles/trajectory/position"]
        same("imported x", group["value"][1, :, 0], [3, 5.5], 1e-12)
        same("imported z", group["value"][1, :, 2], [1, 5.25], 1e-12)
        same("imported time", group["time"][()], [5, 10], 1e-12)
    # A bead that moves 6 in a period of 8. The library leaves out the images of the first frame, which are 0.
    other.particles.N = 1
    other.particles.velocity = None
    with gsd.hoomd.open(str(folder / "fast.gsd"), "wb") as file:
        for step in range(5):
            x = -3.0 + 6 * step
            image = math.floor((x + 4) / 8)
            other.configuration.step = step
            other.particles.position, other.particles.image = [[x - 8 * image, 0, 0]], [[image, 0, 0]]
            file.append(other)
    run(twincell, "import", "fast.gsd", "-o", "fast.h5", "--timestep", 1, "-q", folder=folder)
    with h5py.File(folder / "fast.h5") as file:
        same("unwrapped x", file["particles/trajectory/position/value"][:, 0, 0], [1, 7, 13, 19, 25], 1e-6)


def vtk(twincell, folder, truth):
    try:
        import vtkmodules.vtkIOXML as reading
        from vtkmodules.util.numpy_support import vtk_to_numpy
    except ImportError:
        sys.exit(SKIPPED)
    import xml.etree.ElementTree as ElementTree

    listed = ElementTree.parse(export(twincell, "vtk", "run", folder) / "run.pvd").getroot().findall("Collection/DataSet")
    assert len(listed) == len(truth["time"])
    same("PVD time", [float(d.get("timestep")) for d in listed], truth["time"], 0)
    for frame, entry in enumerate(listed):
        reader = reading.vtkXMLPolyDataReader()
        reader.SetFileName(str(folder / "run" / entry.get("file")))
        reader.Update()
        data = reader.GetOutput()
        assert data.GetNumberOfPoints() == data.GetNumberOfVerts() == 60
        points = vtk_to_numpy(data.GetPoints().GetData())
        assert np.array_equal(points[:, 0], truth["x"][frame]) and np.array_equal(points[:, 1], truth["z"][frame])
        arrays = {data.GetPointData().GetArrayName(i) for i in range(data.GetPointData().GetNumberOfArrays())}
        assert {"id", "radius", "mass", "tracer", "velocity", "spin"} <= arrays, arrays
        velocity = vtk_to_numpy(data.GetPointData().GetArray("velocity"))
        assert np.array_equal(velocity[:, 1], truth["vz"][frame])
        assert data.GetFieldData().GetArray("TimeValue").GetValue(0) == truth["time"][frame]
        q6 = vtk_to_numpy(data.GetPointData().GetArray("q6"))
        assert frame > 0 or np.nanmin(np.abs(q6 - 0.7408)) < 1e-3, q6  # inside the crystal
    print(f"VTK: {len(listed)} files equal to the bit")

    listed = ElementTree.parse(folder / "run" / "run-contacts.pvd").getroot().findall("Collection/DataSet")
    assert len(listed) == len(truth["time"])
    with h5py.File(folder / "run.h5") as file:
        stored = file["twincell/contact_forces"]
        count, pairs, values = stored["count"][()], stored["pairs"][()], stored["values"][()]
        group = file[file["connectivity/contacts"].attrs["particles_group"]]
        assert group == file["particles/trajectory"]
        bonds = file["connectivity/contacts/value"][()]
    lines = 0
    for frame, entry in enumerate(listed):
        reader = reading.vtkXMLPolyDataReader()
        reader.SetFileName(str(folder / "run" / entry.get("file")))
        reader.Update()
        data = reader.GetOutput()
        here = slice(sum(count[:frame]), sum(count[:frame + 1]))
        assert data.GetNumberOfLines() == count[frame]
        cells = data.GetCellData()
        assert np.array_equal(vtk_to_numpy(cells.GetArray("normal_force")), values[here, 4].astype(float))
        j = vtk_to_numpy(cells.GetArray("j"))
        assert np.array_equal(j, pairs[here, 1])
        assert np.array_equal(bonds[frame][bonds[frame][:, 0] >= 0], pairs[here][j >= 0])
        ends = vtk_to_numpy(data.GetPoints().GetData()).reshape(-1, 2, 3)
        for (start, end), (a, b) in zip(ends, pairs[here]):
            assert start[0] == truth["x"][frame][a] and start[1] == truth["z"][frame][a]
            if b >= 0:
                assert abs(end[0] - truth["x"][frame][b]) < 1e-6 and abs(end[1] - truth["z"][frame][b]) < 1e-6
        lines += len(ends)
    assert lines > 0
    print(f"VTK: {lines} contacts as lines")


def xml(twincell, folder, truth):
    """Python's XML parser reads TrackMate's file; its tracks are followed as TmXmlReader does, from edge to edge."""
    import xml.etree.ElementTree as ElementTree

    root = ElementTree.parse(export(twincell, "trackmate", "run.xml", folder)).getroot()
    assert root.tag == "TrackMate" and root.find("Model").get("spatialunits") == "sigma"
    frames = root.findall("Model/AllSpots/SpotsInFrame")
    assert [int(f.get("frame")) for f in frames] == list(range(len(truth["time"])))
    spots = {s.get("ID"): s for f in frames for s in f}
    assert len(spots) == truth["x"].size
    shown = {t.get("TRACK_ID") for t in root.findall("Model/FilteredTracks/TrackID")}
    tracks = root.findall("Model/AllTracks/Track")
    assert len(tracks) == len(shown) == 60
    seen = {name: np.full(truth["x"].shape, np.nan) for name in ("POSITION_X", "POSITION_Y", "POSITION_T")}
    for track in tracks:
        edges = [(e.get("SPOT_SOURCE_ID"), e.get("SPOT_TARGET_ID")) for e in track]
        for spot in {spot for edge in edges for spot in edge}:
            for name, array in seen.items():
                array[int(spots[spot].get("FRAME")), int(track.get("TRACK_ID"))] = float(spots[spot].get(name))
    same("TrackMate x", seen["POSITION_X"], truth["x"], 0)
    same("TrackMate y, downwards", -seen["POSITION_Y"], truth["z"], 0)
    same("TrackMate t", seen["POSITION_T"], np.broadcast_to(truth["time"][:, None], truth["x"].shape), 0)
    listed = ElementTree.parse(export(twincell, "isbi", "isbi.xml", folder)).getroot()
    particles = listed.findall("TrackContestISBI2012/particle")
    assert listed.tag == "root" and len(particles) == 60
    for k, axis in enumerate("xy"):
        found = [[float(d.get(axis)) for d in sorted(p, key=lambda d: int(d.get("t")))] for p in particles]
        same(f"ISBI {axis}", (1, -1)[k] * np.transpose(found), truth["xz"[k]], 0)


def scipy(twincell, folder, truth):
    try:
        from scipy.io import loadmat
    except ImportError:
        sys.exit(SKIPPED)
    mat = loadmat(export(twincell, "mat", "run.mat", folder))
    for name, expected in {"x": "x", "y": "z", "vx": "vx", "vy": "vz"}.items():
        same(f"MAT {name}", mat[name].T, truth[expected], 0)
    same("MAT time", mat["time"][0], truth["time"], 0)
    same("MAT radius", mat["radius"][:, 0], np.full(60, 0.5), 0)
    assert mat["omega_z"].shape == mat["q6"].shape == mat["x"].shape
    assert list(mat["length_unit"]) == ["sigma"] and list(mat["time_unit"]) == ["t0"]


def main():
    twincell, source, folder, client = sys.argv[1:]
    folder = pathlib.Path(folder) / f"export_{client}"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    truth = trajectory(pathlib.Path(twincell), pathlib.Path(source), folder)
    assert truth["x"].shape[1] == 60 and not math.isnan(truth["x"].sum())
    {"mdanalysis": mdanalysis, "lammps": lammps, "pandas": pandas, "ase": ase, "gsd": gsd, "vtk": vtk, "xml": xml,
     "scipy": scipy}[client](twincell, folder, truth)


main()

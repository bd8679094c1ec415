"""What the names and options of trackpy, freud and pims are called here: for the messages of errors."""
from __future__ import annotations

import difflib

_LOCATE = "locate(stack) takes a picture, a sequence of pictures or the name of a stack"
_PAIRS = 'analyze(points, ["g_r", "g_r_distance"], box=box)'
_BONDS = "hexatic_order(points, box) and bond_order(points, box)"
_NEAR = "neighbours(points, box, cutoff) and number_of_neighbours(points, box)"
_CELLS = "voronoi(points, box)"
_MSD = 'analyze(points, ["msd", "msd_lag"], box=box), imsd(tracks, mpp, fps) and emsd(tracks, mpp, fps)'
_STRUCTURE = 'analyze(points, ["S_q", "S_q_wavenumber"], box=box)'
_FRAMES = "open_frames(path)"
_PICTURE = "draw(trajectory, tracks=5)"

_ELSEWHERE = {
    "batch": _LOCATE, "annotate": 'locate(folder, view="page.html") writes a page with the beads on the frames',
    "link_df": "link(beads, search_range)", "link_iter": "link(beads, search_range)", "link_df_iter": "link(beads, search_range)",
    "link_partial": "link(beads, search_range)", "msd": _MSD, "plot_traj": _PICTURE, "plot_displacements": "draw(trajectory, vectors=True)",
    "pair_correlation_2d": _PAIRS, "pair_correlation_3d": _PAIRS, "proximity": _NEAR,
    "ImageSequence": _FRAMES, "Video": _FRAMES, "ND2_Reader": _FRAMES, "open": _FRAMES,
    "PandasHDFStore": 'Trajectory.write(path) and export(trajectory, to="csv", output=path)',
    "box": "Box(lower, upper, boundary), or the lengths of a periodic box, box=[Lx, Lz]",
    "order": _BONDS, "Hexatic": _BONDS, "Steinhardt": _BONDS, "Translational": _BONDS,
    "locality": _NEAR, "AABBQuery": _NEAR, "LinkCell": _NEAR, "NeighborList": _NEAR, "Voronoi": _CELLS,
    "density": _PAIRS, "RDF": _PAIRS, "MSD": _MSD,
    "diffraction": _STRUCTURE, "StaticStructureFactorDirect": _STRUCTURE, "StaticStructureFactorDebye": _STRUCTURE,
}

_DARK = "dark=True for dark beads, bright=True for bright ones"
_SCORE = "min_score, between 0 and 1; a bead's brightness sets no limit"

OPTIONS = {
    ("locate", "invert"): _DARK, ("locate", "minmass"): _SCORE, ("locate", "threshold"): _SCORE, ("locate", "percentile"): _SCORE,
    ("locate", "processes"): "threads", ("track", "search_range"): "range, in bead diameters",
    ("link", "range"): "search_range, in px", ("link", "pos_columns"): 'columns={"x": "X"}', ("link", "t_column"): 'columns={"frame": "t"}',
}


def unknown(name, known):
    """The AttributeError of a name that the module lacks."""
    said = f"module 'twincell' has no attribute '{name}'"
    near = difflib.get_close_matches(name, known, 1)
    if name in _ELSEWHERE:
        said += f"; here: {_ELSEWHERE[name]}."
    elif near:
        said += f"; did you mean '{near[0]}'?"
    return AttributeError(said)

"""Every notebook of docs/notebooks runs in a Jupyter kernel, as nbconvert runs it, and draws what it announces.

Each notebook has its own test, which skips, naming the packages, where one is missing. With TWINCELL_NOTEBOOKS=FOLDER the
executed notebooks and their pictures are kept there.
"""
import base64
import importlib.util
import io
import os
import shutil
from pathlib import Path

import pytest

import twincell
from conftest import ROOT

FOLDER = ROOT / "docs/notebooks"
# What a notebook needs: Debian's package of each module, of each program, and the number of its pictures.
JUPYTER = {"nbconvert": "python3-nbconvert", "ipykernel": "python3-ipykernel", "matplotlib": "python3-matplotlib",
           "PIL": "python3-pil"}
NOTEBOOKS = {
    "compare_with_other_programs": (
        {"scipy": "python3-scipy", "MDAnalysis": "python3-mdanalysis", "gsd": "python3-gsd"}, {"lmp": "lammps"}, 5),
    "locate_and_track": ({}, {}, 4),
    "phase_diagram": ({}, {}, 2),
}


def test_every_notebook_is_listed_and_stored_without_results():
    nbformat = pytest.importorskip("nbformat", reason="python3-nbformat is missing")
    paths = sorted(FOLDER.glob("*.ipynb"))
    assert [path.stem for path in paths] == sorted(NOTEBOOKS)
    for path in paths:
        notebook = nbformat.read(path, as_version=4)
        nbformat.validate(notebook)
        assert notebook.cells[0].source.startswith("# "), f"{path.name} has no title"
        for number, cell in enumerate(notebook.cells, 1):
            stored = cell.cell_type == "code" and (cell.outputs or cell.execution_count is not None)
            assert not stored, f"{path.name}, cell {number} has results; clear them"
            assert not cell.metadata, f"{path.name}, cell {number} has metadata of an editor; clear them"


def executed(path, tmp_path, monkeypatch):
    """The notebook after a run in a kernel of this interpreter that knows this module and writes nothing to the home."""
    import nbformat
    from ipykernel.kernelspec import write_kernel_spec
    from nbconvert.preprocessors import ExecutePreprocessor

    write_kernel_spec(str(tmp_path / "share/kernels/python3"))
    for name, value in {
            "JUPYTER_PATH": tmp_path / "share", "JUPYTER_CONFIG_DIR": tmp_path, "JUPYTER_DATA_DIR": tmp_path / "data",
            "JUPYTER_RUNTIME_DIR": tmp_path / "runtime", "IPYTHONDIR": tmp_path / "ipython", "MPLCONFIGDIR": tmp_path,
            "TMPDIR": tmp_path, "PYTHONPATH": Path(twincell.__file__).resolve().parents[1],
            "PYTHONDONTWRITEBYTECODE": 1, "PYDEVD_DISABLE_FILE_VALIDATION": 1}.items():
        monkeypatch.setenv(name, str(value))
    notebook = nbformat.read(path, as_version=4)
    ExecutePreprocessor(timeout=120, kernel_name="python3").preprocess(notebook, {"metadata": {"path": str(path.parent)}})
    return notebook


@pytest.mark.parametrize("name", NOTEBOOKS)
@pytest.mark.filterwarnings("ignore")
def test_notebook(name, tmp_path, monkeypatch):
    modules, programs, pictures = NOTEBOOKS[name]
    missing = [package for module, package in {**JUPYTER, **modules}.items() if importlib.util.find_spec(module) is None]
    missing += [package for program, package in programs.items() if shutil.which(program) is None]
    if missing:
        pytest.skip(f"{name}.ipynb needs {', '.join(missing)}")
    from PIL import Image

    before = sorted(FOLDER.rglob("*"))
    notebook = executed(FOLDER / f"{name}.ipynb", tmp_path, monkeypatch)
    assert sorted(FOLDER.rglob("*")) == before, f"{name}.ipynb leaves files in its folder"
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    said = "".join(output.text for output in outputs if output.get("name") == "stderr").splitlines()
    warned = [line for line in said if "Warning" in line and "/dist-packages/" not in line]  # not those of other modules
    assert not warned, f"{name}.ipynb writes warnings: {warned}"
    drawn = [base64.b64decode(o.data["image/png"]) for o in outputs if "image/png" in o.get("data", {})]
    assert len(drawn) == pictures
    for picture in drawn:
        grey = Image.open(io.BytesIO(picture)).convert("L")
        dark, bright = grey.getextrema()
        assert dark < 64 and bright > 192 and min(grey.size) > 150, f"{name}.ipynb draws an empty picture"
    keep = os.environ.get("TWINCELL_NOTEBOOKS")
    if keep:
        import nbformat

        Path(keep).mkdir(parents=True, exist_ok=True)
        nbformat.write(notebook, Path(keep) / f"{name}.ipynb")
        for number, picture in enumerate(drawn, 1):
            (Path(keep) / f"{name}-{number}.png").write_bytes(picture)

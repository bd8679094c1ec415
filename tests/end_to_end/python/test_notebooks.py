"""Every notebook of docs/notebooks runs: its code cells in order, in one namespace, in the folder of the notebook.

The cells run in plain Python rather than in a kernel of Jupyter, which the test machine need not have. The value of the last
expression of a cell is shown as a notebook would show it, and figures are drawn.
"""
import ast
import json
import traceback

import pytest

from conftest import ROOT

matplotlib = pytest.importorskip("matplotlib", reason="notebooks draw with python3-matplotlib")
pytest.importorskip("scipy", reason="notebooks compare with python3-scipy")
matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

NOTEBOOKS = sorted((ROOT / "docs/notebooks").glob("*.ipynb"))


def show(value):
    html = getattr(value, "_repr_html_", None)
    return html() if html else repr(value)


def run(code, where, names):
    """Runs a cell; the value of its last expression, or None."""
    tree = ast.parse(code, where)
    last = ast.Expression(tree.body.pop().value) if tree.body and isinstance(tree.body[-1], ast.Expr) else None
    exec(compile(tree, where, "exec"), names)
    return None if last is None else eval(compile(last, where, "eval"), names)


def test_there_are_three():
    assert len(NOTEBOOKS) >= 3


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_notebook(path, tmp_path, monkeypatch):
    notebook = json.loads(path.read_text())
    assert notebook["nbformat"] == 4
    assert notebook["cells"][0]["cell_type"] == "markdown" and notebook["cells"][0]["source"][0].startswith("# ")
    monkeypatch.chdir(path.parent)
    before = set(path.parent.iterdir())
    names = {"__name__": "__main__"}
    figures = 0
    for number, cell in enumerate(notebook["cells"], 1):
        if cell["cell_type"] != "code":
            continue
        where = f"{path.name}, cell {number}"
        assert not cell["outputs"] and cell["execution_count"] is None, f"{where} has outputs; clear them"
        try:
            value = run("".join(cell["source"]), where, names)
            if value is not None:
                show(value)
            for figure in map(plt.figure, plt.get_fignums()):
                figures += 1
                figure.savefig(tmp_path / f"{path.stem}-{figures}.png", dpi=80)
        except Exception:
            pytest.fail(f"{where} fails:\n{traceback.format_exc()}", pytrace=False)
        finally:
            plt.close("all")
    assert figures > 0, f"{path.name} draws nothing"
    assert set(path.parent.iterdir()) == before, f"{path.name} leaves files in its folder"

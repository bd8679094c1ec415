"""Every block of Python in docs/python.md runs, in order, in one namespace."""
import re

from conftest import ROOT


def test_the_blocks_of_the_tutorial_run(tmp_path, monkeypatch):
    (tmp_path / "data_samples").symlink_to(ROOT / "data_samples")
    monkeypatch.chdir(tmp_path)
    text = (ROOT / "docs/python.md").read_text()
    blocks = re.findall(r"^```python\n(.*?)^```", text, flags=re.M | re.S)
    assert len(blocks) >= 6
    names = {}
    for block in blocks:
        exec(compile(block, "docs/python.md", "exec"), names)
    assert names["beads"].shape[0] > 0 and names["trajectory"].drive.gamma > 0

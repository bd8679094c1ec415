"""fit and sweep from Python against the program."""
import numpy as np
import pytest

import twincell
from conftest import document, program, sentence, sentence_of_option


@pytest.fixture()
def table(tmp_path):
    x = np.linspace(1, 4, 9)
    noise = np.array([1, -2, 0.5, 1, -1, 2, -0.5, 0.3, -1]) * 1e-3
    columns = {"W": x, "T": 2.5 * x ** 1.7 * (1 + noise), "error": 1e-3 * x}
    path = tmp_path / "t.csv"
    path.write_text("W,T,error\n" + "".join(f"{a!r},{b!r},{c!r}\n" for a, b, c in zip(*(
        v.tolist() for v in columns.values()))))
    return path, columns


def test_fit_is_the_verb_to_the_bit(table):
    path, columns = table
    verb = document("fit", path, "--law", "power", "--sigma", "error", "--window", "1.5,3.5")
    del verb["provenance"]
    options = {"law": "power", "sigma": "error", "window": (1.5, 3.5)}
    assert twincell.fit(path, **options) == verb
    of_columns = twincell.fit(columns, x="W", y="T", **options)
    assert of_columns == verb
    assert "power" in twincell.laws()
    exponents = [p["value"] for p in verb["parameters"].values()]
    assert any(abs(e - 1.7) < 5e-3 for e in exponents)  # the table's own exponent


def test_fit_refuses_with_the_sentence_of_the_program(table):
    path, columns = table
    for words, options in ((("--law", "powr"), {"law": "powr"}),
                           (("--law", "power", "--x", "Z"), {"law": "power", "x": "Z"}),
                           (("--law", "power", "--window", "3,1"), {"law": "power", "window": (3, 1)})):
        said, code = (sentence if "--x" in words else sentence_of_option)("fit", path, *words)
        with pytest.raises(ValueError) as raised:
            twincell.fit(path, **options)
        assert str(raised.value) == said and raised.value.exit_code == code
    with pytest.raises(OSError, match="3 values"):
        twincell.fit({"x": [1, 2], "y": [1, 2, 3]}, "power")


def test_sweep_is_the_verb_to_the_bit(scene_file, tmp_path):
    plan = tmp_path / "plan.toml"
    plan.write_text(f'scene = "{scene_file}"\n[axes]\ndrive.gamma = [1.2, 1.8]\n')
    done = program("sweep", "run", plan, "--folder", tmp_path / "verb", "-q")
    assert done.returncode == 0, done.stderr
    verb = document("sweep", "collect", plan, "--folder", tmp_path / "verb", "-o", tmp_path / "verb.json")
    seen = []
    mine = twincell.sweep(plan, tmp_path / "mine", callback=lambda done, known: seen.append((done, known)))
    assert mine == verb and len(mine["points"]) == 2 and mine["open"] == 0
    assert twincell.sweep(plan, tmp_path / "mine") == verb  # nothing is computed again
    with pytest.raises(OSError):
        twincell.sweep(tmp_path / "no.toml")

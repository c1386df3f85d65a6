"""Studies with [[vary]]: one deck over values of keys and seeds, means and spreads, mistakes with their lines."""

import csv
import os
from pathlib import Path

import pytest

from splitgrain_postpro.cli import main

STUDY = Path(__file__).parents[2] / "input_decks/studies/friction_of_blocks.toml"
pytestmark = pytest.mark.skipif("SPLITGRAIN_PROGRAM" not in os.environ, reason="no SPLITGRAIN_PROGRAM")


def rows_of(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def test_blocks_against_closed_forms(tmp_path, capsys):
    assert main(["study", str(STUDY), "--output", str(tmp_path / "study"), "--jobs", "2"]) == 0
    rows = rows_of(tmp_path / "study/results.csv")
    assert len(rows) == 8
    for row in rows:
        friction, speed = float(row["law[1].friction"]), float(row["body[1].velocity"].strip("[]").split(",")[0])
        # 50 kg per metre of depth, braked by mu g for 0.2 s.
        assert float(row["kinetic_energy"]) == pytest.approx(25 * (speed - friction * 9.81 * 0.2) ** 2, rel=1e-6)
    page = (tmp_path / "study/study.html").read_text()
    assert page.count("<svg") == 3 and page.count("data-series=") == 2 and "http-equiv" not in page and "src=" not in page
    assert all(f'id="figure2-series{k}"' in page for k in (0, 1))
    assert "8 runs, 3 figures" in capsys.readouterr().out
    assert main(["study", str(STUDY), "--output", str(tmp_path / "study")]) == 0
    assert capsys.readouterr().out.count("done before") == 8


def test_seeds_give_mean_and_spread(tmp_path):
    (tmp_path / "deck.toml").write_text("""[time]
step = 1e-3
steps = 3
[output]
record_every = 1
[[material]]
name = "stone"
density = 1000.0
[[law]]
friction = 0.3
[[sample]]
shape = "disk"
box = [0.0, 0.0, 1.0, 1.0]
radius = [0.02, 0.05]
count = 20
""")
    (tmp_path / "study.toml").write_text("""deck = "deck.toml"
plot = ["compactness"]
seeds = [1, 2, 3]
[[vary]]
key = "sample.count"
values = [10, 20]
""")
    assert main(["study", str(tmp_path / "study.toml"), "--output", str(tmp_path / "out")]) == 0
    runs = [float(row["compactness"]) for row in rows_of(tmp_path / "out/results.csv")]
    found = rows_of(tmp_path / "out/statistics.csv")
    assert [row["runs"] for row in found] == ["3", "3"] and len(runs) == 6
    assert float(found[0]["mean of compactness"]) == pytest.approx(sum(runs[:3]) / 3) and float(found[0]["spread of compactness"]) > 0


@pytest.mark.parametrize("old, new, line, sentence", [
    ('plot = ["kinetic_energy", "friction_loss", "sweeps"]', 'plot = ["kinetic"]', 5, "no column 'kinetic'"),
    ('key = "law[1].friction"', 'key = "law[1].fiction"', 0, "fiction"),
    ("values = [0.1, 0.2, 0.3, 0.4]", "value = 0.1", 10, "unknown key 'value'"),
    ('deck = "../sliding_block.toml"', 'deck = "nowhere.toml"', 4, "no deck"),
])
def test_mistakes_have_their_lines(tmp_path, capsys, old, new, line, sentence):
    text = STUDY.read_text().replace(old, new).replace('"../', f'"{STUDY.parents[1]}/').replace("values = [[1.0, 0.0], [2.0, 0.0]]", "values = [[1.0, 0.0]]")
    (tmp_path / "study.toml").write_text(text)
    assert main(["study", str(tmp_path / "study.toml"), "--output", str(tmp_path / "out")]) == 2
    printed = capsys.readouterr().err
    assert sentence in printed and (not line or f"study.toml:{line}:" in printed), printed

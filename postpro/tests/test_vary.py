"""Studies with [[vary]]: one deck over values of keys and seeds, means and spreads, mistakes with their lines."""

import csv
import json
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
    assert page.count("<svg") == 3 and page.count("checked data-series=") == 2 and "http-equiv" not in page and "src=" not in page
    assert all(f'id="figure2-series{k}"' in page for k in (0, 1))
    assert "8 runs, 3 figures" in capsys.readouterr().out
    (tmp_path / "no study").mkdir()
    assert main(["study", str(tmp_path)]) == 0 and "1 study" in capsys.readouterr().out
    index = (tmp_path / "index.html").read_text()
    assert '<a href="study/study.html">' in index and "8 runs of" in index and index.count("<li>") == 1
    assert main(["study", str(tmp_path / "no study")]) == 2 and "there is no study in this folder" in capsys.readouterr().err
    assert main(["study", str(STUDY), "--output", str(tmp_path / "study")]) == 0
    assert capsys.readouterr().out.count("done before") == 8


def test_parts_share_the_runs(tmp_path, capsys):
    """Tasks of a job array do all runs, each of them once; the study then has no run left."""
    command = ["study", str(STUDY), "--output", str(tmp_path / "study")]
    for part in ("1/3", "2/3", "3/3"):
        assert main([*command, "--part", part]) == 0
        printed = capsys.readouterr().out
        assert "done before" not in printed and f"part {part[0]} of 3" in printed
        assert not (tmp_path / "study/study.html").exists()
    assert main(command) == 0
    assert capsys.readouterr().out.count("done before") == 8
    for part in ("0/3", "4/3", "2", "a/b"):
        assert main([*command, "--part", part]) == 2
        assert "--part needs" in capsys.readouterr().err


def test_columns_of_regions_tracks_and_stages(tmp_path, capsys):
    """A block that falls through a region in two stages: places by the throw, from the checkpoint of a first run."""
    deck = """[constants]
g = 9.81
[scene]
gravity = [0.0, "{-g}"]
[time]
step = 1e-3
[output]
record_every = 10
[[stage]]
name = "up"
steps = 100
[[stage]]
name = "down"
steps = 100
[[track]]
body = "ball"
[[region]]
name = "all"
box = [-1.0, -9.0, 1.0, 9.0]
[[material]]
name = "stone"
density = 1000.0
[[law]]
friction = 0.3
[[body]]
name = "ball"
shape = "disk"
radius = 0.1
"""
    (tmp_path / "deck.toml").write_text(deck)
    study = """deck = "deck.toml"
plot = ["y(ball) after up", "y(ball)", "mean_velocity(all) after up", "time after up"]
[[vary]]
key = "constants.g"
values = [5.0, 10.0]
"""
    (tmp_path / "study.toml").write_text(study)
    done = main(["study", str(tmp_path / "study.toml"), "--output", str(tmp_path / "out")])
    if done == 2 and "HDF5" in capsys.readouterr().err:
        pytest.skip("stages need HDF5")
    assert done == 0
    for row in rows_of(tmp_path / "out/results.csv"):
        g = float(row["constants.g"])
        assert float(row["time after up"]) == pytest.approx(0.1)
        assert float(row["y(ball) after up"]) == pytest.approx(-g * 0.1**2 / 2, rel=1e-9)
        assert float(row["y(ball)"]) == pytest.approx(-g * 0.2**2 / 2, rel=1e-9)
        assert float(row["mean_velocity(all) after up"]) == pytest.approx(g * 0.1, rel=1e-9)
    start = tmp_path / "start"
    assert main(["study", str(tmp_path / "study.toml"), "--output", str(start)]) == 0
    checkpoint = next(place for place in (start / "runs").iterdir() if place.is_dir())
    (tmp_path / "study.toml").write_text(f'restart = "start/runs/{checkpoint.name}"\nset = {{ "stage[2].steps" = 150 }}\n' + study.replace(" after up", ""))
    assert main(["study", str(tmp_path / "study.toml"), "--output", str(tmp_path / "on")]) == 0
    old = json.loads((start / "runs" / f"{checkpoint.name}.json").read_text())["constants.g"]
    for row in rows_of(tmp_path / "on/results.csv"):
        fall = -old * 0.2**2 / 2 - old * 0.2 * 0.05 - float(row["constants.g"]) * 0.05**2 / 2
        assert float(row["y(ball)"]) == pytest.approx(fall, rel=1e-9)
    for old, new, sentence in (("y(ball) after up", "y(bell)", "no region and no track 'bell'"),
                               ("y(ball) after up", "w(ball)", "has no column 'w'"),
                               ("y(ball) after up", "y(ball) after left", "no stage 'left'")):
        (tmp_path / "study.toml").write_text(study.replace(old, new))
        capsys.readouterr()
        assert main(["study", str(tmp_path / "study.toml"), "--output", str(tmp_path / "out")]) == 2
        assert sentence in capsys.readouterr().err


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

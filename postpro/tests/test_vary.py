"""Studies with [[vary]]: one deck over values of keys and seeds, means and spreads, mistakes with their lines."""

import csv
import json
import os
from pathlib import Path

import numpy as np
import pytest

import splitgrain as sg
from splitgrain_postpro import Results
from splitgrain_postpro.cli import main

STUDY = Path(__file__).parents[2] / "input_decks/studies/friction_of_blocks.toml"
pytestmark = pytest.mark.skipif("SPLITGRAIN_PROGRAM" not in os.environ, reason="no SPLITGRAIN_PROGRAM")


@pytest.fixture
def without_figures(monkeypatch):
    """Leaves out rendering: figures of these studies are checked in other tests."""
    monkeypatch.setattr("splitgrain_postpro.study.vary_figures.embedded", lambda *_: "")


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
    assert page.count("<svg") == 4 and page.count("checked data-series=") == 2 + 8 and "http-equiv" not in page and "src=" not in page
    assert all(f'id="figure2-series{k}"' in page for k in (0, 1)) and all(f'id="figure3-series{k}"' in page for k in range(2, 10))
    assert "8 runs, 4 figures" in capsys.readouterr().out
    (tmp_path / "no study").mkdir()
    assert main(["study", str(tmp_path)]) == 0 and "1 study" in capsys.readouterr().out
    index = (tmp_path / "index.html").read_text()
    assert '<a href="study/study.html">' in index and "8 runs of" in index and index.count("<li>") == 1
    assert main(["study", str(tmp_path / "no study")]) == 2 and "there is no study in this folder" in capsys.readouterr().err
    assert main(["study", str(STUDY), "--output", str(tmp_path / "study")]) == 0
    assert capsys.readouterr().out.count("done before") == 8


def test_parts_share_the_runs(tmp_path, capsys, without_figures):
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


def test_columns_of_regions_tracks_and_stages(tmp_path, capsys, without_figures):
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
    for old, new, sentence in (("y(ball) after up", "y(bell)", "no region, track or wall is called 'bell'"),
                               ("y(ball) after up", "w(ball)", "has no column 'w'"),
                               ("y(ball) after up", "y(ball) after left", "no stage 'left'")):
        (tmp_path / "study.toml").write_text(study.replace(old, new))
        capsys.readouterr()
        assert main(["study", str(tmp_path / "study.toml"), "--output", str(tmp_path / "out")]) == 2
        assert sentence in capsys.readouterr().err


def test_seeds_give_mean_and_spread(tmp_path, without_figures):
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
    ("values = [0.1, 0.2, 0.3, 0.4]", "value = 0.1", 11, "unknown key 'value'"),
    ('deck = "../sliding_block.toml"', 'deck = "nowhere.toml"', 4, "no deck"),
])
def test_mistakes_have_their_lines(tmp_path, capsys, old, new, line, sentence):
    text = STUDY.read_text().replace(old, new).replace('"../', f'"{STUDY.parents[1]}/').replace("values = [[1.0, 0.0], [2.0, 0.0]]", "values = [[1.0, 0.0]]")
    (tmp_path / "study.toml").write_text(text)
    assert main(["study", str(tmp_path / "study.toml"), "--output", str(tmp_path / "out")]) == 2
    printed = capsys.readouterr().err
    assert sentence in printed and (not line or f"study.toml:{line}:" in printed), printed


GRAINS = """[time]
step = 1e-3
steps = 60
[output]
record_every = 5
[scene]
gravity = [0.0, -9.81]
[[material]]
name = "stone"
density = 1000.0
[[law]]
friction = 0.3
[[wall]]
name = "floor"
from = [-1.0, -0.01]
to = [2.0, -0.01]
thickness = 0.02
[[region]]
name = "all"
box = [-1.0, -1.0, 2.0, 2.0]
[[track]]
body = "lid"
[[body]]
name = "lid"
shape = "disk"
radius = 0.1
position = [0.5, 1.5]
[[sample]]
kind = "random"
box = [0.0, 0.0, 1.0, 1.0]
radius = [0.03, 0.05]
fill = 0.3
"""


def test_any_column_is_plotted_with_mean_and_spread_over_seeds(tmp_path, unarranged):
    """Every column of every table of a run may be plotted; the numbers of the files are those of the runs."""
    deck = sg.Deck(write(tmp_path / "deck.toml", GRAINS))
    columns = ["compactness", "wall_seconds", "pressure(all)", "y(lid)", "force_y(floor)"]
    curves = ["kinetic_energy", "force_y(floor)", "potential_energy against y(lid)"]
    write(tmp_path / "study.toml", f"""deck = "deck.toml"
plot = {json.dumps([*columns, "largest of kinetic_energy", "mean of sweeps", "least of potential_energy"])}
curves = {json.dumps(curves)}
seeds = [1, 2, 3]
[[vary]]
key = "law[1].friction"
values = [0.1, 0.5]
""")
    assert main(["study", str(tmp_path / "study.toml"), "--output", str(tmp_path / "out"), "--jobs", "2"]) == 0
    page = (tmp_path / "out/study.html").read_text()
    assert page.count("<svg") == len(columns) + 6 and "means over 3 seeds" in page and page.count("checked data-series=") == 2
    runs = {}
    for path in (tmp_path / "out/runs").glob("*.json"):
        values = json.loads(path.read_text())
        runs[values["law[1].friction"], values["seed"]] = Results(path.with_suffix("")).record
    for row in rows_of(tmp_path / "out/results.csv"):
        record = runs[float(row["law[1].friction"]), int(row["seed"])]
        assert all(float(row[name]) == record[name][-1] for name in columns if "(" not in name)
        assert float(row["largest of kinetic_energy"]) == record["kinetic_energy"].max()
        assert float(row["mean of sweeps"]) == pytest.approx(record["sweeps"].mean())
        assert float(row["least of potential_energy"]) == record["potential_energy"].min()
    # A grid of 200 times over 12 rows of equal steps: its ends are rows.
    rows = [row for row in rows_of(tmp_path / "out/curves.csv") if row["column"] == "kinetic_energy" and row["law[1].friction"] == "0.5"]
    ends = np.array([runs[0.5, seed]["kinetic_energy"][[0, -1]] for seed in (1, 2, 3)])
    assert len(rows) == 200 and [float(rows[k]["x"]) for k in (0, -1)] == pytest.approx([0.005, 0.06])
    assert [float(rows[k]["mean"]) for k in (0, -1)] == pytest.approx(ends.mean(axis=0), rel=1e-9)
    assert [float(rows[k]["spread"]) for k in (0, -1)] == pytest.approx(ends.std(axis=0, ddof=1), rel=1e-9) and ends.std() > 0
    assert {row["against"] for row in rows_of(tmp_path / "out/curves.csv")} == {"time", "y(lid)"}
    sweep = sg.sweep(deck, {"law[1].friction": [0.1, 0.5], "seed": [1, 2, 3]}, output=tmp_path / "out/runs", ranks=1)
    assert len(list((tmp_path / "out/runs").glob("*.json"))) == 6
    results = [run.results for run in sweep.runs]
    for tables in (lambda one: {"": one.record}, lambda one: one.tracks, lambda one: one.regions, lambda one: one.walls):
        for owner, table in tables(results[0]).items():
            assert len(table) > 8
            for name in table:
                found = sweep.last(f"{name}({owner})" if owner else name)
                assert np.array_equal(found, [tables(one)[owner][name][-1] for one in results], equal_nan=True), (owner, name)


@pytest.mark.parametrize("curves, sentence", [
    ('["speed"]', "the record has no column 'speed'"), ('["sweeps against tme"]', "the record has no column 'tme'"),
    ('["y(led)"]', "no region, track or wall is called 'led'"), ("[1]", "'curves' should be a list of columns of the record"),
])
def test_mistakes_of_curves_have_their_lines(tmp_path, capsys, curves, sentence):
    write(tmp_path / "deck.toml", GRAINS)
    write(tmp_path / "study.toml", f'deck = "deck.toml"\ncurves = {curves}\n[[vary]]\nkey = "law[1].friction"\nvalues = [0.1]\n')
    assert main(["study", str(tmp_path / "study.toml"), "--output", str(tmp_path / "out")]) == 2
    printed = capsys.readouterr().err
    assert sentence in printed and "study.toml:2:" in printed, printed


def write(path, text):
    path.write_text(text)
    return path

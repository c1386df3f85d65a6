"""The package `splitgrain`: decks that are changed and run, errors, records, motions of bodies, sweeps that go on."""

import os
import shutil
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest

import splitgrain as sg
from splitgrain_postpro.errors import ResultsError

DECKS = Path(__file__).parents[2] / "input_decks"
BLOCK = DECKS / "sliding_block.toml"
needs_program = pytest.mark.skipif("SPLITGRAIN_PROGRAM" not in os.environ, reason="no SPLITGRAIN_PROGRAM")


def stopped_at(run):
    """How far the block slid [m]."""
    return run.results.tracks["block"]["displacement"][-1]


@pytest.fixture
def deck():
    deck = sg.Deck(BLOCK)
    deck["track"] = [{"body": "block"}]
    deck["output"] = {"record_every": 100, "every": 350}
    return deck


@pytest.mark.parametrize("path", sorted(DECKS.glob("*.toml")), ids=lambda path: path.stem)
def test_decks_are_written_as_they_were_read(path):
    deck = sg.Deck(path)
    assert tomllib.loads(deck.toml()) == dict(deck) == tomllib.loads(path.read_text())
    assert deck.settings() == {}


def test_changed_values_are_settings():
    deck = sg.Deck(BLOCK)
    deck["law"][0]["friction"] = np.float64(0.4)
    deck["time"]["steps"] = 10
    deck["body"][0]["position"] = [0.5, 0.05]
    deck["output"] = {"every": 5}
    assert deck.settings() == {"law[1].friction": 0.4, "time.steps": 10, "body[1].position": [0.5, 0.05], "output.every": 5}
    assert sg.Deck(BLOCK)["law"][0]["friction"] == 0.2
    copy = deck.copy()
    del copy["law"][0]["friction"]
    assert copy.settings() is None and deck["law"][0]["friction"] == 0.4
    deck["wall"].append({"from": [0.0, 1.0], "to": [1.0, 1.0]})
    assert deck.settings() is None and tomllib.loads(deck.toml())["wall"][1]["to"] == [1.0, 1.0]


@needs_program
def test_run_gives_its_record_and_motions(deck, tmp_path):
    lines = []
    run = deck.run(tmp_path / "run", set={"law[1].friction": 0.25}, progress=lines.append)
    record = run.record
    assert list(record["time"])[-1] == pytest.approx(0.7) and run.summary["status"] == "done"
    assert any("done: 700 of 700 steps" in line for line in lines)
    # v^2 / (2 mu g)
    assert stopped_at(run) == pytest.approx(1 / (2 * 0.25 * 9.81), rel=2e-3)
    assert run.names() == {1: "block", 2: "floor"}
    moved = run.transformations()[1]
    assert run.transformations()["block"] is not None and "block" in run.transformations().names.values()
    with pytest.raises(KeyError):
        run.transformations()["stone"]
    assert moved[:3, :3] == pytest.approx(np.eye(3), abs=1e-9) and moved[0, 3] == pytest.approx(stopped_at(run), rel=1e-9)
    faces = run.contacts()
    assert set(faces["candidate"]) | set(faces["antagonist"]) == {1, 2} and faces["force_normal"].sum() == pytest.approx(50 * 9.81, rel=1e-6)


@needs_program
def test_turned_body_comes_back_by_its_matrix(tmp_path):
    deck = sg.Deck({"scene": {"dimension": 3, "gravity": [0.0, 0.0, 0.0]}, "time": {"step": 0.01, "steps": 50}, "output": {"every": 50},
                    "material": [{"name": "stone", "density": 1000.0}], "law": [{"friction": 0.0}],
                    "body": [{"name": "cube", "spin": [0.0, 0.0, 1.0], "velocity": [1.0, 0.0, 0.0], "material": "stone",
                              **sg.polyhedron(np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)]))}]})
    run = deck.run(tmp_path / "cube")
    matrix = run.transformations()[1]
    assert matrix[:2, :2] == pytest.approx(np.array([[np.cos(0.5), -np.sin(0.5)], [np.sin(0.5), np.cos(0.5)]]), abs=1e-4)
    first, last = (run.results.scene(k).shapes.points for k in (0, -1))
    assert first @ matrix[:3, :3].T + matrix[:3, 3] == pytest.approx(last, abs=1e-9)


@needs_program
def test_interfaces_have_resultants(tmp_path):
    deck = sg.Deck(BLOCK)
    deck["interface"] = [{}]
    run = deck.run(tmp_path / "run", set={"output.record_every": 100})
    last, first = run.interfaces(), run.interfaces(350)
    assert list(last["first"]) == ["block"] and int(last["step"][0]) == 700 and int(first["step"][0]) == 300
    # At rest its weight of 50 kg on the floor, without friction.
    assert float(last["normal_force"][0]) == pytest.approx(50 * 9.81, rel=1e-6)
    assert abs(float(first["tangential_force"][0])) == pytest.approx(0.2 * 50 * 9.81, rel=1e-6)
    with pytest.raises(ResultsError, match="at or before step 50"):
        run.interfaces(50)


@needs_program
@pytest.mark.parametrize("deck", ["arch", "masonry/dome"])
def test_pictures_have_the_interfaces_of_the_table(tmp_path, deck):
    """In the plane and in space, from one rank or two, straight or from a checkpoint; without a record the pictures are the table."""
    whole = sg.Deck(DECKS / f"{deck}.toml")
    whole["interface"] = [{}]
    settings = {"time.steps": 40, "output.every": 20, "output.record_every": 20, "restart.every": 25, "restart.at_end": False,
                "partition.parts": 2}
    runs = [whole.run(tmp_path / f"ranks{ranks}", ranks=ranks, set=settings) for ranks in (1, 2)]
    runs.append(whole.run(tmp_path / "ranks1", set=settings, restart=tmp_path / "ranks1"))
    table = runs[0].results.interfaces(20)
    assert len(table["first"]) > 20 and any(not str(name).isdecimal() for name in table["first"])
    for run in runs[1:]:
        assert run.results.interface_pictures.field("step").tolist() == [0, 20, 40]
        assert run.results.interface_pictures.field("ninterfaces").tolist()[0] == 0
        csv = run.folder / "interfaces.csv"
        tables = [run.results.interfaces(step) for step in (20, 40)]
        csv.rename(csv.with_suffix(".kept"))
        pictured = sg.Run(run.folder)
        for step, rows in zip((20, 40), tables, strict=True):
            drawn = pictured.results.interfaces(step)
            assert list(drawn) == list(rows)
            for name, values in rows.items():
                assert drawn[name].tolist() == values.tolist(), name


@needs_program
def test_changed_decks_are_in_no_list_of_decks_while_they_run(tmp_path):
    folder = tmp_path / "decks"
    folder.mkdir()
    shutil.copy(BLOCK, folder)
    deck, lists = sg.Deck(folder / BLOCK.name), []
    deck["interface"] = [{}]
    assert deck.settings() is None
    deck.run(tmp_path / "run", set={"time.steps": 2}, progress=lambda line: lists.append({path.name for path in folder.iterdir()}))
    assert any(len(names) == 2 for names in lists) and not any(name.endswith(".toml") for name in set().union(*lists) - {BLOCK.name})
    assert [path.name for path in folder.iterdir()] == [BLOCK.name]


@needs_program
def test_errors_have_file_line_and_caret(tmp_path):
    (tmp_path / "wrong.toml").write_text(BLOCK.read_text().replace("friction = 0.2", "fiction = 0.2"))
    with pytest.raises(sg.DeckError) as caught:
        sg.Deck(tmp_path / "wrong.toml").run(tmp_path / "run")
    assert caught.value.line == 15 and caught.value.column == 1 and caught.value.file.endswith("wrong.toml")
    assert "friction" in caught.value.sentence and "^" in str(caught.value) and caught.value.code == 2
    (tmp_path / "broken.toml").write_text("[time\n")
    with pytest.raises(sg.DeckError, match=r"broken.toml:1"):
        sg.Deck(tmp_path / "broken.toml")
    deck = sg.Deck(BLOCK)
    with pytest.raises(sg.DeckError, match="friction"):
        deck.run(tmp_path / "run", set={"law[1].friction": -1.0})
    with pytest.raises(sg.Stopped) as caught:
        deck.run(tmp_path / "stopped", walltime=1e-6)
    assert caught.value.code == 75
    assert "1 grain" in deck.check()


@needs_program
def test_sweep_goes_on_and_has_means_and_spreads(deck, tmp_path):
    values = {"law[1].friction": [0.2, 0.4], "body[1].velocity": [[1.0, 0.0], [1.2, 0.0]]}
    first = sg.sweep(deck, {**values, "law[1].friction": [0.2]}, output=tmp_path / "sweep", jobs=2)
    assert len(first) == 2
    lines = []
    sweep = sg.sweep(deck, values, output=tmp_path / "sweep", progress=lines.append)
    assert [line.rpartition(": ")[2] for line in lines] == ["done before", "done before", "done", "done"]
    rows = sweep.statistics(stopped_at, over="body[1].velocity")
    ways = np.array([[v**2 / (2 * mu * 9.81) for v in (1.0, 1.2)] for mu in (0.2, 0.4)])
    assert [row["law[1].friction"] for row in rows] == [0.2, 0.4] and [row["runs"] for row in rows] == [2, 2]
    assert [row["mean"] for row in rows] == pytest.approx(ways.mean(axis=1), rel=5e-3)
    assert [row["spread"] for row in rows] == pytest.approx(ways.std(axis=1, ddof=1), rel=2e-2)
    assert len(sweep.table("kinetic_energy")) == 4
    with pytest.raises(sg.DeckError, match="friction") as caught:
        sg.sweep(deck, {"law[1].friction": [0.3, -1.0]}, output=tmp_path / "sweep")
    assert "-1.0" in caught.value.__notes__[0] and len(list((tmp_path / "sweep").glob("*.json"))) == 5


@needs_program
def test_examples(tmp_path):
    pytest.importorskip("scipy")
    sys.path.insert(0, str(Path(__file__).parents[1] / "examples"))
    import calibrate_friction

    assert calibrate_friction.calibrate(0.2, tmp_path) == pytest.approx(1 / (2 * 9.81 * 0.2), rel=5e-3)


@needs_program
def test_pictures_name_planes_and_bricks(tmp_path):
    ball = {"shape": "sphere", "radius": 0.05, "material": "stone"}
    deck = sg.Deck({"scene": {"dimension": 3}, "time": {"step": 1e-3, "steps": 2}, "output": {"every": 1},
                    "material": [{"name": "stone", "density": 2000.0}], "law": [{"friction": 0.6}],
                    "container": [{"name": "box", "size": [2.0, 1.0, 1.0]}],
                    "brick_wall": [{"position": [0.3, 0.5, 0.0], "brick": [0.2, 0.1, 0.1], "columns": 2, "rows": 2}],
                    "body": [{**ball, "position": [1.5, 0.5, 0.05]}, {**ball, "name": "two words", "position": [1.7, 0.5, 0.05]}]})
    run = deck.run(tmp_path / "run")
    names = run.names()
    assert names[2] == "two words" and 1 not in names and "box.floor" in names.values() and len(names) == 1 + 5 + 5
    assert [run.results.number_of_body(name) for name in names.values()] == list(names)
    assert run.transformations()["box.floor"] == pytest.approx(np.eye(4))

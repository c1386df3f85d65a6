"""The page of a run: its meshes and places are those of the pictures, its record is whole, and it asks for nothing outside."""

import base64
import hashlib
import json
import os
import re
from pathlib import Path

import numpy as np
import pytest
from sample_space import write_space_results

import splitgrain as sg
from splitgrain_postpro import Results, ResultsError
from splitgrain_postpro.cli import main
from splitgrain_postpro.viewer import LIBRARY, page_data

TOP = Path(__file__).parents[2]
# Name of a language, not an address.
XHTML = "http://www.w3.org/1999/xhtml"
needs_program = pytest.mark.skipif("SPLITGRAIN_PROGRAM" not in os.environ, reason="no SPLITGRAIN_PROGRAM")


def unpacked(text, *shape):
    return np.frombuffer(base64.b64decode(text), dtype="<f4").reshape(shape).astype(float)


@pytest.fixture
def folder(tmp_path):
    return write_space_results(tmp_path / "a <run>", held=True)


def test_meshes_and_places_give_the_pictures(folder):
    results = Results(folder)
    data = page_data(results)
    n = len(data["grains"])
    assert (n, data["times"], data["in_space"], sum(data["grains"])) == (10, [0.0, 0.1], True, 4)
    places = unpacked(data["places"], 2, n, 3)
    bodies = results.scene(0).bodies
    assert np.diff(places[0], axis=0) == pytest.approx(np.diff(bodies.points, axis=0), abs=1e-6)
    assert unpacked(data["turns"], 2, n, 4)[:, :, 0] == pytest.approx(1)
    # Two cubes of twelve triangles, one of them held above all else, and a capsule; planes are lines.
    of = np.array(data["triangle_bodies"])
    triangles = unpacked(data["triangles"], -1, 3, 3)
    assert np.count_nonzero(of == 2) == 12 and np.count_nonzero(of == 9) == 12 and len(of) == 24 + 12 + 24 + 12
    assert np.abs(triangles[of == 9]) == pytest.approx(0.5)
    assert data["spheres"] == [[0, 0, 0, 0.5, 0], [0, 0, 0, 0.5, 1]]
    assert len(unpacked(data["lines"], -1, 3)) == 5 * 6 * 4 * 2
    assert data["radius"] > 2.75 and unpacked(data["quantities"]["speed"], 2, n)[0, :4] == pytest.approx([1, 2, 3, 4])


def test_page_is_one_file_that_asks_for_nothing(folder, capsys):
    assert main(["page", str(folder)]) == 0
    page = (folder / "page.html").read_text()
    assert "2 pictures of 10 bodies" in capsys.readouterr().out
    # The library is there once, whole; addresses in it are names of XML only, never asked for: tests/pages looks at that in a browser.
    library = LIBRARY.read_text("utf-8")
    assert page.count(library) == 1 and "</script" not in library and set(re.findall(r"https?://[^\"]*", library)) <= {XHTML}
    page = page.replace(library, "")
    assert "http" not in page and "src=" not in page and "a &lt;run&gt;" in page and "<run>" not in page
    data = json.loads(re.search(r'<script id="data" type="application/json">(.*?)</script>', page, re.DOTALL)[1])
    record = Results(folder).record
    assert data["record"]["kinetic_energy"] == pytest.approx(record["kinetic_energy"], rel=1e-5) and len(data["times"]) == 2
    assert page.count("TITLE") == 0 and page.count("LIBRARY") == 0


def test_library_is_the_one_described_with_its_licence():
    described = (LIBRARY.parent / "README.md").read_text("utf-8")
    assert hashlib.sha256(LIBRARY.read_bytes()).hexdigest() in described
    version = re.search(r"npm install three@([\d.]+) ", described)[1]
    library = LIBRARY.read_text("utf-8")
    assert library.startswith(f"/*! three.js {version}\nThe MIT License\n") and (LIBRARY.parent / "three.LICENSE").read_text("utf-8") in library


def test_pictures_are_thinned_and_needed(folder, tmp_path):
    assert page_data(Results(folder), 1)["times"] == [0.0]
    (tmp_path / "none").mkdir()
    (tmp_path / "none/record.csv").write_text("step,time\n")
    with pytest.raises(ResultsError, match="output.every"):
        page_data(Results(tmp_path / "none"))


def run(deck, folder, **settings):
    """Results of a deck of this source, shortened."""
    settings = {"time.steps": 200, "output.every": 50, **settings}
    return sg.Deck(TOP / deck).run(folder, set=settings, ranks=1).results


@needs_program
@pytest.mark.parametrize(("deck", "steps"), [("simple_shear", 800), ("triaxial", 200)])
def test_a_cell_is_drawn_with_the_images_whose_centres_lie_within_it(tmp_path, deck, steps):
    results = run(f"input_decks/cell/{deck}.toml", tmp_path / "run", **{"time.steps": steps, "output.every": steps // 2})
    data = page_data(results)
    d, m, n = 3 if data["in_space"] else 2, len(data["times"]), len(data["grains"])
    box = data["box"]
    edges, inverses = (unpacked(box[name], m, 3, 3) for name in ("edges", "inverses"))
    assert box["periodic"] == [1, 1, d - 2]
    record = results.record
    assert [edges[-1, k, k] for k in range(d)] == pytest.approx([record[name][-1] for name in ("cell_x", "cell_y", "cell_z")[:d]], rel=1e-6)
    # The tilt is the shear strain times the height.
    tilt = record["strain_xy"][-1] * edges[-1, 1, 1] if d == 2 else 0.0
    assert edges[-1, 1, 0] == pytest.approx(tilt, abs=1e-6) and (d == 3 or tilt > 0.01)
    places = unpacked(data["places"], m, n, 3) - box["corner"]
    shares = (places @ inverses)[..., :d]
    assert shares.min() > -1e-5 and shares.max() < 1 + 1e-5
    # Images differ from the bodies of the pictures by whole edges.
    moves = np.array([(results.bodies.step(k).points - places[k]) @ inverses[k] for k in range(m)])[..., :d]
    assert moves == pytest.approx(np.round(moves), abs=1e-4)


@needs_program
def test_absent_bodies_are_marked_and_do_not_widen_the_view(tmp_path):
    results = run("tests/pages/entering.toml", tmp_path / "run")
    data = page_data(results)
    m, n = len(data["times"]), len(data["grains"])
    present = np.array(data["present"], dtype=bool)
    assert present.shape == (m, n) and n == 62
    assert [len(results.scene(k).bodies.points) for k in range(m)] == present.sum(axis=1).tolist()
    # No grain is there at the start, the gate is gone at the end, and all that entered count as grains.
    gate = next(number for number, name in results.body_names.items() if name == "gate") - 1
    assert present[0].sum() == 2 and present[0, gate] and not present[-1, gate]
    assert sum(data["grains"]) == results.record["entered"][-1] and 0 < results.record["removed"][-1] < results.record["entered"][-1]
    places = unpacked(data["places"], m, n, 3)
    grains = present & (np.array(data["grains"]) > 0)
    assert np.all(np.abs(places[grains][:, :2]) < data["half"])
    assert data["half"][1] < 0.4


def test_lines_of_walls_go_with_their_bodies(folder):
    data = page_data(Results(folder))
    lines, of = unpacked(data["lines"], -1, 2, 3), np.array(data["line_bodies"])
    assert len(lines) == len(of) and set(of) == {4, 5, 6, 7, 8}
    assert np.abs(lines[of == 4]).reshape(-1, 3) == pytest.approx(np.tile([1.7, 1.2, 0.1], (2 * np.sum(of == 4), 1)))

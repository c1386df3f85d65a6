"""The page of a run: its meshes and places are those of the pictures, its record is whole, and it asks for nothing outside."""

import base64
import json
import re

import numpy as np
import pytest
from sample_space import write_space_results

from splitgrain_postpro import Results, ResultsError
from splitgrain_postpro.cli import main
from splitgrain_postpro.viewer import page_data


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
    assert "http" not in page and "src=" not in page and "a &lt;run&gt;" in page and "<run>" not in page
    data = json.loads(re.search(r'<script id="data" type="application/json">(.*?)</script>', page, re.DOTALL)[1])
    record = Results(folder).record
    assert data["record"]["kinetic_energy"] == pytest.approx(record["kinetic_energy"], rel=1e-5) and len(data["times"]) == 2
    assert page.count("TITLE") == 0


def test_pictures_are_thinned_and_needed(folder, tmp_path):
    assert page_data(Results(folder), 1)["times"] == [0.0]
    (tmp_path / "none").mkdir()
    (tmp_path / "none/record.csv").write_text("step,time\n")
    with pytest.raises(ResultsError, match="output.every"):
        page_data(Results(tmp_path / "none"))

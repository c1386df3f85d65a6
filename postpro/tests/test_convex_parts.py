"""Objects of OBJ files divided into convex parts."""

import numpy as np
import pytest

from splitgrain_postpro.cli import main
from splitgrain_postpro.convex_parts import convex_parts, is_convex, obj_text, read_obj

CORNERS = np.array([[x, y, z] for z in (0.0, 1.0) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))])
SIDES = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
# An L of three unit squares, one metre deep: two caps and six sides.
OUTLINE = np.array([[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]], dtype=float)
ANGLE = np.vstack([np.column_stack([OUTLINE, np.full(6, z)]) for z in (0.0, 1.0)])
ANGLE_SIDES = [[k, (k + 1) % 6, 6 + (k + 1) % 6, 6 + k] for k in range(6)] + [
    [0, 3, 2], [0, 2, 1], [0, 5, 4], [0, 4, 3], [6, 7, 8], [6, 8, 9], [6, 9, 10], [6, 10, 11]]


def test_convex_objects_stay_as_they_are(tmp_path, capsys):
    assert is_convex(CORNERS, SIDES) and not is_convex(ANGLE, ANGLE_SIDES)
    # Also with faces that run the other way round.
    assert is_convex(CORNERS, [side[::-1] for side in SIDES])
    assert convex_parts("cube", CORNERS, SIDES, 0.05) == [(CORNERS, SIDES)]
    (tmp_path / "two.obj").write_text(obj_text({"a": [(CORNERS, SIDES)], "b c": [(CORNERS + 3, SIDES)]}))
    assert main(["convex", str(tmp_path / "two.obj")]) == 0
    assert "2 objects, 0 of them divided" in capsys.readouterr().out
    written = read_obj(tmp_path / "two.convex.obj")
    assert list(written) == ["a", "b c"] and written["b c"][0] == pytest.approx(CORNERS + 3) and written["a"][1] == SIDES


def test_corners_may_be_counted_backwards_and_have_textures(tmp_path):
    (tmp_path / "x.obj").write_text("v 9 9 9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 2/1/1 3/2/1 4//1\nf -1 -2 -3\n")
    vertices, faces = read_obj(tmp_path / "x.obj")["x"]
    assert vertices.tolist() == [[0, 0, 0], [1, 0, 0], [0, 1, 0]] and faces == [[0, 1, 2], [2, 1, 0]]


@pytest.mark.parametrize(("text", "message"), [("v 0 0 0\n", "holds no faces"), ("v 0 0 0\nf 1 2 3\n", "not there"),
                                               ("v 0 a 0\n", "line 1")])
def test_files_that_are_none(tmp_path, capsys, text, message):
    (tmp_path / "x.obj").write_text(text)
    assert main(["convex", str(tmp_path / "x.obj")]) == 2 and message in capsys.readouterr().err
    assert main(["convex", str(tmp_path / "x.stl")]) == 2 and main(["convex", str(tmp_path / "y.obj")]) == 2


def test_without_the_library_it_is_one_sentence(tmp_path, capsys, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "coacd", None)
    (tmp_path / "l.obj").write_text(obj_text({"angle": [(ANGLE, ANGLE_SIDES)]}))
    assert main(["convex", str(tmp_path / "l.obj")]) == 2
    printed = capsys.readouterr().err
    assert '"angle" is not convex' in printed and "pip install coacd" in printed and printed.count("\n") == 1


def test_an_angle_is_two_parts_or_more(tmp_path):
    pytest.importorskip("coacd")
    (tmp_path / "l.obj").write_text(obj_text({"angle": [(ANGLE, ANGLE_SIDES)]}))
    assert main(["convex", str(tmp_path / "l.obj")]) == 0
    lines = (tmp_path / "l.convex.obj").read_text().splitlines()
    assert lines[0] == "o angle" and sum(line.startswith("g convex_") for line in lines) >= 2
    parts = convex_parts("angle", ANGLE, ANGLE_SIDES, 0.05)
    assert all(is_convex(*part) for part in parts)
    # The parts are the angle to some percent: three cubic metres.
    assert sum(volume(*part) for part in parts) == pytest.approx(3.0, rel=0.05)


def volume(vertices, faces):
    return sum(np.linalg.det(vertices[[face[0], face[k], face[k + 1]]]) for face in faces for k in range(1, len(face) - 1)) / 6

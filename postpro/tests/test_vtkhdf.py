"""The reader finds every step where the page on formats puts it."""

import h5py
import numpy as np
import pytest
from sample_results import write_results

from splitgrain_postpro import Results, ResultsError
from splitgrain_postpro.vtkhdf import VTK_EMPTY_CELL, VTK_LINE, VTK_POLYGON, Pictures


@pytest.fixture
def folder(tmp_path):
    return write_results(tmp_path / "run", columns=5, rows=3)


def test_points_move_and_topology_stays(folder):
    shapes = Pictures(folder / "shapes.vtkhdf")
    first, last = shapes.step(0), shapes.step(-1)
    assert len(shapes) == 3 and shapes.times.tolist() == pytest.approx([0, 0.1, 0.2])
    assert np.array_equal(first.connectivity, last.connectivity)
    # The packing falls by 0.2 m a picture; its floor does not.
    moved = first.points - last.points
    assert moved[0] == pytest.approx([0, 0.4, 0]) and moved[-1] == pytest.approx([0, 0, 0])
    assert len(last.cells(VTK_POLYGON)) == 16
    assert last.outlines([15])[0].shape == (4, 2)


def test_step_without_contacts_is_one_empty_cell(folder):
    contacts = Pictures(folder / "contacts.vtkhdf")
    empty, full = contacts.step(0), contacts.step(1)
    assert empty.types.tolist() == [VTK_EMPTY_CELL] and not len(empty.cells(VTK_LINE))
    assert len(full.cells(VTK_LINE)) == full.field_data["ncontacts"][0] == len(full.cell_data["force_normal"])
    assert contacts.field("step").tolist() == [0, 10, 20]
    assert contacts.field("nothing") is None


def test_contact_lines_join_touching_disks(folder):
    grid = Pictures(folder / "contacts.vtkhdf").step(2)
    lines = np.array(grid.outlines(grid.cells(VTK_LINE)))
    lengths = np.linalg.norm(lines[:, 1] - lines[:, 0], axis=1)
    # All disks have radius 0.5 and touch; rounding of sqrt(3)/2 only.
    assert lengths == pytest.approx(np.ones(len(lengths)), abs=1e-12)


def test_absent_bodies_are_left_out_of_scenes(folder):
    """The second body enters after the first picture, the floor is gone in the last: the rest stays as it was."""
    for file, group in (("bodies", "PointData"), ("shapes", "CellData")):
        with h5py.File(folder / f"{file}.vtkhdf", "r+") as whole:
            root = whole["VTKHDF"]
            rows = int(root["NumberOfPoints" if group == "PointData" else "NumberOfCells"][0])
            present = np.ones((3, rows), dtype=np.int32)
            present[0, 1] = 0
            present[2, -1] = 0
            root[group]["is_present"] = present.ravel()
            root["Steps"][f"{group}Offsets"]["is_present"] = rows * np.arange(3)
    results = Results(folder)
    for step, gone in ((0, 1), (1, None), (2, 15)):
        scene = results.scene(step)
        every = results.bodies.step(step)
        kept = [body for body in range(16) if body != gone]
        assert np.array_equal(scene.bodies.points, every.points[kept])
        assert scene.bodies.point_data["id"].tolist() == [body + 1 for body in kept]
        assert scene.shapes.cell_data["body"].tolist() == [body + 1 for body in kept]
        outlines = results.shapes.step(step).outlines(kept)
        assert all(np.array_equal(one, other) for one, other in zip(scene.shapes.outlines(range(len(kept))), outlines, strict=True))


def test_run_that_goes_on_may_lack_a_picture_in_one_file(folder):
    with h5py.File(folder / "contacts.vtkhdf", "r+") as file:
        file["VTKHDF/Steps"].attrs["NSteps"] = 2
    results = Results(folder)
    assert results.picture_times.tolist() == pytest.approx([0, 0.1])
    assert results.scene().time == pytest.approx(0.1)


@pytest.mark.parametrize("step, picture", [(0, 0), (9, 0), (10, 1), (1000, 2)])
def test_picture_of_step(folder, step, picture):
    assert Results(folder).picture_of_step(step) == picture


def test_no_picture_before_the_first(folder):
    with pytest.raises(ResultsError, match="no picture at or before step -1"):
        Results(folder).picture_of_step(-1)


@pytest.mark.parametrize("spoil, message", [
    (lambda path: path.write_bytes(b"no file of HDF5"), "cannot read"),
    (lambda path: path.write_bytes(path.read_bytes()[:3000]), "cannot read"),
    (lambda path: _delete(path, "VTKHDF"), "no group VTKHDF"),
    (lambda path: _delete(path, "VTKHDF/Steps"), "not a temporal grid"),
    (lambda path: _delete(path, "VTKHDF/Points"), "not a temporal grid"),
    (lambda path: _cut(path, "VTKHDF/Points", 7), "ends early"),
])  # fmt: skip
def test_spoilt_files_give_one_clear_error(folder, spoil, message):
    path = folder / "bodies.vtkhdf"
    spoil(path)
    with pytest.raises(ResultsError, match=message) as caught:
        Pictures(path).step(-1)
    assert "bodies.vtkhdf" in str(caught.value) and "\n" not in str(caught.value)


def _delete(path, name):
    with h5py.File(path, "r+") as file:
        del file[name]


def _cut(path, name, rows):
    with h5py.File(path, "r+") as file:
        file[name].resize(rows, axis=0)

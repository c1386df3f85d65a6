"""Read the pictures written by tests/unit/output/test_pictures with VTK (>= 9.3) and h5py, and check what they hold.

usage: check_vtkhdf.py FOLDER [TOLERANCE]
       FOLDER holds bodies, shapes and contacts (.vtkhdf, .xmf), as test_pictures writes them; TOLERANCE is relative
       to lengths of 10 m (default 1e-12; 1e-6 for files in single precision).
"""
import sys
from pathlib import Path

import h5py
import numpy as np
import vtk
from vtk.util.numpy_support import vtk_to_numpy

from vtk_pictures import check, finish, grid_at, points_of, times_of

STEPS, STEP, VELOCITY, PERIOD = 11, 0.01, 2.0, 10.0


def near(got, wanted, tolerance, what):
    check(np.allclose(got, wanted, rtol=0, atol=10 * tolerance), f"{what}: got {got}, expected {wanted}")


def contacts_at(step):
    """Number of contacts in the test's scene."""
    return step % 3


def grids(path, reader):
    """The grid of every step."""
    times = times_of(reader, path)
    check(len(times) == STEPS, f"{path.name}: {STEPS} times")
    near(times, STEP * np.arange(len(times)), 1e-14, f"{path.name}: times")
    for time in times:
        yield grid_at(reader, time)


def array(data, name):
    found = data.GetArray(name)
    check(found is not None, f"array {name}")
    return vtk_to_numpy(found)


def check_bodies(path, reader, tolerance):
    for step, grid in enumerate(grids(path, reader)):
        check(grid.GetNumberOfPoints() == 6 and grid.GetNumberOfCells() == 6, f"{path.name} {step}: six bodies")
        moved = 9.9 + VELOCITY * STEP * step
        # Of a grain within rounding of the border either side is right.
        near((points_of(grid)[0, 0] - moved + 1) % PERIOD - 1, 0, tolerance, f"{path.name} {step}: the first grain")
        near(points_of(grid)[2, 0], 3 + VELOCITY * STEP * step, tolerance, f"{path.name} {step}: the third grain")
        data = grid.GetPointData()
        near(array(data, "displacement")[:4, 0], VELOCITY * STEP * step, tolerance, f"{path.name} {step}: displacement")
        near(array(data, "velocity").sum(0), [4 * VELOCITY, 0, 0], tolerance, f"{path.name} {step}: velocity")
        near(array(data, "radius"), np.sqrt(0.25 / np.pi), tolerance, f"{path.name} {step}: radius")
        check(list(array(data, "id")) == [1, 2, 3, 4, 5, 6], f"{path.name} {step}: id")
        check(array(data, "is_grain").sum() == 4, f"{path.name} {step}: is_grain")


def check_shapes(path, reader, tolerance):
    for step, grid in enumerate(grids(path, reader)):
        check(grid.GetNumberOfCells() == 7, f"{path.name} {step}: seven shapes")
        types = [grid.GetCellType(cell) for cell in range(grid.GetNumberOfCells())]
        check(types == [7] * 6 + [4], f"{path.name} {step}: six polygons and a closed line, got {types}")
        check(list(array(grid.GetCellData(), "kind")) == [1, 1, 1, 1, 4, 2, 3], f"{path.name} {step}: kinds")
        check(list(array(grid.GetCellData(), "body")) == [1, 2, 3, 3, 4, 5, 6], f"{path.name} {step}: bodies")
        square = grid.GetCell(4)
        corners = np.array([square.GetPoints().GetPoint(i) for i in range(square.GetNumberOfPoints())])
        near(corners.mean(0), [5 + VELOCITY * STEP * step, 1, 0], tolerance, f"{path.name} {step}: the square")
        edge = corners[1] - corners[0]
        near([np.hypot(*edge[:2]), np.arctan2(edge[1], edge[0])], [1, 0.25], tolerance, f"{path.name} {step}: its turn")
        drum = grid.GetCell(6)
        last = drum.GetNumberOfPoints() - 1
        check(drum.GetPointId(0) == drum.GetPointId(last), f"{path.name} {step}: the drum is closed")


def check_contacts(path, reader, tolerance):
    for step, grid in enumerate(grids(path, reader)):
        wanted = contacts_at(step)
        lines = [c for c in range(grid.GetNumberOfCells()) if grid.GetCellType(c) in (3, 4)]
        if path.suffix == ".xmf" and wanted == 0:
            continue  # there a step without contacts is a line of no length
        check(len(lines) == wanted, f"{path.name} {step}: {wanted} lines, got {len(lines)}")
        if wanted == 0:
            check(grid.GetNumberOfPoints() == 0, f"{path.name} {step}: no points")
            continue
        data = grid.GetCellData()
        near(array(data, "force_normal")[lines].sum(), [0, 3, 8][wanted], tolerance, f"{path.name} {step}: forces")
        ends = points_of(grid)[:2]
        near(ends[1, 0] - ends[0, 0], 0.6, tolerance, f"{path.name} {step}: a line ends at the near image")
        if path.suffix != ".xmf":
            count = array(grid.GetFieldData(), "ncontacts")
            check(count[0] == wanted, f"{path.name} {step}: ncontacts")


def check_h5py(folder, tolerance):
    """What analysis with h5py alone relies on."""
    for name in ("bodies", "shapes", "contacts"):
        with h5py.File(folder / f"{name}.vtkhdf", "r") as file:
            root = file["VTKHDF"]
            check(root.attrs["Type"] == b"UnstructuredGrid", f"{name}: type")
            check(root["Steps"].attrs["NSteps"] == STEPS, f"{name}: steps")
            check(list(root["FieldData/step"]) == list(range(STEPS)), f"{name}: step numbers")
            check(root["Types"].dtype == np.uint8, f"{name}: types are bytes")
            check("deck_hash" in file.attrs and "program" in file.attrs, f"{name}: origin")
    with h5py.File(folder / "contacts.vtkhdf", "r") as file:
        root = file["VTKHDF"]
        check(list(root["FieldData/ncontacts"]) == [contacts_at(s) for s in range(STEPS)], "contacts: ncontacts")
        near(root["CellData/force_normal"][:].sum(), 7 * 3 + 3 * 5, tolerance, "contacts: sum of forces")


def main():
    folder = Path(sys.argv[1])
    tolerance = float(sys.argv[2]) if len(sys.argv) > 2 else 1e-12
    check_h5py(folder, tolerance)
    checks = {"bodies": check_bodies, "shapes": check_shapes, "contacts": check_contacts}
    for name, look in checks.items():
        look(folder / f"{name}.vtkhdf", vtk.vtkHDFReader(), tolerance)
        if hasattr(vtk, "vtkXdmfReader"):
            look(folder / f"{name}.xmf", vtk.vtkXdmfReader(), tolerance)
    finish(folder)


if __name__ == "__main__":
    main()

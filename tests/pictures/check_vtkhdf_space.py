"""Read pictures of a scene in space with VTK (>= 9.3): those of tests/unit/output/test_pictures_space, or those of a run.

usage: check_vtkhdf_space.py FOLDER [DENSITY]
       FOLDER holds bodies, shapes and contacts (.vtkhdf, .xmf). With DENSITY [kg/m3], that of all grains, VTK's volumes
       of their shapes are compared with their masses (shapes of a body must not overlap).
"""
import sys
from pathlib import Path

import h5py
import numpy as np
import vtk
from vtk.util.numpy_support import vtk_to_numpy

from vtk_pictures import check, finish, grid_at, points_of, times_of

NAMES = ("bodies", "shapes", "contacts")


def arrays(data):
    """All arrays by name, as numpy's."""
    return {data.GetArrayName(i): vtk_to_numpy(data.GetArray(i)) for i in range(data.GetNumberOfArrays())}


def surface_of(grid, cells):
    """The triangles of some cells of a grid as VTK's surface."""
    chosen = vtk.vtkIdList()
    for cell in cells:
        chosen.InsertNextId(int(cell))
    pick = vtk.vtkExtractCells()
    pick.SetInputData(grid)
    pick.SetCellList(chosen)
    surface = vtk.vtkGeometryFilter()
    surface.SetInputConnection(pick.GetOutputPort())
    triangles = vtk.vtkTriangleFilter()
    triangles.SetInputConnection(surface.GetOutputPort())
    triangles.Update()
    return triangles.GetOutput()


def volume_of(surface):
    """Volume within a closed surface by VTK."""
    mass = vtk.vtkMassProperties()
    mass.SetInputData(surface)
    mass.Update()
    return mass.GetVolume()


def open_edges(surface):
    """How many edges belong to one triangle only, or to more than two."""
    edges = vtk.vtkFeatureEdges()
    edges.SetInputData(surface)
    edges.FeatureEdgesOff()
    edges.ManifoldEdgesOff()
    edges.Update()
    return edges.GetOutput().GetNumberOfCells()


def check_shapes(grid, kind_names, bodies, density, what):
    """Cells, closed surfaces, and volumes against masses."""
    cells, points = arrays(grid.GetCellData()), points_of(grid)
    types = np.array([grid.GetCellType(i) for i in range(grid.GetNumberOfCells())])
    check(set(types) <= {1, 2, 7}, f"{what}: types {set(types)}")  # XDMF calls one vertex a polyvertex
    kinds = np.array(kind_names)[cells["kind"] - 1]
    check(np.array_equal(np.isin(types, (1, 2)), kinds == "sphere"), f"{what}: spheres are points, others polygons")
    radius = arrays(grid.GetPointData())["radius"]
    volumes = np.zeros(len(bodies["id"]))
    for shape in np.unique(cells["shape"]):
        own = np.flatnonzero(cells["shape"] == shape)
        kind, body = kinds[own[0]], cells["body"][own[0]]
        if kind == "sphere":
            volumes[body - 1] += 4 / 3 * np.pi * radius[grid.GetCell(int(own[0])).GetPointId(0)] ** 3
            continue
        surface = surface_of(grid, own)
        check(open_edges(surface) == (2 * 96 if kind == "hollow cylinder" else 0), f"{what}: the surface of shape {shape} is closed")
        if kind != "hollow cylinder":
            # Chords of 15 (in large scenes 30) degrees within a capsule.
            volumes[body - 1] += volume_of(surface) / (0.985 if kind == "cylinder" else 1)
    check(np.all(np.isfinite(points)), f"{what}: points are finite")
    if density is not None:
        grains = bodies["is_grain"] > 0
        ratio = volumes[grains] * density / bodies["mass"][grains]
        round_ones = np.isin(bodies["id"][grains], cells["body"][kinds == "cylinder"])
        check(np.all(np.abs(ratio - 1) < np.where(round_ones, 0.06, 1e-5)), f"{what}: volumes times density, {ratio.min()} to {ratio.max()} masses")


def check_bodies(grid, what):
    data = arrays(grid.GetPointData())
    if "orientation" in data:
        check(np.allclose(np.linalg.norm(data["orientation"], axis=1), 1, atol=1e-6), f"{what}: quaternions of length one")
    check(data["spin"].shape[1] == 3 and data["velocity"].shape[1] == 3, f"{what}: vectors")
    check(np.array_equal(data["id"], np.arange(1, grid.GetNumberOfPoints() + 1)), f"{what}: id")
    return data


def check_contacts(grid, what):
    data = arrays(grid.GetCellData())
    lines = np.array([grid.GetCellType(i) in (3, 4) for i in range(grid.GetNumberOfCells())], dtype=bool)
    if not lines.any() or np.all(data["candidate"] == 0):
        return 0
    normal, force = data["normal"][lines], data["force"][lines]
    check(np.allclose(np.linalg.norm(normal, axis=1), 1, atol=1e-6), f"{what}: normals of length one")
    along = np.einsum("ij,ij->i", force, normal)
    largest = np.abs(force).max() + 1e-30
    check(np.allclose(along, data["force_normal"][lines], atol=1e-5 * largest), f"{what}: normal part of the force")
    across = np.linalg.norm(force - along[:, None] * normal, axis=1)
    check(np.allclose(across, data["force_tangential"][lines], atol=1e-5 * largest), f"{what}: tangential part of the force")
    return int(lines.sum())


def look(folder, suffix, maker, density):
    """All checks on the files of one kind; returns what the other kind must show too."""
    readers = {name: maker() for name in NAMES}
    times = {name: times_of(readers[name], folder / f"{name}{suffix}") for name in NAMES}
    check(len(set(map(tuple, times.values()))) == 1 and times["bodies"], f"{suffix}: the same times in all files")
    with h5py.File(folder / "shapes.vtkhdf", "r") as file:
        kind_names = file.attrs["shape_kinds"].decode().split("|")
    seen = []
    for time in {times["bodies"][0], times["bodies"][-1]}:
        what = f"{suffix} at {time:g} s"
        grids = {name: grid_at(readers[name], time) for name in NAMES}
        bodies = check_bodies(grids["bodies"], what)
        check_shapes(grids["shapes"], kind_names, bodies, density, what)
        n_contacts = check_contacts(grids["contacts"], what)
        seen.append((time, n_contacts, np.round(grids["shapes"].GetBounds(), 6).tolist(), points_of(grids["bodies"]).sum()))
    return sorted(seen)


def main():
    folder = Path(sys.argv[1])
    density = float(sys.argv[2]) if len(sys.argv) > 2 else None
    seen = look(folder, ".vtkhdf", vtk.vtkHDFReader, density)
    if hasattr(vtk, "vtkXdmfReader"):
        also = look(folder, ".xmf", vtk.vtkXdmfReader, density)
        for one, other in zip(seen, also):
            check(one[:3] == other[:3] and np.isclose(one[3], other[3]), f"the sidecars show what the files show: {one}, {other}")
    finish(folder)


if __name__ == "__main__":
    main()

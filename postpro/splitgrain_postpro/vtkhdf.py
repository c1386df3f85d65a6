"""Read the pictures of a run: VTKHDF files that hold one temporal unstructured grid, one part per step.

A file may be read while the run goes on, or after it was killed: steps that are announced but not there are
left out.
"""

from dataclasses import dataclass, replace
from pathlib import Path

import h5py
import numpy as np

from .errors import ResultsError

VTK_EMPTY_CELL, VTK_VERTEX, VTK_LINE, VTK_POLY_LINE, VTK_POLYGON = 0, 1, 3, 4, 7


@dataclass
class Grid:
    """The grid of one step; connectivity and offsets as VTK has them."""

    time: float
    points: np.ndarray
    connectivity: np.ndarray
    offsets: np.ndarray
    types: np.ndarray
    point_data: dict
    cell_data: dict
    field_data: dict
    kind_names: tuple = ()

    def cells(self, cell_type: int) -> np.ndarray:
        """Numbers of the cells of one type."""
        return np.flatnonzero(self.types == cell_type)

    def kinds(self) -> np.ndarray:
        """Kind of shape of every cell, by its word in decks."""
        if not self.kind_names:
            raise ResultsError("the pictures of the shapes do not name their kinds: an older version made them")
        return np.array(self.kind_names)[np.asarray(self.cell_data["kind"], dtype=int) - 1]

    def present(self) -> "Grid":
        """The grid without the bodies that have not entered yet or have left; their points and their cells."""
        if "is_present" in self.cell_data:
            cells = np.asarray(self.cell_data["is_present"]) > 0
        elif "is_present" in self.point_data:
            # One cell per body: its point.
            cells = np.asarray(self.point_data["is_present"])[self.connectivity] > 0
        else:
            return self
        if cells.all():
            return self
        sizes = np.diff(self.offsets)
        points, connectivity = np.unique(self.connectivity[np.repeat(cells, sizes)], return_inverse=True)
        return replace(
            self,
            points=self.points[points],
            connectivity=connectivity,
            offsets=np.concatenate([[0], np.cumsum(sizes[cells])]),
            types=self.types[cells],
            point_data={name: values[points] for name, values in self.point_data.items()},
            cell_data={name: values[cells] for name, values in self.cell_data.items()},
        )

    def outlines(self, cells: np.ndarray) -> list[np.ndarray]:
        """Corners (x, y) of these cells, one array per cell."""
        corners = self.points[self.connectivity, :2]
        return [corners[self.offsets[c] : self.offsets[c + 1]] for c in cells]


class Pictures:
    """The steps of one VTKHDF file."""

    def __init__(self, path: Path):
        self.path = Path(path)
        with self._root() as root:
            steps = root["Steps"]
            self.times = np.asarray(steps["Values"][: int(steps.attrs["NSteps"])], dtype=float)

    def __len__(self) -> int:
        return len(self.times)

    def step(self, index: int) -> Grid:
        """The grid of a step, counted from 0, or from the end when negative."""
        if not -len(self) <= index < len(self):
            raise ResultsError(f"{self.path} has {len(self)} pictures; there is no number {index}")
        with self._root() as root:
            return _grid(root, index % len(self), float(self.times[index]))

    def field(self, name: str) -> np.ndarray | None:
        """The first value of a field of every step, or None when the file has no such field."""
        with self._root() as root:
            if name not in root.get("FieldData", {}):
                return None
            values = root["FieldData"][name][()].reshape(-1)
            rows = _field_rows(root, name, len(self))
            return values[rows]

    def names(self) -> dict[int, str]:
        """Names of bodies by their numbers; only the pictures of bodies have some, and only where the deck names bodies."""
        with self._root() as root:
            text = root.file["names"][()] if "names" in root.file else b""
        lines = text.decode(errors="replace").splitlines()
        return {int(number): name for number, _, name in (line.partition(" ") for line in lines)}

    def _root(self):
        return _Root(self.path)


class _Root:
    """Open a file's VTKHDF group; whatever is wrong with the file becomes one ResultsError."""

    def __init__(self, path):
        self.path = path

    def __enter__(self):
        try:
            self.file = h5py.File(self.path, "r")
        except OSError as error:
            raise ResultsError(f"cannot read {self.path}: {_short(error)}") from error
        if "VTKHDF" not in self.file:
            self.file.close()
            raise ResultsError(f"{self.path} is no VTKHDF file: it has no group VTKHDF")
        return self.file["VTKHDF"]

    def __exit__(self, kind, error, trace):
        self.file.close()
        if isinstance(error, (KeyError, IndexError, ValueError, OSError)):
            raise ResultsError(f"{self.path} is not a temporal grid as SplitGrain writes it: {_short(error)}") from error


def _short(error):
    """The first line of a library's message."""
    return str(error).strip("'\"").splitlines()[0]


def _grid(root, step, time):
    """Read one step; its counts and offsets give its place in the long arrays."""
    steps = root["Steps"]
    part = int(steps["PartOffsets"][step])
    n_points = int(root["NumberOfPoints"][part])
    n_cells = int(root["NumberOfCells"][part])
    n_ids = int(root["NumberOfConnectivityIds"][part])
    first_point = int(steps["PointOffsets"][step])
    first_cell = int(np.ravel(steps["CellOffsets"][step])[0])
    first_id = int(np.ravel(steps["ConnectivityIdOffsets"][step])[0])
    # Every part owns one entry of Offsets more than it has cells.
    first_offset = first_cell + part
    return Grid(
        time=time,
        points=_rows(root["Points"], first_point, n_points),
        connectivity=_rows(root["Connectivity"], first_id, n_ids),
        offsets=_rows(root["Offsets"], first_offset, n_cells + 1),
        types=_rows(root["Types"], first_cell, n_cells),
        point_data=_attached(root, "PointData", step, first_point, n_points),
        cell_data=_attached(root, "CellData", step, first_cell, n_cells),
        field_data={name: _field(root, name, step) for name in root.get("FieldData", {})},
        kind_names=tuple(filter(None, root.file.attrs.get("shape_kinds", b"").decode().split("|"))),
    )


def _rows(dataset, first, count):
    """Rows of a long array, which must all be there."""
    if first + count > dataset.shape[0]:
        raise ValueError(f"{dataset.name} ends early")
    return dataset[first : first + count]


def _attached(root, group, step, first, count):
    """Arrays of points or cells; each may have its own offsets, for what never changes is stored once."""
    own = root["Steps"].get(group + "Offsets", {})
    return {
        name: _rows(data, int(own[name][step]) if name in own else first, count)
        for name, data in root.get(group, {}).items()
    }


def _field_rows(root, name, n_steps):
    """Where in a field the first value of each step lies."""
    own = root["Steps"].get("FieldDataOffsets", {})
    return np.asarray(own[name][:n_steps], dtype=int) if name in own else np.arange(n_steps)


def _field(root, name, step):
    """All values of a field at a step."""
    first = int(_field_rows(root, name, step + 1)[step])
    sizes = root["Steps"].get("FieldDataSizes", {})
    count = int(sizes[name][step][1]) if name in sizes else 1
    return _rows(root["FieldData"][name], first, count)

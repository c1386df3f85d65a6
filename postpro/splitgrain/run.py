"""Results of a run: the record as a table, fields as arrays, contacts and motions of bodies."""

from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from splitgrain_postpro.errors import ResultsError
from splitgrain_postpro.results import Results
from splitgrain_postpro.vtkhdf import VTK_EMPTY_CELL


class Transformations(dict[int, np.ndarray]):
    """Matrices (4, 4) by numbers of bodies; `names` has the names of some, by which they are found as well."""

    def __init__(self, names: dict[int, str]):
        super().__init__()
        self.names = names

    def __missing__(self, name: str) -> np.ndarray:
        for number, its in self.names.items():
            if its == name and number in self:
                return self[number]
        raise KeyError(name)


class Run:
    """What a run wrote to its folder, finished or not."""

    def __init__(self, folder: str | Path):
        self.results = Results(folder)
        """The same as numpy arrays, with pictures (`splitgrain_postpro.Results`)"""
        self.folder = self.results.folder

    def __repr__(self) -> str:
        return f"Run({str(self.folder)!r})"

    @property
    def summary(self) -> dict[str, Any]:
        """run.json: status, errors, costs."""
        return self.results.run

    @cached_property
    def record(self) -> Any:
        """record.csv as a pandas DataFrame with the step as index; without pandas a dictionary of numpy arrays."""
        return _table(self.results.record)

    @cached_property
    def tracks(self) -> dict[str, Any]:
        """tracks.csv: such a table for each tracked body."""
        return {name: _table(columns) for name, columns in self.results.tracks.items()}

    @cached_property
    def walls(self) -> dict[str, Any]:
        """walls.csv: such a table for each wall."""
        return {name: _table(columns) for name, columns in self.results.walls.items()}

    def field(self, number: int = 1) -> Any:
        """A coarse-grained field as an xarray Dataset over time, x, y, z; without xarray a dictionary of numpy arrays."""
        field = self.results.field(number)
        arrays = {name: field[name] for name in field.names}
        try:
            import xarray
        except ModuleNotFoundError:
            return {"time": field.times, **{axis: field.centres(k) for k, axis in enumerate("xyz")}, **arrays}
        axes = ("time", "x", "y", "z")
        coordinates = {"time": field.times, **{axis: field.centres(k) for k, axis in enumerate("xyz")}}
        data = {name: ((*axes, "component")[: values.ndim], values) for name, values in arrays.items()}
        # Arrays with other numbers of components have axes of their own.
        data = {name: (tuple(f"component_{values.shape[-1]}" if axis == "component" else axis for axis in dims), values)
                for name, (dims, values) in data.items()}
        return xarray.Dataset(data, coordinates)

    def names(self) -> dict[int, str]:
        """Numbers of bodies that have a name: of the deck, planes of containers, bricks and voussoirs."""
        return dict(self.results.body_names)

    def interfaces(self, step: int | None = None) -> Any:
        """Pairs of bodies of the last recorded step up to this one: interfaces.csv as a DataFrame; without pandas numpy arrays."""
        columns = self.results.interfaces(step)
        try:
            import pandas
        except ModuleNotFoundError:
            return columns
        return pandas.DataFrame(columns)

    def contacts(self, picture: int = -1) -> dict[str, np.ndarray]:
        """Contacts of a picture: the numbers of both bodies, point, normal, gap, force; one row per contact point."""
        contacts = self.results.scene(picture).contacts
        if contacts is None:
            raise ResultsError(f"{self.folder} has no contacts.vtkhdf: set output.every in the deck")
        wanted = ("candidate", "antagonist", "point", "normal", "gap", "force", "force_normal", "force_tangential", "status")
        # A picture without contacts has one empty cell.
        rows = contacts.types != VTK_EMPTY_CELL
        return {name: np.asarray(contacts.cell_data[name])[rows] for name in wanted if name in contacts.cell_data}

    def transformations(self, picture: int = -1) -> "Transformations":
        """Matrices (4, 4) that bring points of each body from where they were in the first picture to where they are in this one.

        In the plane the rotation is about z. Keys are numbers of bodies; a name finds its body, too.
        """
        first, now = (self.results.scene(k).bodies for k in (0, picture))
        if first is None:
            raise ResultsError(f"{self.folder} has no bodies.vtkhdf: set output.every in the deck")
        if int(self.results.picture_steps[0]) != 0:
            raise ResultsError(f"{self.folder} has no picture of the start: this run went on from a checkpoint in another folder")
        rows = {int(number): row for row, number in enumerate(first.point_data["id"])}
        matrices = Transformations(self.names())
        turned_first, turned_now = _rotations(first.point_data), _rotations(now.point_data)
        for row, number in enumerate(now.point_data["id"]):
            if int(number) not in rows:
                continue
            start = rows[int(number)]
            matrix = np.eye(4)
            matrix[:3, :3] = turned_now[row] @ turned_first[start].T
            matrix[:3, 3] = now.points[row] - matrix[:3, :3] @ first.points[start]
            matrices[int(number)] = matrix
        return matrices


def _rotations(data):
    """Rotation matrix of every body: from its angle in the plane, from its quaternion (w, x, y, z) in space."""
    if "orientation" in data:
        w, x, y, z = np.asarray(data["orientation"], dtype=float).T
    else:
        half = 0.5 * np.asarray(data["angle"], dtype=float)
        w, x, y, z = np.cos(half), 0 * half, 0 * half, np.sin(half)
    rows = [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]
    return np.moveaxis(np.array(rows), -1, 0)


def _table(columns):
    """Columns as a DataFrame where there is pandas."""
    try:
        import pandas
    except ModuleNotFoundError:
        return columns
    table = pandas.DataFrame(columns)
    if "step" in table:
        table["step"] = table["step"].astype(int)
        table = table.set_index("step")
    return table

"""The folder of results of one run: record.csv, run.json and the pictures, each read when it is asked for."""

import csv
import json
import tomllib
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from .errors import ResultsError
from .fields import Field
from .lattice import cell_of
from .vtkhdf import Grid, Pictures

# Layers of equal thickness, by which grains may be coloured.
LAYERS = 8
# Names of bodies that a message lists.
MOST_LISTED = 20


@dataclass
class Scene:
    """What one picture shows; a part is None when the run did not write it."""

    time: float
    bodies: Grid | None
    shapes: Grid | None
    contacts: Grid | None
    cell: np.ndarray | None = None
    """Edges of the periodic cell of the moment as rows [m], none where there is none"""


class Results:
    """The results of one run, finished or not."""

    def __init__(self, folder: str | Path):
        self.folder = Path(folder)
        if not self.folder.is_dir():
            raise ResultsError(f"there is no folder {self.folder}")
        known = ("record.csv", "run.json", "bodies.vtkhdf", "shapes.vtkhdf", "contacts.vtkhdf")
        if not any((self.folder / name).exists() for name in known):
            raise ResultsError(f"{self.folder} holds no results: none of {', '.join(known)}")

    @property
    def name(self) -> str:
        """Name of the folder, for titles."""
        return self.folder.resolve().name

    @cached_property
    def run(self) -> dict[str, Any]:
        """run.json; empty when the run has not written it yet."""
        path = self.folder / "run.json"
        if not path.exists():
            return {}
        try:
            content = json.loads(path.read_text())
        except (OSError, ValueError) as error:
            raise ResultsError(f"cannot read {path}: {error}") from error
        if not isinstance(content, dict):
            raise ResultsError(f"cannot read {path}: it should be one object")
        return content

    @cached_property
    def record(self) -> dict[str, np.ndarray]:
        """record.csv as one array per column; empty arrays when there is no row yet, empty when there is no file."""
        path = self.folder / "record.csv"
        if not path.exists():
            return {}
        return read_record(path)

    @cached_property
    def tracks(self) -> dict[str, dict[str, np.ndarray]]:
        """tracks.csv: for each tracked body one array per column; empty when the run tracked none, or has no row yet."""
        path = self.folder / "tracks.csv"
        return read_tracks(path) if path.exists() else {}

    @cached_property
    def walls(self) -> dict[str, dict[str, np.ndarray]]:
        """walls.csv: for each wall one array per column; empty when the run has no walls, or no row yet."""
        path = self.folder / "walls.csv"
        return read_tracks(path, "wall") if path.exists() else {}

    @cached_property
    def regions(self) -> dict[str, dict[str, np.ndarray]]:
        """regions.csv: for each region one array per column; empty when the run has no regions, or no row yet."""
        path = self.folder / "regions.csv"
        return read_tracks(path, "region") if path.exists() else {}

    @cached_property
    def subdomains(self) -> dict[str, dict[str, np.ndarray]]:
        """subdomains.csv: for each subdomain one array per column; empty without output.subdomain_means, or without a row."""
        path = self.folder / "subdomains.csv"
        return read_tracks(path, "subdomain") if path.exists() else {}

    def interfaces(self, step: int | None = None) -> dict[str, np.ndarray]:
        """Pairs of bodies of the last recorded step up to this one, one array per column, names in `first` and `second`.

        They are rows of interfaces.csv; of a run without a record they come from its pictures.
        """
        rows = self._interface_rows
        if not rows:
            raise ResultsError(f"{self.folder} has no interfaces.csv and no interfaces.vtkhdf: set [[interface]] in the deck")
        steps = np.unique(rows["step"])
        steps = steps if step is None else steps[steps <= step]
        if not len(steps):
            raise ResultsError(f"{self.folder} has no row of interfaces" + ("" if step is None else f" at or before step {step}"))
        return {name: values[rows["step"] == steps[-1]] for name, values in rows.items()}

    @cached_property
    def _interface_rows(self):
        """interfaces.csv, or the pictures of interfaces, as one array per column; empty when there are none."""
        path = self.folder / "interfaces.csv"
        if path.exists():
            return read_interfaces(path)
        return self._pictured_interfaces() if self.interface_pictures is not None else {}

    def _pictured_interfaces(self):
        """The pictures of interfaces as rows of interfaces.csv have them, all steps one below the other."""
        steps, axes = self.interface_pictures.field("step"), "xyz" if self.is_in_space else "xy"
        tables = []
        for index, step in enumerate(steps[: len(self.interface_pictures)]):
            grid = self.interface_pictures.step(index)
            n = len(grid.points)
            data = {name: np.asarray(values)[:n] for name, values in grid.cell_data.items()}
            table = {"step": np.full(n, float(step)), "time": np.full(n, grid.time)}
            for side in ("first", "second"):
                table[side] = np.array([self.body_names.get(int(b), str(int(b))) for b in data[side]], dtype=object)
            for name, values in (("", grid.points), ("middle_", data["middle"]), ("normal_", data["normal"]),
                                 ("force_", data["force"])):
                table |= {name + axis: values[:, k] for k, axis in enumerate(axes)}
            table |= {name: data[name] for name in ("normal_force", "tangential_force")}
            moments = data["moment"].T if self.is_in_space else [data["moment"]]
            names = [f"moment_{axis}" for axis in axes] if self.is_in_space else ["moment"]
            table |= dict(zip(names, moments, strict=True))
            tables.append(table | {name: data[name].astype(float) for name in ("eccentricity", "area", "contacts")})
        return {name: np.concatenate([table[name] for table in tables]) for name in tables[0]} if tables else {}

    def field(self, number: int = 1) -> Field:
        """A coarse-grained field, by its place among the blocks [[field]] of the deck, from 1."""
        path = self.folder / f"field_{number}.vtkhdf"
        if not path.exists():
            raise ResultsError(f"{self.folder} has no {path.name}: set [[field]] in the deck")
        return Field(path)

    @cached_property
    def trace(self) -> list[dict[str, np.ndarray]]:
        """trace.csv and trace_steps.csv, each as one array per column; empty when the run kept no traces."""
        paths = [self.folder / name for name in ("trace.csv", "trace_steps.csv")]
        return [read_record(path) if path.exists() else {} for path in paths]

    @cached_property
    def bodies(self) -> Pictures | None:
        """Pictures of the bodies, or None."""
        return self._pictures("bodies.vtkhdf")

    @cached_property
    def shapes(self) -> Pictures | None:
        """Pictures of the shapes, or None."""
        return self._pictures("shapes.vtkhdf")

    @cached_property
    def contacts(self) -> Pictures | None:
        """Pictures of the contacts, or None."""
        return self._pictures("contacts.vtkhdf")

    @cached_property
    def interface_pictures(self) -> Pictures | None:
        """Pictures of the interfaces, or None."""
        return self._pictures("interfaces.vtkhdf")

    @cached_property
    def picture_times(self) -> np.ndarray:
        """Times of the pictures that all files have [s]."""
        files = [pictures for pictures in (self.bodies, self.shapes, self.contacts) if pictures is not None]
        # A run that goes on, or was killed, may have one picture more in one file than in the next.
        return min((pictures.times for pictures in files), key=len, default=np.empty(0))

    @cached_property
    def is_in_space(self) -> bool:
        """Is this a run in three dimensions? Read from run.json, or from what only such a run records."""
        return self.run["dimension"] == 3 if "dimension" in self.run else "stress_zz" in self.record

    @property
    def periods(self) -> tuple[float, float]:
        """Lengths of the periods in x and y [m]; zero where the scene is not periodic."""
        return self._period("period"), self._period("period_y")

    def _period(self, name):
        for pictures in (self.bodies, self.shapes, self.contacts):
            periods = pictures.field(name) if pictures is not None else None
            if periods is not None and len(periods):
                return float(periods[0])
        return float(self.run.get(name, 0))

    def scene(self, index: int = -1) -> Scene:
        """One picture, counted from 0, or from the end when negative; bodies that are absent then are left out."""
        n = len(self.picture_times)
        if not -n <= index < n:
            if n == 0:
                raise ResultsError(f"{self.folder} has no pictures: set output.every in the deck")
            raise ResultsError(f"{self.folder} has {n} pictures; there is no number {index}")
        index %= n
        grids = [None if pictures is None else pictures.step(index).present()
                 for pictures in (self.bodies, self.shapes, self.contacts)]
        grids[0] = self.with_layers(grids[0])
        return Scene(float(self.picture_times[index]), *grids, self.cell(index))

    def cell(self, index: int) -> np.ndarray | None:
        """Edges of the periodic cell of a picture as rows [m]; None where there is none: its tilt is what only such a cell has."""
        tilt = self.bodies.field("tilt") if self.bodies is not None else None
        if tilt is None:
            return None
        lengths = [self.bodies.field(name) for name in ("period", "period_y", "period_z")]
        return cell_of([float(values[index]) for values in lengths if values is not None], float(tilt[index]))

    @cached_property
    def picture_steps(self) -> np.ndarray:
        """Numbers of the time steps of all pictures; their own numbers where they do not hold them."""
        for pictures in (self.bodies, self.shapes, self.contacts):
            steps = pictures.field("step") if pictures is not None else None
            if steps is not None:
                return np.asarray(steps[: len(self.picture_times)], dtype=int)
        return np.arange(len(self.picture_times))

    @cached_property
    def deck(self) -> dict[str, Any]:
        """effective.toml, the deck with all defaults and settings; empty where there is none."""
        path = self.folder / "effective.toml"
        try:
            return tomllib.loads(path.read_text()) if path.exists() else {}
        except (OSError, ValueError) as error:
            raise ResultsError(f"cannot read {path}: {error}") from error

    @cached_property
    def body_names(self) -> dict[int, str]:
        """Names of bodies by their numbers, from the pictures; without pictures those of [[body]], which come first."""
        named = self.bodies.names() if self.bodies is not None else {}
        blocks = self.deck.get("body", []) if not named else []
        return named or {number: block["name"] for number, block in enumerate(blocks, 1) if block.get("name")}

    def number_of_body(self, word: str) -> int:
        """Number of a body by its name, or by its number."""
        if word.isdecimal():
            return int(word)
        for number, name in self.body_names.items():
            if name == word:
                return number
        known = ", ".join(list(self.body_names.values())[:MOST_LISTED]) or "none"
        more = ", ..." if len(self.body_names) > MOST_LISTED else ""
        raise ResultsError(f'{self.folder} has no body "{word}" (names: {known}{more}); a body goes also by its number')

    @cached_property
    def _layer_edges(self):
        """Heights between the layers in which the grains were at the start [m]; those enter that come later."""
        grid = self.bodies.step(-1)
        data = grid.point_data
        if "start_position" not in data or "is_grain" not in data:
            return None
        heights = data["start_position"][np.asarray(data["is_grain"]) > 0, 2 if "orientation" in data else 1]
        return np.linspace(heights.min(), heights.max(), LAYERS + 1)[1:-1] if len(heights) else None

    def with_layers(self, grid: Grid | None) -> Grid | None:
        """The grid of the bodies with the layer of origin of each, from 1 at the bottom."""
        if grid is not None and self._layer_edges is not None:
            data = grid.point_data
            heights = data["start_position"][:, 2 if "orientation" in data else 1]
            data["layer"] = 1 + np.searchsorted(self._layer_edges, heights, side="right")
        return grid

    def picture_of_step(self, step: int) -> int:
        """Number of the last picture at or before a time step."""
        for pictures in (self.bodies, self.shapes, self.contacts):
            steps = pictures.field("step") if pictures is not None else None
            if steps is not None:
                earlier = np.flatnonzero(steps[: len(self.picture_times)] <= step)
                if not len(earlier):
                    raise ResultsError(f"{self.folder} has no picture at or before step {step}")
                return int(earlier[-1])
        raise ResultsError(f"{self.folder} has no picture with the number of its step")

    def _pictures(self, name):
        path = self.folder / name
        pictures = Pictures(path) if path.exists() else None
        return pictures if pictures else None


def read_record(path: Path) -> dict[str, np.ndarray]:
    """A record as one array per column; a last row that is cut short (the run goes on) is left out."""
    try:
        with open(path, newline="") as file:
            rows = [row for row in csv.reader(file) if row and not row[0].startswith("#")]
    except (OSError, ValueError, csv.Error) as error:
        raise ResultsError(f"cannot read {path}: {error}") from error
    if not rows:
        raise ResultsError(f"cannot read {path}: it has no line of names")
    names = [name.strip() for name in rows[0]]
    if rows[1:] and len(rows[-1]) != len(names):
        rows.pop()
    for number, row in enumerate(rows[1:], 1):
        if len(row) != len(names):
            raise ResultsError(f"cannot read {path}: row {number} has {len(row)} values for {len(names)} names")
    columns = zip(*rows[1:], strict=True) if rows[1:] else [()] * len(names)
    return {name: np.array([_number(word) for word in column]) for name, column in zip(names, columns, strict=True)}


def read_interfaces(path: Path) -> dict[str, np.ndarray]:
    """interfaces.csv as one array per column, of words in `first` and `second`; a last row that is cut short is left out."""
    names, rows = _read_rows(path)
    if not {"step", "first", "second"} <= set(names):
        raise ResultsError(f"cannot read {path}: it has no line of names")
    if rows and len(rows[-1]) != len(names):
        rows.pop()
    try:
        columns = list(zip(*rows, strict=True)) or [()] * len(names)
        return {name: np.array(column, dtype=object) if name in ("first", "second") else np.array(column, dtype=float)
                for name, column in zip(names, columns, strict=True)}
    except ValueError as error:
        raise ResultsError(f"cannot read {path}: {error}") from error


def _read_rows(path):
    """Names of the columns of a file, and its rows of words."""
    try:
        with open(path, newline="") as file:
            rows = [row for row in csv.reader(file) if row]
    except (OSError, ValueError, csv.Error) as error:
        raise ResultsError(f"cannot read {path}: {error}") from error
    return (rows[0], rows[1:]) if rows else ([], [])


def read_tracks(path: Path, key: str = "body") -> dict[str, dict[str, np.ndarray]]:
    """tracks.csv, walls.csv, regions.csv or subdomains.csv as one table per body, one array per column; a row cut short is left out."""
    names, rows = _read_rows(path)
    if key not in names:
        raise ResultsError(f"cannot read {path}: it has no line of names")
    place = names.index(key)
    if rows and len(rows[-1]) != len(names):
        rows.pop()
    bodies = {}
    try:
        for row in rows:
            bodies.setdefault(row[place], []).append([float(word) for i, word in enumerate(row) if i != place])
        tables = {body: np.array(table).T for body, table in bodies.items()}
        names.pop(place)
        return {body: dict(zip(names, table, strict=True)) for body, table in tables.items()}
    except ValueError as error:
        raise ResultsError(f"cannot read {path}: {error}") from error


def _number(word):
    """A number; logicals become 1 and 0, and what is not known NaN."""
    word = word.strip()
    if word.lower() in ("t", "true", "f", "false"):
        return float(word.lower().startswith("t"))
    try:
        return float(word)
    except ValueError:
        return float("nan")

"""One offline page of a run: a view of the bodies that turns, a slider over the pictures, curves of the record."""

import base64
import html
import json
import re
from argparse import Namespace
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from .errors import ResultsError
from .fragments import fans
from .lattice import fold_bodies
from .quantities import LABELS, rows_of
from .results import Results
from .vtkhdf import VTK_POLYGON, VTK_VERTEX, Grid

TEMPLATE = Path(__file__).with_name("viewer.html")
# three.js with its licence: vendor/README.md.
LIBRARY = Path(__file__).parent / "vendor/three.min.js"
# Shapes of walls in space: lines, that hide no grain.
LINES = ("plane", "hollow cylinder")
FLAT_WALLS = ("segment", "hollow disk")
MOST_ROWS = 600
# Walls are shown as far beyond the grains as this part of what these take up.
NEAR = 0.5
# Part of its length by which the box of a plane scene is thick, so that it has an inverse.
THIN = 1e-6


def write_page(results: Results, options: Namespace) -> str:
    """Write the page; returns a sentence about it."""
    path = options.output or results.folder / "page.html"
    content = page_data(results, options.pictures)
    # A script element ends with the first "</": there is none in JSON without a slash after "<".
    text = json.dumps(content, separators=(",", ":")).replace("</", "<\\/")
    parts = {"TITLE": html.escape(results.name), "LIBRARY": LIBRARY.read_text("utf-8"), "DATA": text}
    page = re.sub("|".join(parts), lambda word: parts[word[0]], TEMPLATE.read_text("utf-8"))
    path.write_text(page, "utf-8")
    return f"wrote {path}: {len(content['times'])} pictures of {len(content['grains'])} bodies, {len(page) / 1e6:.1f} MB"


def page_data(results: Results, most: int = 60) -> dict[str, Any]:
    """What the page shows: meshes about the centres of the bodies, and the place and turn of each body in at most so many pictures."""
    if results.bodies is None or results.shapes is None or not len(results.picture_times):
        raise ResultsError(f"{results.folder} has no pictures of bodies and shapes: set output.every in the deck")
    n = len(results.picture_times)
    chosen = np.unique(np.linspace(0, n - 1, min(n, most)).round().astype(int))
    grids = [results.bodies.step(int(k)) for k in chosen]
    first, shapes = grids[0], results.shapes.step(int(chosen[0]))
    present = np.array([grid.point_data.get("is_present", np.ones(len(grid.points))) for grid in grids]) > 0
    # What waits for its entry is no grain yet.
    is_grain = np.any([np.asarray(grid.point_data["is_grain"]) > 0 for grid in grids], axis=0)
    solid = _solid(shapes, first, is_grain)
    box, places = _wrapped(results, chosen, grids, present & solid, shapes)
    low, high = box.ends.min(axis=0), box.ends.max(axis=0)
    middle, half, reach = (low + high) / 2, (high - low) / 2, first.point_data["radius"][solid].max()
    turns = [_quaternions(grid) for grid in grids]
    start = turns[0] * [1, -1, -1, -1]
    quantities = _quantities(results, grids)
    return {
        "times": [float(results.picture_times[k]) for k in chosen], "in_space": "orientation" in first.point_data,
        "grains": is_grain.astype(int).tolist(),
        "radius": float(1.05 * np.linalg.norm(half) + reach) or 1.0, "half": [float(1.05 * side + reach) or 1.0 for side in half[:2]],
        "places": _packed(places - middle),
        "turns": _packed(np.array([_product(turn, start) for turn in turns])),
        "present": None if present.all() else present.astype(int).tolist(),
        "quantities": {name: _packed(values) for name, values in quantities.items()},
        "units": {name: LABELS[name].partition("[")[2].rstrip("]") for name in quantities if name in LABELS},
        "box": box.content(middle), **_meshes(shapes, first, is_grain), "record": _record(results),
    }  # fmt: skip


@dataclass
class Box:
    """What the view is about: in each picture a corner and three edges, some of them periods."""

    corner: np.ndarray
    edges: np.ndarray  # of each picture as rows (picture, edge, component) [m]
    periodic: np.ndarray  # of each edge

    @property
    def ends(self) -> np.ndarray:
        """All corners in all pictures."""
        signs = np.array([[(i >> k) & 1 for k in range(3)] for i in range(8)])
        return (self.corner + signs @ self.edges).reshape(-1, 3)

    def content(self, middle: np.ndarray) -> dict[str, Any] | None:
        """Corner about the middle of the view, edges and their inverses; None where nothing is periodic."""
        if not self.periodic.any():
            return None
        return {"corner": (self.corner - middle).tolist(), "edges": _packed(self.edges),
                "inverses": _packed(np.linalg.inv(self.edges)), "periodic": self.periodic.astype(int).tolist()}


def _wrapped(results, chosen, grids, shown, shapes):
    """The box of the view, and the places of all bodies in all pictures: in a periodic cell those of the images within it."""
    places = np.array([grid.points for grid in grids])
    cells = [results.cell(int(k)) for k in chosen]
    edges = np.tile(np.eye(3), (len(grids), 1, 1))
    if cells[0] is not None:
        size = len(cells[0])
        edges *= THIN * cells[0].max()
        edges[:, :size, :size] = cells
        return Box(np.zeros(3), edges, np.arange(3) < size), places + [fold_bodies(*one) for one in zip(places, edges, strict=True)]
    seen = places[shown] if shown.any() else places.reshape(-1, 3)
    low, high = _with_walls(seen.min(axis=0), seen.max(axis=0), shapes, "orientation" in grids[0].point_data)
    periods = np.array([*results.periods, 0.0])
    low, high = np.where(periods > 0, 0.0, low), np.where(periods > 0, periods, high)
    return Box(low, edges * np.maximum(high - low, THIN * (high - low).max() or 1.0), periods > 0), places


def _with_walls(low, high, shapes, in_space):
    """Ends of the box with the walls of a plane scene, as far as they are near."""
    if in_space:
        return low, high
    walls, near = shapes.points[shapes.connectivity], NEAR * (high - low).max()
    return np.maximum(np.minimum(low, walls.min(axis=0)), low - near), np.minimum(np.maximum(high, walls.max(axis=0)), high + near)


def _quantities(results, grids):
    """Values of all bodies that give colours, in all pictures or once."""
    first = grids[0].point_data
    names = (("speed", "velocity"), ("displacement", "displacement"))
    found = {name: np.array([np.linalg.norm(grid.point_data[array], axis=1) for grid in grids]) for name, array in names if array in first}
    found |= {name: np.asarray(first[name]) for name in ("radius", "material") if name in first}
    if "layer" in results.with_layers(grids[0]).point_data:
        found["layer"] = first["layer"]
    return found


def _solid(shapes, bodies, is_grain):
    """Which bodies the view is about: grains, and those that are held and have another shape than walls; all where there are none."""
    rows = rows_of(bodies.point_data["id"], shapes.cell_data["body"])
    solid = is_grain.copy()
    solid[rows[~np.isin(shapes.kinds(), (*LINES, *FLAT_WALLS))]] = True
    return solid if solid.any() else ~solid


def _meshes(shapes: Grid, bodies: Grid, is_grain: np.ndarray) -> dict[str, Any]:
    """Triangles, spheres and, of walls in space, lines about the centres of their bodies."""
    rows = rows_of(bodies.point_data["id"], shapes.cell_data["body"])
    in_space = "orientation" in bodies.point_data
    is_line = np.isin(shapes.kinds(), LINES) if in_space else np.zeros(len(rows), dtype=bool)
    is_line &= ~is_grain[rows]
    polygons = np.flatnonzero((shapes.types == VTK_POLYGON) & ~is_line)
    sizes = np.diff(shapes.offsets)[polygons]
    offsets = np.concatenate([[0], np.cumsum(sizes)])
    places = np.repeat(shapes.offsets[polygons] - offsets[:-1], sizes) + np.arange(offsets[-1])
    corners, face = fans(offsets)
    of = rows[polygons][face]
    triangles = shapes.points[shapes.connectivity[places]][corners] - bodies.points[of][:, None]
    edges, line_bodies = [], []
    for cell in np.flatnonzero(is_line):
        points = shapes.points[shapes.connectivity[shapes.offsets[cell] : shapes.offsets[cell + 1]]] - bodies.points[rows[cell]]
        edges.append(np.stack([points, np.roll(points, -1, axis=0)], axis=1).reshape(-1, 3))
        line_bodies += [int(rows[cell])] * len(points)
    round_ = np.flatnonzero(shapes.types == VTK_VERTEX)
    points = shapes.connectivity[shapes.offsets[round_]]
    centres = shapes.points[points] - bodies.points[rows[round_]]
    radii = shapes.point_data["radius"][points] if len(points) else []
    return {"triangles": _packed(triangles), "triangle_bodies": of.tolist(),
            "lines": _packed(np.concatenate(edges) if edges else []), "line_bodies": line_bodies,
            "spheres": [[*map(float, centre), float(radius), int(row)] for centre, radius, row in zip(centres, radii, rows[round_], strict=True)]}


def _quaternions(grid):
    """Turn of every body (w, x, y, z)."""
    if "orientation" in grid.point_data:
        return np.asarray(grid.point_data["orientation"], dtype=float)
    half = 0.5 * np.asarray(grid.point_data["angle"], dtype=float)
    return np.column_stack([np.cos(half), 0 * half, 0 * half, np.sin(half)])


def _product(a, b):
    """Products of quaternions, row by row."""
    w, x, y, z = a.T
    s, i, j, k = b.T
    return np.column_stack([w * s - x * i - y * j - z * k, w * i + x * s + y * k - z * j, w * j - x * k + y * s + z * i,
                            w * k + x * j - y * i + z * s])


def _packed(values):
    """Numbers as text: 32-bit floats, little end first, base 64."""
    return base64.b64encode(np.ascontiguousarray(values, dtype="<f4").tobytes()).decode()


def _record(results):
    """Columns of the record, thinned; what is not finite is null."""
    record = results.record
    if not record or not len(record["time"]):
        return {"time": [0.0]}
    rows = np.unique(np.linspace(0, len(record["time"]) - 1, MOST_ROWS).astype(int))
    changing = [name for name, values in record.items() if name not in ("step", "stage", "time") and _changes(values)]
    columns = {"time": record["time"][rows], **{name: record[name][rows] for name in changing}}
    return {name: [float(f"{value:.6g}") if np.isfinite(value) else None for value in values] for name, values in columns.items()}


def _changes(values):
    """Has a column different finite values?"""
    finite = values[np.isfinite(values)]
    return len(finite) > 1 and finite.min() < finite.max()

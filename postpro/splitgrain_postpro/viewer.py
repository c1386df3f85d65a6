"""One offline page of a run: a view of the bodies that turns, a slider over the pictures, curves of the record."""

import base64
import html
import json
from argparse import Namespace
from pathlib import Path
from typing import Any

import numpy as np

from .errors import ResultsError
from .fragments import fans
from .quantities import LABELS, rows_of
from .results import Results
from .vtkhdf import VTK_POLYGON, VTK_VERTEX, Grid

TEMPLATE = Path(__file__).with_name("viewer.html")
# Shapes of walls in space: lines, that hide no grain.
LINES = ("plane", "hollow cylinder")
FLAT_WALLS = ("segment", "hollow disk")
MOST_ROWS = 600


def write_page(results: Results, options: Namespace) -> str:
    """Write the page; returns a sentence about it."""
    path = options.output or results.folder / "page.html"
    content = page_data(results, options.pictures)
    # A script element ends with the first "</": there is none in JSON without a slash after "<".
    text = json.dumps(content, separators=(",", ":")).replace("</", "<\\/")
    page = TEMPLATE.read_text().replace("TITLE", html.escape(results.name)).replace("DATA", text, 1)
    path.write_text(page)
    return f"wrote {path}: {len(content['times'])} pictures of {len(content['grains'])} bodies, {len(page) / 1e6:.1f} MB"


def page_data(results: Results, most: int = 60) -> dict[str, Any]:
    """What the page shows: meshes about the centres of the bodies, and the place and turn of each body in at most so many pictures."""
    if results.bodies is None or results.shapes is None or not len(results.picture_times):
        raise ResultsError(f"{results.folder} has no pictures of bodies and shapes: set output.every in the deck")
    n = len(results.picture_times)
    chosen = np.unique(np.linspace(0, n - 1, min(n, most)).round().astype(int))
    grids = [results.bodies.step(k) for k in chosen]
    first, shapes = grids[0], results.shapes.step(int(chosen[0]))
    solid = _solid(shapes, first)
    low, high = (end(np.array([grid.points[solid] for grid in grids]), axis=(0, 1)) for end in (np.min, np.max))
    middle, half = (low + high) / 2, np.linalg.norm(high - low) / 2
    turns = [_quaternions(grid) for grid in grids]
    start = turns[0] * [1, -1, -1, -1]
    quantities = {"speed": np.array([np.linalg.norm(grid.point_data["velocity"], axis=1) for grid in grids])}
    quantities |= {name: np.asarray(first.point_data[name]) for name in ("radius", "material") if name in first.point_data}
    if "layer" in results.with_layers(first).point_data:
        quantities["layer"] = first.point_data["layer"]
    meshes = _meshes(shapes, first, middle)
    present = [grid.point_data["is_present"] for grid in grids if "is_present" in grid.point_data]
    return {
        "times": [float(results.picture_times[k]) for k in chosen], "in_space": "orientation" in first.point_data,
        "grains": [int(one > 0) for one in first.point_data["is_grain"]],
        "radius": float(1.05 * half + first.point_data["radius"][solid].max()) or 1.0,
        "places": _packed(np.array([grid.points - middle for grid in grids])),
        "turns": _packed(np.array([_product(turn, start) for turn in turns])),
        "present": [[int(one > 0) for one in row] for row in present] or None,
        "quantities": {name: _packed(values) for name, values in quantities.items()},
        "units": {name: LABELS[name].partition("[")[2].rstrip("]") for name in (*quantities, "displacement") if name in LABELS},
        **meshes, "record": _record(results),
    }  # fmt: skip


def _solid(shapes, bodies):
    """Which bodies the view is about: grains, and those that are held and have another shape than walls; all where there are none."""
    rows = rows_of(bodies.point_data["id"], shapes.cell_data["body"])
    solid = np.asarray(bodies.point_data["is_grain"]) > 0
    solid[rows[~np.isin(shapes.kinds(), (*LINES, *FLAT_WALLS))]] = True
    return solid if solid.any() else ~solid


def _meshes(shapes: Grid, bodies: Grid, middle) -> dict[str, Any]:
    """Triangles and spheres about the centres of their bodies; walls in space as lines where they are."""
    rows = rows_of(bodies.point_data["id"], shapes.cell_data["body"])
    in_space = "orientation" in bodies.point_data
    is_line = np.isin(shapes.kinds(), LINES) if in_space else np.zeros(len(rows), dtype=bool)
    is_line &= np.asarray(bodies.point_data["is_grain"])[rows] <= 0
    polygons = np.flatnonzero((shapes.types == VTK_POLYGON) & ~is_line)
    sizes = np.diff(shapes.offsets)[polygons]
    offsets = np.concatenate([[0], np.cumsum(sizes)])
    places = np.repeat(shapes.offsets[polygons] - offsets[:-1], sizes) + np.arange(offsets[-1])
    corners, face = fans(offsets)
    of = rows[polygons][face]
    triangles = shapes.points[shapes.connectivity[places]][corners] - bodies.points[of][:, None]
    edges = []
    for cell in np.flatnonzero(is_line):
        points = shapes.points[shapes.connectivity[shapes.offsets[cell] : shapes.offsets[cell + 1]]] - middle
        edges.append(np.stack([points, np.roll(points, -1, axis=0)], axis=1).reshape(-1, 3))
    round_ = np.flatnonzero(shapes.types == VTK_VERTEX)
    points = shapes.connectivity[shapes.offsets[round_]]
    centres = shapes.points[points] - bodies.points[rows[round_]]
    radii = shapes.point_data["radius"][points] if len(points) else []
    return {"triangles": _packed(triangles), "triangle_bodies": of.tolist(), "lines": _packed(np.concatenate(edges) if edges else []),
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

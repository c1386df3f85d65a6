"""Quantities that fill the grains, and the scales of their colours."""

from colorsys import hsv_to_rgb
from dataclasses import dataclass, replace

import numpy as np
from matplotlib.colors import Colormap, ListedColormap, Normalize

from .command_line import LABELS, QUANTITIES
from .errors import ResultsError
from .results import Scene
from .style import FILL, KINDS, number
from .style import number as number_text
from .vtkhdf import VTK_LINE, Grid

# Quantities that are labels: one colour each, not a scale.
LABEL_QUANTITIES = ("material", "rank", "layer")
# Quantities whose scale begins at the smallest value, not at zero.
FROM_THE_LEAST = ("radius", "start_height", "id")
# A force this share of the largest is drawn; the rest is rounding.
SMALL_FORCE = 1e-3


@dataclass
class Colouring:
    """How values become colours; without a map all are equal, and `note` states it."""

    label: str
    map: Colormap | None = None
    norm: Normalize | None = None
    ticks: np.ndarray | None = None
    extend: str = "neither"
    note: str = ""


def colouring(values: np.ndarray, quantity: str, fill: Colormap = FILL) -> Colouring:
    """The colours of these values, which are finite."""
    label = "force [N]" if quantity == "force" else LABELS.get(quantity, quantity)
    if quantity in LABEL_QUANTITIES:
        return _colouring_of_labels(values, label)
    low = 0.0 if values.min() >= 0 and quantity not in FROM_THE_LEAST else float(values.min())
    # The end of the scale leaves out the fastest hundredth, which would pale all others.
    high = float(values.max()) if quantity in ("coordination", "id") else float(np.quantile(values, 0.99))
    if not high > low:
        return Colouring(label, note=f"{label}: {number(low)} everywhere")
    return Colouring(label, fill, Normalize(low, high), extend="max" if values.max() > high else "neither")


def _colouring_of_labels(values, label):
    """One colour a label; of many labels those near in number have hues far apart."""
    low, high = int(values.min()), int(values.max())
    count = high - low + 1
    if count <= len(KINDS):
        colours = ListedColormap(KINDS[:count])
    else:  # steps of the golden section about the circle of hues
        colours = ListedColormap([hsv_to_rgb(0.618034 * k % 1, (0.28, 0.5, 0.38)[k % 3], (0.97, 0.88)[k // 2 % 2])
                                  for k in range(count)])
    ticks = np.arange(low, high + 1, -(-count // 11))
    return Colouring(label, colours, Normalize(low - 0.5, high + 0.5), ticks)


def is_in_space(scene: Scene) -> bool:
    """Is this the picture of a scene in three dimensions?"""
    return any(
        grid is not None and name in data(grid)
        for grid, name, data in (
            (scene.bodies, "orientation", lambda grid: grid.point_data),
            (scene.shapes, "radius", lambda grid: grid.point_data),
            (scene.contacts, "force", lambda grid: grid.cell_data),
        )
    )


def of_bodies(scene: Scene, quantity: str) -> np.ndarray | None:
    """A quantity of every body; None when the run did not write what it needs."""
    data = scene.bodies.point_data if scene.bodies is not None else {}
    if quantity == "coordination":
        return _coordination(scene)
    if quantity == "pressure":
        return _pressure(scene)
    if quantity == "start_height":
        return data["start_position"][:, 2 if is_in_space(scene) else 1] if "start_position" in data else None
    values = data.get("velocity" if quantity == "speed" else quantity)
    if values is None and quantity[-2:] in ("_x", "_y", "_z") and np.ndim(data.get(quantity[:-2])) == 2:
        return data[quantity[:-2]][:, "xyz".index(quantity[-1])]
    return np.linalg.norm(values, axis=1) if values is not None and values.ndim == 2 else values


def need_quantity(scene: Scene, quantity: str) -> None:
    """Refuse a quantity that has no name here and is no array of the bodies in this picture."""
    if quantity in QUANTITIES or scene.bodies is None or of_bodies(scene, quantity) is not None:
        return
    others = sorted(name + ("_x, _y, _z" if np.ndim(values) == 2 else "") for name, values in scene.bodies.point_data.items())
    raise ResultsError(f'no quantity "{quantity}"; there are {", ".join(QUANTITIES)}, and of the pictures {", ".join(others)}')


def relative_to(scene: Scene, number: int) -> Scene:
    """The scene with displacements and velocities relative to those of the centre of a body."""
    rows = np.flatnonzero(scene.bodies.point_data["id"] == number) if scene.bodies is not None else []
    if not len(rows):
        raise ResultsError(f"there is no body {number} in the picture at {number_text(scene.time)} s")
    data = dict(scene.bodies.point_data)
    for name in ("displacement", "velocity"):
        if name in data:
            data[name] = data[name] - data[name][rows[0]]
    return replace(scene, bodies=replace(scene.bodies, point_data=data))


def of_shapes(scene: Scene, quantity: str, default: float) -> np.ndarray:
    """A quantity of the bodies, for every cell of the shapes."""
    shapes = scene.shapes
    values = of_bodies(scene, quantity)
    if values is None:
        return np.asarray(shapes.cell_data.get(quantity, np.full(len(shapes.types), default)))
    return np.asarray(values)[rows_of(scene.bodies.point_data["id"], shapes.cell_data["body"])]


def _coordination(scene):
    """How many bodies each body shares force with."""
    if scene.bodies is None or scene.contacts is None or "id" not in scene.bodies.point_data:
        return None
    ids = scene.bodies.point_data["id"]
    data = scene.contacts.cell_data
    carries = carrying(scene.contacts)
    pairs = np.sort(np.column_stack([data["candidate"], data["antagonist"]])[carries], axis=1)
    pairs = np.unique(pairs, axis=0).reshape(-1, 2)
    return np.bincount(rows_of(ids, pairs.ravel()), minlength=len(ids))


def _pressure(scene):
    """Mean stress of every body by Love and Weber: - sum(force . arm)/(d V), positive under pressure."""
    bodies, contacts = scene.bodies, scene.contacts
    needed = ("candidate", "antagonist", "point", "normal")
    if bodies is None or contacts is None or "radius" not in bodies.point_data or "id" not in bodies.point_data:
        return None
    if not all(name in contacts.cell_data for name in needed):
        return None
    data = bodies.point_data
    cells = np.flatnonzero(contacts.types == VTK_LINE)
    force = forces_of(contacts)[cells]
    point = contacts.cell_data["point"][cells]
    ends = contacts.points[contacts.connectivity].reshape(-1, 2, 3) if len(cells) else np.zeros((0, 2, 3))
    sums = np.zeros(len(data["id"]))
    for side, name, sign in ((0, "candidate", -1.0), (1, "antagonist", 1.0)):
        rows = rows_of(data["id"], contacts.cell_data[name][cells])
        np.add.at(sums, rows, sign * np.einsum("ij,ij->i", force, point - ends[:, side]))
    radius = np.asarray(data["radius"], dtype=float)
    size = 4 * np.pi * radius**3 if is_in_space(scene) else 2 * np.pi * radius**2
    return np.where(data.get("is_grain", np.ones(len(size))) > 0, sums / np.maximum(size, 1e-300), 0.0)


def forces_of(contacts: Grid) -> np.ndarray:
    """The force that each candidate feels [N]."""
    data = contacts.cell_data
    if "force" in data:
        return np.asarray(data["force"], dtype=float)
    normal = np.asarray(data["normal"], dtype=float)
    tangent = np.column_stack([normal[:, 1], -normal[:, 0], np.zeros(len(normal))])
    return data["force_normal"][:, None] * normal + data["force_tangential"][:, None] * tangent


def rows_of(ids: np.ndarray, wanted: np.ndarray) -> np.ndarray:
    """Where in `ids` each wanted id stands."""
    order = np.argsort(ids, kind="stable")
    found = np.searchsorted(ids, wanted, sorter=order)
    rows = order[np.minimum(found, len(ids) - 1)] if len(ids) else found
    if not len(ids) and len(wanted) or np.any(ids[rows] != wanted):
        raise ResultsError("the pictures do not fit together: a shape or contact names a body that is not there")
    return rows


def between_ranks(scene: Scene) -> tuple[np.ndarray, int]:
    """Cells that are contacts of two grains of different ranks, and the number of contacts between grains."""
    data, contacts = scene.bodies.point_data, scene.contacts
    ends = np.column_stack([contacts.cell_data["candidate"], contacts.cell_data["antagonist"]])
    cells = np.flatnonzero(contacts.types == VTK_LINE)
    rows = rows_of(data["id"], ends[cells].ravel()).reshape(-1, 2)
    grains = np.all(np.asarray(data["is_grain"])[rows] > 0, axis=1)
    ranks = np.asarray(data["rank"])[rows]
    return cells[grains & (ranks[:, 0] != ranks[:, 1])], int(grains.sum())


def links(contacts: Grid) -> tuple[np.ndarray, np.ndarray]:
    """Cells that are links, and their tensions; none where the scene has no links."""
    number = np.asarray(contacts.cell_data.get("link", np.zeros(len(contacts.types))))
    cells = np.flatnonzero((contacts.types == VTK_LINE) & (number > 0))
    return cells, np.asarray(contacts.cell_data["tension"], dtype=float)[cells] if len(cells) else np.zeros(0)


def bonds(contacts: Grid) -> tuple[np.ndarray, np.ndarray]:
    """Cells that hold bonds of cohesive zones, the most damaged ones last, and their damages; none where there are no such laws."""
    damage = np.asarray(contacts.cell_data.get("damage", np.full(len(contacts.types), -1.0)), dtype=float)
    cells = np.flatnonzero((contacts.types == VTK_LINE) & (damage >= 0))
    cells = cells[np.argsort(damage[cells], kind="stable")]
    return cells, damage[cells]


def carrying(contacts: Grid) -> np.ndarray:
    """Which cells are contacts that carry a normal force worth drawing."""
    force = np.abs(contacts.cell_data["force_normal"])
    is_contact = contacts.types == VTK_LINE
    largest = force[is_contact].max(initial=0.0)
    return is_contact & (force > SMALL_FORCE * largest)

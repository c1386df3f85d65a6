"""Draw a scene in space: grains as solid bodies, walls that do not hide them, forces as bars between grains.

The view is a parallel projection, so that lengths can be compared; the axes with their units stand at the edges of a
box about the scene.
"""

from dataclasses import dataclass

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LinearSegmentedColormap, to_rgb
from matplotlib.collections import LineCollection
from matplotlib.ticker import MaxNLocator

from .errors import ResultsError
from .quantities import carrying, colouring, of_bodies, of_shapes, rows_of
from .raster import Canvas, normal_of
from .style import number
from .vtkhdf import VTK_POLYGON, VTK_VERTEX

KIND_PLANE, KIND_CYLINDER, KIND_HOLLOW = 6, 7, 8
PIXELS = 1500
GRAIN, WALL = "#B9C4CE", "#D3D3D0"
# Light enough everywhere for shades to be seen.
FILL = LinearSegmentedColormap.from_list("solid", ["#3B5BA9", "#3E9CC0", "#7CC9A2", "#DDE68A", "#F2A93B", "#D9512C"])
FORCES = LinearSegmentedColormap.from_list("forces", ["#F2C14E", "#E8743B", "#C02942", "#53113B"])
# Part of the grains that a wall may hide; one that hides more is drawn as its outline.
HIDES = 0.08


@dataclass
class View:
    """How to look at a scene in space."""

    azimuth: float = -60.0  # of the viewer, from x towards y [degrees]
    elevation: float = 22.0  # of the viewer above the horizon [degrees]
    forces: bool = False  # forces between grains, which are pale then
    cut: tuple | None = None  # (axis, place [m]): grains on the viewer's side are left out

    def axes(self):
        """Unit vectors to the right, up and towards the viewer, as rows."""
        a, e = np.radians([self.azimuth, self.elevation])
        right = np.array([-np.sin(a), np.cos(a), 0])
        toward = np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])
        return np.array([right, np.cross(toward, right), toward])


@dataclass
class Solids:
    """What is to be drawn, in the axes of the camera; one number of a body, by its row, for each."""

    spheres: tuple  # centres, radii, bodies
    tubes: tuple  # starts, ends, radii, bodies
    polygons: tuple  # corners, bodies, shapes, kinds


def draw_space(ax, scene, quantity="speed", periods=(0.0, 0.0), view=None):
    """Draw one picture; returns sentences about what is not there to draw."""
    view = view or View()
    axes = view.axes()
    missing = [f"no {name}.vtkhdf" for name in ("shapes", "contacts", "bodies") if getattr(scene, name) is None]
    if scene.bodies is None:
        raise ResultsError("a scene in space is drawn from its bodies: there is no bodies.vtkhdf")
    box = _box(scene, periods)
    solids = _solids(scene, axes, view, box)
    is_grain = scene.bodies.point_data["is_grain"] > 0
    corners = _corners(box) @ axes.T
    margin = 0.02 * np.ptp(corners[:, :2], axis=0).max()
    frame = np.column_stack([corners.min(axis=0) - margin, corners.max(axis=0) + margin])[:2].ravel()
    ax.set(aspect="equal", xlim=frame[:2], ylim=frame[2:])
    ax.set_axis_off()
    scale, colours = _colours(scene, quantity, is_grain, view)
    canvas = Canvas(frame, PIXELS)
    _paint(canvas, solids, is_grain, keep=True)
    outlines = _paint_walls(canvas, solids, is_grain, box, axes)
    radius = _middling_radius(scene, is_grain)
    edge = 0.55 * np.clip(radius * canvas.scale / canvas.FINE / 5, 0.0, 1.0)
    picture = canvas.image(colours, radius, edge)
    _draw_box(ax, box, axes, periods)
    if view.forces:
        picture[..., :3] = 0.25 * picture[..., :3] + 0.75
    ax.imshow(picture, extent=frame, origin="lower", zorder=2, interpolation="antialiased")
    ax.add_collection(LineCollection(outlines, colors="#6A6A6A", linewidths=0.7, alpha=0.6, zorder=3), autolim=False)
    if view.forces and scene.contacts is not None:
        scale = _draw_forces(ax, scene, axes, frame, radius, view)
    if scale is not None and scale.map is not None:
        _colour_bar(ax, scale)
    note = "" if scale is None or not scale.note else f"      {scale.note}"
    ax.set_title(f"t = {number(scene.time)} s{note}")
    return missing


def proportions(scene, periods=(0.0, 0.0), view=None):
    """Width over height of what is shown, within what fits on a page."""
    if scene.bodies is None:
        return 1.0
    corners = _corners(_box(scene, periods)) @ (view or View()).axes().T
    width, height = np.ptp(corners[:, :2], axis=0)
    return float(np.clip(width / height, 0.3, 3.5)) if height > 0 else 1.0


def _box(scene, periods):
    """Corners (low, high) of what is shown: all grains, and walls that are near them."""
    is_grain = scene.bodies.point_data["is_grain"] > 0
    radius = scene.bodies.point_data["radius"][:, None]
    low, high = scene.bodies.points - radius, scene.bodies.points + radius
    box = None
    if is_grain.any():
        box = np.array([low[is_grain].min(axis=0), high[is_grain].max(axis=0)])
    if scene.shapes is not None and len(scene.shapes.points):
        of_grain = _points_of_grains(scene)
        reach = np.asarray(scene.shapes.point_data["radius"])[:, None]
        low, high = scene.shapes.points - reach, scene.shapes.points + reach
        if of_grain.any():
            box = np.array([low[of_grain].min(axis=0), high[of_grain].max(axis=0)])
        if not of_grain.all():
            walls = np.array([low[~of_grain].min(axis=0), high[~of_grain].max(axis=0)])
            more = 0.2 * np.ptp(box, axis=0).max() if box is not None else 0
            box = walls if box is None else np.array([np.maximum(np.minimum(walls[0], box[0]), box[0] - more),
                                                      np.minimum(np.maximum(walls[1], box[1]), box[1] + more)])
    if box is None:
        box = np.array([low.min(axis=0), high.max(axis=0)])
    for axis, period in enumerate(periods):
        if period > 0:
            box[:, axis] = 0, period
    return box


def _points_of_grains(scene):
    """Which points of the shapes belong to grains."""
    shapes = scene.shapes
    is_grain = np.zeros(len(shapes.points), dtype=bool)
    is_grain[shapes.connectivity] = np.repeat(of_shapes(scene, "is_grain", 1) > 0, np.diff(shapes.offsets))
    return is_grain


def _corners(box):
    """The eight corners of a box; bit k of their number tells on which side of axis k."""
    return np.array([[box[(i >> k) & 1, k] for k in range(3)] for i in range(8)])


def _solids(scene, axes, view, box):
    """All shapes in the axes of the camera, without the grains that a cut removes."""
    bodies, shapes = scene.bodies, scene.shapes
    kept = _kept(bodies, view)
    none = np.zeros((0, 3))
    if shapes is None:
        rows = np.flatnonzero(kept)
        spheres = bodies.points[rows] @ axes.T, bodies.point_data["radius"][rows], rows
        return Solids(spheres, (none, none, [], []), ([], [], [], []))
    of_cell = rows_of(bodies.point_data["id"], shapes.cell_data["body"])
    kinds = np.asarray(shapes.cell_data["kind"])
    points = shapes.points @ axes.T
    cells = shapes.cells(VTK_VERTEX)
    cells = cells[kept[of_cell[cells]]]
    centres = shapes.connectivity[shapes.offsets[cells]]
    spheres = points[centres], shapes.point_data["radius"][centres], of_cell[cells]
    cells = shapes.cells(VTK_POLYGON)
    cells = cells[kept[of_cell[cells]]]
    tubes = _tubes(shapes, points, of_cell, cells[kinds[cells] == KIND_CYLINDER])
    cells = cells[kinds[cells] != KIND_CYLINDER]
    is_wall = bodies.point_data["is_grain"][of_cell[cells]] <= 0
    polygons = []
    for cell, wall in zip(cells, is_wall, strict=True):
        corners = shapes.connectivity[shapes.offsets[cell] : shapes.offsets[cell + 1]]
        polygons.append(_clipped(shapes.points[corners], box) @ axes.T if wall else points[corners])
    numbers = np.asarray(shapes.cell_data.get("shape", shapes.cell_data["body"]))
    return Solids(spheres, tubes, (polygons, of_cell[cells], numbers[cells], kinds[cells]))


def _kept(bodies, view):
    """Which bodies a cut leaves: walls, and grains beyond it."""
    kept = np.ones(len(bodies.points), dtype=bool)
    if view.cut is not None:
        axis, place = view.cut
        side = np.sign(view.axes()[2, axis]) or 1.0
        kept = (side * (bodies.points[:, axis] - place) <= 0) | (bodies.point_data["is_grain"] <= 0)
    return kept


def _tubes(shapes, points, of_cell, cells):
    """Cylinders with round ends, taken back from their polygons: the first and the last point are the poles."""
    numbers = np.asarray(shapes.cell_data["shape"])[cells]
    _, firsts = np.unique(numbers, return_index=True)
    starts, ends, radii, rows = [], [], [], []
    bounds = np.append(firsts, len(cells))
    for first, after in zip(bounds[:-1], bounds[1:], strict=True):
        own = shapes.connectivity[shapes.offsets[cells[first]] : shapes.offsets[cells[after - 1] + 1]]
        low, high = points[own.min()], points[own.max()]
        middle, way = (low + high) / 2, (high - low) / np.linalg.norm(high - low)
        apart = points[own.min() : own.max() + 1] - middle
        radius = np.linalg.norm(apart - (apart @ way)[:, None] * way, axis=1).max()
        starts.append(low + radius * way)
        ends.append(high - radius * way)
        radii.append(radius)
        rows.append(of_cell[cells[first]])
    return np.reshape(starts, (-1, 3)), np.reshape(ends, (-1, 3)), radii, rows


def _clipped(corners, box):
    """The part of a convex polygon within a box."""
    for axis in range(3):
        for sign, bound in ((1.0, box[0, axis]), (-1.0, box[1, axis])):
            if not len(corners):
                return np.zeros((3, 3))
            inside = sign * (corners[:, axis] - bound)
            if inside.min() >= 0:
                continue
            kept = []
            for a, b, da, db in zip(corners, np.roll(corners, -1, axis=0), inside, np.roll(inside, -1), strict=True):
                if da >= 0:
                    kept.append(a)
                if da * db < 0:
                    kept.append(a + (b - a) * da / (da - db))
            corners = np.array(kept).reshape(-1, 3)
    return corners if len(corners) else np.zeros((3, 3))


def _paint(canvas, solids, is_grain, keep):
    """Paint grains (keep) or round walls (not keep)."""
    for adder, parts in ((canvas.add_spheres, solids.spheres), (canvas.add_tubes, solids.tubes)):
        chosen = is_grain[np.asarray(parts[-1], dtype=int)] == keep
        adder(*(np.asarray(part)[chosen] for part in parts))
    if keep:
        corners, rows, _, _ = solids.polygons
        chosen = np.flatnonzero(is_grain[np.asarray(rows, dtype=int)])
        canvas.add_polygons([corners[k] for k in chosen], np.asarray(rows)[chosen] if len(chosen) else [])


def _paint_walls(canvas, solids, is_grain, box, axes):
    """Paint walls that hide few grains; returns the outlines of the others."""
    corners, rows, shapes, kinds = solids.polygons
    rows = np.asarray(rows, dtype=int)
    outlines = []
    grains = np.count_nonzero(canvas.item >= 0)
    middle = axes @ box.mean(axis=0)
    walls = np.flatnonzero(~is_grain[rows]) if len(rows) else []
    shown = []
    for shape in np.unique(np.asarray(shapes)[walls]):
        cells = [k for k in walls if shapes[k] == shape]
        faces = [corners[k] for k in cells]
        # The inside of a hollow cylinder is its only side: its front half is left out by itself.
        if kinds[cells[0]] != KIND_HOLLOW and canvas.hidden_by(faces) > HIDES * grains:
            outlines += [_closed(face) for face in faces if _faces(face, middle)]
        else:
            shown += cells
        if kinds[cells[0]] == KIND_HOLLOW:
            outlines += [face[[i, i + 1], :2] for face in faces if len(face) == 4 for i in (0, 2)]
    canvas.add_polygons([corners[k] for k in shown], rows[shown] if len(shown) else [])
    _paint(canvas, solids, is_grain, keep=False)
    return outlines


def _faces(face, middle):
    """Does the outer side of a face look towards a point, away from the viewer?"""
    normal = normal_of(face)
    return normal @ (middle - face[0]) > 0 and normal[2] < 0


def _closed(face):
    return np.vstack([face, face[:1]])[:, :2]


def _colours(scene, quantity, is_grain, view):
    """The scale of the colours, and red, green and blue of every body."""
    n = len(scene.bodies.points)
    colours = np.tile(to_rgb(GRAIN), (n, 1)).astype(np.float32)
    colours[~is_grain] = to_rgb(WALL)
    values = None if quantity == "none" or view.forces else of_bodies(scene, quantity)
    if values is None or not is_grain.any():
        return None, colours
    values = np.asarray(values, dtype=float)[is_grain]
    scale = colouring(values, quantity, FILL)
    if scale.map is not None:
        colours[is_grain] = scale.map(scale.norm(values))[:, :3]
    return scale, colours


def _middling_radius(scene, is_grain):
    radii = scene.bodies.point_data["radius"]
    return float(np.median(radii[is_grain] if is_grain.any() else radii))


def _draw_forces(ax, scene, axes, frame, radius, view):
    """Forces as bars from grain to grain; returns their scale. Points of one pair are one force."""
    contacts = scene.contacts
    cells = np.flatnonzero(carrying(contacts))
    if not len(cells):
        ax.text(0.01, 0.99, "no contact carries force", transform=ax.transAxes, va="top", fontsize=8)
        return None
    data = contacts.cell_data
    pairs, first, own = np.unique(np.column_stack([data["candidate"], data["antagonist"]])[cells], axis=0,
                                  return_index=True, return_inverse=True)
    force = np.zeros((len(pairs), 3))
    np.add.at(force, np.ravel(own), np.asarray(data["force"], dtype=float)[cells])
    force = np.linalg.norm(force, axis=1)
    ends = contacts.points[contacts.connectivity].reshape(-1, 2, 3)[cells[first]]
    kept = _kept(scene.bodies, view)
    rows = rows_of(scene.bodies.point_data["id"], pairs.ravel()).reshape(-1, 2)
    shown = kept[rows].all(axis=1)
    # A tail of rare large forces must not thin out the chains: widths saturate at the largest hundredth.
    thick = float(np.quantile(force, 0.99))
    share = np.clip(force / thick, 0, 1)[shown]
    order = np.argsort(share)
    canvas = Canvas(frame, PIXELS)
    least = 0.7 / canvas.scale
    canvas.add_tubes(*(ends[shown][order][:, k] @ axes.T for k in (0, 1)), np.maximum(0.45 * radius * share[order], least),
                     np.arange(len(order)))
    colours = FORCES(share[order])[:, :3].astype(np.float32)
    ax.imshow(canvas.image(colours, 0.5 * radius, 0.0), extent=frame, origin="lower", zorder=4, interpolation="antialiased")
    return colouring(force, "force", FORCES)


def _colour_bar(ax, scale):
    bar = ax.figure.colorbar(ScalarMappable(scale.norm, scale.map), cax=ax.inset_axes([1.03, 0.12, 0.025, 0.72]),
                             label=scale.label, extend=scale.extend, ticks=scale.ticks)
    bar.outline.set_linewidth(0.5)


def _draw_box(ax, box, axes, periods):
    """The far edges of the box, and ticks at three of its edges."""
    corners = _corners(box)
    flat = corners @ axes.T
    far = [int(axes[2, k] < 0) for k in range(3)]  # side of each axis that is farther away
    dashes = [period > 0 for period in (*periods, 0)]
    for i in range(8):
        for k in range(3):
            if (i >> k) & 1:
                continue
            others = [m for m in range(3) if m != k]
            on_far_side = any(((i >> m) & 1) == far[m] for m in others)
            if on_far_side:
                ends = flat[[i, i | 1 << k], :2]
                ax.plot(*ends.T, color="#BDBDBD", linewidth=0.7, zorder=1, linestyle="--" if dashes[k] else "-")
    bottom = 0 if axes[2, 2] >= -1e-9 else 1
    near = [1 - side for side in far]
    size = np.ptp(flat[:, :2], axis=0).max()
    middle = flat[:, :2].mean(axis=0)
    _draw_axis(ax, 0, [None, near[1], bottom], box, axes, size, middle)
    _draw_axis(ax, 1, [near[0], None, bottom], box, axes, size, middle)
    # The upright edge that is farthest to the left.
    left = min(((a, b) for a in (0, 1) for b in (0, 1)), key=lambda s: flat[s[0] | s[1] << 1, 0])
    _draw_axis(ax, 2, [*left, None], box, axes, size, middle)


def _draw_axis(ax, k, sides, box, axes, size, middle):
    """An edge of the box along axis k, with ticks that point away from the scene."""
    base = np.array([0.0 if side is None else box[side, m] for m, side in enumerate(sides)])
    def place(x):
        point = base.copy()
        point[k] = x
        return (axes @ point)[:2]
    start, end = place(box[0, k]), place(box[1, k])
    if np.linalg.norm(end - start) < 0.08 * size:
        return  # seen along itself
    way = (end - start) / np.linalg.norm(end - start)
    out = np.array([way[1], -way[0]])
    if out @ ((start + end) / 2 - middle) < 0:
        out = -out
    steps = max(2, round(6 * np.linalg.norm(end - start) / size))
    ticks = [x for x in MaxNLocator(steps, steps=[1, 2, 2.5, 5, 10]).tick_values(*box[:, k]) if box[0, k] <= x <= box[1, k]]
    lines = [np.array([start, end])] + [np.array([place(x), place(x) + 0.012 * size * out]) for x in ticks]
    ax.add_collection(LineCollection(lines, colors="#444444", linewidths=0.8, zorder=3, clip_on=False), autolim=False)
    align = {"ha": "left" if out[0] > 0.5 else "right" if out[0] < -0.5 else "center",
             "va": "bottom" if out[1] > 0.5 else "top" if out[1] < -0.5 else "center"}
    for x in ticks:
        ax.text(*(place(x) + 0.02 * size * out), f"{x:g}", fontsize=8, zorder=3, **align)
    ax.text(*((start + end) / 2 + 0.085 * size * out), f"{'xyz'[k]} [m]", fontsize=9, zorder=3, **align)

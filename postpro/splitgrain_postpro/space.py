"""Draw a scene in space: grains as solid bodies, walls that do not hide them, forces as bars between grains.

The view is a parallel projection, so that lengths can be compared; the axes with their units stand at the edges of a
box about the scene.
"""

from dataclasses import dataclass, replace

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LinearSegmentedColormap, to_rgb
from matplotlib.collections import LineCollection
from matplotlib.ticker import MaxNLocator

from .command_line import AZIMUTH, ELEVATION
from .errors import ResultsError
from .frame import Frame
from .lattice import fold_bodies
from .quantities import bonds, colouring, links, of_bodies, of_shapes, rows_of
from .raster import Canvas, normal_of
from .results import Scene
from .style import BLACK, BLUE, VERMILION, draw_bonds, number
from .thrust import draw_thrust, lines_of_force, resultants, say_no_force
from .vtkhdf import VTK_POLYGON, VTK_VERTEX

PIXELS = 1500
GRAIN, WALL = "#C6D0D9", "#F8F7F4"
# Bodies that are held or driven: a sleeper, a tine.
HELD = "#8E8A86"
# Shapes of walls, which a picture may cut short or leave out; any other shape is drawn whole wherever it is.
WALLS = ("plane", "hollow cylinder")
# Light enough everywhere for shades to be seen.
FILL = LinearSegmentedColormap.from_list("solid", ["#6C8FD0", "#5BB8CE", "#93D3A8", "#E6E78F", "#F4AE45", "#DB5530"])
FORCES = LinearSegmentedColormap.from_list("forces", ["#F2C14E", "#E8743B", "#C02942", "#53113B"])
# Part of the grains that a wall may hide; one that hides more is drawn as its outline.
HIDES = 0.08
# Part of a radius by which a contact point may lie behind what is drawn: between round grains it lies in a crevice.
CREVICE = 0.3


@dataclass
class View:
    """How to look at a scene in space."""

    azimuth: float = AZIMUTH  # of the viewer, from x towards y [degrees]
    elevation: float = ELEVATION  # of the viewer above the horizon [degrees]
    forces: bool = False  # forces between grains, which are pale then
    thrust: bool = False  # thrust lines through the centres of pressure, over pale grains
    cut: tuple | None = None  # (axis, place [m]): grains on the viewer's side are left out

    def axes(self) -> np.ndarray:
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
    faces: tuple  # of grains: points, connectivity, offsets, bodies
    polygons: tuple  # of all others: corners, bodies, shapes, kinds


def draw_space(
    ax: Axes, scene: Scene, quantity: str = "speed", periods: tuple[float, float] = (0.0, 0.0), view: View | None = None,
    common: Frame | None = None,
) -> list[str]:
    """Draw one picture, perhaps with what it has in common with others; returns sentences about what is not there to draw."""
    view, common = view or View(), common or Frame()
    axes = view.axes()
    missing = [f"no {name}.vtkhdf" for name in ("shapes", "contacts", "bodies") if getattr(scene, name) is None]
    if scene.bodies is None:
        raise ResultsError("a scene in space is drawn from its bodies: there is no bodies.vtkhdf")
    scene = _folded(scene)
    walls = _wall_faces(scene) if scene.shapes is not None else {}
    box = _box(scene, periods, walls) if common.box is None else common.box
    solids = _solids(scene, axes, view, box, walls)
    is_grain = scene.bodies.point_data["is_grain"] > 0
    corners = _corners(box, _tilt(scene)) @ axes.T
    margin = 0.02 * np.ptp(corners[:, :2], axis=0).max()
    if max(periods) > 0 or scene.cell is not None:  # grains stick out of the period
        margin = max(margin, 1.05 * scene.bodies.point_data["radius"][is_grain].max(initial=0))
    frame = np.column_stack([corners.min(axis=0) - margin, corners.max(axis=0) + margin])[:2].ravel()
    ax.set(aspect="equal", xlim=frame[:2], ylim=frame[2:])
    ax.set_axis_off()
    scale, colours = _colours(scene, quantity, is_grain, view, common.scale)
    canvas = Canvas(frame, common.pixels or PIXELS)
    _paint(canvas, solids, is_grain, keep=True)
    outlines = _paint_walls(canvas, solids, is_grain)
    radius = _middling_radius(scene, is_grain)
    edge = 0.55 * np.clip(radius * canvas.scale / canvas.FINE / 5, 0.0, 1.0)
    picture = canvas.image(colours, radius, edge)
    _draw_box(ax, box, axes, periods if scene.cell is None else np.diag(scene.cell), _tilt(scene))
    if view.forces or view.thrust:
        pale = 0.75 if view.forces else 0.4
        picture[..., :3] = (1 - pale) * picture[..., :3] + pale
    ax.imshow(picture, extent=frame, origin="lower", zorder=2, interpolation="antialiased")
    ax.add_collection(LineCollection(outlines, colors="#6A6A6A", linewidths=0.7, alpha=0.6, zorder=3), autolim=False)
    if scene.contacts is not None:
        _draw_links(ax, scene, axes)
        _draw_bonds(ax, scene, axes, canvas, radius, view)
    if view.thrust and scene.contacts is not None:
        draw_thrust(ax, scene, lambda points: (points @ axes.T)[..., :2], lambda line: line)
    if view.forces and scene.contacts is not None:
        scale = _draw_forces(ax, scene, axes, frame, radius, view, common)
    if scale is not None and scale.map is not None:
        _colour_bar(ax, scale)
    note = "" if scale is None or not scale.note else f"      {scale.note}"
    ax.set_title(f"t = {number(scene.time)} s{note}")
    return missing


def proportions(
    scene: Scene, periods: tuple[float, float] = (0.0, 0.0), view: View | None = None, box: np.ndarray | None = None,
) -> float:
    """Width over height of what is shown, within what fits on a page."""
    if scene.bodies is None:
        return 1.0
    corners = _corners(_box(scene, periods) if box is None else box, _tilt(scene)) @ (view or View()).axes().T
    width, height = np.ptp(corners[:, :2], axis=0)
    return float(np.clip(width / height, 0.3, 3.5)) if height > 0 else 1.0


def box_of(scene: Scene, periods: tuple[float, float]) -> np.ndarray | None:
    """Corners of what a picture shows; None of a periodic cell, which is its own box in every picture."""
    return None if scene.cell is not None or scene.bodies is None else _box(scene, periods)


def _box(scene, periods, walls=None):
    """Corners (low, high) of what is shown: all bodies, and walls that are near them; of a tilted cell those before the tilt."""
    if scene.cell is not None:
        return np.array([np.zeros(3), np.diag(scene.cell)])
    grains, others = _extents(scene)
    if walls is None and scene.shapes is not None:
        walls = _wall_faces(scene)
    if walls:
        corners = np.concatenate(list(walls.values()))
        others = _joined(others, np.array([corners.min(axis=0), corners.max(axis=0)]))
    box = others if grains is None else grains
    if grains is not None and others is not None:
        more = 0.2 * np.ptp(grains, axis=0).max()
        box = np.array([np.maximum(np.minimum(others[0], grains[0]), grains[0] - more),
                        np.minimum(np.maximum(others[1], grains[1]), grains[1] + more)])
    for axis, period in enumerate(periods):
        if period > 0:
            box[:, axis] = 0, period
    return box


def _extents(scene):
    """Corners of a box about all bodies, held ones included, and of one about all hollow walls; None where there are none."""
    if scene.shapes is None:
        points, reach = scene.bodies.points, scene.bodies.point_data["radius"]
        is_grain = scene.bodies.point_data["is_grain"] > 0
        is_hollow = is_grain
    else:
        points, reach = scene.shapes.points, scene.shapes.point_data["radius"]
        kinds = scene.shapes.kinds()
        is_grain = _points_of(scene.shapes, (of_shapes(scene, "is_grain", 1) > 0) | ~np.isin(kinds, WALLS))
        is_hollow = _points_of(scene.shapes, kinds == "hollow cylinder")
    reach = np.asarray(reach)[:, None]
    return tuple(
        np.array([(points - reach)[own].min(axis=0), (points + reach)[own].max(axis=0)]) if own.any() else None
        for own in (is_grain, is_hollow)
    )


def _joined(one, other):
    """A box about two boxes, of which the first may be missing."""
    return other if one is None else np.array([np.minimum(one[0], other[0]), np.maximum(one[1], other[1])])


def _points_of(shapes, cells):
    """Which points of the shapes these cells use."""
    used = np.zeros(len(shapes.points), dtype=bool)
    used[shapes.connectivity[np.repeat(cells, np.diff(shapes.offsets))]] = True
    return used


def _wall_faces(scene):
    """Faces of planes that are drawn, by cell.

    Of a plane that holds the grains in, only the face before which they are is drawn, as far as it bounds the room
    that is left by all such faces: so a box looks the same however thick its walls are and however they overlap.
    """
    shapes = scene.shapes
    is_plane = shapes.kinds() == "plane"
    planes = np.flatnonzero(is_plane & (of_shapes(scene, "is_grain", 1) <= 0))
    numbers = np.asarray(shapes.cell_data["shape"])[planes]
    grains = scene.bodies.points[scene.bodies.point_data["is_grain"] > 0]
    faces, holding = {}, {}
    for shape in np.unique(numbers):
        own = {cell: _face(shapes, cell) for cell in planes[numbers == shape]}
        before = {cell: face for cell, face in own.items() if _all_before(grains, face)}
        holding |= before
        faces |= before or own
    bounds = {cell: (normal_of(face), face[0]) for cell, face in holding.items()}
    for cell, face in holding.items():
        faces[cell] = _clipped(face, [bound for other, bound in bounds.items() if other != cell])
    return faces


def _all_before(grains, face):
    """Are nearly all these centres on the outer side of a face?"""
    return len(grains) > 0 and np.mean((grains - face[0]) @ normal_of(face) > 0) > 0.97


def _face(shapes, cell):
    """Corners of a cell."""
    return shapes.points[shapes.connectivity[shapes.offsets[cell] : shapes.offsets[cell + 1]]]


def _corners(box, tilt=0.0):
    """The eight corners of a box; bit k of their number gives the side of axis k. Those at the upper y are moved by the tilt."""
    return np.array([[box[(i >> k) & 1, k] + (tilt * ((i >> 1) & 1) if k == 0 else 0) for k in range(3)] for i in range(8)])


def _tilt(scene):
    """Way of the upper face in y along x [m]; zero where there is no periodic cell."""
    return 0.0 if scene.cell is None else scene.cell[1, 0]


def _folded(scene):
    """The scene with the centres of all bodies in the periodic cell, and with contacts where their candidates are."""
    if scene.cell is None or scene.bodies is None:
        return scene
    bodies, shapes, contacts = scene.bodies, scene.shapes, scene.contacts
    moves = fold_bodies(bodies.points, scene.cell)
    if shapes is not None:
        of_cell = rows_of(bodies.point_data["id"], shapes.cell_data["body"])
        points = shapes.points.copy()
        points[shapes.connectivity] += np.repeat(moves[of_cell], np.diff(shapes.offsets), axis=0)
        shapes = replace(shapes, points=points)
    if contacts is not None and len(contacts.connectivity):
        starts = contacts.points[contacts.connectivity].reshape(-1, 2, 3)[:, 0]
        points = contacts.points.copy()
        ways = fold_bodies(starts, scene.cell)
        points[contacts.connectivity] += np.repeat(ways, 2, axis=0)
        data = dict(contacts.cell_data)
        if "point" in data:
            data["point"] = np.asarray(data["point"], dtype=float) + ways
        contacts = replace(contacts, points=points, cell_data=data)
    return replace(scene, bodies=replace(bodies, points=bodies.points + moves), shapes=shapes, contacts=contacts)


def _solids(scene, axes, view, box, walls):
    """All shapes in the axes of the camera, without the grains that a cut removes."""
    bodies, shapes = scene.bodies, scene.shapes
    kept = _kept(bodies, view)
    none = np.zeros((0, 3))
    if shapes is None:
        rows = np.flatnonzero(kept)
        spheres = bodies.points[rows] @ axes.T, bodies.point_data["radius"][rows], rows
        return Solids(spheres, (none, none, [], []), (none, [], [0], []), ([], [], [], []))
    of_cell = rows_of(bodies.point_data["id"], shapes.cell_data["body"])
    kinds = shapes.kinds()
    points = shapes.points @ axes.T
    cells = shapes.cells(VTK_VERTEX)
    cells = cells[kept[of_cell[cells]]]
    centres = shapes.connectivity[shapes.offsets[cells]]
    spheres = points[centres], shapes.point_data["radius"][centres], of_cell[cells]
    cells = shapes.cells(VTK_POLYGON)
    cells = cells[kept[of_cell[cells]]]
    tubes = _tubes(shapes, points, of_cell, cells[kinds[cells] == "cylinder"])
    cells = cells[kinds[cells] != "cylinder"]
    is_grain = bodies.point_data["is_grain"][of_cell] > 0
    own = cells[is_grain[cells]]
    sizes = np.diff(shapes.offsets)[own]
    offsets = np.concatenate([[0], np.cumsum(sizes)])
    places = np.repeat(shapes.offsets[own] - offsets[:-1], sizes) + np.arange(offsets[-1])
    faces = points, shapes.connectivity[places], offsets, of_cell[own]
    cells = np.array([k for k in cells[~is_grain[cells]] if kinds[k] != "plane" or k in walls], dtype=int)
    sides = [(sign * unit, bound) for sign, bound in ((1.0, box[0]), (-1.0, box[1])) for unit in np.eye(3)]
    polygons = []
    for cell in cells:
        face = walls.get(cell, _face(shapes, cell))
        polygons.append((_clipped(face, sides) if kinds[cell] in WALLS else face) @ axes.T)
    numbers = np.asarray(shapes.cell_data["shape"])
    return Solids(spheres, tubes, faces, (polygons, of_cell[cells], numbers[cells], kinds[cells]))


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


def _clipped(corners, bounds):
    """The part of a convex polygon before planes (normal, point); a polygon without area where nothing is left."""
    for normal, point in bounds:
        before = (corners - point) @ normal
        before[np.abs(before) < 1e-9 * np.ptp(corners, axis=0).max()] = 0
        if before.min() >= 0:
            continue
        kept = []
        for a, b, da, db in zip(corners, np.roll(corners, -1, axis=0), before, np.roll(before, -1), strict=True):
            if da >= 0:
                kept.append(a)
            if da * db < 0:
                kept.append(a + (b - a) * da / (da - db))
        if len(kept) < 3:
            return np.tile(corners[:1], (3, 1))
        corners = np.array(kept)
    return corners


def _paint(canvas, solids, is_grain, keep):
    """Paint grains (keep) or round walls (not keep)."""
    for adder, parts in ((canvas.add_spheres, solids.spheres), (canvas.add_tubes, solids.tubes)):
        chosen = is_grain[np.asarray(parts[-1], dtype=int)] == keep
        adder(*(np.asarray(part)[chosen] for part in parts))
    if keep:
        canvas.add_faces(*solids.faces)


def _paint_walls(canvas, solids, is_grain):
    """Paint walls that hide few grains; returns the outlines of the others."""
    corners, rows, shapes, kinds = solids.polygons
    rows = np.asarray(rows, dtype=int)
    outlines = []
    grains = np.count_nonzero(canvas.item >= 0)
    shown = []
    for shape in np.unique(shapes):
        cells = np.flatnonzero(np.asarray(shapes) == shape).tolist()
        faces = [corners[k] for k in cells]
        if kinds[cells[0]] not in WALLS:
            shown += cells
            continue
        # The inside of a hollow cylinder is its only side: its front half is left out by itself.
        if kinds[cells[0]] != "hollow cylinder" and canvas.hidden_by(faces) > HIDES * grains:
            outlines += [_closed(face) for face in faces]
            continue
        shown += cells
        if kinds[cells[0]] == "plane" and len(faces) == 1 and normal_of(faces[0])[2] < 0:
            outlines.append(_closed(faces[0]))
        if kinds[cells[0]] == "hollow cylinder":
            outlines += [face[[i, i + 1], :2] for face in faces if len(face) == 4 for i in (0, 2)]
    smooth = [kinds[b] == "hollow cylinder" and shapes[a] == shapes[b] for a, b in zip(shown[:1] + shown[:-1], shown, strict=True)]
    canvas.add_polygons([corners[k] for k in shown], rows[shown] if len(shown) else [], smooth)
    _paint(canvas, solids, is_grain, keep=False)
    return outlines


def _closed(face):
    return np.vstack([face, face[:1]])[:, :2]


def _colours(scene, quantity, is_grain, view, common):
    """The scale of the colours, and red, green and blue of every body."""
    n = len(scene.bodies.points)
    colours = np.tile(to_rgb(GRAIN), (n, 1)).astype(np.float32)
    colours[~is_grain] = to_rgb(WALL)
    colours[_held(scene, is_grain)] = to_rgb(HELD)
    values = None if quantity == "none" or view.forces or view.thrust else of_bodies(scene, quantity)
    if values is None or not is_grain.any():
        return None, colours
    values = np.asarray(values, dtype=float)[is_grain]
    scale = common or colouring(values, quantity, FILL)
    if scale.map is not None:
        colours[is_grain] = scale.map(scale.norm(values))[:, :3]
    return scale, colours


def _held(scene, is_grain):
    """Which bodies are held or driven and have another shape than walls."""
    held = np.zeros(len(is_grain), dtype=bool)
    if scene.shapes is not None:
        cells = ~np.isin(scene.shapes.kinds(), WALLS)
        held[rows_of(scene.bodies.point_data["id"], scene.shapes.cell_data["body"][cells])] = True
    return held & ~is_grain


def _middling_radius(scene, is_grain):
    radii = scene.bodies.point_data["radius"]
    return float(np.median(radii[is_grain] if is_grain.any() else radii))


def _draw_links(ax, scene, axes):
    """Links as lines over all else: pulling ones blue, pushing ones red, as wide as their force; slack ones thin."""
    cells, tension = links(scene.contacts)
    if not len(cells):
        return
    ends = scene.contacts.points[scene.contacts.connectivity].reshape(-1, 2, 3)[cells] @ axes.T
    widest = np.abs(tension).max(initial=0.0)
    widths = 0.6 + 2.4 * (np.abs(tension) / widest if widest > 0 else 0 * tension)
    colours = np.where(tension > 0, BLUE, np.where(tension < 0, VERMILION, BLACK))
    ax.add_collection(LineCollection(ends[:, :, :2], linewidths=widths, colors=colours, zorder=5), autolim=False)


def _draw_bonds(ax, scene, axes, canvas, radius, view):
    """Bonds of cohesive zones at their contact points, those that nothing hides."""
    cells, damage = bonds(scene.contacts)
    if not len(cells):
        return
    points = np.asarray(scene.contacts.cell_data["point"], dtype=float)[cells] @ axes.T
    data = scene.contacts.cell_data
    rows = rows_of(scene.bodies.point_data["id"], np.column_stack([data["candidate"], data["antagonist"]])[cells].ravel())
    seen = _kept(scene.bodies, view)[rows].reshape(-1, 2).all(axis=1) & canvas.sees(points, CREVICE * radius)
    diameter = 2 * radius * ax.get_window_extent().width * 72 / ax.figure.dpi / (canvas.box[1] - canvas.box[0])  # as drawn [pt]
    draw_bonds(ax, points[seen, :2], damage[seen], np.clip(0.12 * diameter, 2.0, 5.0))


def thickest_force(scene: Scene) -> float | None:
    """Force of the thickest bar of one picture [N]; None where there is none."""
    force = np.linalg.norm(resultants(scene).force, axis=1) if scene.contacts is not None else []
    return float(np.quantile(force, 0.99)) if len(force) else None


def _draw_forces(ax, scene, axes, frame, radius, view, common):
    """Forces as bars from grain to grain, through the centre of pressure of each pair; returns their scale."""
    found = resultants(scene)
    if not len(found.force):
        say_no_force(ax)
        return None
    force, lines = np.linalg.norm(found.force, axis=1), lines_of_force(found)
    shown = _kept(scene.bodies, view)[found.bodies].all(axis=1)
    # A tail of rare large forces must not thin out the chains: widths saturate at the largest hundredth.
    thick = common.force or float(np.quantile(force, 0.99))
    share = np.clip(force / thick, 0, 1)[shown]
    order = np.argsort(share)
    canvas = Canvas(frame, common.pixels or PIXELS)
    least = 0.7 / canvas.scale
    for k in (0, 1):
        canvas.add_tubes(*(lines[shown][order][:, m] @ axes.T for m in (k, k + 1)), np.maximum(0.45 * radius * share[order], least),
                         np.arange(len(order)))
    colours = FORCES(share[order])[:, :3].astype(np.float32)
    ax.imshow(canvas.image(colours, 0.5 * radius, 0.0), extent=frame, origin="lower", zorder=4, interpolation="antialiased")
    # The scale of the colours ends where bars are thickest.
    return colouring(force if common.force is None else np.array([0.0, common.force]), "force", FORCES)


def _colour_bar(ax, scale):
    bar = ax.figure.colorbar(ScalarMappable(scale.norm, scale.map), cax=ax.inset_axes([1.03, 0.12, 0.025, 0.72]),
                             label=scale.label, extend=scale.extend, ticks=scale.ticks)
    bar.outline.set_linewidth(0.5)


def _draw_box(ax, box, axes, periods, tilt):
    """The far edges of the box, and ticks at three of its edges."""
    corners = _corners(box, tilt)
    flat = corners @ axes.T
    far = [int(axes[2, k] < 0) for k in range(3)]  # side of each axis that is farther away
    dashes = [period > 0 for period in (*periods, 0)][:3]
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
    _draw_axis(ax, 0, [None, near[1], bottom], box, axes, size, middle, tilt)
    _draw_axis(ax, 1, [near[0], None, bottom], box, axes, size, middle, tilt)
    # The upright edge that is farthest to the left.
    left = min(((a, b) for a in (0, 1) for b in (0, 1)), key=lambda s: flat[s[0] | s[1] << 1, 0])
    _draw_axis(ax, 2, [*left, None], box, axes, size, middle, tilt)


def _draw_axis(ax, k, sides, box, axes, size, middle, tilt):
    """An edge of the box along axis k, with ticks that point away from the scene."""
    base = np.array([0.0 if side is None else box[side, m] for m, side in enumerate(sides)])
    def place(x):
        point = base.copy()
        point[k] = x
        point[0] += tilt * (point[1] - box[0, 1]) / np.ptp(box[:, 1])
        return (axes @ point)[:2]
    start, end = place(box[0, k]), place(box[1, k])
    if np.linalg.norm(end - start) < 0.08 * size:
        return  # seen along itself
    way = (end - start) / np.linalg.norm(end - start)
    out = np.array([way[1], -way[0]])
    if out @ ((start + end) / 2 - middle) < 0:
        out = -out
    steps = max(2, round(9 * np.linalg.norm(end - start) / size))
    ticks = [x for x in MaxNLocator(steps, steps=[1, 2, 2.5, 5, 10]).tick_values(*box[:, k]) if box[0, k] <= x <= box[1, k]]
    lines = [np.array([start, end])] + [np.array([place(x), place(x) + 0.012 * size * out]) for x in ticks]
    ax.add_collection(LineCollection(lines, colors="#444444", linewidths=0.8, zorder=3, clip_on=False), autolim=False)
    align = {"ha": "left" if out[0] > 0.15 else "right" if out[0] < -0.15 else "center",
             "va": "bottom" if out[1] > 0.5 else "top" if out[1] < -0.5 else "center"}
    for x in ticks:
        ax.text(*(place(x) + 0.02 * size * out), f"{x:g}", fontsize=8, zorder=3, **align)
    ax.text(*((start + end) / 2 + 0.085 * size * out), f"{'xyz'[k]} [m]", fontsize=9, zorder=3, **align)

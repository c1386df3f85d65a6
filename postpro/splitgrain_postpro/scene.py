"""Draw the scene: grains filled by a quantity, walls grey, force chains as lines as wide as the force they carry."""

from collections.abc import Callable

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.patches import Polygon

from . import space
from .frame import Frame
from .lattice import Lattice
from .quantities import QUANTITIES, between_ranks, bonds, carrying, colouring, is_in_space, links, of_bodies, of_shapes
from .results import Scene
from .space import View
from .style import BLACK, BLUE, GRAIN, VERMILION, WALL, draw_bonds, number
from .thrust import draw_thrust, lines_of_force, resultants, say_no_force
from .vtkhdf import VTK_POLY_LINE, VTK_POLYGON

# Shapes of walls, which a picture may cut short; any other shape is drawn whole wherever it is.
WALLS = ("segment", "hollow disk")

__all__ = ["QUANTITIES", "box_of", "draw_scene", "draw_split", "proportions"]


def draw_split(ax: Axes, scene: Scene, periods: tuple[float, float] = (0.0, 0.0), view: View | None = None) -> list[str]:
    """Draw grains in the colours of their ranks and, in the plane, the contacts between ranks as lines."""
    missing = draw_scene(ax, scene, "rank", periods, view, draw_contacts=_draw_interface)
    data = scene.bodies.point_data if scene.bodies is not None else {}
    if "rank" not in data or scene.contacts is None:
        return missing
    cells, count = between_ranks(scene)
    parts = np.unique(np.asarray(data["rank"])[np.asarray(data["is_grain"]) > 0])
    ax.set_title(f"{len(parts)} parts, {len(cells)} of {count} contacts between them ({100 * len(cells) / max(count, 1):.1f} %)")
    return missing


def draw_scene(
    ax: Axes, scene: Scene, quantity: str = "speed", periods: tuple[float, float] = (0.0, 0.0), view: View | None = None,
    draw_contacts: Callable | None = None, common: Frame | None = None,
) -> list[str]:
    """Draw one picture of a run, perhaps with what it has in common with others; returns sentences about what is not there to draw."""
    if is_in_space(scene):
        return space.draw_space(ax, scene, quantity, periods, view, common)
    lattice = Lattice.of(periods[0], scene.cell)
    missing = []
    common = common or Frame()
    look, view = view or View(), _view(scene, lattice) if common.box is None else common.box
    if view is not None:
        _set_view(ax, view)
    if scene.shapes is None:
        missing.append("no shapes.vtkhdf")
    else:
        _draw_shapes(ax, scene, quantity, lattice, view, common.scale)
    if scene.contacts is None:
        missing.append("no contacts.vtkhdf")
    elif view is not None and quantity != "layer":  # lines of forces would hide the layers
        if draw_contacts is not None:
            draw_contacts(ax, scene, lattice, view)
        elif look.thrust and scene.bodies is not None:
            draw_thrust(ax, scene, lambda points: points[..., :2], lattice.straight)
        else:
            _draw_forces(ax, scene, lattice, view, common.force, look.forces and scene.bodies is not None)
            _draw_bonds(ax, scene, lattice, view)
    if scene.bodies is None:
        missing.append("no bodies.vtkhdf")
    elif scene.shapes is None:
        _draw_centres(ax, scene, quantity, lattice)
    _draw_frame(ax, scene, lattice, view)
    return missing


def box_of(scene: Scene, periods: tuple[float, float] = (0.0, 0.0)) -> np.ndarray | None:
    """Box of what a picture shows; None where it is that of a periodic cell."""
    if is_in_space(scene):
        return space.box_of(scene, periods)
    lattice = Lattice.of(periods[0], scene.cell)
    return None if lattice.is_cell else _view(scene, lattice)


def proportions(
    scene: Scene, periods: tuple[float, float] = (0.0, 0.0), view: View | None = None, box: np.ndarray | None = None,
) -> float:
    """Width over height of what is shown, within what fits on a page."""
    if is_in_space(scene):
        return space.proportions(scene, periods, view, box)
    view = _view(scene, Lattice.of(periods[0], scene.cell)) if box is None else box
    if view is None or not view[3] > view[2]:
        return 1.0
    return float(np.clip((view[1] - view[0]) / (view[3] - view[2]), 0.3, 3.5))


def _view(scene, lattice):
    """Box to show (x low, x high, y low, y high): all bodies, and walls that are near them; or the periodic cell."""
    if lattice.is_cell:
        return _with_margin(_box(lattice.corners))
    grains, walls = _boxes(scene)
    if grains is None:
        return walls
    box = grains.copy()
    reach = 0.5 * max(grains[1] - grains[0], grains[3] - grains[2])
    if walls is not None:
        low = np.maximum(np.minimum(walls, grains), grains - reach)[[0, 2]]
        high = np.minimum(np.maximum(walls, grains), grains + reach)[[1, 3]]
        box = np.array([low[0], high[0], low[1], high[1]])
    box = _with_margin(box)
    if len(lattice.edges):
        box[:2] = 0, lattice.edges[0, 0]
    return box


def _with_margin(box):
    margin = 0.03 * max(box[1] - box[0], box[3] - box[2])
    return box + margin * np.array([-1, 1, -1, 1])


def _boxes(scene):
    """Boxes about all grains, held bodies included, and about all walls; None where there are none."""
    grid = scene.shapes if scene.shapes is not None else scene.bodies if scene.bodies is not None else scene.contacts
    if grid is None or not len(grid.points):
        return None, None
    if grid is scene.shapes:
        is_grain = of_shapes(scene, "is_grain", 1) > 0
        if grid.kind_names:
            is_grain = is_grain | ~np.isin(grid.kinds(), WALLS)
        is_grain = np.repeat(is_grain, np.diff(grid.offsets))
        points = grid.points[grid.connectivity, :2]
    else:
        points = grid.points[:, :2]
        is_grain = np.asarray(grid.point_data.get("is_grain", np.ones(len(points)))) > 0
    return _box(points[is_grain]), _box(points[~is_grain])


def _box(points):
    if not len(points):
        return None
    low, high = points.min(axis=0), points.max(axis=0)
    return np.array([low[0], high[0], low[1], high[1]], dtype=float)


def _set_view(ax, view):
    ax.set_aspect("equal")
    ax.set_xlim(view[0], view[1])
    ax.set_ylim(view[2], view[3])


def _draw_shapes(ax, scene, quantity, lattice, view, scale):
    """Walls, then grains, then hollow disks, which are outlines."""
    shapes = scene.shapes
    is_grain = of_shapes(scene, "is_grain", 1) > 0
    polygons = shapes.cells(VTK_POLYGON)
    walls, grains = polygons[~is_grain[polygons]], polygons[is_grain[polygons]]
    outlines, _ = lattice.repeated(shapes.outlines(walls), view)
    ax.add_collection(PolyCollection(outlines, facecolor=WALL, edgecolor=WALL, linewidth=0.4), autolim=False)
    _draw_grains(ax, scene, grains, quantity, lattice, view, scale)
    hollow, _ = lattice.repeated(shapes.outlines(shapes.cells(VTK_POLY_LINE)), view)
    ax.add_collection(LineCollection(hollow, colors="#5A5A5A", linewidth=1.2), autolim=False)


def _draw_grains(ax, scene, grains, quantity, lattice, view, scale):
    """Grains filled by a quantity, with its scale."""
    outlines, copied = lattice.repeated(scene.shapes.outlines(grains), view)
    # Outlines of many small grains would hide their colours.
    edge = min(0.04 * _grain_diameter(ax, scene, view), 0.5)
    collection = PolyCollection(outlines, edgecolor="#6B7B88", linewidth=edge, facecolor=GRAIN)
    ax.add_collection(collection, autolim=False)
    values = None if quantity == "none" else of_shapes(scene, quantity, np.nan)[grains].astype(float)
    if values is None or not len(values) or not np.isfinite(values).any():
        return
    collection.set_array(values[copied])
    scale = scale or colouring(values, quantity)
    if scale.map is None:
        collection.set(array=None, facecolor=GRAIN)
        ax.set_title(scale.note, loc="right")
    else:
        collection.set(cmap=scale.map, norm=scale.norm)
        _colour_bar(ax, collection, scale)


def _colour_bar(ax, collection, scale):
    """The scale of the colours, as high as the scene."""
    (left, right), (low, high) = ax.get_xlim(), ax.get_ylim()
    # As wide on the page for a tower as for a flume.
    width = 0.02 * max(1.0, (high - low) / (right - left))
    bar = ax.figure.colorbar(collection, cax=ax.inset_axes([1 + width, 0, width, 1]), label=scale.label,
                             ticks=scale.ticks, extend=scale.extend)
    bar.outline.set_linewidth(0.5)


def _draw_forces(ax, scene, lattice, view, thick, through_centres=False):
    """Force chains: pushing contacts red, pulling ones blue, the width in proportion to the normal force; slack links thin.

    Lines go from body to body; on request one for each pair, through its centre of pressure."""
    contacts = scene.contacts
    cells = np.flatnonzero(carrying(contacts))
    linked, tension = links(contacts)
    if len(linked):
        lines = contacts.outlines(linked)
        lines = [lattice.straight(line) for line in lines]
        lines, _ = lattice.repeated(lines, view)
        ax.add_collection(LineCollection(lines, linewidths=0.7, colors=BLACK), autolim=False)
    if not len(cells):
        say_no_force(ax)
        return
    if through_centres:
        found = resultants(scene)
        force, lines = np.linalg.norm(found.force, axis=1), list(lines_of_force(found)[..., :2])
    else:
        force = _forces(contacts)[cells]
        lines = [lattice.straight(line) for line in contacts.outlines(cells)]
    lines, copied = lattice.repeated(lines, view)
    # A tail of rare large forces must not thin out the chains: widths saturate at the largest hundredth.
    widest = np.clip(0.6 * _grain_diameter(ax, scene, view), 0.8, 10.0)
    thick = thick or np.quantile(np.abs(force), 0.99)
    widths = np.minimum(np.abs(force[copied]) / thick, 1.0) * widest
    colours = np.where(force[copied] >= 0, VERMILION, BLUE)
    ax.add_collection(LineCollection(lines, linewidths=widths, colors=colours, capstyle="round"), autolim=False)
    ax.set_xlabel(f"x [m]      thickest line: {'' if through_centres else 'normal '}force {number(thick)} N and above")


def _forces(contacts):
    """Normal force of every contact, of links minus their tension [N]."""
    force = np.array(contacts.cell_data["force_normal"], dtype=float)
    linked, tension = links(contacts)
    force[linked] = -tension
    return force


def thickest_force(scene: Scene) -> float | None:
    """Force of the thickest line of one picture [N]: its largest hundredth is drawn alike; None where no force is drawn."""
    if is_in_space(scene):
        return space.thickest_force(scene)
    cells = np.flatnonzero(carrying(scene.contacts)) if scene.contacts is not None else []
    return float(np.quantile(np.abs(_forces(scene.contacts)[cells]), 0.99)) if len(cells) else None


def _draw_bonds(ax, scene, lattice, view):
    """Bonds of cohesive zones at their contact points."""
    cells, damage = bonds(scene.contacts)
    if not len(cells):
        return
    points = np.asarray(scene.contacts.cell_data["point"], dtype=float)[cells, :2]
    draw_bonds(ax, lattice.folded(points), damage, np.clip(0.12 * _grain_diameter(ax, scene, view), 2.0, 7.0))


def _draw_interface(ax, scene, lattice, view):
    """Contacts between grains of different ranks, as lines from centre to centre."""
    if scene.bodies is None or "rank" not in scene.bodies.point_data:
        return
    lines = scene.contacts.outlines(between_ranks(scene)[0])
    lines = [lattice.straight(line) for line in lines]
    lines, _ = lattice.repeated(lines, view)
    width = np.clip(0.15 * _grain_diameter(ax, scene, view), 0.6, 2.0)
    ax.add_collection(LineCollection(lines, linewidths=width, colors=BLACK, capstyle="round"), autolim=False)


def _grain_diameter(ax, scene, view):
    """Diameter of a middling grain as it is drawn [points]; what can be seen well where no radius is known."""
    data = scene.bodies.point_data if scene.bodies is not None else {}
    if "radius" not in data:
        return 5.0
    box = ax.get_window_extent()
    points_per_metre = min(box.width / (view[1] - view[0]), box.height / (view[3] - view[2])) * 72 / ax.figure.dpi
    grains = data["is_grain"] > 0 if "is_grain" in data else data["radius"] > 0
    return 2 * float(np.median(data["radius"][grains])) * points_per_metre if grains.any() else 5.0


def _draw_centres(ax, scene, quantity, lattice):
    """Centres of bodies, where no shapes are known."""
    values = None if quantity == "none" else of_bodies(scene, quantity)
    points = scene.bodies.points[:, :2]
    if lattice.is_cell:
        points = lattice.folded(points)
    scale = colouring(np.asarray(values, dtype=float), quantity) if values is not None and len(values) else None
    if scale is None or scale.map is None:
        ax.scatter(points[:, 0], points[:, 1], s=6, c=BLUE)
        return
    drawn = ax.scatter(points[:, 0], points[:, 1], s=6, c=values, cmap=scale.map, norm=scale.norm)
    _colour_bar(ax, drawn, scale)


def _draw_frame(ax, scene, lattice, view):
    """Axes with units; the borders of the period or of the cell dashed, and nothing beyond a cell."""
    ax.set_title(f"t = {number(scene.time)} s")
    ax.set_ylabel("y [m]")
    if not ax.get_xlabel():
        ax.set_xlabel("x [m]")
    ax.grid(False)
    if lattice.is_cell:
        outline = Polygon(lattice.corners, fill=False, edgecolor="#444444", linestyle="--", linewidth=1)
        for drawn in ax.collections:
            drawn.set_clip_path(outline.get_path(), ax.transData)
        ax.add_patch(outline)
    elif len(lattice.edges) and view is not None:
        for x in view[:2]:
            ax.axvline(x, color="#444444", linestyle="--", linewidth=1)

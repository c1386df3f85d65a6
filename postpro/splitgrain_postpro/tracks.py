"""Tracked bodies, regions and walls of a run: curves of the columns of tracks.csv, regions.csv and walls.csv against time."""

from fnmatch import fnmatchcase

import numpy as np
from matplotlib.figure import Figure

from .errors import ResultsError
from .results import Results
from .style import BLACK, BLUE, GREEN, ORANGE, PURPLE, SKY, VERMILION, WALL, draw_series, new_figure, say_nothing_there

COLOURS = (BLUE, VERMILION, GREEN, ORANGE, PURPLE, SKY, BLACK, WALL)
#: Panels of the page unless columns are asked for: a title, columns, unit.
PANELS = (
    ("displacement", ("displacement",), "m"),
    ("mean contact force", ("mean_force_x", "mean_force_y", "mean_force_z"), "N"),
    ("mean torque of contacts", ("mean_torque", "mean_torque_x", "mean_torque_y", "mean_torque_z"), "N m"),
    ("work of contacts", ("contact_work",), "J"),
)
#: The same of regions: in these a curve goes by the first word of its column, not by the last one.
REGION_PANELS = (
    ("compactness", ("compactness",), ""),
    ("coordination", ("coordination",), ""),
    ("volume error", ("volume_error",), ""),
    ("pairs by their points of contact", ("single_contacts", "double_contacts", "triple_contacts", "quadruple_contacts"), ""),
    ("speed of grains", ("mean_velocity", "max_velocity"), "m/s"),
    ("inertia number", ("inertia_number",), ""),
)
#: The same of walls, and columns of the record that are about the cell which they enclose.
WALL_PANELS = (
    ("mean pressure on walls", ("mean_pressure",), "Pa"),
    ("size of the mean force of grains", ("force",), "N"),
)
CELL_PANELS = (("strains of the cell", ("strain_xx", "strain_yy", "strain_zz"), ""), ("void ratio", ("void_ratio",), ""))
STYLES = ("-", "--", ":", "-.")


def tracks_figure(results: Results, pattern: str = "*", columns: list[str] | None = None) -> tuple[Figure, list[str]]:
    """Curves of the tracked bodies whose names match a pattern, as many as there are colours; dotted lines where stages begin."""
    if not results.tracks:
        raise ResultsError(f"{results.folder} has no tracks: set [[track]] body = \"NAME\" in the deck")
    found = _matching(results.tracks, pattern, "tracked body")
    return _curves(results, found, "bodies", columns, "tracks.csv", PANELS)


def regions_figure(results: Results, pattern: str = "*", columns: list[str] | None = None) -> tuple[Figure, list[str]]:
    """Curves of the indicators of regions whose names match a pattern; dotted lines where stages begin."""
    if not results.regions:
        raise ResultsError(f"{results.folder} has no regions: set [[region]] box = [...] in the deck")
    found = _matching(results.regions, pattern, "region")
    return _curves(results, found, "regions", columns, "regions.csv", REGION_PANELS, word=0)


def _matching(tables, pattern, what):
    """Tables whose names match a pattern."""
    found = {name: rows for name, rows in tables.items() if fnmatchcase(name, pattern)}
    if not found:
        raise ResultsError(f"no {what} matches {pattern}; there are {', '.join(tables)}")
    return found


def _curves(results, found, what, columns, file, panels, word=-1):
    """A page of panels, one colour per table, and what is not drawn; `word` is the part of a column's name that labels it."""
    known = next(iter(found.values()))
    for column in columns or ():
        if column not in known:
            raise ResultsError(f"{file} has no column {column}; it has {', '.join(known)}")
    option = {"bodies": "--body", "regions": "--region"}[what]
    missing = [f"{len(found) - len(COLOURS)} {what} are not drawn: {option} PATTERN chooses"] if len(found) > len(COLOURS) else []
    tables = dict(list(found.items())[: len(COLOURS)])
    panels = [(column, (column,), "") for column in columns] if columns else panels
    wide = 2 if len(panels) > 1 else 1
    figure = new_figure(5.5 * wide, 3.7 * -(-len(panels) // wide))
    for ax, (title, names, unit) in zip(figure.subplots(-(-len(panels) // wide), wide, squeeze=False).flat, panels, strict=False):
        _draw_panel(ax, tables, [name for name in names if name in known], word)
        for stage in results.run.get("stages", [])[1:]:
            ax.axvline(stage["start_time"], color=WALL, linewidth=0.8, linestyle=":")
        ax.set(title=title, xlabel="time [s]", ylabel=unit and f"[{unit}]")
    figure.suptitle(results.name)
    return figure, missing


def walls_figure(results: Results, pattern: str = "*") -> tuple[Figure, list[str]]:
    """Pressure, force and place of the walls whose names match a pattern; where walls enclose a cell, its strains and void ratio."""
    if not results.walls:
        raise ResultsError(f"{results.folder} has no walls.csv: its deck has no [[wall]] and no [[container]], or keeps no record")
    found = {name: rows for name, rows in results.walls.items() if fnmatchcase(name, pattern)}
    if not found:
        raise ResultsError(f"no wall matches {pattern}; there are {', '.join(results.walls)}")
    missing = [f"{len(found) - len(COLOURS)} walls are not drawn: --wall PATTERN chooses"] if len(found) > len(COLOURS) else []
    walls = {name: rows | {"force": _size(rows, "mean_force_"), "way": _size(rows, "", rows)}
             for name, rows in list(found.items())[: len(COLOURS)]}
    figure = new_figure(11, 7.4)
    axes = list(figure.subplots(2, 2).flat)
    for ax, (title, names, unit) in zip(axes, WALL_PANELS, strict=False):
        _draw_panel(ax, walls, names)
        ax.set(title=title, xlabel="time [s]", ylabel=f"[{unit}]")
    if "void_ratio" in results.record:
        cell = {"cell": results.record}
        for ax, (title, names, _) in zip(axes[2:], CELL_PANELS, strict=True):
            _draw_panel(ax, cell, [name for name in names if name in results.record])
            ax.set(title=title, xlabel="time [s]")
    else:
        ax, share = axes[2:]
        _draw_panel(ax, walls, ["way"])
        ax.set(title="way of the walls", xlabel="time [s]", ylabel="[m]")
        if "floor_share" in results.record:
            _draw_panel(share, {"walls": results.record}, ["floor_share"])
        share.set(title="weight of the grains that walls carry", xlabel="time [s]", ylabel="share")
    figure.suptitle(results.name)
    return figure, missing


def _size(rows, prefix, origin=None):
    """Length of a vector in each row; less that of the first row, where `origin` is given."""
    names = [prefix + axis for axis in "xyz" if prefix + axis in rows]
    return np.sqrt(sum((rows[name] - (origin[name][0] if origin else 0)) ** 2 for name in names))


def _draw_panel(ax, bodies, names, word=-1):
    """One colour per body, one style per component, which goes by a word of its name."""
    drawn = False
    for (body, rows), colour in zip(bodies.items(), COLOURS, strict=False):
        for name, style in zip(names, STYLES, strict=False):
            label = body if len(names) == 1 else f"{body}, {name.split('_')[word]}"
            before = len(ax.lines)
            drawn = draw_series(ax, rows["time"], rows[name], colour, label) or drawn
            for line in ax.lines[before:]:
                line.set_linestyle(style)
    if not drawn:
        say_nothing_there(ax, "no row yet")
    elif len(ax.get_legend_handles_labels()[0]) > 1:
        ax.legend(loc="best")

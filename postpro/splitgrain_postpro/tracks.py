"""Tracked bodies of a run: curves of the columns of tracks.csv against time."""

from fnmatch import fnmatchcase

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
STYLES = ("-", "--", ":")


def tracks_figure(results: Results, pattern: str = "*", columns: list[str] | None = None) -> tuple[Figure, list[str]]:
    """Curves of the tracked bodies whose names match a pattern; as many as there are colours."""
    if not results.tracks:
        raise ResultsError(f"{results.folder} has no tracks: set [[track]] body = \"NAME\" in the deck")
    found = {name: rows for name, rows in results.tracks.items() if fnmatchcase(name, pattern)}
    if not found:
        raise ResultsError(f"no tracked body matches {pattern}; there are {', '.join(results.tracks)}")
    known = next(iter(found.values()))
    for column in columns or ():
        if column not in known:
            raise ResultsError(f"tracks.csv has no column {column}; it has {', '.join(known)}")
    missing = [f"{len(found) - len(COLOURS)} bodies are not drawn: --body PATTERN chooses"] if len(found) > len(COLOURS) else []
    bodies = dict(list(found.items())[: len(COLOURS)])
    panels = [(column, (column,), "") for column in columns] if columns else PANELS
    wide = 2 if len(panels) > 1 else 1
    figure = new_figure(5.5 * wide, 3.7 * -(-len(panels) // wide))
    for ax, (title, names, unit) in zip(figure.subplots(-(-len(panels) // wide), wide, squeeze=False).flat, panels, strict=False):
        _draw_panel(ax, bodies, [name for name in names if name in known])
        ax.set(title=title, xlabel="time [s]", ylabel=unit and f"[{unit}]")
    figure.suptitle(results.name)
    return figure, missing


def _draw_panel(ax, bodies, names):
    """One colour per body, one style per component."""
    drawn = False
    for (body, rows), colour in zip(bodies.items(), COLOURS, strict=False):
        for name, style in zip(names, STYLES, strict=False):
            label = body if len(names) == 1 else f"{body}, {name.rsplit('_', 1)[-1]}"
            before = len(ax.lines)
            drawn = draw_series(ax, rows["time"], rows[name], colour, label) or drawn
            for line in ax.lines[before:]:
                line.set_linestyle(style)
    if not drawn:
        say_nothing_there(ax, "no row yet")
    elif len(ax.get_legend_handles_labels()[0]) > 1:
        ax.legend(loc="best")

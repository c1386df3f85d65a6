"""Figures of frequencies and wave numbers: spectra of a run, structure of its packing."""

import numpy as np
from matplotlib.figure import Figure

from .errors import ResultsError
from .results import Results, read_record
from .structure import centres_of, radial_distribution, structure_factor
from .style import BLACK, BLUE, GREEN, ORANGE, SKY, VERMILION, new_figure, say_nothing_there

COLOURS = {"x": BLUE, "y": VERMILION, "z": GREEN}
#: Lines of a spectrum that are drawn at most: a picture has no more columns.
MANY_LINES = 4000
#: Peaks that are named: so many times the median of the lines about them.
PEAK, NAMED, ABOUT = 30.0, 6, 40


def spectrum_figure(results: Results) -> tuple[Figure, list[str]]:
    """Power spectra of what the run sampled: wall forces, momentum and kinetic energy of the grains."""
    path = results.folder / "spectrum.csv"
    if not path.exists():
        raise ResultsError(f"{path} is not there: set [report] spectrum = true in the deck")
    table = read_record(path)
    figure = new_figure(9, 9)
    panels = figure.subplots(3, 1, sharex=True)
    for ax, stem, what, unit in zip(panels, ("wall_force", "momentum", "kinetic_energy"),
                                    ("force of contacts on all walls", "momentum of the grains", "kinetic energy of the grains"),
                                    ("N$^2$", "(kg m/s)$^2$", "J$^2$"), strict=True):
        _draw_spectra(ax, table, stem, unit)
        ax.set_title(what)
    panels[-1].set_xlabel("frequency [Hz]")
    figure.suptitle(results.name)
    return figure, []


def _draw_spectra(ax, table, stem, unit):
    """The columns that begin with a stem; lines of which many fall together as the highest of them, since peaks count."""
    frequency = table["frequency_hz"][1:]
    highest = np.zeros(len(frequency))
    for name in [column for column in table if column.startswith(stem)]:
        power = table[name][1:]
        if not (power > 0).any():
            continue
        highest = np.maximum(highest, power)
        axis = name[len(stem) + 1:]
        bundle = len(frequency) // MANY_LINES + 1
        starts = np.arange(0, len(frequency), bundle)
        ax.plot(frequency[starts], np.maximum.reduceat(power, starts), color=COLOURS.get(axis, BLACK), lw=0.8, label=axis or None)
    if not (highest > 0).any():
        say_nothing_there(ax, f"nothing but zero in {stem}")
        return
    ax.set(yscale="log", ylabel=f"power [{unit}]", ylim=(highest.max() * 1e-9, highest.max() * 20))
    if len(ax.get_legend_handles_labels()[0]) > 1:
        ax.legend(loc="upper right", ncols=3)
    for place in peaks(highest):
        ax.annotate(f"{frequency[place]:.4g} Hz", (frequency[place], highest[place]), xytext=(0, 3), textcoords="offset points",
                    ha="left", fontsize=7, color="#444444", rotation=30)


def peaks(power: np.ndarray) -> list[int]:
    """Places of the highest lines that stand out of those about them, at most six, in order of frequency."""
    places = []
    for place in np.argsort(power)[::-1][:200]:
        around = power[max(0, place - ABOUT): place + ABOUT + 1]
        is_top = power[place] >= power[max(0, place - 3): place + 4].max() and 0 < place < len(power) - 1
        if is_top and power[place] > PEAK * np.median(around) and all(abs(place - other) > ABOUT // 4 for other in places):
            places.append(int(place))
        if len(places) == NAMED:
            break
    return sorted(places)


def structure_figure(results: Results, picture: int = -1) -> tuple[Figure, list[str]]:
    """Radial distribution and structure factor of a picture, and what the run itself wrote at that step."""
    scene = results.scene(picture)
    if scene.bodies is None or "is_grain" not in scene.bodies.point_data:
        raise ResultsError(f"{results.folder} has no bodies.vtkhdf with grains to draw")
    if not results.run.get("mean_radius"):
        raise ResultsError(f"{results.folder}/run.json, which holds the mean radius, is written at the end of the run")
    centres = centres_of(scene.bodies, results.periods, 2 * results.run["mean_radius"], results.is_in_space, scene.cell)
    figure = new_figure(8, 7)
    upper, lower = figure.subplots(2, 1)
    step = int(scene.bodies.field_data["step"][0])
    r, g = radial_distribution(centres)
    k, s, _ = structure_factor(centres)
    missing = []
    for ax, x, y, names in ((upper, r, g, ("radial_distribution", "r_diameters", "g")),
                            (lower, k, s, ("structure_factor", "k_diameters", "s"))):
        if not len(x):
            say_nothing_there(ax, "no grain has its surroundings in the box" if ax is upper else "no wave fits into the box")
            missing.append(f"no {names[0]}")
            continue
        scale = 1 / centres.diameter if ax is upper else centres.diameter
        own = _rows_of_step(results.folder / f"{names[0]}.csv", step)
        ax.plot(x * scale, y, color=BLUE, label="from the picture")
        if own is not None:
            ax.plot(own[names[1]], own[names[2]], "--", color=ORANGE, lw=1, label="written by the run")
            ax.legend()
        ax.axhline(1, color=SKY, lw=0.6, zorder=0)
    upper.set(xlabel="distance r / d", ylabel="g(r)", title="radial distribution", xlim=(0, None), ylim=(0, None))
    lower.set(xlabel="wave number k d", ylabel="S(k)", title="structure factor", xlim=(0, None), ylim=(0, None))
    figure.suptitle(f"{results.name}, step {step}: {len(centres.points)} grains, mean diameter d = {centres.diameter:.4g} m")
    return figure, missing


def _rows_of_step(path, step):
    """The rows that a run wrote of a step, or None."""
    if not path.exists():
        return None
    table = read_record(path)
    rows = table["step"] == step
    return {name: column[rows] for name, column in table.items()} if rows.any() else None

"""Curves of a run from record.csv: energies, effort of the solver, residuals."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import StrMethodFormatter

from .style import (
    BLACK, BLUE, GREEN, ORANGE, PURPLE, SKY, VERMILION, WALL, draw_series, say_nothing_there,
)  # fmt: skip

TIME = "time [s]"
# A legend beside the title hides no curve.
ABOVE = {"loc": "lower right", "bbox_to_anchor": (1, 0.99), "ncols": 3, "borderpad": 0.2,
         "handlelength": 1.2, "columnspacing": 1.0}  # fmt: skip
COUNT = StrMethodFormatter("{x:,.0f}")
# Energies below this share of the largest are zero.
ROUNDING = 1e-9
# Share of the smallest residuals that need not be shown.
LEFT_OUT = 0.02
PHASES = {
    "cpu_predict": ("predict", SKY), "cpu_detect": ("detect", GREEN), "cpu_assemble": ("assemble", ORANGE),
    "cpu_solve": ("solve", BLUE), "cpu_update": ("update", PURPLE), "cpu_measure": ("measure", "#999999"),
    "cpu_output": ("output", "#CCCCCC"),
}  # fmt: skip


def _column(record, name):
    """A column, or NaN where the record has none."""
    if name in record:
        return record[name]
    return np.full(len(next(iter(record.values()))), np.nan)


def _is_empty(ax, record):
    """State it in the panel when there is no row to draw."""
    if record and len(next(iter(record.values()))):
        return False
    say_nothing_there(ax, "no record.csv" if not record else "record.csv has no row yet")
    return True


def _finish(ax, drawn, x_label, y_label, title, **legend):
    """Labels and legend; a panel without any curve states it."""
    ax.set_title(title)
    if not drawn:
        say_nothing_there(ax, "all zero or not recorded")
        return
    ax.set(xlabel=x_label, ylabel=y_label)
    if len(ax.get_legend_handles_labels()[0]) > 1:
        ax.legend(**legend)


def draw_energies(ax: Axes, record: dict[str, np.ndarray], is_in_space: bool = False) -> None:
    """Kinetic and potential energy, works and losses, each since the start of the record."""
    if _is_empty(ax, record):
        return
    time = _column(record, "time")
    potential = _column(record, "potential_energy")
    curves = [
        ("kinetic", _column(record, "kinetic_energy"), BLUE),
        ("potential, from its start", potential - potential[0], GREEN),
        ("work of forces", _column(record, "external_work"), ORANGE),
        ("work of drives", _column(record, "drive_work"), PURPLE),
        ("lost in friction", _column(record, "friction_loss"), VERMILION),
        ("lost in impacts", _column(record, "impact_loss"), SKY),
        ("stored in bonds", _column(record, "bond_energy"), BLACK),
        ("lost in bonds", _column(record, "bond_loss"), WALL),
    ]
    drawn = False
    largest = max(np.nanmax(np.abs(values), initial=0.0) for _, values, _ in curves)
    for label, values, colour in curves:
        # Works and bonds that a scene does not have stay zero to rounding: they would only fill the legend.
        if ("work" in label or "bonds" in label) and not np.any(np.abs(values) > ROUNDING * largest):
            continue
        drawn = draw_series(ax, time, values, colour, label) or drawn
    _finish(ax, drawn, TIME, "energy [J]" if is_in_space else "energy [J per m of depth]", "Energies", loc="best")


def draw_closure(ax: Axes, record: dict[str, np.ndarray]) -> None:
    """How far the energy balance is from closing."""
    if _is_empty(ax, record):
        return
    drawn = draw_series(ax, _column(record, "time"), _column(record, "energy_closure"), BLACK, log=True)
    ax.set_yscale("log")
    _finish(ax, drawn, TIME, "defect over largest term [-]", "Energy balance")


def draw_contacts(ax: Axes, record: dict[str, np.ndarray]) -> None:
    """Contacts, and those that carry force."""
    if _is_empty(ax, record):
        return
    time = _column(record, "time")
    drawn = draw_series(ax, time, _column(record, "contacts"), SKY, "all")
    drawn = draw_series(ax, time, _column(record, "active_contacts"), BLUE, "carrying force") or drawn
    ax.set_ylim(bottom=0)
    ax.yaxis.set_major_formatter(COUNT)
    _finish(ax, drawn, TIME, "contacts [-]", "Contacts", **ABOVE)


def draw_sweeps(ax: Axes, record: dict[str, np.ndarray]) -> None:
    """Sweeps of the solver per step; steps that did not converge are marked."""
    if _is_empty(ax, record):
        return
    time, sweeps = _column(record, "time"), _column(record, "sweeps")
    drawn = draw_series(ax, time, sweeps, BLUE, "sweeps")
    failed = _column(record, "converged") <= 0
    if failed.any():
        ax.plot(time[failed], sweeps[failed], "x", color=VERMILION, markersize=4, label="not converged")
    ax.set_ylim(bottom=0)
    _finish(ax, drawn, TIME, "sweeps per step [-]", "Solver effort", **ABOVE)


def draw_effort(ax: Axes, record: dict[str, np.ndarray]) -> None:
    """Sweeps and contacts in one panel with two scales, for the summary."""
    draw_sweeps(ax, record)
    if not ax.axison:
        return
    other = ax.twinx()
    other.spines.right.set_visible(True)
    other.grid(False)
    draw_series(other, _column(record, "time"), _column(record, "contacts"), ORANGE, "contacts")
    other.set_ylim(bottom=0)
    other.yaxis.set_major_formatter(COUNT)
    other.set_ylabel("contacts [-]", color="#9A6A00")
    ax.set_ylabel("sweeps per step [-]", color=BLUE)
    handles = [axes.get_legend_handles_labels() for axes in (ax, other)]
    if ax.get_legend():
        ax.get_legend().remove()
    # Where the legend fills the line above the panel, it is the title.
    if len(handles[0][0]) > 1:
        ax.set_title("")
    other.legend(handles[0][0] + handles[1][0], handles[0][1] + handles[1][1], **ABOVE)


def draw_residuals(ax: Axes, record: dict[str, np.ndarray], against: str = "time") -> None:
    """Residuals E1, E2 and E8 against simulated time or against CPU time."""
    if _is_empty(ax, record):
        return
    x = _column(record, "time" if against == "time" else "cpu_seconds")
    lowest = []
    for name, colour in (("e1", ORANGE), ("e2", GREEN), ("e8", BLUE)):
        y = _column(record, name)
        if draw_series(ax, x, y, colour, name.upper(), log=True, dashed=name == "e2"):
            lowest.append(np.quantile(y[np.isfinite(y) & (y > 0)], LEFT_OUT))
    ax.set_yscale("log")
    # The first steps, in which hardly anything touches, are exact to rounding: they would squeeze all others.
    if lowest:
        ax.set_ylim(0.5 * min(lowest), 2 * ax.dataLim.y1)
    drawn = bool(lowest)
    if against == "time":
        _finish(ax, drawn, TIME, "residual [-]", "Residuals", **ABOVE)
    else:
        _finish(ax, drawn, "CPU time since the start [s]", "residual [-]", "Error against cost", **ABOVE)


def draw_phases(ax: Axes, record: dict[str, np.ndarray]) -> None:
    """CPU time by phase, stacked, against simulated time."""
    if _is_empty(ax, record):
        return
    phases = [(label, _column(record, name), colour) for name, (label, colour) in PHASES.items()]
    phases = [phase for phase in phases if np.nanmax(phase[1], initial=0.0) > 0]
    if phases:
        ax.stackplot(_column(record, "time"), *[np.nan_to_num(values) for _, values, _ in phases],
                     labels=[label for label, _, _ in phases], colors=[colour for *_, colour in phases], linewidth=0)
    _finish(ax, bool(phases), TIME, "CPU time since the start [s]", "Cost by phase", loc="upper left")

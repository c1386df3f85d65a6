"""Traces of a run: errors within chosen steps, and where the time of these steps went."""

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes

from .plots import PHASES
from .style import say_nothing_there

WORK = {"cpu_seconds": "CPU time of the solve [s]", "contact_updates": "contact updates [-]"}
# Lines that a legend can hold.
MOST_NAMED = 10


def draw_history(ax: Axes, points: dict[str, np.ndarray], error: str, work: str) -> None:
    """An error within each traced step against work; both start at zero, which logarithms cannot show, so time is linear."""
    numbers = np.unique(points["step"])
    colours = colormaps["viridis"](np.linspace(0, 0.9, len(numbers)))
    drawn = False
    for step, colour in zip(numbers, colours, strict=True):
        rows = (points["step"] == step) & np.isfinite(points[error]) & (points[error] > 0)
        if rows.any():
            ax.plot(points[work][rows], points[error][rows], color=colour, lw=1.1, marker="o", markersize=2,
                    label=f"step {step:.0f}")  # fmt: skip
            drawn = True
    ax.set_title(f"{error.upper()} within steps")
    if not drawn:
        say_nothing_there(ax, "nothing to draw: no contact in the steps that were traced, or no updates")
        return
    ax.set_yscale("log")
    ax.set(xlabel=WORK[work], ylabel=f"error {error.upper()} [-]")
    ax.set_xlim(left=0)
    if len(numbers) <= MOST_NAMED:
        ax.legend(fontsize=7, handlelength=1.2)


def draw_costs(ax: Axes, steps: dict[str, np.ndarray]) -> None:
    """CPU time of traced steps by phase, stacked."""
    ax.set_title("Where the time of these steps went")
    places = np.arange(len(steps["step"]))
    base = np.zeros(len(places))
    for name, (label, colour) in PHASES.items():
        if steps[name].sum() > 0:
            ax.bar(places, 1e3 * steps[name], bottom=1e3 * base, color=colour, label=label, width=0.75)
            base += steps[name]
    shown = np.unique(np.linspace(0, len(places) - 1, 12).astype(int))
    ax.set_xticks(shown, [f"{steps['step'][i]:.0f}" for i in shown])
    ax.set(xlabel="step", ylabel="CPU time of the step [ms]")
    ax.set_ylim(0, 1.35e3 * base.max() if base.any() else 1)
    ax.grid(visible=False, axis="x")
    ax.legend(ncols=4, loc="upper left")

"""How all figures look: fonts that can be read in print, colours that colour-blind people distinguish."""

import io
from contextlib import AbstractContextManager

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure

# Okabe and Ito (2008).
BLACK, ORANGE, SKY, GREEN, YELLOW, BLUE, VERMILION, PURPLE = (
    "#000000", "#E69F00", "#56B4E9", "#009E73", "#F0E442", "#0072B2", "#D55E00", "#CC79A7",
)  # fmt: skip
WALL = "#8C8C8C"
GRAIN = "#DDE3E8"

# ColorBrewer's YlGnBu without its ends: to be seen on white, and light enough everywhere for force chains to stand out.
FILL = LinearSegmentedColormap.from_list("fill", ["#EDF8B1", "#C7E9B4", "#7FCDBB", "#41B6C4", "#1D91C0"])
KINDS = ["#BFD9EA", "#F3D9A4", "#B9E0CF", "#E7C9DA", "#F0E9A8", "#D9D9D9", "#F2BFA0"]

SETTINGS = {
    "font.size": 9, "axes.titlesize": 10, "axes.labelsize": 9, "legend.fontsize": 8, "figure.titlesize": 12,
    "axes.spines.top": False, "axes.spines.right": False, "axes.grid": True, "grid.color": "#E4E4E4",
    "axes.axisbelow": True, "legend.edgecolor": "none", "legend.framealpha": 0.8, "lines.linewidth": 1.3, "savefig.dpi": 150,
    "axes.titlelocation": "left", "axes.formatter.limits": (-3, 4), "axes.formatter.use_mathtext": True,
}  # fmt: skip

# Resolution of pictures next to a page [dots per inch]
PNG_DPI = 130
# Rows beyond which a series is drawn as mean and range over windows.
MANY_ROWS = 1200
WINDOWS = 400


def styled() -> AbstractContextManager[None]:
    """A context in which figures have the common look."""
    return matplotlib.rc_context(SETTINGS)


def new_figure(width: float, height: float) -> Figure:
    """A figure of this size [inch] that arranges its parts itself."""
    return Figure(figsize=(width, height), layout="constrained")


def as_png(figure: Figure) -> bytes:
    """A figure as PNG. Its parts are arranged once and stay there: what it is saved to later neither moves nor measures them again."""
    figure.set_dpi(PNG_DPI)
    figure.get_layout_engine().execute(figure)
    figure.set_layout_engine(None)
    file = io.BytesIO()
    figure.savefig(file, format="png", dpi=PNG_DPI)
    return file.getvalue()


def draw_series(
    ax: Axes, x: np.ndarray, y: np.ndarray, colour: str, label: str | None = None, log: bool = False, dashed: bool = False,
) -> bool:
    """A line; a long series as its mean over windows, with its range as a shade. Returns whether anything is drawn."""
    known = np.isfinite(x) & np.isfinite(y)
    if log:
        known &= y > 0
    x, y = x[known], y[known]
    if not len(x):
        return False
    style = "--" if dashed else "-"
    if len(x) <= MANY_ROWS:
        marker = "o" if len(x) == 1 else None
        ax.plot(x, y, style, color=colour, label=label, marker=marker, markersize=4)
        return True
    edges = np.linspace(0, len(x), WINDOWS + 1).astype(int)[:-1]
    sizes = np.diff(np.append(edges, len(x)))
    middle = np.add.reduceat(x, edges) / sizes
    heights = np.log(y) if log else y
    mean = np.add.reduceat(heights, edges) / sizes
    ax.fill_between(middle, np.minimum.reduceat(y, edges), np.maximum.reduceat(y, edges), color=colour, alpha=0.2, lw=0)
    ax.plot(middle, np.exp(mean) if log else mean, style, color=colour, label=label)
    return True


def draw_bonds(ax: Axes, points: np.ndarray, damage: np.ndarray, size: float) -> None:
    """Bonds of cohesive zones as dots of a size [pt], pale where whole and red where broken, and what they mean."""
    ax.scatter(*points.T, s=size**2, c=damage, cmap="YlOrRd", vmin=0, vmax=1, edgecolors=BLACK, linewidths=0.4, zorder=5)
    ax.text(0.01, 0.99, "dots: bonds, from whole (pale) to broken (red)", transform=ax.transAxes, va="top", fontsize=8)


def say_nothing_there(ax: Axes, sentence: str) -> None:
    """An empty panel that names what is not there."""
    ax.set_axis_off()
    ax.text(0.5, 0.5, sentence, ha="center", va="center", transform=ax.transAxes, color="#666666", wrap=True)


def number(value: float) -> str:
    """A number in four digits, without trailing zeros."""
    return f"{value:.4g}"

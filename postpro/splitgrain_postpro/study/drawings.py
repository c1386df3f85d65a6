"""Figures of a study, each of one panel, so that it can be read on a narrow page too."""

from textwrap import fill

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, FuncFormatter, MaxNLocator, NullFormatter, NullLocator

from ..style import BLACK, BLUE, GREEN, ORANGE, PURPLE, SKY, VERMILION, new_figure, say_nothing_there
from .measures import messages_of
from .model import Case, Curves, Study

LOOKS = list(zip((BLUE, VERMILION, GREEN, ORANGE, PURPLE, SKY, BLACK), "os^Dvp*", strict=True))
SIZE = (4.7, 3.7)
# Most letters of a line of a title, of a legend, and of a label that stands upright.
TITLE, WIDEST, HIGHEST = 46, 58, 38
PANEL = 2.9  # height of panels above a legend of their own
ERRORS = {
    "e1": "error E1 [-]", "e2": "error E2 [-]", "e8": "error E8 [-]",
    "distance": "distance to the reference [-]",
}  # fmt: skip
CLOCKS = {"cpu_seconds": "CPU time [s]", "contact_updates": "contact updates [-]", "bytes": "data exchanged [byte]"}
CPU, UPDATES, BYTES = CLOCKS


def look(study: Study, variant: str) -> tuple[str, str]:
    """Colour and marker of a variant, the same in all figures."""
    names = [other.name for other in study.variants]
    number = names.index(variant)
    # Beyond the last look colours come again with other markers.
    return LOOKS[number % len(LOOKS)][0], LOOKS[(number + number // len(LOOKS)) % len(LOOKS)][1]


def line_style(study: Study, variant: str) -> str:
    """Line of a variant where there are no markers: dashed where a colour comes again."""
    return "--" if [other.name for other in study.variants].index(variant) >= len(LOOKS) else "-"


def work_precision(study: Study, case: Case, curves: Curves, clock: str, error_label: str, title: str) -> Figure:
    """Error against work: `curves[variant]` lists (work, error, is it as asked?), by falling tolerance."""
    figure = new_figure(*SIZE)
    ax = figure.add_subplot()
    drawn = False
    for variant, points in curves.items():
        points = [point for point in points if point[0] and point[1] and np.isfinite(point[:2]).all()]
        if not points:
            continue
        colour, marker = look(study, variant)
        work, errors, good = (np.array(numbers) for numbers in zip(*points, strict=True))
        ax.plot(work, errors, color=colour, label=variant, lw=1, marker=marker, markersize=4.5)
        ax.plot(work[~good], errors[~good], marker, color=colour, markersize=4.5, markerfacecolor="white")
        drawn = True
    _finish(ax, drawn, CLOCKS[clock], error_label, title)
    return figure


def traces(study: Study, curves: Curves, title: str) -> Figure:
    """Error against CPU time within one run of each variant: `curves[variant]` lists (seconds, e1, e8)."""
    figure = new_figure(*SIZE)
    ax = figure.add_subplot()
    drawn = False
    for variant, points in curves.items():
        points = [(seconds, e1) for seconds, e1, _ in points if seconds > 0 and e1 > 0]
        if points:
            colour, marker = look(study, variant)
            ax.plot(*zip(*points, strict=True), color=colour, label=variant, lw=1, marker=marker, markersize=2.5)
            drawn = True
    _finish(ax, drawn, CLOCKS[CPU], ERRORS["e1"], title)
    return figure


def histories(curves: dict[str, list[tuple[float, float]]], label: str, title: str) -> Figure:
    """Error of the whole problem within one step, on different numbers of subdomains: `curves[name]` lists (iterations or seconds, E8)."""
    figure = new_figure(*SIZE)
    ax = figure.add_subplot()
    for number, (name, points) in enumerate(curves.items()):
        ax.plot(*zip(*points, strict=True), color=LOOKS[number % len(LOOKS)][0], label=name, lw=1)
    _finish(ax, bool(curves), label, ERRORS["e8"], title, legend="subdomains")
    return figure


def comparison(study: Study, histories: dict[str, list[dict[str, float]]], subdomains: int, title: str) -> Figure:
    """Error of the whole problem within one step, by every variant, against CPU time and, of several subdomains, messages and bytes."""
    efforts = {CLOCKS[CPU]: lambda point: point["cpu_seconds"]}
    if subdomains > 1:
        efforts["messages [-]"] = lambda point: messages_of(point, subdomains)
        efforts[CLOCKS[BYTES]] = lambda point: point["bytes"]
    figure = new_figure(SIZE[0] if len(efforts) == 1 else 9.0, PANEL)
    axes = figure.subplots(1, len(efforts), sharey=True, squeeze=False)[0]
    for ax, (label, effort) in zip(axes, efforts.items(), strict=True):
        for variant, points in histories.items():
            curve = [(effort(point), point["e8"]) for point in points]
            curve = [(x, y) for x, y in curve if x > 0 and y > 0]
            if curve:
                ax.plot(*zip(*curve, strict=True), color=look(study, variant)[0], ls=line_style(study, variant), label=variant, lw=1)
        ax.set(xscale="log", yscale="log", xlabel=label)
    axes[0].set(ylabel=ERRORS["e8"])
    axes[0].set_title(fill(title, TITLE * (1 if len(efforts) == 1 else 2)))
    legend_beneath(figure, axes[0].get_legend_handles_labels(), "method")
    return figure


def legend_beneath(figure: Figure, entries: tuple[list, list], title: str | None = None) -> None:
    """One legend for all panels, in as many columns as the figure has room for; the figure grows by its height."""
    for columns in (4, 3, 2, 1):
        legend = figure.legend(*entries, loc="lower center", ncols=columns, title=title, handlelength=1.5, columnspacing=1.2)
        if columns == 1:
            for text in legend.get_texts():
                text.set_text(fill(text.get_text(), WIDEST))
        box = legend.get_window_extent()
        if box.width <= figure.bbox.width or columns == 1:
            break
        legend.remove()
    room = (box.height + 2 * box.y0) / figure.dpi
    height = PANEL + room
    figure.set_figheight(height)
    figure.get_layout_engine().set(rect=(0, room / height, 1, PANEL / height))


def profiles(study: Study, ratios: dict[str, list[float]], count: int, title: str) -> Figure:
    """Share of problems solved within tau times the fastest: steps, drawn to a common end."""
    figure = new_figure(*SIZE)
    ax = figure.add_subplot()
    end = max([2.0, *(values[-1] * 1.3 for values in ratios.values() if values)])
    for number, (variant, values) in enumerate(ratios.items()):
        colour, _ = look(study, variant)
        taus = [1.0, *values, end]
        shares = [sum(value <= 1 for value in values) / count, *((i + 1) / count for i in range(len(values))), len(values) / count]
        # Lines that coincide stay to be seen, since each is thinner than the one before.
        ax.step(taus, shares, where="post", color=colour, label=variant, lw=3.2 - 0.4 * min(number, 5))
    ax.set_ylim(-0.02, 1.04)
    ax.set_xlim(1, end)
    _finish(ax, bool(count), "time over that of the fastest, $\\tau$ [-]", "share of problems [-]", title, scale="x")
    return figure


def convergence(study: Study, curves: Curves, orders: dict[str, float | None], label: str, title: str) -> Figure:
    """Error of a measure, or what it took, against the axis; over time steps with lines of orders one and two."""
    figure = new_figure(*SIZE)
    ax = figure.add_subplot()
    all_points = []
    for variant, points in curves.items():
        points = [(value, error) for value, error in points if error > 0 and np.isfinite(error)]
        if points:
            colour, marker = look(study, variant)
            order = f", order {orders[variant]:.2f}" if orders.get(variant) is not None else ""
            ax.plot(*zip(*points, strict=True), color=colour, marker=marker, markersize=4.5, label=variant + order, lw=1)
            all_points += points
    if all_points and study.axis == "time_steps":
        h = np.array(sorted({value for value, _ in all_points}))
        least = min(error / value for value, error in all_points)
        ax.plot(h, 0.4 * least * h, color="#777777", ls="--", lw=1, label="order 1")
        ax.plot(h, 0.4 * least * h**2 / h[-1], color="#777777", ls=":", lw=1, label="order 2")
    axis = {"time_steps": "time step [s]", "tolerances": "tolerance [-]", "subdomains": "subdomains [-]"}[study.axis]
    _finish(ax, bool(all_points), axis, label, title)
    if all_points and study.axis == "subdomains":
        ax.xaxis.set_major_locator(FixedLocator(sorted({value for value, _ in all_points})))
        ax.xaxis.set_minor_locator(NullLocator())
    return figure


def _finish(ax, drawn, x_label, y_label, title, scale="both", legend=None):
    """Scales, labels, and the legend, with its heading, beneath the panel, where it hides nothing."""
    ax.set_title(fill(title, TITLE))
    if not drawn:
        say_nothing_there(ax, "nothing to draw: no run arrived, or none has this number")
        return
    ax.set_xscale("log")
    if scale == "both":
        ax.set_yscale("log")
    low, high = ax.get_xlim()
    if high / low < 3:
        # Neither a power of ten nor two or five times one need lie on so short an axis.
        ax.xaxis.set_major_locator(MaxNLocator(4))
        ax.xaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
        ax.xaxis.set_minor_locator(NullLocator())
    elif high / low < 300:
        # Within two decades powers of ten alone would leave the axis without a number.
        ax.xaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
        ax.xaxis.set_minor_formatter(FuncFormatter(lambda x, _: f"{x:g}" if f"{x:e}"[0] in "25" else ""))
    else:
        ax.xaxis.set_minor_formatter(NullFormatter())
    ax.set(xlabel=fill(x_label, TITLE), ylabel=fill(y_label, HIGHEST))
    legend_beneath(ax.figure, ax.get_legend_handles_labels(), legend)

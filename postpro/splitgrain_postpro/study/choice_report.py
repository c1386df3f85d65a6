"""The choice of a study as a figure, tables and lines to print."""

import math
from collections.abc import Callable

import numpy as np
from matplotlib.figure import Figure

from ..style import VERMILION, new_figure, say_nothing_there
from . import page
from .choice import choose
from .drawings import SIZE, legend_beneath, look
from .model import Section, Study, Table

# Ratios below this are drawn here: no error at all has no logarithm.
LEAST_RATIO = 1e-3


def choice_section(study: Study, table: Table, save: Callable[[Figure, str, str], str]) -> tuple[Section, list[str]]:
    """The section of the page, and the lines to print; `save` takes a figure, a name and words."""
    settings, limits = choose(study, table)
    picture = save(_figure(study, settings), "choice", "Error over its limit against CPU time, a point per tolerance")
    choice, lines = study.choice, []
    best = next((setting for setting in settings if setting.is_best), None)
    if best:
        lines.append(f"best: {best.variant} to {best.tolerance:g}, within its limit in {100 * best.within:.0f} % of "
                     f"{len(study.cases)} cases, at most {best.worst:.2g} times beyond")  # fmt: skip
    else:
        lines.append("no setting is fit: none is within its limits")
    present = next((s for s in settings if [s.variant, s.tolerance] == choice["present"]), None)
    if present:
        lines.append(f"present: {present.variant} to {present.tolerance:g}, {'fit' if present.is_fit else 'not fit'} "
                     f"({100 * present.within:.0f} % within, at most {present.worst:.2g}), {present.cost:.2f} times the CPU time of the best")  # fmt: skip
    words = (f"The error of a setting is the difference in {choice['measure']} from the run of {study.variants[0].name} to "
             f"{min(study.values):g}. Its limit in a case is {choice['share']:g} of the error of the time step (the difference from a run "
             f"with a time step {choice['finer']} times finer), but at least {choice['least']:g} of the mean radius. Fit is what is within "
             f"the limit in {100 * choice['cases']:.0f} % of the cases and nowhere beyond {choice['worst']:g} times it. The best of the fit "
             "has the smallest geometric mean of CPU times.")  # fmt: skip
    rows = [[s.variant, f"{s.tolerance:g}", f"{100 * s.within:.0f} %", _known(s.worst), _known(s.cost),
             "best" if s.is_best else "fit" if s.is_fit else ""] for s in settings]  # fmt: skip
    names = ("variant", "tolerance", "within limit", "worst error / limit", "CPU time / best", "verdict")
    ranges = [[name, *limit, *_of_case(study, settings, place)] for place, (name, limit) in enumerate(limits.items())]
    content = (f'<p class="quiet">{words}</p>' + page.pictures([picture]) + "<p></p>" + page.table(names, rows)
               + "<p></p>" + page.table(("case", "limit", "error of the time step", "cheapest within limit", "CPU s"), ranges))  # fmt: skip
    return ("Choice", None, content), lines


def _of_case(study, settings, place):
    """The cheapest setting of one case alone that is within its limit, and its CPU seconds."""
    good = [s for s in settings if s.ratios[place] <= 1 and math.isfinite(s.seconds[place])]
    if not good:
        return "none", None
    best = min(good, key=lambda s: s.seconds[place])
    return f"{best.variant} to {best.tolerance:g}", best.seconds[place]


def _known(number):
    """A number that may be infinite."""
    return number if math.isfinite(number) else None


def _figure(study, settings):
    """The error that all but a few cases stay below, over its limit, against CPU time over that of the best."""
    figure = new_figure(*SIZE)
    ax = figure.add_subplot()
    drawn = False
    for variant in study.variants:
        points = [s for s in settings if s.variant == variant.name and math.isfinite(s.cost)]
        heights = [max(LEAST_RATIO, float(np.quantile(s.ratios, study.choice["cases"], method="inverted_cdf"))) for s in points]
        points = [(s, height) for s, height in zip(points, heights, strict=True) if math.isfinite(height)]
        if not points:
            continue
        colour, marker = look(study, variant.name)
        ax.plot([s.cost for s, _ in points], [h for _, h in points], color=colour, marker=marker, markersize=4.5, lw=1, label=variant.name)
        unfit = [(s.cost, h) for s, h in points if not s.is_fit]
        if unfit:
            ax.plot(*zip(*unfit, strict=True), marker, color=colour, markersize=4.5, markerfacecolor="white")
        for s, height in points:
            if s.is_best or [s.variant, s.tolerance] == study.choice["present"]:
                ax.annotate(f"{'best' if s.is_best else 'present'}: {s.tolerance:g}", (s.cost, height), xytext=(8, 8),
                            textcoords="offset points", fontsize=8, arrowprops={"arrowstyle": "-", "lw": 0.6})  # fmt: skip
        drawn = True
    ax.set_title(f"{len(study.cases)} cases; hollow: not fit")
    if not drawn:
        say_nothing_there(ax, "nothing to draw: no setting ran in all cases")
        return figure
    ax.axhline(1, color=VERMILION, lw=1, ls="--", gid="limit")
    ax.set(xscale="log", yscale="log", xlabel="CPU time over that of the best, geometric mean [-]",
           ylabel=f"error / limit, {100 * study.choice['cases']:.0f} % of cases below")  # fmt: skip
    legend_beneath(figure, ax.get_legend_handles_labels())
    return figure

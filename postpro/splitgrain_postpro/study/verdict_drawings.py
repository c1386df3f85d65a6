"""Figures of verdicts: where along a parameter runs hold, or which cases hold by which variants."""

from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from ..style import BLUE, VERMILION, new_figure
from .model import Case
from .thresholds import changes_of
from .verdict_file import VerdictStudy
from .verdicts import Point, Verdicts

GREY = "#777777"


def thresholds(study: VerdictStudy, case: Case, table: dict[str, list[Point]]) -> Figure:
    """One row per variant along the parameter: dots hold, crosses do not; a number where the verdict changes."""
    figure = new_figure(5.2, 1.5 + 0.42 * len(table))
    ax = figure.add_subplot()
    values = [point[0].value for points in table.values() for point in points]
    for row, points in enumerate(table.values()):
        for (job, _, verdict), (other, _, next_verdict) in zip(points, points[1:], strict=False):
            colour = GREY if verdict["held"] != next_verdict["held"] else BLUE if verdict["held"] else VERMILION
            ax.plot([job.value, other.value], [row, row], color=colour, lw=2, alpha=0.45, solid_capstyle="butt", zorder=1)
        for held, marker, colour in ((True, "o", BLUE), (False, "X", VERMILION)):
            chosen = [point[0].value for point in points if point[2]["held"] == held]
            ax.plot(chosen, [row] * len(chosen), marker, color=colour, markersize=5, zorder=2)
        for number, change in enumerate(changes_of(study, points)):
            # In turns above and below the line, so that neighbours stay apart.
            ax.annotate(f"{change.low if change.held_below else change.high:.3g}", (change.low, row), (0, (6, -13)[number % 2]),
                        textcoords="offset points", ha="center", fontsize=8)  # fmt: skip
    if study.is_log:
        if min(values) > 0:
            ax.set_xscale("log")
        else:
            ax.set_xscale("symlog", linthresh=min(value for value in values if value > 0))
    ax.set_yticks(range(len(table)), list(table))
    ax.set_ylim(len(table) - 0.4, -0.7)
    ax.grid(axis="y", visible=False)
    ax.set(xlabel=f"{study.parameter} [{study.unit}]", title=case.name)
    _explain(figure)
    return figure


def matrix(study: VerdictStudy, table: Verdicts) -> Figure:
    """One row per case, one column per variant."""
    cases, variants = [case.name for case in study.cases], [variant.name for variant in study.variants]
    figure = new_figure(2.6 + 0.9 * len(variants), 1.3 + 0.24 * len(cases))
    ax = figure.add_subplot()
    for held, marker, colour in ((True, "o", BLUE), (False, "X", VERMILION)):
        places = [(variants.index(variant), cases.index(case)) for (case, variant), points in table.items()
                  if points[0][2]["held"] == held]  # fmt: skip
        if places:
            ax.plot(*zip(*places, strict=True), marker, color=colour, markersize=6)
    ax.set_xticks(range(len(variants)), variants)
    ax.set_yticks(range(len(cases)), cases)
    ax.set_xlim(-0.6, len(variants) - 0.4)
    ax.set_ylim(len(cases) - 0.4, -0.6)
    _explain(figure)
    return figure


def _explain(figure):
    """The legend, on a strip of its own beneath the panel."""
    marks = [Line2D([], [], marker="o", color=BLUE, ls="", label="holds"),
             Line2D([], [], marker="X", color=VERMILION, ls="", label="does not hold")]  # fmt: skip
    figure.legend(handles=marks, loc="lower center", ncols=2)
    strip = 0.35 / figure.get_figheight()
    figure.get_layout_engine().set(rect=(0, strip, 1, 1 - strip))

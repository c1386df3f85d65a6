"""Figures of a study with [[vary]]: values at the end against a key, and curves of a column, with means and spreads over seeds."""

from collections.abc import Iterable
from html import escape

import numpy as np

from ..style import BLACK, BLUE, GREEN, ORANGE, PURPLE, SKY, VERMILION, new_figure, styled
from .svg import embedded

COLOURS = (BLUE, VERMILION, GREEN, ORANGE, PURPLE, SKY, BLACK)
# Lines of one colour differ by these.
DASHES = ("-", "--", ":", "-.")


def shown_value(value: object) -> object:
    """A value of a key as a cell."""
    return value if isinstance(value, int | float | str) else str(value)


def boxes(blocks: list[dict], series: Iterable[dict], start: int) -> str:
    """A box for each line of the figures, which shows and hides it; its number counts from `start`."""
    labels = {block["key"]: block.get("label", block["key"]) for block in blocks}
    words = [", ".join(f"{labels[key]} = {shown_value(value)}" for key, value in one.items()) for one in series]
    return "".join(f'<label><input type="checkbox" checked data-series="{start + k}"> <span style="color:{COLOURS[k % len(COLOURS)]}">'
                   f"{'&#9679;' if k < len(COLOURS) else '&#9675;'}</span> {escape(text)}</label> " for k, text in enumerate(words))  # fmt: skip


def _style(k):
    """Colour and dashes of a line by its number."""
    return {"color": COLOURS[k % len(COLOURS)], "linestyle": DASHES[k // len(COLOURS) % len(DASHES)]}


def end_figure(number: int, first: dict, series: list[dict], column: str, statistics: list[dict]) -> str:
    """One column against the first key, one line per combination of the others, as SVG."""
    numeric = all(isinstance(value, int | float) and not isinstance(value, bool) for value in first["values"])
    places = list(first["values"]) if numeric else list(range(len(first["values"])))
    with styled():
        figure = new_figure(5, 3.6)
        ax = figure.add_subplot()
        for k, one in enumerate(series):
            found = [row for value in first["values"] for row in statistics
                     if row[first["key"]] == value and all(row[key] == other for key, other in one.items())]  # fmt: skip
            bars = ax.errorbar(places, [row["mean"] for row in found], np.nan_to_num([row["spread"] for row in found]),
                               marker="o", markersize=4, capsize=3, **_style(k))
            for part in (bars[0], *bars[1], *bars[2]):
                part.set_gid(f"series{k}")
        if not numeric:
            ax.set_xticks(places, [shown_value(value) for value in first["values"]])
        ax.set(xlabel=first.get("label", first["key"]), ylabel=_label(column))
        return embedded(figure, number, column)


def curve_figure(number: int, start: int, column: str, against: str, rows: list[dict]) -> str:
    """A column against time or another column, one line per combination of values, over a band of one standard deviation."""
    with styled():
        figure = new_figure(5, 3.6)
        ax = figure.add_subplot()
        for k, row in enumerate(rows):
            parts = ax.plot(row["x"], row["mean"], linewidth=1.2, **_style(k))
            if np.isfinite(row["spread"]).any():
                band = row["mean"] - row["spread"], row["mean"] + row["spread"]
                parts.append(ax.fill_between(row["x"], *band, color=COLOURS[k % len(COLOURS)], alpha=0.2, linewidth=0))
            for part in parts:
                part.set_gid(f"series{start + k}")
        ax.set(xlabel=_label(against), ylabel=_label(column))
        return embedded(figure, number, f"{column} against {against}")


def _label(column):
    """A column as the label of an axis."""
    return "time [s]" if column == "time" else column.replace("_", " ")

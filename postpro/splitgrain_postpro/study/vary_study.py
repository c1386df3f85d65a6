"""A study of one deck over values of any keys and over seeds: columns of results at the end of each run, with mean and spread."""

import math
from collections.abc import Callable
from html import escape
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

from splitgrain import Deck, RunError, sweep

from ..errors import StudyError
from ..style import BLACK, BLUE, GREEN, ORANGE, PURPLE, SKY, VERMILION, new_figure, styled
from .csv_text import csv_text
from .page import page, pictures, table
from .study_file import StudyFile
from .svg import embedded

TOP = {"title": (str,), "about": (str,), "deck": (str,), "restart": (str,), "seeds": (list,), "jobs": (int, str), "ranks": (int,), "plot": (list,),
       "set": (dict,), "vary": (list,)}  # fmt: skip
VARY = {"key": (str,), "values": (list,), "label": (str,)}
COLOURS = (BLUE, VERMILION, GREEN, ORANGE, PURPLE, SKY, BLACK)


class VaryReader(StudyFile):
    """Reads one study file with [[vary]]."""

    def read(self) -> dict[str, Any]:
        """The study as a checked table."""
        table = self.table
        self.check(table, TOP)
        for name in ("deck", "plot"):
            if name not in table:
                self.fail(f"a study with [[vary]] needs its '{name}'" + (": columns of the record" if name == "plot" else ""))
        if not (self.path.parent / table["deck"]).is_file():
            self.fail(f"there is no deck {self.path.parent / table['deck']}", key="deck")
        if not table["plot"] or not all(isinstance(name, str) for name in table["plot"]):
            self.fail("'plot' should be a list of columns of the record", key="plot")
        if table.get("jobs", 1) != "all" and (isinstance(table.get("jobs", 1), str) or table.get("jobs", 1) < 1):
            self.fail("'jobs' should be a whole number above 0, or \"all\"", key="jobs")
        for number, block in enumerate(table["vary"], 1):
            self.table_of(block, VARY, "vary", number)
            for name in ("key", "values"):
                if not block.get(name):
                    self.fail(f"[[vary]] needs its '{name}'", "vary", number, name)
        if any(isinstance(seed, bool) or not isinstance(seed, int) for seed in table.get("seeds", [])):
            self.fail("'seeds' should be a list of whole numbers", key="seeds")
        return table


def is_varied(table: dict) -> bool:
    """Is a study file one with [[vary]]?"""
    return "vary" in table


def do_vary(
    path: Path, folder: Path, workers: Callable[[int | str], int], show: Callable[[str], None], part: tuple[int, int] | None = None,
) -> list[str]:
    """Run the study and write study.html, results.csv and statistics.csv, or do a part of the runs alone; returns what came out."""
    reader = VaryReader(path)
    study = reader.read()
    values = {block["key"]: block["values"] for block in study["vary"]}
    if study.get("seeds"):
        values["seed"] = study["seeds"]
    restart = {"restart": path.parent / study["restart"]} if "restart" in study else {}
    try:
        runs = sweep(Deck(path.parent / study["deck"]), values, jobs=workers(study.get("jobs", 1)), output=folder / "runs",
                     progress=show, set=study.get("set", {}), ranks=study.get("ranks", 1), part=part or (1, 1), **restart)  # fmt: skip
    except RunError as error:
        raise StudyError(str(error).partition("error: ")[2] or str(error), path, code=1 if error.code != 2 else 2) from error
    if part:
        return [f"part {part[0]} of {part[1]}: {len(runs)} runs are done; the study without --part does what is left, and its page"]
    for name in study["plot"]:
        try:
            runs.last(name)
        except KeyError as missing:
            reader.fail(missing.args[0], key="plot")
    rows = [[*(_shown(value) for value in values.values()), *numbers]
            for values, *numbers in zip(runs.values, *(runs.last(name) for name in study["plot"]), strict=True)]  # fmt: skip
    names = [*values, *study["plot"]]
    (folder / "results.csv").write_text(csv_text([names, *rows]))
    statistics = {name: runs.statistics(name, over="seed") for name in study["plot"]}
    (folder / "statistics.csv").write_text(csv_text(_statistics_rows(study, statistics)))
    (folder / "study.html").write_text(_page(study, runs, statistics, names, rows))
    return [f"wrote {folder / 'study.html'}, results.csv and statistics.csv: {len(runs)} runs, {len(study['plot'])} figures"]


def _statistics_rows(study, statistics):
    """Mean and spread of every column, one row per combination of values."""
    keys = [block["key"] for block in study["vary"]]
    yield [*keys, "runs", *(f"{kind} of {name}" for name in statistics for kind in ("mean", "spread"))]
    for rows in zip(*statistics.values(), strict=True):
        numbers = [None if math.isnan(row[kind]) else row[kind] for row in rows for kind in ("mean", "spread")]
        yield [*(_shown(rows[0][key]) for key in keys), rows[0]["runs"], *numbers]


def _page(study, runs, statistics, names, rows):
    """The page: a figure for each column, boxes that show and hide lines, all numbers."""
    first, *others = study["vary"]
    series = [dict(zip([block["key"] for block in others], combination, strict=True))
              for combination in product(*(block["values"] for block in others))]  # fmt: skip
    labels = [", ".join(f"{block.get('label', block['key'])} = {_shown(one[block['key']])}" for block in others) for one in series]
    figures = [_figure(number, first, series, name, found) for number, (name, found) in enumerate(statistics.items())]
    boxes = "".join(f'<label><input type="checkbox" checked data-series="{k}"> <span style="color:{COLOURS[k % len(COLOURS)]}">&#9679;</span> '
                    f"{escape(label)}</label> " for k, label in enumerate(labels)) if others else ""  # fmt: skip
    seeds = len(study.get("seeds", [])) or 1
    facts = f"{len(runs)} runs of {study['deck']}; points are means over {seeds} seeds, bars one standard deviation." if seeds > 1 else \
            f"{len(runs)} runs of {study['deck']}."
    return page(study.get("title", "Study"), study.get("about", ""), facts,
                [("Last values of the record", None, f"<p>{boxes}</p>{pictures(figures)}"),
                 ("All runs", False, table(names, rows))])


def _figure(number, first, series, column, statistics):
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
                               color=COLOURS[k % len(COLOURS)], marker="o", markersize=4, capsize=3)
            for part in (bars[0], *bars[1], *bars[2]):
                part.set_gid(f"series{k}")
        if not numeric:
            ax.set_xticks(places, [_shown(value) for value in first["values"]])
        ax.set(xlabel=first.get("label", first["key"]), ylabel=column.replace("_", " "))
        return embedded(figure, number, column)


def _shown(value):
    """A value of a key as a cell."""
    return value if isinstance(value, int | float | str) else str(value)

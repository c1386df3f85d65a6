"""A study of one deck over values of any keys and over seeds: columns of results at the end of each run, with mean and spread."""

import math
from collections.abc import Callable
from itertools import product
from pathlib import Path
from typing import Any

from splitgrain import Deck, RunError, sweep

from ..errors import StudyError
from .csv_text import csv_text
from .page import page, pictures, table
from .study_file import StudyFile
from .vary_figures import boxes, curve_figure, end_figure, shown_value

TOP = {"title": (str,), "about": (str,), "deck": (str,), "restart": (str,), "seeds": (list,), "jobs": (int, str), "ranks": (int,), "plot": (list,), "curves": (list,),
       "set": (dict,), "vary": (list,)}  # fmt: skip
VARY = {"key": (str,), "values": (list,), "label": (str,)}


class VaryReader(StudyFile):
    """Reads one study file with [[vary]]."""

    def read(self) -> dict[str, Any]:
        """The study as a checked table."""
        table = self.table
        self.check(table, TOP)
        if "deck" not in table:
            self.fail("a study with [[vary]] needs its 'deck'")
        if not table.get("plot") and not table.get("curves"):
            self.fail("a study with [[vary]] needs 'plot' or 'curves': columns of the record", key="plot" if "plot" in table else "")
        if not (self.path.parent / table["deck"]).is_file():
            self.fail(f"there is no deck {self.path.parent / table['deck']}", key="deck")
        for name in ("plot", "curves"):
            if not all(isinstance(column, str) for column in table.get(name, [])):
                self.fail(f"'{name}' should be a list of columns of the record", key=name)
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
    plot, key = study.get("plot", []), "plot"
    try:
        statistics = {name: runs.statistics(name, over="seed") for name in plot}
        key = "curves"
        pairs = {text: [part.strip() for part in text.partition(" against ")[::2]] for text in study.get("curves", [])}
        curves = {(column, against or "time"): runs.curves(column, against or "time", over="seed") for column, against in pairs.values()}
    except KeyError as missing:
        reader.fail(missing.args[0], key=key)
    rows = [[*(shown_value(value) for value in values.values()), *numbers]
            for values, *numbers in zip(runs.values, *(runs.last(name) for name in plot), strict=True)]  # fmt: skip
    names = [*values, *plot]
    files = {"results.csv": csv_text([names, *rows]), "statistics.csv": csv_text(_statistics_rows(study, statistics)) if plot else "",
             "curves.csv": csv_text(_curve_rows(study, curves)) if curves else "", "study.html": _page(study, runs, statistics, curves, rows, names)}
    written = [name for name, text in files.items() if text]
    for name in written:
        (folder / name).write_text(files[name])
    return [f"wrote {folder / written.pop()}, {', '.join(written)}: {len(runs)} runs, {len(statistics) + len(curves)} figures"]


def _curve_rows(study, curves):
    """All points of all curves: mean and spread of a column over the mean of another one."""
    keys = [block["key"] for block in study["vary"]]
    yield [*keys, "column", "against", "x", "mean", "spread", "runs"]
    for (column, against), rows in curves.items():
        for row in rows:
            for numbers in zip(row["x"], row["mean"], row["spread"], strict=True):
                yield [*(shown_value(row[key]) for key in keys), column, against,
                       *(None if math.isnan(number) else number for number in numbers), row["runs"]]  # fmt: skip


def _statistics_rows(study, statistics):
    """Mean and spread of every column, one row per combination of values."""
    keys = [block["key"] for block in study["vary"]]
    yield [*keys, "runs", *(f"{kind} of {name}" for name in statistics for kind in ("mean", "spread"))]
    for rows in zip(*statistics.values(), strict=True):
        numbers = [None if math.isnan(row[kind]) else row[kind] for row in rows for kind in ("mean", "spread")]
        yield [*(shown_value(rows[0][key]) for key in keys), rows[0]["runs"], *numbers]


def _page(study, runs, statistics, curves, rows, names):
    """The page: a figure for each column and for each curve, boxes that show and hide lines, all numbers."""
    first, *others = study["vary"]
    series = [dict(zip([block["key"] for block in others], combination, strict=True))
              for combination in product(*(block["values"] for block in others))]  # fmt: skip
    ends = [end_figure(number, first, series, name, found) for number, (name, found) in enumerate(statistics.items())]
    lines = [curve_figure(len(ends) + number, len(series), *name, found) for number, (name, found) in enumerate(curves.items())]
    all_values = [{block["key"]: row[block["key"]] for block in study["vary"]} for row in next(iter(curves.values()), [])]
    seeds = len(study.get("seeds", [])) or 1
    facts = f"{len(runs)} runs of {study['deck']}" + (
        f"; points and lines are means over {seeds} seeds, bars and bands one standard deviation." if seeds > 1 else ".")
    sections = [("Values at the end", None, boxes(study["vary"], series if others else [], 0) + pictures(ends))] if ends else []
    if lines:
        sections.append(("Curves", None, boxes(study["vary"], all_values, len(series)) + pictures(lines)))
    return page(study.get("title", "Study"), study.get("about", ""), facts, [*sections, ("All runs", False, table(names, rows))])

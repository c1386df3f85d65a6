"""Runs of a deck over all combinations of some values, which go on where they were stopped; means and spreads over repetitions."""

import hashlib
import json
import re
from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import ThreadPoolExecutor
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

from .deck import Deck
from .errors import RunError
from .run import Run

OVER_ROWS: dict[str, Callable[[np.ndarray], float]] = {"largest": np.nanmax, "least": np.nanmin, "mean": np.nanmean}
"""What a number of a run may be in place of the last value of a column."""


class Sweep:
    """The runs of a sweep, in the order of the combinations."""

    def __init__(self, values: list[dict[str, Any]], runs: list[Run]):
        self.values, self.runs = values, runs

    def __len__(self) -> int:
        return len(self.runs)

    def last(self, column: str | Callable[[Run], float]) -> np.ndarray:
        """A number per run: a column (`last_value`), or what a function returns for a run."""
        if callable(column):
            return np.array([float(column(run)) for run in self.runs])
        return np.array([last_value(run.results, column) for run in self.runs])

    def statistics(self, column: str | Callable[[Run], float], over: str = "seed") -> list[dict[str, Any]]:
        """For every combination of the other values: `mean`, `spread` (standard deviation, not a number for one) and `runs`."""
        numbers = self.last(column)
        rows = []
        for other, own in self._groups(over):
            found = numbers[own]
            spread = float(found.std(ddof=1)) if len(own) > 1 else float("nan")
            rows.append({**other, "mean": float(found.mean()), "spread": spread, "runs": len(own)})
        return rows

    def curves(self, column: str, against: str = "time", over: str = "seed", points: int = 200) -> list[dict[str, Any]]:
        """For every combination of the other values a column in time: `x` (mean of `against`), `mean`, `spread` and `runs`.

        Runs are interpolated to common times, as far as all of a combination go.
        """
        rows = []
        for other, own in self._groups(over):
            pairs = [[timed_column(self.runs[k].results, name) for name in (against, column)] for k in own]
            times = [time for pair in pairs for time, _ in pair]
            grid = np.linspace(max(time[0] for time in times), min(time[-1] for time in times), points)
            x, y = (np.array([np.interp(grid, *pair[k]) for pair in pairs]) for k in (0, 1))
            spread = y.std(axis=0, ddof=1) if len(own) > 1 else np.full(points, np.nan)
            rows.append({**other, "x": x.mean(axis=0), "mean": y.mean(axis=0), "spread": spread, "runs": len(own)})
        return rows

    def _groups(self, over):
        """Values other than one, and the numbers of the runs that have them."""
        groups: dict[str, tuple[dict, list[int]]] = {}
        for k, values in enumerate(self.values):
            other = {key: value for key, value in values.items() if key != over}
            groups.setdefault(_text(other), (other, []))[1].append(k)
        return list(groups.values())

    def table(self, *columns: str) -> Any:
        """Values and last numbers of columns, one row per run: a pandas DataFrame, or a list of dictionaries without pandas."""
        numbers = {column: self.last(column) for column in columns}
        rows = [{**values, **{column: numbers[column][k] for column in columns}} for k, values in enumerate(self.values)]
        try:
            import pandas
        except ModuleNotFoundError:
            return rows
        return pandas.DataFrame(rows)


def last_value(results: Any, column: str) -> float:
    """The last value of a column, which is named as in `timed_column`; behind `largest of`, `least of` or `mean of` that over all rows."""
    what, of, name = column.strip().partition(" of ")
    if of and what in OVER_ROWS:
        return float(OVER_ROWS[what](timed_column(results, name)[1]))
    return float(timed_column(results, column)[1][-1])


def timed_column(results: Any, column: str) -> tuple[np.ndarray, np.ndarray]:
    """Times and values of a column of the record; of `column(name)` those of a region, a tracked body or a wall; of each with
    `after STAGE` behind it those up to the end of that stage. A KeyError holds a sentence about what is not there."""
    found = re.fullmatch(r"(\w+)(?:\((.+)\))?(?: after (.+))?", column.strip())
    name, owner, stage = found.groups() if found else (column, None, None)
    tables = [results.record] if owner is None else [one[owner] for one in (results.regions, results.tracks, results.walls) if owner in one]
    rows = next((one for one in tables if name in one), {})
    where = ("the record" if owner is None else f"the region, track or wall '{owner}'" if tables else
             f"no region, track or wall is called '{owner}', so it")  # fmt: skip
    if not len(rows.get(name, ())):
        raise KeyError(f"{where} has no column '{name}'")
    if stage is None:
        return rows["time"], rows[name]
    ends = [one["last_step"] for one in results.run.get("stages", []) if one["name"] == stage]
    count = np.count_nonzero(rows["step"] <= ends[0]) if ends else 0
    if not count:
        raise KeyError(f"the run has no stage '{stage}', or no row up to its end")
    return rows["time"][:count], rows[name][:count]


def sweep(
    deck: Deck | str | Path, values: Mapping[str, Iterable[Any]], jobs: int = 1, output: str | Path | None = None,
    progress: Callable[[str], object] | bool = False, part: tuple[int, int] = (1, 1), **options: Any,
) -> Sweep:
    """Run a deck for every combination of values, `jobs` at a time; runs that are done are not run again.

    values: keys of `--set` with their values; `seed` alone is `sample.seed`. output: folder of the sweep (default: NAME.sweep here).
    part: (2, 5) for the second of five parts of the runs, which tasks of a job array share.
    options: those of `Deck.run`. A run that fails raises its error once all others have ended.
    """
    deck = deck if isinstance(deck, Deck) else Deck(deck)
    folder = Path(output) if output is not None else Path(f"{deck.path.stem if deck.path else 'deck'}.sweep")
    folder.mkdir(parents=True, exist_ok=True)
    keys = list(values)
    combinations = [dict(zip(keys, combination, strict=True)) for combination in product(*(list(values[key]) for key in keys))]
    combinations = combinations[part[0] - 1 :: part[1]]
    show = print if progress is True else progress or (lambda line: None)

    def one(combination):
        settings = {"sample.seed" if key == "seed" else key: value for key, value in combination.items()}
        settings |= options.get("set") or {}
        start = {"restart": str(options["restart"])} if options.get("restart") else {}
        text = _text({"deck": deck.toml(), **settings, "ranks": options.get("ranks", 1), **start})
        place = folder / hashlib.sha256(text.encode()).hexdigest()[:12]
        label = ", ".join(f"{key} = {value}" for key, value in combination.items())
        if _is_done(place):
            show(f"{label}: done before")
            return Run(place)
        try:
            run = deck.run(place, **{**options, "set": settings, "force": True})
        except RunError as error:
            show(f"{label}: {error.sentence}")
            return error
        (folder / f"{place.name}.json").write_text(_text(combination))
        show(f"{label}: done")
        return run

    with ThreadPoolExecutor(max(1, jobs)) as pool:
        runs = list(pool.map(one, combinations))
    for combination, run in zip(combinations, runs, strict=True):
        if isinstance(run, RunError):
            run.add_note(f"with {combination}")
            raise run
    return Sweep(combinations, runs)


def _is_done(place):
    """Did this run end, and is its record there?"""
    try:
        return json.loads((place / "run.json").read_text())["status"] == "done"
    except (OSError, ValueError, KeyError):
        return False


def _text(values):
    """Values as JSON, always in the same order."""
    return json.dumps(values, sort_keys=True, default=lambda value: value.tolist() if hasattr(value, "tolist") else str(value))

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


class Sweep:
    """The runs of a sweep, in the order of the combinations."""

    def __init__(self, values: list[dict[str, Any]], runs: list[Run]):
        self.values, self.runs = values, runs

    def __len__(self) -> int:
        return len(self.runs)

    def last(self, column: str | Callable[[Run], float]) -> np.ndarray:
        """A number per run: the last value of a column (`last_value`), or what a function returns for a run."""
        if callable(column):
            return np.array([float(column(run)) for run in self.runs])
        return np.array([last_value(run.results, column) for run in self.runs])

    def statistics(self, column: str | Callable[[Run], float], over: str = "seed") -> list[dict[str, Any]]:
        """For every combination of the other values: `mean`, `spread` (standard deviation, not a number for one) and `runs`."""
        groups: dict[str, list[int]] = {}
        others = [{key: value for key, value in values.items() if key != over} for values in self.values]
        for k, other in enumerate(others):
            groups.setdefault(_text(other), []).append(k)
        numbers = self.last(column)
        rows = []
        for own in groups.values():
            found = numbers[own]
            spread = float(found.std(ddof=1)) if len(own) > 1 else float("nan")
            rows.append({**others[own[0]], "mean": float(found.mean()), "spread": spread, "runs": len(own)})
        return rows

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
    """The last value of a column of the record; of `column(name)` that of a region or a tracked body; of either with `after STAGE`
    behind it the last one of that stage. A KeyError holds a sentence about what is not there."""
    found = re.fullmatch(r"(\w+)(?:\((.+)\))?(?: after (.+))?", column.strip())
    name, owner, stage = found.groups() if found else (column, None, None)
    rows = results.record if owner is None else results.regions.get(owner, results.tracks.get(owner, {}))
    where = "the record" if owner is None else f"the region or the track '{owner}'" if rows else f"no region and no track '{owner}', so it"
    if not len(rows.get(name, ())):
        raise KeyError(f"{where} has no column '{name}'")
    if stage is None:
        return float(rows[name][-1])
    ends = [one["last_step"] for one in results.run.get("stages", []) if one["name"] == stage]
    last = np.flatnonzero(rows["step"] <= ends[0]) if ends else []
    if not len(last):
        raise KeyError(f"the run has no stage '{stage}', or no row up to its end")
    return float(rows[name][last[-1]])


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

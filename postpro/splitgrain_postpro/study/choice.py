"""A choice among variants and tolerances: those whose error stays within what the time step costs anyway, by their CPU time.

The error of a setting in a case is the difference of a measure from the run of the first variant at the smallest tolerance. The limit of
a case is a share of what the time step itself does to that measure (the difference between that run and one with a time step so many
times finer over the same time), but not less than a small part of the grains' mean radius. A setting is fit when its error is within the
limit in most cases and never far beyond it. Of the fit ones, that with the smallest geometric mean of CPU times over the cases is the
best. All numbers of this stand in the study before it is run.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from .jobs import finer_variant
from .measures import rms_of_bodies
from .model import Case, Measure, Study, Table


@dataclass
class Setting:
    """A variant at a tolerance: what it did in all cases."""

    variant: str
    tolerance: float
    # Error over the limit, and CPU seconds, per case; infinite where a run did not end well.
    ratios: list
    seconds: list
    # CPU time over that of the fastest fit setting, geometric mean over the cases.
    cost: float = math.inf
    is_fit: bool = False
    is_best: bool = False

    @property
    def within(self) -> float:
        """Share of cases within the limit."""
        return sum(ratio <= 1 for ratio in self.ratios) / len(self.ratios)

    @property
    def worst(self) -> float:
        """Largest error over its limit."""
        return max(self.ratios)


def choose(study: Study, table: Table) -> tuple[list[Setting], dict[str, tuple[float | None, float | None]]]:
    """All settings, judged; and the limit and the error of the time step of each case."""
    place = [measure.name for measure in study.measures].index(study.choice["measure"])
    measure = study.measures[place]

    def value(case, variant, tolerance):
        result = table.get((case, variant, tolerance)) or {}
        return np.array(result["series"][place][1]) if result.get("series") else None

    finest, first = min(study.values), study.variants[0].name
    limits, references = {}, {}
    for case in study.cases:
        references[case.name] = value(case.name, first, finest)
        limits[case.name] = limit_of(study, case, measure, table, references[case.name], value)
    settings = []
    for variant in study.variants:
        # The smallest tolerance is what others are measured by.
        for tolerance in [t for t in variant.values or study.values if t != finest]:
            ratios, seconds = [], []
            for case in study.cases:
                found, limit = value(case.name, variant.name, tolerance), limits[case.name][0]
                is_known = found is not None and references[case.name] is not None and limit
                ratios.append(difference(measure, found, references[case.name]) / limit if is_known else math.inf)
                seconds.append((table.get((case.name, variant.name, tolerance)) or {}).get("cpu_seconds") or math.inf)
            settings.append(Setting(variant.name, tolerance, ratios, seconds))
    judge(settings, study.choice)
    return settings, limits


def limit_of(
    study: Study, case: Case, measure: Measure, table: Table, reference: np.ndarray | None,
    value: Callable[[str, str, float], np.ndarray | None],
) -> tuple[float | None, float | None]:
    """The limit of a case, and the error of its time step; None where a run is missing."""
    finer = value(case.name, finer_variant(study, case).name, min(study.values))
    if reference is None or finer is None:
        return None, None
    step = difference(measure, reference, finer)
    radius = (table.get((case.name, study.variants[0].name, min(study.values))) or {}).get("mean_radius") or 0.0
    return max(study.choice["share"] * step, study.choice["least"] * radius), step


def difference(measure: Measure, one: np.ndarray, other: np.ndarray) -> float:
    """Difference of a measure between two runs."""
    return rms_of_bodies(one - other) if measure.bodies else float(abs(one[-1] - other[-1]))


def judge(settings: list[Setting], choice: dict) -> None:
    """Which settings are fit, what each costs over the cheapest fit one, and which is best."""
    for setting in settings:
        setting.is_fit = setting.within >= choice["cases"] and setting.worst <= choice["worst"]
    means = [math.exp(np.mean(np.log(setting.seconds))) if all(map(math.isfinite, setting.seconds)) else math.inf
             for setting in settings]  # fmt: skip
    least = min((mean for setting, mean in zip(settings, means, strict=True) if setting.is_fit), default=min(means))
    for setting, mean in zip(settings, means, strict=True):
        setting.cost = mean / least if math.isfinite(least) else math.inf
        setting.is_best = setting.is_fit and mean == least

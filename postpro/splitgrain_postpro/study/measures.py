"""Errors of runs against a closed form, or against the run of the finest value; and the order in which they fall."""

import numpy as np

from .expressions import evaluate
from .model import Study, Table

LEVELS = [10.0**-power for power in range(1, 11)]
"""Levels of E8 within a step at which efforts are listed"""


def messages_of(point: dict[str, float], subdomains: float) -> float:
    """Messages up to a point of a history. A collective operation counts as those of a tree, to one rank and back."""
    return point["messages"] + 2 * (subdomains - 1) * point["collectives"]


def efforts_to_levels(points: list[dict[str, float]], subdomains: float) -> list[list[float]]:
    """What a history took to bring E8 to each level for the first time: level, iterations, CPU seconds, messages, bytes."""
    firsts = [(level, next((point for point in points if point["e8"] <= level), None)) for level in LEVELS]
    return [[level, first["iteration"], first["cpu_seconds"], messages_of(first, subdomains), first["bytes"]] for level, first in firsts if first]


def errors_of(study: Study, table: Table, measure_number: int) -> dict[tuple[str, str], list[tuple[float, float]]]:
    """Error of a measure by case, variant and value: a dictionary of (case, variant) to a list of (value, error)."""
    measure = study.measures[measure_number]
    finest = study.values[-1] if study.axis != "subdomains" else 1
    found = {}
    for case in study.cases:
        for variant in study.variants:
            runs = {value: result for value in study.values if (result := table.get((case.name, variant.name, value)))
                    and result.get("series")}  # fmt: skip
            exact_variant = study.variants[0].name if measure.against == "first" else variant.name
            best = table.get((case.name, exact_variant, finest))
            if not measure.closed_form and not (best and best.get("series")):
                continue
            points = []
            for value, result in runs.items():
                if not measure.closed_form and value == finest and exact_variant == variant.name:
                    continue
                times, values = (np.array(numbers) for numbers in result["series"][measure_number])
                if measure.closed_form:
                    exact = np.array([evaluate(measure.closed_form, study.constants | {"t": t}) for t in times])
                elif measure.bodies:
                    exact = np.array(best["series"][measure_number][1])
                else:
                    other_times, others = (np.array(numbers) for numbers in best["series"][measure_number])
                    exact = np.interp(times, other_times, others)
                difference = np.abs(values - exact)
                points.append((value, rms_of_bodies(difference) if measure.bodies else norm(difference, measure.over)))
            found[case.name, variant.name] = points
    return found


def rms_of_bodies(differences: np.ndarray) -> float:
    """Root mean square over the bodies of differences that hold three components of each."""
    return float(np.sqrt(3 * np.mean(np.square(differences))))


def norm(errors: np.ndarray, over: str) -> float:
    """Errors over time as one number."""
    return float({"end": lambda e: e[-1], "mean": np.mean, "largest": np.max}[over](errors))


def order_of(points: list[tuple[float, float]]) -> float | None:
    """Slope of log(error) against log(value) by least squares; None with fewer than two errors above zero."""
    points = [(value, error) for value, error in points if error > 0 and np.isfinite(error)]
    if len({value for value, _ in points}) < 2:
        return None
    values, errors = np.log(np.array(points)).T
    return float(np.polyfit(values, errors, 1)[0])

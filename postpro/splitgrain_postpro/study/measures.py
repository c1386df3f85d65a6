"""Errors of runs against a closed form, or against the run of the finest value; and the order in which they fall."""

import numpy as np

from .expressions import evaluate


def errors_of(study, table, measure_number):
    """Error of a measure by case, variant and value: a dictionary of (case, variant) to a list of (value, error)."""
    measure = study.measures[measure_number]
    found = {}
    for case in study.cases:
        for variant in study.variants:
            runs = {value: result for value in study.values if (result := table.get((case.name, variant.name, value)))
                    and result.get("series")}  # fmt: skip
            finest = study.values[-1] if study.axis != "subdomains" else 1
            if not measure.closed_form and finest not in runs:
                continue
            points = []
            for value, result in runs.items():
                if not measure.closed_form and value == finest:
                    continue
                times, values = (np.array(numbers) for numbers in result["series"][measure_number])
                if measure.closed_form:
                    exact = np.array([evaluate(measure.closed_form, study.constants | {"t": t}) for t in times])
                else:
                    other_times, others = (np.array(numbers) for numbers in runs[finest]["series"][measure_number])
                    exact = np.interp(times, other_times, others)
                points.append((value, norm(np.abs(values - exact), measure.over)))
            found[case.name, variant.name] = points
    return found


def norm(errors, over):
    """Errors over time as one number."""
    return float({"end": lambda e: e[-1], "mean": np.mean, "largest": np.max}[over](errors))


def order_of(points):
    """Slope of log(error) against log(value) by least squares; None with fewer than two errors above zero."""
    points = [(value, error) for value, error in points if error > 0 and np.isfinite(error)]
    if len({value for value, _ in points}) < 2:
        return None
    values, errors = np.log(np.array(points)).T
    return float(np.polyfit(values, errors, 1)[0])

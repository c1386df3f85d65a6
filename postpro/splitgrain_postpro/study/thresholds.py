"""Where a verdict changes along a parameter, found by bisection."""

from collections.abc import Callable
from dataclasses import dataclass

from .model import Result
from .verdict_file import VerdictStudy, distance, middle
from .verdicts import Point, VerdictJob, judge


@dataclass
class Change:
    """The verdict of a case by a variant changes between two values of the parameter."""

    case: str
    variant: str
    low: float
    high: float
    held_below: bool
    why: str
    """Why the side that does not hold does not"""


def changes_of(study: VerdictStudy, points: list[Point]) -> list[Change]:
    """Changes among the points of a case by a variant: `points` lists (job, result, verdict) in rising order of the value."""
    found = []
    for (job, _, verdict), (other, _, next_verdict) in zip(points, points[1:], strict=False):
        if verdict["held"] != next_verdict["held"]:
            why = (next_verdict if verdict["held"] else verdict)["why"]
            found.append(Change(job.case.name, job.variant.name, job.value, other.value, verdict["held"], why))
    return found


def sharpen(study: VerdictStudy, points: list[Point], run: Callable[[float], tuple[VerdictJob, Result]]) -> list[Point]:
    """Bisect every change among `points` until its ends are near enough; returns the points, with those in between."""
    points = sorted(points, key=lambda point: point[0].value)
    if study.until is None:
        return points
    for change in changes_of(study, points):
        low, high = change.low, change.high
        while distance(low, high, study.is_log) > study.until:
            value = middle(low, high, study.is_log)
            if not low < value < high:
                break
            job, result = run(value)
            verdict = judge(study, job, result)
            points.append((job, result, verdict))
            low, high = (value, high) if verdict["held"] == change.held_below else (low, value)
    return sorted(points, key=lambda point: point[0].value)


def sentence(study: VerdictStudy, points: list[Point]) -> str:
    """How far a case by a variant holds, in one sentence."""
    first, last = points[0], points[-1]
    head = f"{first[0].case.name}, {first[0].variant.name}: "
    if first[0].value is None:
        verdict = first[2]
        return head + ("holds" if verdict["held"] else "does not hold") + (f" ({verdict['why']})" if verdict["why"] else "")
    unit = "" if study.unit == "-" else f" {study.unit}"
    changes = changes_of(study, points)
    if not changes:
        does = "holds" if first[2]["held"] else "does not hold"
        why = f" ({first[2]['why']})" if first[2]["why"] else ""
        return f"{head}{does} from {first[0].value:.4g} to {last[0].value:.4g}{unit}{why}"
    words = [f"{'holds up' if change.held_below else 'does not hold up'} to {change.low:.4g}, "
             f"{'not at' if change.held_below else 'holds at'} {change.high:.4g}{unit} ({change.why})" for change in changes]  # fmt: skip
    return head + "; ".join(words)

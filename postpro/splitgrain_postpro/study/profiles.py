"""Performance profiles after Dolan and More (2002)."""

import math

from .model import Case, Study, Table


def profile(times: dict[str, dict[str, float]]) -> tuple[dict[str, list[float]], int]:
    """Profiles of solvers from `times[solver][problem]`, infinite where unsolved.

    Returns for each solver the ratios to the fastest at which its share of problems grows, sorted: the share at tau is the number
    of ratios up to tau over that of problems. Problems that no solver solves count for all of them as unsolved.
    """
    problems = sorted({problem for row in times.values() for problem in row})
    best = {problem: min(row.get(problem, math.inf) for row in times.values()) for problem in problems}
    ratios = {}
    for solver, row in times.items():
        solved = [problem for problem in problems if math.isfinite(row.get(problem, math.inf))]
        ratios[solver] = sorted(row[problem] / best[problem] for problem in solved)
    return ratios, len(problems)


def share(ratios: list[float], count: int, tau: float) -> float:
    """Share of problems that a solver solves within tau times the time of the fastest."""
    return sum(ratio <= tau for ratio in ratios) / count if count else 0.0


def times_of(
    study: Study, table: Table, tolerance: float, cases: list[Case] | None = None, clock: str = "cpu_seconds", least: float = 1e-6,
) -> dict[str, dict[str, float]]:
    """Time of each variant on each problem to reach a tolerance on e1, measured from the answer; infinite where it does not.

    `cases` are those that count, all unless given.
    """
    times = {variant.name: {} for variant in study.variants}
    for variant in study.variants:
        for case in cases or study.cases:
            result = table.get((case.name, variant.name, tolerance), {})
            error = result.get("e1")
            is_solved = result.get("status") == "solved" and error is not None and error <= tolerance
            times[variant.name][case.name] = max(result.get(clock) or 0.0, least) if is_solved else math.inf
    return times

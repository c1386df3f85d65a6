"""A study that gives verdicts, from its file to its report: all values first, then thresholds between them."""

from collections.abc import Callable
from pathlib import Path

from .model import Result
from .program import Program
from .runner import Store, run_jobs
from .threads import do_all, threads_of
from .thresholds import sharpen
from .verdict_file import VerdictReader, VerdictStudy
from .verdict_report import VerdictReport
from .verdicts import VerdictJob, Verdicts, job_of, judge, run_verdict


def do_verdicts(
    path: Path, jobs: Callable[[VerdictStudy], int], store_of: Callable[[], Store], program: Program, show: Callable[[str], None],
) -> tuple[VerdictReport, list[tuple[VerdictJob, Result]]]:
    """Do a study that gives verdicts; returns its report and all (job, result)."""
    study = VerdictReader(path).study()
    workers, store = jobs(study), store_of()
    todo = [job_of(study, case, variant, value, program) for case in study.cases for variant in study.variants
            for value in study.values]  # fmt: skip
    results = run_jobs(study, todo, store, program, workers, show, run_verdict)
    table = {}
    for job, result in zip(todo, results, strict=True):
        table.setdefault((job.case.name, job.variant.name), []).append((job, result, judge(study, job, result)))
    if study.until is not None:
        sharpen_all(study, table, store, program, workers, show)
    points = [point[:2] for points in table.values() for point in points]
    return VerdictReport(study, table, store, program.version), points


def sharpen_all(study: VerdictStudy, table: Verdicts, store: Store, program: Program, workers: int, show: Callable[[str], None]) -> None:
    """Bisect the changes of all cases by all variants; those of one follow each other, others go on beside."""

    def one(place):
        case, variant = table[place][0][0].case, table[place][0][0].variant

        def run(value):
            job = job_of(study, case, variant, value, program)
            result = store.load(job.key)
            if result is None:
                result = run_verdict(job, store, program)
                if result["status"] != "failed":
                    store.save(job.key, result)
                show(f"between: {job.label}: {result['status']}")
            return job, result

        table[place] = sharpen(study, table[place], run)

    with threads_of(program, workers) as pool:
        do_all(pool, one, list(table))

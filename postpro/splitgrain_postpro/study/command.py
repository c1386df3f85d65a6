"""The command `splitgrain study STUDY.toml --output DIR`."""

import os
import signal
import sys
from argparse import Namespace
from contextlib import contextmanager
from pathlib import Path

from ..errors import StudyError
from .description import read_study
from .index_page import write_index
from .jobs import jobs_of
from .program import Program
from .report import Report
from .runner import Store, run_jobs
from .study_file import StudyFile
from .vary_study import do_vary, is_varied
from .verdict_file import gives_verdicts
from .verdict_study import do_verdicts

EXIT_DONE, EXIT_FAILED, EXIT_STOPPED = 0, 1, 75


def run_study(arguments: Namespace) -> int:
    """Do a study; returns the exit code."""
    try:
        return _study(arguments)
    except StudyError as error:
        print(error.report(), file=sys.stderr)
        return error.code
    except KeyboardInterrupt:
        print("stopped: finished runs are kept; the same command goes on with the others", file=sys.stderr)
        return EXIT_STOPPED


def _study(arguments):
    """Read, run, report."""
    if int(os.environ.get("OMPI_COMM_WORLD_SIZE", os.environ.get("PMI_SIZE", "1"))) > 1:
        raise StudyError("each run of a study is one process, also with several subdomains: call it without mpiexec")
    if arguments.study.is_dir():
        print(write_index(arguments.study))
        return EXIT_DONE
    table = StudyFile(arguments.study).table
    if is_varied(table):
        return _varied(arguments)
    if arguments.part is not None:
        raise StudyError("--part is for studies with [[vary]]")
    if gives_verdicts(table):
        return _verdicts(arguments)
    study = read_study(arguments.study)
    workers = workers_of(arguments.jobs if arguments.jobs is not None else study.jobs)
    program = Program(arguments.program)
    store = _store(arguments)
    with _stopped_by_term():
        jobs = jobs_of(study, program.digest)
        results = run_jobs(study, jobs, store, program, workers, _show)
    return _conclude(Report(study, jobs, results, store, program.version), store, jobs, results)


def _verdicts(arguments):
    """Read, run, report, where verdicts are wanted."""
    program = Program(arguments.program)
    with _stopped_by_term():
        report, points = do_verdicts(
            arguments.study, lambda study: workers_of(arguments.jobs if arguments.jobs is not None else study.jobs),
            lambda: _store(arguments), program, _show)  # fmt: skip
    return _conclude(report, report.store, *zip(*points, strict=True))


def _varied(arguments):
    """Run one deck over values of keys."""
    os.environ["SPLITGRAIN_PROGRAM"] = Program(arguments.program).path
    folder = arguments.output or Path(f"{arguments.study.stem}.study")
    folder.mkdir(parents=True, exist_ok=True)
    with _stopped_by_term():
        lines = do_vary(arguments.study, folder, lambda jobs: workers_of(arguments.jobs if arguments.jobs is not None else jobs), _show,
                        part_of(arguments.part))  # fmt: skip
    for line in lines:
        print(line)
    return EXIT_DONE


def _store(arguments):
    """The folder of the study."""
    return Store(arguments.output or Path(f"{arguments.study.stem}.study"))


def _show(line):
    print(line, flush=True)


@contextmanager
def _stopped_by_term():
    """TERM ends a study as INT does."""
    before = signal.signal(signal.SIGTERM, _interrupt)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


def _conclude(report, store, jobs, results):
    """Write the report and print what came out."""
    for line in report.write():
        print(line)
    print(f"wrote {store.folder / 'study.html'}, results.csv and {report.figures} figures")
    return _verdict(jobs, results)


def _verdict(jobs, results):
    """Print which runs failed."""
    failed = [(job, result) for job, result in zip(jobs, results, strict=True) if result["status"] in ("failed", "crashed")]
    if not failed:
        return EXIT_DONE
    job, result = failed[0]
    print(f"error: {len(failed)} of {len(jobs)} runs failed, the first is {job.label}: {result['reason']}", file=sys.stderr)
    return EXIT_FAILED


def part_of(words: str | None) -> tuple[int, int] | None:
    """The part K/N of the runs that `--part` asks for; None for all."""
    if words is None:
        return None
    number, _, count = words.partition("/")
    if not (number.isdecimal() and count.isdecimal() and 1 <= int(number) <= int(count)):
        raise StudyError(f"--part needs the part and the number of parts, such as 2/5, not {words}")
    return int(number), int(count)


def workers_of(jobs: int | str) -> int:
    """How many runs go on at a time."""
    if jobs == "all":
        return len(os.sched_getaffinity(0))
    try:
        count = int(jobs)
    except ValueError:
        count = 0
    if count < 1:
        raise StudyError(f"--jobs needs a whole number above 0, or all, not {jobs}")
    return count


def _interrupt(*_):
    raise KeyboardInterrupt

"""The command `splitgrain study STUDY.toml --output DIR`."""

import os
import signal
import sys
from pathlib import Path

from ..errors import StudyError
from .description import read_study
from .jobs import jobs_of
from .program import Program
from .report import Report
from .runner import Store, run_jobs

EXIT_DONE, EXIT_FAILED, EXIT_STOPPED = 0, 1, 75


def add_command(commands):
    """The command line of `study`."""
    sentence = "run a study: cases x variants x tolerances, time steps or subdomains; error against work"
    command = commands.add_parser("study", help=sentence, description=sentence, prog="splitgrain study")
    command.add_argument("study", metavar="STUDY.toml", type=Path, help="what to run (doc/guide/studies.md)")
    command.add_argument("--output", metavar="DIR", type=Path, help="folder of the study (default: NAME.study here)")
    command.add_argument("--jobs", metavar="N", help="runs at a time, or all for one a core (default: as the study says)")
    command.add_argument("--program", metavar="PATH", help="the splitgrain to run")


def run_study(arguments):
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
        raise StudyError("a study starts ranks itself: call it without mpiexec")
    study = read_study(arguments.study)
    workers = workers_of(arguments.jobs if arguments.jobs is not None else study.jobs)
    program = Program(arguments.program)
    store = Store(arguments.output or Path(f"{arguments.study.stem}.study"))
    before = signal.signal(signal.SIGTERM, _interrupt)
    try:
        jobs = jobs_of(study, program.digest)
        results = run_jobs(study, jobs, store, program, workers, lambda line: print(line, flush=True))
    finally:
        signal.signal(signal.SIGTERM, before)
    report = Report(study, jobs, results, store, program.version)
    for line in report.write():
        print(line)
    print(f"wrote {store.folder / 'study.html'}, results.csv and {report.figures} figures")
    return _verdict(jobs, results)


def _verdict(jobs, results):
    """Say which runs failed."""
    failed = [(job, result) for job, result in zip(jobs, results, strict=True) if result["status"] == "failed"]
    if not failed:
        return EXIT_DONE
    job, result = failed[0]
    print(f"error: {len(failed)} of {len(jobs)} runs failed, the first is {job.label}: {result['reason']}", file=sys.stderr)
    return EXIT_FAILED


def workers_of(jobs):
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

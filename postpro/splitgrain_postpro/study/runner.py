"""Does the jobs of a study that are not done yet; each leaves one file, whole or not at all."""

import json
import os
import shutil
import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from ..errors import StudyError
from .model import Result, Study
from .problems import ProblemRunner
from .program import Program
from .simulations import run_simulation
from .states import prepare_states
from .threads import as_they_end, do_all, threads_of
from .verdict_file import VerdictStudy

EXIT_OUTPUT = 5


class Store:
    """The folder of a study: results in runs/, problems made by decks in problems/."""

    def __init__(self, folder: str | Path):
        self.folder = Path(folder)
        with writing(self.folder):
            for name in ("runs", "problems"):
                (self.folder / name).mkdir(parents=True, exist_ok=True)

    def load(self, key: str) -> Result | None:
        """A result, or None when it is not there or not whole."""
        try:
            result = json.loads((self.folder / "runs" / f"{key}.json").read_text())
        except (OSError, ValueError):
            return None
        return result if isinstance(result, dict) and result.get("key") == key else None

    def save(self, key: str, result: Result) -> None:
        """Write a result: a reader finds it whole or not at all."""
        self.write(self.folder / "runs" / f"{key}.json", (json.dumps(result | {"key": key}) + "\n").encode())

    def write(self, path: Path, content: bytes) -> None:
        """Write a file under another name, then give it its own."""
        with writing(path):
            other = path.with_name(f".{path.name}.{os.getpid()}")
            other.write_bytes(content)
            os.replace(other, path)

    @contextmanager
    def scratch(self) -> Iterator[Path]:
        """A folder for a run, gone afterwards."""
        with writing(self.folder):
            place = Path(tempfile.mkdtemp(prefix=".run-", dir=self.folder))
        try:
            yield place
        finally:
            shutil.rmtree(place, ignore_errors=True)


@contextmanager
def writing(path: Path) -> Iterator[None]:
    """Report what cannot be written."""
    try:
        yield
    except OSError as error:
        raise StudyError(f"cannot write: {error.strerror or error}", path, code=EXIT_OUTPUT) from error


def run_jobs(
    study: Study | VerdictStudy, jobs: Sequence, store: Store, program: Program, workers: int, show: Callable[[str], None],
    run: Callable[..., Result] = run_simulation,
) -> list[Result]:
    """Do all jobs; returns their results, in order. Finished ones are read, failed ones tried again; `run` does one that is a run."""
    results = {job.key: result for job in jobs if (result := store.load(job.key))}
    todo = list({job.key: job for job in jobs if job.key not in results}.values())
    show(f"{len(todo)} of {len(jobs)} runs to do" + (f", {len(jobs) - len(todo)} done before" if len(todo) < len(jobs) else ""))
    problems = ProblemRunner(study, store, program) if study.of_problems else None
    with threads_of(program, workers) as pool:
        if problems:
            # Problems and reference solutions come first: all others need them.
            do_all(pool, problems.prepare, {case.name: case for case in study.cases}.values())
        prepare_states(study, todo, store, program, pool)
        waiting = {pool.submit(_do, job, problems, store, program, run): job for job in todo}
        for count, done in enumerate(as_they_end(waiting), 1):
            job = waiting[done]
            results[job.key] = done.result()
            show(f"{count}/{len(todo)} {job.label}: {in_words(results[job.key])}")
    return [results[job.key] for job in jobs]


def _do(job, problems, store, program, run):
    """Do one job and keep its result; what failed is not kept, so that it is tried again."""
    result = problems.solve(job) if problems else run(job, store, program)
    if result["status"] != "failed":
        store.save(job.key, result)
    return result


def in_words(result: Result) -> str:
    """A result in a few words."""
    reason = f", {result['reason']}" if result.get("reason") else ""
    return f"{result['status']}{reason}, {result.get('cpu_seconds') or 0:.3g} CPU s"

"""States of decks from which the runs of a study go on: each is made once, by the deck's own settings."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Iterable
from concurrent.futures import Executor
from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import StudyError
from .jobs import Job
from .model import Study
from .program import Program, settings_words
from .threads import do_all
from .verdict_file import VerdictStudy

if TYPE_CHECKING:
    from .runner import Store


def prepare_states(study: Study | VerdictStudy, jobs: Iterable, store: Store, program: Program, pool: Executor) -> None:
    """Make all states that jobs begin from and that are not there yet."""
    first = {state_folder(job, store): job for job in jobs if job.case.start}
    todo = [(folder, job) for folder, job in first.items() if not (folder / "run.json").exists()]
    do_all(pool, lambda item: _make(*item, study, store, program), todo)


def state_folder(job: Job, store: Store) -> Path:
    """Where the state of a job is: the same for the same work."""
    what = [job.program, job.content, job.case.start, job.case.settings]
    return store.folder / "states" / hashlib.sha256(json.dumps(what, sort_keys=True).encode()).hexdigest()[:20]


def _make(folder, job, study, store, program):
    """Run a deck up to its state, and keep the checkpoint and the numbers of the run."""
    start = job.case.start
    settings = job.case.settings | {"time.steps": start, "restart.every": start, "output.every": 0, "output.record_every": 0}
    with store.scratch() as place:
        words = ["run", job.case.file.resolve(), "--output", place / "state", "--quiet", "--force"] + settings_words(settings)
        code, _, message = program.call(words, 20 * study.seconds)
        if code != 0 or not list((place / "state").glob("restart_*.h5")):
            raise StudyError(f"{job.case.file.name} makes no state at step {start}: {message or f'exit code {code}'}", study.path)
        folder.parent.mkdir(exist_ok=True)
        os.replace(place / "state", folder)

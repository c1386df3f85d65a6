"""The program, called once for each run, with a limit of CPU time, and ended with the study."""

import hashlib
import json
import math
import os
import shutil
import signal
import subprocess
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from ..errors import StudyError

#: Threads that wait leave the processor to others
IDLE_WAITING = {"OMP_WAIT_POLICY": "passive"}


class Program:
    """splitgrain, and the processes of it that are running."""

    def __init__(self, path: str | None = None):
        found = path or os.environ.get("SPLITGRAIN_PROGRAM") or shutil.which("splitgrain")
        if not found or not shutil.which(found):
            raise StudyError(f"there is no program {found}" if found else
                             "there is no splitgrain on the path; give it by --program or SPLITGRAIN_PROGRAM")  # fmt: skip
        self.path = str(Path(shutil.which(found)).resolve())
        with open(self.path, "rb") as file:
            self.digest = hashlib.file_digest(file, "sha256").hexdigest()
        done = subprocess.run([self.path, "--version"], capture_output=True, text=True)
        lines = done.stdout.splitlines()
        if done.returncode or not lines or not lines[0].startswith("splitgrain"):
            raise StudyError(f"{self.path} is no splitgrain: it prints no version")
        self.version = " ".join([lines[0], *(line.split()[1] for line in lines if line.startswith("commit"))])
        self.running, self.lock, self.is_stopped = set(), threading.RLock(), False

    def call(self, words: Sequence, seconds: float) -> tuple[int | None, str, str]:
        """Run the program; exit code (None when CPU time ran out), what it printed, and the first line of its errors, warnings left out."""
        words = [self.path, *map(str, words)]
        # The shell sets the limit and becomes the program.
        limit = ["/bin/sh", "-c", 'ulimit -t "$0" && exec "$@"', str(math.ceil(seconds))]
        with self.lock:
            if self.is_stopped:
                raise InterruptedError
            environment = {name: value for name, value in os.environ.items() if name != "TMPDIR"} | IDLE_WAITING
            process = subprocess.Popen(limit + words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                       stdin=subprocess.DEVNULL, start_new_session=True, env=environment)  # fmt: skip
            self.running.add(process)
        try:
            printed, errors = process.communicate(timeout=60 + 30 * seconds)
        except subprocess.TimeoutExpired:
            end(process)
            printed, errors = process.communicate()
            return None, printed, "no end in thirty times the limit"
        finally:
            with self.lock:
                self.running.discard(process)
        if self.is_stopped:
            raise InterruptedError
        is_out_of_time = process.returncode in (-signal.SIGXCPU, -signal.SIGKILL, 128 + signal.SIGXCPU, 128 + signal.SIGKILL)
        lines = [line for line in errors.strip().splitlines() if "warning:" not in line]
        return None if is_out_of_time else process.returncode, printed, lines[0] if lines else ""

    @contextmanager
    def ended_by_signals(self) -> Iterator[None]:
        """INT and TERM end all that runs, which ends the wait for it. An exception out of a signal could leave locks of that wait closed."""
        if threading.current_thread() is not threading.main_thread():
            yield
            return
        caught = [number for number in (signal.SIGINT, signal.SIGTERM) if signal.getsignal(number) not in (signal.SIG_IGN, None)]
        before = {number: signal.signal(number, lambda *_: self.stop()) for number in caught}
        try:
            yield
        finally:
            for number, handler in before.items():
                signal.signal(number, handler)

    def stop(self) -> None:
        """End all that runs; nothing starts any more."""
        with self.lock:
            self.is_stopped = True
            for process in self.running:
                end(process)


def end(process: subprocess.Popen) -> None:
    """End a process and those that it started."""
    try:
        os.killpg(process.pid, signal.SIGKILL)
    except ProcessLookupError:
        pass


def json_lines(printed: str) -> list[dict]:
    """Objects that were printed, one per line; other lines are left out."""
    found = []
    for line in printed.splitlines():
        try:
            value = json.loads(line)
        except ValueError:
            continue
        if isinstance(value, dict):
            found.append(value)
    return found


def settings_words(settings: dict) -> list[str]:
    """Settings as options of `run`."""
    words = []
    for name, value in settings.items():
        words += ["--set", f"{name}={value if isinstance(value, str) else json.dumps(value)}"]
    return words

#!/usr/bin/env python3
"""Faults: disks and files that may not grow (a small disk where one can be mounted, else `ulimit -f`), standard output that takes
nothing, signals at any time. What bears its final name must be whole, what was there before must be there still or be replaced by
the whole new file, the exit code must be that of the fault, and a run that was ended must go on to the answer of the run that was not."""

import atexit
import json
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import h5py
from fuzz_harness import SOURCE, Outcome, fuzz, judge, run

STEPS = 40
PICTURES = ["--set", "output.every=10", "--set", "restart.every=10", "--set", "output.record_every=1"]
PRINTING = [["--help"], ["--version"], ["reference"], ["check", "deck.toml"], ["solve", "problem.hdf5"], ["solve", "problem.hdf5", "--json"],
            ["partition", "deck.toml", "--parts", "2"], ["run", "deck.toml", "--output", "results"], ["bench", "--contacts", "100"]]


class SmallDisk:
    """A disk of few bytes, where one may be mounted; else none."""

    def __init__(self):
        self.place = Path(tempfile.mkdtemp(prefix="small_disk_"))
        self.is_mounted = self.mount(64)
        atexit.register(self.remove)

    def mount(self, kilobytes):
        """Mount an empty disk of so many kilobytes."""
        subprocess.run(["umount", self.place], capture_output=True)
        return subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={kilobytes}k", "tmpfs", self.place], capture_output=True).returncode == 0

    def remove(self):
        """Give it back."""
        subprocess.run(["umount", self.place], capture_output=True)
        self.place.rmdir()


def prepare(program, folder):
    """A small deck, its answer, a contact problem of it, its DATBOX folder, and the deck of that."""
    text = (SOURCE / "input_decks" / "polygons_settling.toml").read_text()
    text = re.sub(r"^(\s*count\s*=)\s*\d+", r"\1 12", text, flags=re.M)
    (folder / "deck.toml").write_text(re.sub(r"^(steps\s*=)\s*\d+", rf"\1 {STEPS}", text, flags=re.M))
    run(program, ["run", "deck.toml", "--output", "results", "--quiet", "--dump", str(STEPS), *PICTURES], folder)
    shutil.copy(folder / "results" / f"dump-{STEPS}-local.hdf5", folder / "problem.hdf5")
    with h5py.File(folder / "problem.hdf5", "r+") as file:
        del file["solution"]
    run(program, ["convert", "deck.toml", "DATBOX"], folder)
    run(program, ["convert", "DATBOX", "again.toml"], folder)
    return folder, SmallDisk()


def try_case(rng, program, place, material):
    """One command under one fault."""
    folder, disk = material
    for name in ("deck.toml", "problem.hdf5"):
        shutil.copy(folder / name, place / name)
    shutil.copytree(folder / "DATBOX", place / "DATBOX")
    way = rng.randrange(10)
    if way == 0:
        words = rng.choice(PRINTING)
        ended = run(program, words, place, stdout="/dev/full")
        outcome = judge(ended)
        return outcome if outcome.word != "clean" else Outcome("wrong", f"{words} ends with {ended.code} where nothing can be printed")
    if way <= 3:
        return end_and_go_on(rng, program, place, folder)
    words = rng.choice([["run", "deck.toml", "--output", "results", "--quiet", *PICTURES], ["convert", "deck.toml", "made"],
                        ["convert", "DATBOX", "made.toml"], ["solve", "problem.hdf5", "--write", "--solver", "nlgs", "--trace", "trace.csv"]])
    if not (disk.is_mounted and rng.random() < 0.5):
        # What is printed on errors goes to a file too, which must have room for a sentence.
        limit = rng.randrange(500, rng.choice([4000, 40000, 400000]))
        return judge_files(run(program, words, place, file_bytes=limit), place, folder, words)
    disk.mount(rng.choice([16, 32, 64, 128, 256, 512]))
    for name in ("deck.toml", "problem.hdf5", "DATBOX"):
        subprocess.run(["cp", "-r", place / name, disk.place], capture_output=True)
    if not (disk.place / "DATBOX").is_dir() or (disk.place / "problem.hdf5").stat().st_size < (place / "problem.hdf5").stat().st_size:
        return Outcome("clean", "no room for the input")
    return judge_files(run(program, words, disk.place), disk.place, folder, words)


def judge_files(ended, place, folder, words):
    """Wrong where a file is neither as it was nor as it must be, or the exit code does not report that one is missing."""
    outcome = judge(ended, place)
    if outcome.word in ("crashed", "hung", "wrong"):
        return outcome
    fault = {"run": results_fault, "convert": converted_fault, "solve": solved_fault}[words[0]](place, folder, words, ended.code)
    parts = [path.name for path in place.rglob("*.part")]
    if parts and not fault:
        fault = f"{parts[0]} is left behind"
    return Outcome("wrong", fault) if fault else outcome


def results_fault(place, folder, words, code):
    """What is wrong with results."""
    made, whole = place / "results", folder / "results"
    missing = [path.name for path in whole.iterdir() if not path.name.startswith("dump") and not (made / path.name).exists()]
    if code == 0 and missing:
        return f"exit code 0 without {missing[0]}"
    for path in made.iterdir() if made.exists() else []:
        if path.stat().st_size == 0:
            return f"{path.name} is empty"
        if path.suffix in (".vtkhdf", ".h5"):
            with h5py.File(path) as file:
                if path.suffix == ".vtkhdf" and file["VTKHDF/Steps"].attrs["NSteps"] < 1:
                    return f"{path.name} holds no step"
        elif path.suffix == ".json":
            json.loads(path.read_text())
        elif path.name == "effective.toml" and path.read_bytes() != (whole / path.name).read_bytes():
            return f"{path.name} is not whole"
    return None


def converted_fault(place, folder, words, code):
    """What is wrong with a conversion."""
    made, whole = place / words[2], folder / ("DATBOX" if words[2] == "made" else "again.toml")
    pairs = [(made / path.name, path) for path in whole.iterdir()] if whole.is_dir() else [(made, whole)]
    for path, other in pairs:
        if not path.exists():
            if code == 0:
                return f"exit code 0 without {path.name}"
        elif path.read_bytes() != other.read_bytes():
            return f"{path.name} is not whole"
    return None


def solved_fault(place, folder, words, code):
    """What is wrong with a problem that got an answer, or not."""
    path = place / "problem.hdf5"
    if path.read_bytes() == (folder / "problem.hdf5").read_bytes():
        return "exit code 0 without an answer in the file" if code == 0 else None
    with h5py.File(path) as file:
        return None if "solution/r" in file and "fclib_local/W/x" in file else "the problem is not what it was"


def end_and_go_on(rng, program, place, folder):
    """End a run by a signal at any time, and go on until it is done: the answer is that of the run that was not ended."""
    words = ["run", "deck.toml", "--output", "results", "--quiet", *PICTURES]
    for attempt in range(6):
        has_checkpoint = any((place / "results").glob("restart_?.h5"))
        child = subprocess.Popen([program, *words, *(["--restart", "results"] if has_checkpoint else [])], cwd=place,
                                 stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        if attempt < 5:
            time.sleep(rng.random() * 0.12)
            number = rng.choice([signal.SIGTERM, signal.SIGINT, signal.SIGHUP, signal.SIGPIPE, signal.SIGUSR1, signal.SIGKILL])
            child.send_signal(number)
        try:
            err = child.communicate(timeout=200)[1]
        except subprocess.TimeoutExpired:
            child.kill()
            return Outcome("hung", "no end after a signal")
        # Before the handlers are set a signal ends the program as it does any other.
        if child.returncode not in (0, 75, *(-number for number in signal.valid_signals())):
            return Outcome("wrong", f"exit code {child.returncode}: {err}")
    if child.returncode != 0:
        return Outcome("wrong", f"exit code {child.returncode} at the end: {err}")
    answers = [(results / "results" / "numbers.tag").read_text() for results in (place, folder)]
    steps = [[line.split(",")[0] for line in (results / "results" / "record.csv").read_text().splitlines()] for results in (place, folder)]
    if answers[0] != answers[1] or steps[0] != steps[1]:
        return Outcome("wrong", "another answer than of the run that was not ended")
    return Outcome("clean")


if __name__ == "__main__":
    sys.exit(fuzz("faults", __doc__, try_case, prepare))

"""Common harness of fuzzers: seeded cases, runs of the program within limits, outcomes, and the line of counts.

A fuzzer is a file `fuzz_<kind>.py` with a function that makes one case, runs it and returns its outcome:

    def try_case(rng, program, place, material):
        (place / "deck.toml").write_bytes(...)
        ended = run(program, ["run", "deck.toml", "--output", "results", "--quiet"], place)
        return judge(ended, place)

    if __name__ == "__main__":
        sys.exit(fuzz("decks", __doc__, try_case, prepare))

`rng` is a `random.Random` of seed and case, `place` an empty folder, `material` what `prepare(program, folder)` returned once at
the beginning. Options: `PROGRAM --seed N --seconds S --only I --keep FOLDER`. The last line printed is one JSON object with
`kind`, `tried` and a count per outcome. The exit code is 1 when a case crashed, hung or was wrong; its folder is kept.
"""

import argparse
import json
import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "stiff"))
from judged_runs import ALARMS, CODES, SENTENCE, Runner, cpu  # noqa: E402

OUTCOMES = ("clean", "refused", "crashed", "hung", "wrong")
FAULTS = ("crashed", "hung", "wrong")
SOURCE = Path(os.environ.get("SPLITGRAIN_SOURCE") or Path(__file__).resolve().parents[2])
CPU_LIMIT = 20
"""CPU seconds of one run, after which it hangs: cases are made to need less than one"""


@dataclass
class Ended:
    """How a run ended."""

    code: int
    """Exit code; minus the signal"""
    out: str
    err: str
    is_hung: bool


@dataclass
class Outcome:
    """What a case came to: one of OUTCOMES, and why."""

    word: str
    why: str = ""


def run(program, words, place, *, seconds=CPU_LIMIT, file_bytes=None, memory_bytes=None, stdout=None, environment=None):
    """Run the program in a folder, within CPU seconds and ten times as many by the clock. `file_bytes` is `ulimit -f`,
    `memory_bytes` is `ulimit -v`, `stdout` a path that replaces the captured output."""
    def limit():
        resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 2))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        if file_bytes is not None:
            resource.setrlimit(resource.RLIMIT_FSIZE, (file_bytes, file_bytes))
        if memory_bytes is not None:
            resource.setrlimit(resource.RLIMIT_AS, (memory_bytes, memory_bytes))

    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err, open(stdout or os.devnull, "wb") as other:
        child = subprocess.Popen([program, *map(os.fspath, words)], cwd=place, stdin=subprocess.DEVNULL, stdout=other if stdout else out,
                                 stderr=err, preexec_fn=limit, start_new_session=True, env={**os.environ, **(environment or {})})
        is_hung = False
        try:
            code = child.wait(timeout=10 * seconds)
        except subprocess.TimeoutExpired:
            os.killpg(child.pid, signal.SIGKILL)
            code, is_hung = child.wait(), True
        texts = []
        for file in (out, err):
            file.seek(0)
            texts.append(file.read().decode("utf8", "replace"))
    is_hung = is_hung or code in (-signal.SIGXCPU, 128 + signal.SIGXCPU) or code == -signal.SIGKILL
    return Ended(code, *texts, is_hung)


def judge(ended, place=None, results="results", codes=CODES):
    """Outcome of a run: crashed where a signal, a backtrace, a sanitizer or an exit code that no page lists ended it; wrong where it
    refuses without a sentence, or where `results` (a folder below `place`) holds a number that is not finite."""
    alarm = ALARMS.search(ended.err)
    if ended.is_hung:
        return Outcome("hung", f"no end within {CPU_LIMIT} CPU seconds")
    if alarm:
        return Outcome("crashed", ended.err[alarm.start():alarm.start() + 200].splitlines()[0])
    if ended.code not in codes:
        return Outcome("crashed", f"exit code {ended.code}")
    if ended.code in (2, 4, 5, 7) and not SENTENCE.search(ended.err):
        return Outcome("wrong", f"exit code {ended.code} without a sentence that gives the reason")
    fault = Runner.judge_results(place / results, None) if place else None
    if fault:
        return Outcome("wrong", fault)
    if ended.code not in (2, 5, 7):
        return Outcome("clean")
    return Outcome("refused", f"exit code {ended.code}, {SENTENCE.search(ended.err).group()}")


def worst(outcomes):
    """Of several outcomes the one to report: a fault before all, clean last."""
    order = ("crashed", "hung", "wrong", "refused", "clean")
    return min(outcomes, key=lambda outcome: order.index(outcome.word))


def fuzz(kind, about, try_case, prepare=None):
    """Try cases until the time is over, and print the counts; the exit code."""
    chosen = read_options(about)
    program = str(Path(chosen.program).resolve())
    os.environ.update(OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
    os.environ.pop("TMPDIR", None)
    keep = Path(chosen.keep).resolve()
    keep.mkdir(parents=True, exist_ok=True)
    counts = dict.fromkeys(("tried", *OUTCOMES), 0)
    with tempfile.TemporaryDirectory(prefix=f"fuzz_{kind}_") as shared:
        material = prepare(program, Path(shared)) if prepare else None
        began, used = time.monotonic(), cpu()
        index = chosen.only or 0
        while chosen.only is not None or (cpu() - used < chosen.seconds and time.monotonic() - began < 10 * chosen.seconds):
            place = Path(tempfile.mkdtemp(prefix=f"{kind}_{chosen.seed}_{index}_", dir=keep))
            outcome = try_case(random.Random(f"{kind}:{chosen.seed}:{index}"), program, place, material)
            counts["tried"] += 1
            counts[outcome.word] += 1
            if outcome.word in FAULTS:
                print(f"{kind}, case {index} of seed {chosen.seed}: {outcome.word}: {outcome.why}\n  kept in {place}; again by: "
                      f"{sys.argv[0]} {chosen.program} --seed {chosen.seed} --only {index}", flush=True)
            elif chosen.only is None:
                shutil.rmtree(place, ignore_errors=True)
            if chosen.only is not None:
                print(f"{outcome.word}: {outcome.why}; {place}")
                break
            index += 1
    print(json.dumps({"kind": kind, **counts}), flush=True)
    return 1 if any(counts[word] for word in FAULTS) else 0


def read_options(about):
    """The command line of a fuzzer."""
    parser = argparse.ArgumentParser(description=about, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--seconds", type=float, default=10, help="CPU seconds of all runs together")
    parser.add_argument("--only", type=int, help="try this case alone, and keep it")
    parser.add_argument("--keep", default=".", help="folder for the cases that fail")
    return parser.parse_args()

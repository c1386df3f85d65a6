"""Runs of a program within limits, and what is wrong with them."""

import json
import re
import resource
import signal
import subprocess

CODES = {0: "ran", 2: "refused", 3: "not converged", 4: "stopped for a value that is not finite", 5: "could not write", 6: "unbalanced", 7: "out of memory", 75: "stopped early"}
ALARMS = re.compile(r"(?i:Sanitizer|runtime error:|Fortran runtime|Backtrace for|internal error|forrtl)|SIG[A-Z]{3,}")
# A launcher that gets no time for some seconds takes ranks that end meanwhile for lost; those in order end well the next time.
LOST = "exiting improperly"
SENTENCE = re.compile(r"^(?:[^\n]*?: )?error: \S.*[^.\s]$", re.M)
CPU_LIMIT = 60
# How a run ends that is cut short for its time: by itself, or one of its ranks.
TOO_LONG = {code: "cut short" for number in (signal.SIGXCPU, signal.SIGKILL) for code in (-number, 128 + number)}
# Share of decks that may be cut short: more are a program that does not end.
MOST_CUT = 0.02


class Runner:
    """Runs decks and judges them."""

    def __init__(self, program, launcher, share):
        self.program, self.launcher, self.share = program, launcher, share

    def call(self, words, place, ranks=1):
        """Run the program within limits; output to files, since it may be long."""
        command = [self.program, *words]
        if ranks > 1:
            command = [self.launcher, "--oversubscribe", "-n", str(ranks), *command]
        code = self.start(command, place)
        if ranks > 1 and LOST in (place / "err.txt").read_text(errors="replace"):
            code = self.start(command, place)
        return code

    @staticmethod
    def start(command, place):
        """Start a command, and wait for its end."""
        with open(place / "out.txt", "wb") as out, open(place / "err.txt", "wb") as err:
            try:
                done = subprocess.run(command, cwd=place, stdout=out, stderr=err, timeout=20 * CPU_LIMIT, check=False,
                                      preexec_fn=limit)
                return done.returncode
            except subprocess.TimeoutExpired:
                return -signal.SIGXCPU

    def ends_soon_alone(self, place):
        """Does one rank end a run in a small part of the time? Ranks that wait for one another do not."""
        alone = place / "alone"
        alone.mkdir()
        before = cpu()
        code = self.call(["run", str((place / "deck.toml").resolve()), "--output", "results", "--quiet", "--force"], alone)
        return code not in TOO_LONG and cpu() - before < CPU_LIMIT / 20

    def judge(self, place, code, results="results"):
        """What is wrong with a run; nothing when all is well."""
        said = (place / "err.txt").read_bytes().decode("utf8", "replace")
        alarm = ALARMS.search(said)
        # Random counts make long runs, in builds with checks ten times as long: what was cut short is counted, and judged together.
        if code in TOO_LONG and (not alarm or alarm.group().startswith("SIG")):
            return None
        if alarm:
            return f"the run-time checks speak: {said[alarm.start():alarm.start() + 200].splitlines()[0]}"
        if code not in CODES:
            return f"exit code {code}"
        if code in (2, 4, 5) and not SENTENCE.search(said):
            return f"exit code {code} without a sentence that tells why"
        if code == 2 and not any(re.match(r"(\S.*?)(:\d+)*: error: ", line) for line in said.splitlines()):
            return "a mistake without its file"
        return self.judge_results(place / results, code)

    @staticmethod
    def judge_results(folder, code):
        """Numbers that are not finite in what was written."""
        summary = folder / "run.json"
        if code == 0 and not summary.exists():
            return "no run.json"
        if summary.exists():
            try:
                json.loads(summary.read_text(encoding="utf8"), parse_constant=complain)
            except ValueError as error:
                return f"run.json: {error}"
        record = folder / "record.csv"
        if record.exists() and re.search(r"(?:^|,)\s*[-+]?(?:nan|inf)", record.read_text(), re.I | re.M):
            return "a number that is not finite in record.csv"
        return None


def cpu():
    """CPU seconds of all programs run."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def complain(word):
    raise ValueError(f"holds {word}")


def limit():
    """Limits of a run: its time, and no core file."""
    resource.setrlimit(resource.RLIMIT_CPU, (CPU_LIMIT, CPU_LIMIT + 5))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))

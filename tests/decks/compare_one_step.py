#!/usr/bin/env python3
"""Compare two values of a setting on the same states of a run: one step with each, from restart files.

usage: compare_one_step.py PROGRAM DECK SETTING=VALUE,VALUE FIRST LAST EVERY [SETTING=VALUE...]

PROGRAM may be several words, such as "mpiexec -n 2 splitgrain". With program=PROGRAM,PROGRAM as SETTING two programs are compared.

Whole runs differ by chance from the first rounding on; single steps from one state do not. The states are those of a run with the
first value, after FIRST, FIRST + EVERY, ..., LAST steps. Each value takes each step twice, in turns.
"""

import json
import shlex
import subprocess
import sys
import tempfile
from pathlib import Path


def main():
    program, deck, compared, first, last, every, *others = sys.argv[1:]
    setting, values = compared.split("=")
    values = values.split(",")
    always = ["output.every=0", *others]

    def run(folder, *words, **settings):
        called = settings.pop("program", program)
        words = [*shlex.split(called), "run", deck, "--quiet", "--force", "--output", str(folder), *words]
        for one in [*always, *(f"{name.replace('__', '.')}={value}" for name, value in settings.items())]:
            words += ["--set", one]
        subprocess.run(words, check=True, stderr=subprocess.DEVNULL)
        return json.loads((folder / "run.json").read_text())

    key = setting.replace(".", "__")
    names = ("sweeps", "contact_updates", "cpu_solve", "converged_steps")
    sums = {value: dict.fromkeys(names, 0) for value in values}
    with tempfile.TemporaryDirectory(prefix="splitgrain ") as place:
        state = Path(place) / "state"
        going_on = []
        for step in range(int(first), int(last) + 1, int(every)):
            before = run(state, *going_on, time__steps=step, restart__every=step, **{key: values[0]})
            going_on = ["--restart", str(state)]
            for value in (*values, *reversed(values)):
                after = run(Path(place) / "step", *going_on, time__steps=step + 1, restart__every=0, **{key: value})
                for name in names:
                    sums[value][name] += (after[name] - before[name]) / 2
    for value in values:
        print(f"{setting}={value}: " + ", ".join(f"{name} {sums[value][name]:.6g}" for name in names))


if __name__ == "__main__":
    main()

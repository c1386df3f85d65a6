#!/usr/bin/env python3
"""Random decks: small scenes, right and wrong, that the program must run or refuse, but never break on.

    random_decks.py PROGRAM [--seed N] [--seconds S] [--only I] [--ranks MPIEXEC [--share S]] [--keep FOLDER]

Sections, keys, kinds of value and ranges are those of `splitgrain reference`, so that keys that are new are met without a
change here; places, shapes and sizes come from here, since bodies must not overlap. One deck in three is right as far as its
keys go, one in three is spoilt as text, one in nine is a DATBOX, half of those spoilt. Deck I of seed N is always the same:
`--only I` repeats it alone.

A deck fails when the exit code is none of those documented, or a signal; when a sanitizer or the run-time checks speak; when a
number that is not finite stands in run.json or record.csv; when what is refused is not told by one sentence with its file; or
when several ranks are cut short for their time where one ends soon. The folder of a deck that fails is kept.
"""

import argparse
import os
import random
import shutil
import sys
import tempfile
from pathlib import Path

from judged_runs import CODES, CPU_LIMIT, MOST_CUT, TOO_LONG, Runner, cpu
from random_scene import Scene
from reference_keys import read_reference
from spoilt_decks import spoil, spoil_datbox

# Share of right decks that must run: fewer means that the program refuses what the generator takes for right (97 % ran when this was set).
LEAST_RAN = 0.75


def make(rng, sections, runner, place):
    """Write the deck of one number: its kind, and is it right?"""
    scene = Scene(rng, sections)
    kind = rng.randrange(9)
    text = ("\n".join(scene.lines()) + "\n").encode("utf8")
    deck = place / "deck.toml"
    if kind < 4 or kind == 8:
        deck.write_bytes(text)
        if kind < 4:
            return "right", True
        code = runner.call(["convert", "deck.toml", "DATBOX"], place)
        box = place / "DATBOX"
        if code != 0 or not box.is_dir():
            return "right", True
        is_spoilt = rng.random() < 0.7
        if is_spoilt:
            spoil_datbox(rng, box)
        dimension = f"dimension = {scene.dimension}\n"
        deck.write_text(f'[scene]\n{dimension}datbox = "DATBOX"\n[time]\nstep = 1e-4\nsteps = 3\n[solver]\nmaximum_sweeps = 40\n')
        return "DATBOX", not is_spoilt
    deck.write_bytes(spoil(rng, scene.lines()))
    return "spoilt", False


def one(seed, index, sections, runner, place):
    """Make and run one deck; its kind, exit code, and what is wrong."""
    rng = random.Random(f"{seed}:{index}")
    kind, _ = make(rng, sections, runner, place)
    ranks = rng.choice([2, 3]) if runner.launcher and rng.random() < runner.share else 1
    code = runner.call(["run", "deck.toml", "--output", "results", "--quiet"], place, ranks)
    fault = runner.judge(place, code)
    if ranks > 1 and code in TOO_LONG and not fault and runner.ends_soon_alone(place):
        fault = "several ranks do not end where one does"
    if kind == "right" and "was built without" in (place / "err.txt").read_text(errors="replace"):
        kind = "beyond this build"
    return kind + (f" on {ranks} ranks" if ranks > 1 else ""), code, fault


def main():
    """Run decks until the time is over."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--seconds", type=float, default=60, help="CPU seconds of all runs together")
    parser.add_argument("--decks", type=int, default=1000000, help="decks at most")
    parser.add_argument("--only", type=int, help="run this deck alone, and keep it")
    parser.add_argument("--ranks", metavar="MPIEXEC", help="run some decks on several ranks")
    parser.add_argument("--share", type=float, default=0.3, help="share of decks that run on several ranks")
    parser.add_argument("--keep", default=".", help="folder for those that fail")
    parser.add_argument("--from", dest="first", type=int, default=0, help="first deck")
    chosen = parser.parse_args()
    program = str(Path(chosen.program).resolve())
    runner = Runner(program, chosen.ranks, chosen.share)
    os.environ.update(OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
    os.environ.pop("TMPDIR", None)
    sections = read_reference(program)
    print(f"random decks of seed {chosen.seed}", flush=True)
    counts, failed, n = {}, 0, 0
    indices = [chosen.only] if chosen.only is not None else range(chosen.first, chosen.first + chosen.decks)
    for index in indices:
        if cpu() > chosen.seconds and chosen.only is None:
            break
        n += 1
        place = Path(tempfile.mkdtemp(prefix=f"random_{chosen.seed}_{index}_", dir=chosen.keep))
        kind, code, fault = one(chosen.seed, index, sections, runner, place)
        outcome = (kind.split(" on ")[0], CODES.get(code) or TOO_LONG.get(code) or f"code {code}")
        counts[outcome] = counts.get(outcome, 0) + 1
        if fault:
            failed += 1
            print(f"deck {index} ({kind}): {fault}\n  kept in {place}; again by: {sys.argv[0]} {chosen.program} --seed {chosen.seed} "
                  f"--only {index}" + (f" --ranks {chosen.ranks} --share {chosen.share}" if chosen.ranks else ""), flush=True)
        elif chosen.only is None:
            shutil.rmtree(place)
        else:
            print(f"{kind}: {CODES.get(code, code)}; {place}")
    for (kind, outcome), count in sorted(counts.items()):
        print(f"  {count:6d} {kind}: {outcome}")
    cut = sum(count for (_, outcome), count in counts.items() if outcome == "cut short")
    if cut > 1 + MOST_CUT * n:
        failed += 1
        print(f"{cut} of {n} runs did not end within {CPU_LIMIT} CPU seconds")
    right = sum(count for (kind, _), count in counts.items() if kind == "right")
    ran = counts.get(("right", "ran"), 0) + counts.get(("right", "not converged"), 0)
    if right >= 20 and ran < LEAST_RAN * right:
        failed += 1
        print(f"of {right} right decks {ran} ran: the generator no longer knows what the program takes")
    print(f"{n - min(n, failed)} passed, {failed} failed", flush=True)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())

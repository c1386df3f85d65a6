#!/usr/bin/env python3
"""A picture of the start of every deck for the gallery of the site.

usage: draw_gallery.py PROGRAM FOLDER (with the package splitgrain_postpro)

Each deck runs one step. Decks that need more than they ship with, such as the checkpoint of another run, are left out with a sentence; those
of the top folder and of OWN need nothing, so that a failure there is an error. Pictures that are newer than program and deck stay.
"""

import subprocess
import sys
import tomllib
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from tempfile import TemporaryDirectory

from splitgrain_postpro import Results
from splitgrain_postpro.frame import Frame
from splitgrain_postpro.scene import draw_scene, proportions
from splitgrain_postpro.style import new_figure, styled

DECKS = Path(__file__).resolve().parents[2] / "input_decks"
OWN = ("cell", "masonry")
DPI = 45
PIXELS = 250
SECONDS = 30


def run_start(program, deck, folder):
    """Run one step; returns what went wrong, empty when nothing did."""
    words = [program, "run", deck, "--output", folder, "--quiet", "--set", "time.steps=1", "--set", "output.every=1"]
    try:
        done = subprocess.run(words, capture_output=True, text=True, timeout=SECONDS)
    except subprocess.TimeoutExpired:
        return f"its start takes more than {SECONDS} s"
    return "" if done.returncode == 0 else (done.stderr.splitlines() or ["it ends early"])[0]


def draw(folder, path):
    """Draw the first picture of a run, small."""
    results = Results(folder)
    scene = results.scene(0)
    with styled():
        ratio = proportions(scene, results.periods)
        figure = new_figure(5 * ratio**0.5 + 1.2, 5 / ratio**0.5 + 0.6)
        draw_scene(figure.add_subplot(), scene, "none", results.periods, common=Frame(pixels=PIXELS))
        path.parent.mkdir(parents=True, exist_ok=True)
        figure.savefig(path, dpi=DPI)


def main(program, folder):
    folder, program = Path(folder), Path(program).resolve()
    # Studies have no time steps of their own; decks that stability tables vary have no pictures.
    decks = sorted(deck for deck in DECKS.rglob("*.toml")
                   if "extreme" not in deck.relative_to(DECKS).parts and "time" in tomllib.loads(deck.read_text()))  # fmt: skip
    paths = {deck: (folder / deck.relative_to(DECKS)).with_suffix(".png") for deck in decks}
    due = [deck for deck, path in paths.items()
           if not path.exists() or path.stat().st_mtime < max(deck.stat().st_mtime, program.stat().st_mtime)]  # fmt: skip
    failed = 0
    with TemporaryDirectory() as place, ThreadPoolExecutor(2) as pool:
        runs = {deck: Path(place) / f"{number}" for number, deck in enumerate(due)}
        for deck, sentence in zip(due, pool.map(lambda deck: run_start(program, deck, runs[deck]), due), strict=True):
            if sentence:
                print(f"no picture of {deck.relative_to(DECKS)}: {sentence}")
                failed += deck.parent == DECKS or deck.parent.name in OWN
            else:
                draw(runs[deck], paths[deck])
    print(f"{sum(path.exists() for path in paths.values())} of {len(decks)} decks have pictures in {folder}")
    return 1 if failed else 0


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    sys.exit(main(*sys.argv[1:]))

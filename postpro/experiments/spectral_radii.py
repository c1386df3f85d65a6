"""Spectral radii of the dual method and of the enriched interface on the three small examples of Alart's talk of 2010.

    python postpro/experiments/spectral_radii.py PROGRAM FOLDER

calls `PROGRAM spectrum` on input_decks/talk/*_disks.toml: linear interactions with four epsilons, and contact without friction,
with 25 sets of velocities that press the disks together, of which some contacts open. Writes linear.csv, contact.csv, contact.md
and radii.png to FOLDER. It needs numpy and matplotlib; doc/talk/spectral_radii.md shows what it gave.
"""

import argparse
import csv
import random
import re
import statistics
import subprocess
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from runs import BLUE, DECKS, GREEN, ORANGE, VERMILION

NAMES = {"four": BLUE, "eight": GREEN, "twelve": VERMILION}
EPSILONS = {1.0: BLUE, 0.1: GREEN, 0.02: ORANGE, 0.001: VERMILION}
SETS = 25
LINEAR = 'kind = "LINEAR"\ndirections = "normal"\nrelative_epsilon = 1.0\n'


def deck_of(name):
    """The deck of an example."""
    return DECKS / "talk" / f"{name}_disks.toml"


def radii(program, folder, deck, *words):
    """What `spectrum` prints, and its rows."""
    file = folder / "radii.csv"
    done = subprocess.run([program, "spectrum", deck, "--csv", file, *words], check=True, capture_output=True, text=True)
    with open(file, newline="") as rows:
        return done.stdout, [{name: float(value) for name, value in row.items()} for row in csv.DictReader(rows)]


def pressed(deck, seed):
    """The deck with contact in place of linear interactions, and velocities towards the middle with a random part."""
    stream = random.Random(seed)
    text = deck.read_text().replace(LINEAR, "")
    places = [(float(x), float(y)) for x, y in re.findall(r"position = \[([\d.]+), ([\d.]+)\]", text)]
    middle = [sum(place[axis] for place in places) / len(places) for axis in (0, 1)]
    speeds = iter([[middle[axis] - place[axis] + stream.uniform(-0.3, 0.3) for axis in (0, 1)] for place in places])
    return re.sub(r"velocity = \[[^]]*\]", lambda _: "velocity = [{:.3f}, {:.3f}]".format(*next(speeds)), text)


def linear(program, folder):
    """Radii with linear interactions: rows by example and epsilon."""
    found = {}
    for name in NAMES:
        _, rows = radii(program, folder, deck_of(name), *(word for epsilon in EPSILONS for word in ("--epsilon", str(epsilon))))
        for epsilon in EPSILONS:
            found[name, epsilon] = [row for row in rows if abs(row["epsilon"] / epsilon - 1) < 1e-6]
    write(folder / "linear.csv", [{"disks": name} | row for (name, _), rows in found.items() for row in rows])
    return found


def contact(program, folder):
    """Radii near solutions of contact: rows by example and set of velocities, and a summary of each."""
    found, lines = {}, []
    for name in NAMES:
        for seed in range(SETS):
            deck = folder / "pressed.toml"
            deck.write_text(pressed(deck_of(name), seed))
            printed, rows = radii(program, folder, deck)
            potential, active = map(int, re.search(r"contacts +(\d+), (\d+) of", printed).groups())
            best = min(rows, key=lambda row: row["enriched"])
            near = [row["eta"] for row in rows if row["enriched"] <= 1.1 * best["enriched"]]
            found[name, seed] = rows
            lines.append({"disks": name, "set": seed, "potential": potential, "active": active, "dual": best["dual"],
                          "enriched": best["enriched"], "at eta": best["eta"],
                          "converges from": min(row["eta"] for row in rows if row["enriched"] < 1),
                          "below dual from": min(row["eta"] for row in rows if row["enriched"] < row["dual"]),
                          "within a tenth": max(near) / min(near)})  # fmt: skip
    write(folder / "contact.csv", lines)
    summarise(folder / "contact.md", lines)
    return found


def summarise(path, lines):
    """Medians, least and largest over the sets that have an open contact, as a table."""
    columns = list(lines[0])[3:]
    text = "| disks | sets | " + " | ".join(columns) + " |\n" + "|---" * (len(columns) + 2) + "|\n"
    for name in NAMES:
        some = [line for line in lines if line["disks"] == name and line["active"] < line["potential"]]
        cells = []
        for column in columns:
            values = [line[column] for line in some]
            cells.append(f"{statistics.median(values):.3g} ({min(values):.3g} to {max(values):.3g})")
        text += f"| {name} | {len(some)} | " + " | ".join(cells) + " |\n"
    path.write_text(text)


def write(path, rows):
    """Write rows as CSV."""
    with open(path, "w", newline="") as file:
        writer = csv.DictWriter(file, rows[0].keys())
        writer.writeheader()
        writer.writerows(rows)


def draw(folder, lines, contacts):
    """Radius against eta: twelve disks with linear interactions, and one set of each example with contact."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.8), sharey=True, layout="constrained")
    for epsilon, colour in EPSILONS.items():
        rows = lines["twelve", epsilon]
        left.plot(*zip(*((row["eta"], row["enriched"]) for row in rows), strict=True), color=colour,
                  label=rf"$\varepsilon = {epsilon:g}\,\varepsilon_0$")  # fmt: skip
        left.axhline(rows[0]["dual"], color=colour, ls=":", lw=1)
    for name, colour in NAMES.items():
        for seed in range(SETS):
            rows = contacts[name, seed]
            right.plot(*zip(*((row["eta"], row["enriched"]) for row in rows), strict=True), color=colour, lw=0.6,
                       label=f"{name} disks" if seed == 0 else None)  # fmt: skip
    left.set(title="twelve disks, linear (dotted: dual method)", ylabel="spectral radius [-]", ylim=(0, 1.5))
    right.set(title=f"contact, {SETS} sets of velocities")
    for ax in (left, right):
        ax.set(xscale="log", xlabel=r"search direction $\eta/\varepsilon_0$ [-]")
        ax.axhline(1, color="#777777", lw=0.8)
        ax.legend(loc="upper right", fontsize="small")
    figure.savefig(folder / "radii.png", dpi=90)


def main():
    """Run all."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("folder", type=Path)
    words = parser.parse_args()
    words.folder.mkdir(parents=True, exist_ok=True)
    program = str(Path(words.program).resolve())
    draw(words.folder, linear(program, words.folder), contact(program, words.folder))


if __name__ == "__main__":
    main()

"""Volume error and coordination below two neighbouring sleepers, by the numbers of sweeps of the subdomains.

usage: PYTHONPATH=postpro python3 -P postpro/experiments/subdomain_sweeps.py FOLDER... [PNG]

FOLDER is what `splitgrain study` makes of input_decks/studies/subdomain_sweeps.toml, subdomain_sweeps_few.toml or sweeps_needed.toml,
or the results of a single run of that kind. Prints one line per run: the largest volume error below sleepers 3 and 4 and below any,
over the steps of the stage in which tines plunge that all runs have recorded, the mean coordination below 3 and 4 in them, with the
change against the first run, the one with most sweeps, and the number of these steps. Draws both in time into PNG, dashed the warm runs where there
are both. A cold run starts each step from impulses of zero, the others from those of the step before.
"""

import sys
import tomllib
from pathlib import Path

import numpy as np
from splitgrain_postpro.results import Results
from splitgrain_postpro.style import new_figure

SLEEPERS = ("below.3", "below.4")
PLUNGING = 6  # number of the stage


def results_in(folder):
    """Folders of results: those of the runs of a study, or the folder itself."""
    return [path.with_suffix("") for path in Path(folder, "runs").glob("*.json")] or [Path(folder)]


def read_runs(folders):
    """Runs as (sweeps per step of each subdomain, start of impulses, regions while tines plunge), the most sweeps first."""
    runs = []
    for folder in (results for folder in folders for results in results_in(folder)):
        deck = tomllib.loads((folder / "effective.toml").read_text())
        start = "warm" if deck["solver"]["warm_start"] else "cold"
        runs.append((sweeps_of(deck), start, plunging(Results(folder).regions)))
    return sorted(runs, key=lambda run: (run[1] == "cold", [-sweeps for sweeps in run[0]]))


def sweeps_of(deck):
    """Sweeps per step of each subdomain: rounds, of which the longest counts, times its number in the table."""
    table = deck["partition"]["sweeps"]
    if not isinstance(table, list):
        table = [table]
    rounds = -(-deck["solver"]["maximum_sweeps"] // max(table))
    return [rounds * sweeps for sweeps in (table if len(table) > 1 else table * deck["partition"]["parts"])]


def plunging(regions):
    """The rows of all regions in the stage in which tines plunge."""
    return {name: {column: values[region["stage"] == PLUNGING] for column, values in region.items() if column != "region"}
            for name, region in regions.items()}  # fmt: skip


def in_common(runs):
    """The runs with the rows of those steps alone that all of them have."""
    steps = set.intersection(*(set(regions[SLEEPERS[0]]["step"]) for _, _, regions in runs))
    return [(sweeps, start, {name: {column: values[np.isin(region["step"], list(steps))] for column, values in region.items()}
                             for name, region in regions.items()}) for sweeps, start, regions in runs]  # fmt: skip


def print_table(runs):
    """A line per run."""
    print("sweeps per subdomain | largest volume error [%] below 3, 4, any | mean coordination below 3, 4, change [%] | steps")
    first = None
    for sweeps, start, regions in runs:
        means = np.array([regions[name]["coordination"].mean() for name in SLEEPERS])
        first = means if first is None else first
        errors = [100 * regions[name]["volume_error"].max() for name in (*SLEEPERS, *regions)]
        shown = [*errors[:2], max(errors)]
        print(" ".join(f"{number:4d}" for number in sweeps), start, "|", " ".join(f"{error:7.4f}" for error in shown), "|",
              " ".join(f"{mean:5.2f} ({change:+.1f})" for mean, change in zip(means, 100 * (means / first - 1))), "|",
              len(regions[SLEEPERS[0]]["time"]))  # fmt: skip


def draw(runs, output):
    """Volume error and coordination below each of the two sleepers against time, a line per run."""
    figure = new_figure(9, 6)
    axes = figure.subplots(2, 2, sharex=True, sharey="row")
    tables = list(dict.fromkeys(tuple(run[0]) for run in runs))
    for sweeps, start, regions in runs:
        look = {"color": f"C{tables.index(tuple(sweeps))}", "linestyle": "-" if start == runs[-1][1] else "--"}
        label = " ".join(map(str, sweeps)) if start == runs[-1][1] else None
        for name, (upper, lower) in zip(SLEEPERS, axes.T):
            time = regions[name]["time"]
            upper.plot(time, 100 * regions[name]["volume_error"], **look, label=label)
            lower.plot(time, regions[name]["coordination"], **look)
    for number, (upper, lower) in zip((3, 4), axes.T):
        upper.set(title=f"sleeper {number}")
        lower.set(xlabel="time [s]")
    axes[0, 0].set(ylabel="volume error [%]")
    axes[1, 0].set(ylabel="coordination")
    axes[0, 0].legend(title="sweeps per subdomain" + ("; dashed: warm" if len(runs) > len(tables) else ""), fontsize=8)
    figure.savefig(output, dpi=110)


def main(*words):
    folders = [word for word in words if not str(word).endswith(".png")]
    runs = read_runs(folders)
    print_table(in_common(runs))
    for output in set(words) - set(folders):
        draw(runs, output)


if __name__ == "__main__":
    main(*sys.argv[1:])

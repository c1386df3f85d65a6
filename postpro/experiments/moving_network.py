"""Interface between subdomains and grains that change their subdomain, in time, of a run on several subdomains.

usage: PYTHONPATH=postpro python3 -P postpro/experiments/moving_network.py RESULTS...

RESULTS is what a run with `[partition] parts` or on several ranks leaves, with pictures. Prints one row of a Markdown table per
picture: grains of the subdomain that has fewest and most, contacts between grains of two subdomains and between all grains, and the
grains whose subdomain is another one than in the picture before; then what run.json counts of repartitions.
doc/talk/sandbox.md shows what it gave.
"""

import sys

import numpy as np
from splitgrain_postpro.quantities import between_ranks
from splitgrain_postpro.results import Results

COUNTED = ("splits", "moved_bodies", "imbalance_before_splits", "imbalance_after_splits", "imbalance", "rank_updates_min",
           "rank_updates_max", "cpu_seconds")  # fmt: skip


def subdomains(scene):
    """Numbers of the grains of a picture in ascending order, and their subdomains."""
    data = scene.bodies.point_data
    grains = np.asarray(data["is_grain"]) > 0
    number, rank = np.asarray(data["id"])[grains], np.asarray(data["rank"])[grains]
    order = np.argsort(number)
    return number[order], rank[order]


def changed(before, after):
    """Grains that both pictures have, and that lie in another subdomain in the second one."""
    _, first, second = np.intersect1d(before[0], after[0], return_indices=True)
    return int(np.sum(before[1][first] != after[1][second]))


def rows(results):
    """Per picture: time, fewest and most grains per subdomain, contacts between subdomains, of all grains, grains that changed."""
    before = None
    for index, time in enumerate(results.picture_times):
        scene = results.scene(index)
        now = subdomains(scene)
        cells, contacts = between_ranks(scene)
        grains = np.unique(now[1], return_counts=True)[1]
        yield time, grains.min(), grains.max(), len(cells), contacts, changed(before, now) if before else 0
        before = now


def main(*folders):
    for folder in folders:
        results = Results(folder)
        print(f"{folder}\n| time [s] | grains, fewest | most | contacts between | of all | grains that changed |\n" + 6 * "|---" + "|")
        for time, *numbers in rows(results):
            print(f"| {time:.2f} | " + " | ".join(map(str, numbers)) + " |")
        print(", ".join(f"{name} {results.run[name]:.6g}" for name in COUNTED if name in results.run))


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    main(*sys.argv[1:])

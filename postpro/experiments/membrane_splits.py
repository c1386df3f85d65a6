"""The biaxial test between membranes on 1, 4, 16 and 64 subdomains, and overlap at the cuts between them.

usage: PYTHONPATH=postpro:postpro/experiments python3 -P postpro/experiments/membrane_splits.py PROGRAM FOLDER
         [curves] [recovered] [overlaps] [rigid]

`curves`: input_decks/talk/membrane_biaxial.toml with half the radii and half the step from one consolidated state, SEEDS runs on one
subdomain that differ in the order of sweeps and three of each split (`dual`), judged as in doc/theory/decomposition_study.md
(spread.py): inside the band of the runs on one subdomain for no less of the strain, and out of it by no more, than each of those is
when left out. `recovered`: the same with overlap undone, on 16 subdomains.

`overlaps`: the test of that study between rigid walls (input_decks/decomposition/biaxial_compression.toml), whose overlaps at cuts
grew: by plain sweeps as there, by the default solver, with overlap undone (`time.recovery`), and glued by `primal`; and the test
between membranes with overlap undone and without. `rigid`: RIGID_SEEDS runs of that test on one subdomain and three on 16, by the
default solver without recovery and with it, judged as in that study.

All subdomains share one process (`partition.parts`). Runs that are in FOLDER are not made again. doc/talk/membrane_biaxial.md shows
what it gave.
"""

import sys

import numpy as np
from biaxial_causes import frames, pressed
from membrane import curves
from runs import BLACK, GREEN, ORANGE, PLAIN_SWEEPS, VERMILION, Runner, newest, record, summary
from splitgrain_postpro.results import Results
from splitgrain_postpro.style import new_figure
from spread import difference, left_out, newcomer

MEMBRANE, RIGID = "talk/membrane_biaxial.toml", "decomposition/biaxial_compression.toml"
SIZE = {"sample.radius": "[3.5e-3,5.25e-3]", "time.step": 2.5e-4}
SHORTENED, CONSOLIDATED = 0.5, 2.5e-4  # durations of the second stage [s]: of runs, and of the one that makes their start
SEEDS = 12
#: Subdomains: boxes, runs, colour (64 subdomains in one process cost 17 times as much as one)
SPLITS = {4: ([2, 2], 3, GREEN), 16: ([4, 4], 3, ORANGE), 64: ([8, 8], 3, VERMILION)}
CURVES = ("compactness", "deviator")
RIGID_CURVES = ("compactness", "stress_ratio")
LABELS = {"compactness": "compactness", "deviator": "deviatoric over confining stress", "stress_ratio": "stress ratio"}
DEFAULT = {"method": '"nesterov"', "check_every": 0}
#: Ways to solve, for overlaps: solver, gluing, recovery
WAYS = {
    "plain sweeps, dual": (PLAIN_SWEEPS, "dual", 0),
    "default, dual": (DEFAULT, "dual", 0),
    "default, dual, recovery 1e-3": (DEFAULT, "dual", 1e-3),
    "default, primal": (DEFAULT, "primal", 0),
}
RIGID_STEPS, RIGID_RATE, RIGID_SEEDS = 600, 0.1, 20  # 6 % of strain by 0.1 1/s
RIGID_LATE = 0.01  # strain by which the shock of the start is over


def cut(parts, gluing="dual"):
    """Keys of [partition] that cut a scene in boxes."""
    return {"parts": parts, "gluing": f'"{gluing}"'} | ({"boxes": SPLITS[parts][0]} if parts > 1 else {})


def shortened(runner, parts, seed, recovery=0):
    """One run of the test between membranes: its folder."""
    state = runner.run("consolidated", MEMBRANE, anywhere=SIZE | {"stage[2].duration": CONSOLIDATED})
    keys = {"stage[2].duration": SHORTENED, "solver.order": "shuffled", "solver.order_seed": seed}
    name = f"membrane_{parts}_{seed}" + ("_recovered" if recovery else "")
    return runner.run(name, MEMBRANE, state=newest(state), partition=cut(parts), time={"recovery": recovery}, anywhere=SIZE | keys)


def columns(folder):
    """Strain and curves of a run."""
    strain, deviator, compactness = curves(Results(folder))
    return {"strain": strain, "deviator": deviator, "compactness": compactness}


def bands(runner, recovery=0, splits=tuple(SPLITS)):
    """Bands of the test between membranes: table and figure of the runs on one subdomain and of each split."""
    ones = [columns(shortened(runner, 1, seed, recovery)) for seed in range(1, 1 + SEEDS)]
    runs = {parts: [columns(shortened(runner, parts, seed, recovery)) for seed in range(1, 1 + SPLITS[parts][1])] for parts in splits}
    write_bands(runner, "membrane_bands" + ("_recovered" if recovery else ""), CURVES, ones, runs)


def write_bands(runner, name, names, ones, runs):
    """Table and figure of runs on one subdomain, and of those of each split."""
    rows = [row for curve in names for row in verdicts(curve, [run[curve] for run in ones],
                                                       {parts: [run[curve] for run in found] for parts, found in runs.items()})]
    runner.write(name, rows)
    draw_bands(runner.folder / f"{name}.png", names, ones, runs)


def verdicts(curve, ones, splits):
    """Rows of a curve: the runs on one subdomain left out, and each split: first run against the band, mean of the last third."""
    band = np.array(ones)
    share, out = left_out(band).T
    last = 2 * band.shape[1] // 3
    rows = [line(curve, f"1 subdomain, left out: {name}", inside, beyond) for name, inside, beyond in
            (("worst", share.min(), out.max()), ("median", np.median(share), np.median(out)))]  # fmt: skip
    for parts, runs in splits.items():
        by, error = difference(np.array(runs)[:, last:].mean(1), band[:, last:].mean(1))
        for seed, run in enumerate(runs, 1):
            inside, beyond = newcomer(run, band)
            passes = "yes" if inside >= share.min() and beyond <= out.max() else "NO"
            shift = f"{by:+.1e} ± {error:.1e}" if seed == 1 else ""
            rows.append(line(curve, f"{parts} subdomains, seed {seed}", inside, beyond, passes, shift))
    return rows


def line(curve, run, share, out, passes="", shift=""):
    """A row of the table of bands."""
    return {"curve": LABELS[curve], "run": run, "inside the band": f"{100 * share:.0f} %", "largest distance out": f"{out:.1e}",
            "within the worst": passes, "mean of the last third, difference": shift}


def draw_bands(path, names, ones, splits):
    """Both curves against strain, over the band of one subdomain."""
    figure = new_figure(9, 4)
    for ax, curve in zip(figure.subplots(1, 2), names):
        strain, band = 100 * ones[0]["strain"], np.array([run[curve] for run in ones])
        ax.fill_between(strain, band.min(0), band.max(0), color="#CFCFCF", lw=0, label=f"1 subdomain: {len(band)} orders")
        ax.plot(strain, band[0], color=BLACK, lw=1, label="1 subdomain, the first of them")
        for parts, runs in splits.items():
            for seed, run in enumerate(runs):
                ax.plot(strain, run[curve], color=SPLITS[parts][2], lw=1.2 if seed == 0 else 0.5,
                        label=f"{parts} subdomains" if seed == 0 else None)
        ax.set(xlabel="axial strain [%]", ylabel=LABELS[curve])
        ax.legend()
    figure.savefig(path, dpi=110)


def rigid_start(runner):
    """The dense sample between rigid walls: its folder."""
    return runner.run("rigid_start", RIGID, time={"steps": 600}, restart={"every": 600}, anywhere={"law[1].friction": 1e-6})


def sheared(runner, parts, seed, recovery):
    """Columns of one run between rigid walls in a shuffled order."""
    state = rigid_start(runner)
    begin, name = summary(state), f"rigid_{parts}_seed_{seed}" + ("_recovered" if recovery else "")
    results = runner.run(name, RIGID, state=newest(state), partition=cut(parts), solver={"order": '"shuffled"', "order_seed": seed},
                         time={"steps": begin["steps"] + RIGID_STEPS, "recovery": recovery})
    rows = record(results)
    rows = rows[rows["time"] > begin["time"]]
    ratio = (rows["stress_yy"] - rows["stress_xx"]) / (rows["stress_yy"] + rows["stress_xx"])
    return {"strain": RIGID_RATE * (rows["time"] - begin["time"]), "compactness": rows["compactness"], "stress_ratio": ratio}


def rigid_bands(runner, recovery):
    """Bands of the test between rigid walls, on 16 subdomains."""
    ones = [sheared(runner, 1, seed, recovery) for seed in range(1, 1 + RIGID_SEEDS)]
    runs = [sheared(runner, 16, seed, recovery) for seed in range(1, 1 + SPLITS[16][1])]
    name = "rigid_bands" + ("_recovered" if recovery else "")
    write_bands(runner, name, RIGID_CURVES, ones, {16: runs})
    write_bands(runner, f"{name}_late", RIGID_CURVES, late(ones), {16: late(runs)})


def late(runs):
    """Columns of runs from the strain RIGID_LATE on."""
    return [{name: values[run["strain"] > RIGID_LATE] for name, values in run.items()} for run in runs]


def pressed_between(runner, parts, way):
    """One run of the test between rigid walls: its folder."""
    solver, gluing, recovery = WAYS[way]
    state = rigid_start(runner)
    name = f"rigid_{parts}_{list(WAYS).index(way)}"
    return runner.run(name, RIGID, state=newest(state), partition=cut(parts, gluing), solver=solver,
                      output={"every": RIGID_STEPS // 3}, time={"steps": summary(state)["steps"] + RIGID_STEPS, "recovery": recovery})  # fmt: skip


def ratios(frame):
    """Mean overlap of contacts that carry a force: between subdomains, and of grains that touch no other one; the largest of both."""
    pair, rank = frame["pair"], frame["rank"]
    between = rank[pair[0]] != rank[pair[1]]
    inside = ~np.isin(pair, pair[:, between]).any(0)
    overlap = np.maximum(-frame["gap"], 0)
    return [function(overlap[where]) for function in (np.mean, np.max) for where in (between, inside)]


def overlap_row(names, split, places):
    """Overlaps of all pictures of a run, at the cuts of the run `places`, and what the record has of them."""
    found = np.array([ratios(pressed(frame) | {"rank": where["rank"]}) for frame, where in zip(frames(split), frames(places))]).T
    shown = [", ".join(f"{1e6 * value:.2g}" for value in values) for values in found]
    rows, late = record(split), slice(-len(np.atleast_1d(record(split))) // 2, None)
    return names | {"mean at cuts [µm]": shown[0], "elsewhere": shown[1], "ratio": f"{found[0, -1] / found[1, -1]:.2f}",
                    "largest at cuts [µm]": f"{1e6 * found[2, -1]:.2g}", "elsewhere, largest": f"{1e6 * found[3, -1]:.2g}",
                    "volume error": f"{rows['volume_error'][late].mean():.1e}",
                    "compactness": f"{rows['compactness'][late].mean():.4f}", "sweeps per step": f"{rows['sweeps'][late].mean():.0f}"}  # fmt: skip


def overlaps(runner):
    """Overlap at cuts against elsewhere: between rigid walls by each way to solve, and between membranes."""
    rows = []
    for way in WAYS:
        runs = {parts: pressed_between(runner, parts, way) for parts in (1, 16, 64)}
        for parts, places in ((1, 64), (16, 16), (64, 64)):
            rows.append(overlap_row({"test": f"rigid walls, {way}", "subdomains": parts}, runs[parts], runs[places]))
    for recovery, way, splits in ((0, "default", tuple(SPLITS)), (1e-3, "recovery 1e-3", (4, 16))):
        runs = {parts: shortened(runner, parts, 1, recovery) for parts in (1, *splits)}
        for parts, places in ((1, splits[-1]), *((parts, parts) for parts in splits)):
            rows.append(overlap_row({"test": f"membranes, {way}, dual", "subdomains": parts}, runs[parts], runs[places]))
    runner.write("membrane_overlaps", rows)


def main(program, folder, *studies):
    runner = Runner(program, folder, "mpiexec --oversubscribe -n", solver={})
    if "curves" in studies or not studies:
        bands(runner)
    if "recovered" in studies or not studies:
        bands(runner, 1e-3, (16,))
    if "overlaps" in studies or not studies:
        overlaps(runner)
    if "rigid" in studies or not studies:
        rigid_bands(runner, 1e-3)
        rigid_bands(runner, 0)


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])

"""The biaxial test: are split runs of the same kind as runs on one rank that differ in the order of sweeps alone?

SEEDS runs on one rank sweep in shuffled orders of seeds 1, 2, ...; a few runs of each split do so too. What passes was fixed
before any split run was made, for compactness and for the stress ratio alike:

1. The curve of the first run of a split lies inside the band of the runs on one rank for a share of the strain that is not
   below the least of those that each of these runs gives when it is left out of the band, and its largest distance out of
   the band is not above the largest of theirs. A run that differs in the seed alone fails either test once in SEEDS + 1.
2. The mean over the plateau of all runs of a split differs from that of the runs on one rank by no more than 2.5 standard
   errors (a false alarm in one comparison of fifty, by Student's law with 19 degrees of freedom).
"""

import csv

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from runs import BLACK, GREEN, ORANGE, VERMILION, newest, record, summary
from spread import difference, left_out, newcomer, ranks

DECK = "decomposition/biaxial_compression.toml"
RATE = 0.1  # strain rate of the deck [1/s]
SEEDS = 20
# Name, boxes, runs, colour
SPLITS = {
    "4 subdomains, boxes 2 x 2": ([2, 2], 3, GREEN),
    "4 subdomains, strips 4 x 1": ([4, 1], 3, ORANGE),
    "16 subdomains, boxes 4 x 4": ([4, 4], 3, VERMILION),
}
PLATEAU = 0.09  # strain from which compactness is taken for constant
CURVES = {"compactness": "compactness", "stress_ratio": "stress ratio"}
ALLOWED_ERRORS = 2.5


def biaxial(runner):
    """Compactness and stress ratio against strain: one rank in shuffled orders, then 4 and 16 subdomains glued by `dual`."""
    splits = {name: [] for name in SPLITS}
    for seed in range(1, 1 + max(runs for _, runs, _ in SPLITS.values())):
        for name, (boxes, runs, _) in SPLITS.items():
            if seed <= runs:
                splits[name].append(sheared(runner, name_of(boxes), boxes, seed))
    ones = [sheared(runner, "one", [1, 1], seed) for seed in range(1, 1 + SEEDS)]
    verdicts(runner, ones, splits)
    with open(runner.folder / "biaxial_curves.csv", "w", newline="") as file:
        writer = csv.writer(file)
        all_runs = {f"one rank {i + 1}": run for i, run in enumerate(ones)}
        all_runs |= {f"{name} {i + 1}": run for name, runs in splits.items() for i, run in enumerate(runs)}
        writer.writerow(["strain", *(f"{curve} {name}" for curve in CURVES for name in all_runs)])
        writer.writerows(zip(ones[0]["strain"], *(run[curve] for curve in CURVES for run in all_runs.values())))
    curves_figure(runner, ones, splits)
    left_out_figure(runner, ones, splits)


def name_of(boxes):
    """What folders of a split are called."""
    return "x".join(str(n) for n in boxes)


def sheared(runner, name, boxes, seed, steps=1200, tolerance=3e-4, gluing="dual", output=None,
            order="shuffled"):
    """One run of the shear from the dense state, as columns, and its folder."""
    state = runner.run("biaxial_start", DECK, time={"steps": 600}, restart={"every": 600}, anywhere={"law[1].friction": 1e-6})
    begin = summary(state)
    split = {"boxes": boxes, "gluing": f'"{gluing}"'} if boxes != [1, 1] else {}
    results = runner.run(f"biaxial_{name}_{seed}", DECK, boxes[0] * boxes[1], newest(state), partition=split,
                         solver={"order": f'"{order}"', "order_seed": seed, "tolerance": tolerance},
                         time={"steps": begin["steps"] + steps}, output=output or {})  # fmt: skip
    rows = record(results)
    rows = rows[rows["time"] > begin["time"]]
    columns = {key: rows[key] for key in ("compactness", "inertia_number", "sweeps", "converged", "volume_error")}
    columns["stress_ratio"] = (rows["stress_yy"] - rows["stress_xx"]) / (rows["stress_yy"] + rows["stress_xx"])
    columns["strain"] = RATE * (rows["time"] - begin["time"])
    columns["folder"] = results
    return columns


def together(runs, curve):
    """One curve of all runs, as rows."""
    return np.array([run[curve] for run in runs])


def plateau(runs, curve):
    """The mean of a curve over the plateau, of each run."""
    return together(runs, curve)[:, runs[0]["strain"] >= PLATEAU].mean(1)


def verdicts(runner, ones, splits):
    """Tables: each split run beside the runs left out, and the plateaus."""
    rows, means = [], []
    for curve, word in CURVES.items():
        band = together(ones, curve)
        share, out = left_out(band).T
        width = band.max(0) - band.min(0)
        rows.append(line(word, "one rank, left out: worst", share.min(), out.max(), "", "", ""))
        rows.append(line(word, "one rank, left out: median", np.median(share), np.median(out), "", "", ""))
        rows.append(line(word, "one rank, left out: best", share.max(), out.min(), "", "", ""))
        for name, runs in splits.items():
            for i, run in enumerate(runs):
                inside, beyond = newcomer(run[curve], band)
                passes = inside >= share.min() and beyond <= out.max()
                rows.append(line(word, f"{name}, seed {i + 1}", inside, beyond, f"{(share < inside).sum()} of {SEEDS}",
                                 f"{(out > beyond).sum()} of {SEEDS}", "yes" if passes else "NO",
                                 ranks(run[curve], band).mean()))  # fmt: skip
            by, error = difference(plateau(runs, curve), plateau(ones, curve))
            means.append({
                "curve": word, "split": name, "runs": len(runs), "one rank": f"{plateau(ones, curve).mean():.5f}",
                "difference": f"{by:+.1e}", "standard error": f"{error:.1e}", "ratio": f"{by / error:+.1f}",
                "within 2.5": "yes" if abs(by) <= ALLOWED_ERRORS * error else "NO",
            })  # fmt: skip
        print(f"{word}: band of {SEEDS} runs {width.max():.1e} wide at its widest, {np.median(width):.1e} in the median")
    runner.write("biaxial", rows)
    runner.write("biaxial_plateau", means)
    for name, runs in {"one rank": ones, **splits}.items():
        print(f"{name}: sweeps {together(runs, 'sweeps').mean():.0f}, I {np.median(together(runs, 'inertia_number')):.1e} in the "
              f"median, {together(runs, 'inertia_number').max():.1e} at most, "
              f"{(together(runs, 'converged') < 1).sum()} recorded steps not converged")  # fmt: skip


def line(curve, run, share, out, better_share, better_out, passes, rank=None):
    """A row of the table of verdicts."""
    return {
        "curve": curve, "run": run, "inside the band": f"{100 * share:.0f} %", "largest distance out": f"{out:.1e}",
        "inside for longer than": better_share, "less far out than": better_out,
        "mean rank": "" if rank is None else f"{rank:.1f}", "passes": passes,
    }  # fmt: skip


def curves_figure(runner, ones, splits):
    """Curves over the band of the runs on one rank; their distance from its mean; their rank; the stress ratio."""
    figure, axes = plt.subplots(4, 1, figsize=(6.6, 9.6), sharex=True, height_ratios=(3, 2, 1.6, 2.4), layout="constrained")
    strain = 100 * ones[0]["strain"]
    band = together(ones, "compactness")
    mean = band.mean(0)
    over_band(axes[0], strain, band, splits, "compactness", lambda y: y)
    over_band(axes[1], strain, band, splits, "compactness", lambda y: 1e3 * (y - mean))
    over_band(axes[3], strain, together(ones, "stress_ratio"), splits, "stress_ratio", lambda y: y)
    for name, runs in splits.items():
        axes[2].plot(strain, ranks(runs[0]["compactness"], band), color=SPLITS[name][2], lw=1.2)
    axes[2].set_yticks((0, SEEDS // 2, SEEDS))
    axes[0].set_title("Biaxial test, 2400 disks, friction 0.5, dual gluing", loc="left", fontsize=10)
    axes[0].legend(fontsize=8, frameon=False)
    axes[0].set_ylabel("compactness")
    axes[1].set_ylabel("difference from the\nmean of one rank ($10^{-3}$)")
    axes[2].set_ylabel("runs on one\nrank below")
    axes[3].set_ylabel(r"$(\sigma_{yy}-\sigma_{xx})/(\sigma_{yy}+\sigma_{xx})$")
    axes[3].set_xlabel("axial strain (%)")
    axes[3].set_xlim(0, strain[-1])
    for ax in axes:
        ax.grid(color="#E4E4E4")
        ax.set_axisbelow(True)
    figure.savefig(runner.folder / "biaxial.png", dpi=100)
    plt.close(figure)


def over_band(ax, strain, band, splits, curve, shown):
    """The band, its first run, and the first run of each split; `shown` names what of a curve is drawn."""
    ax.fill_between(strain, shown(band.min(0)), shown(band.max(0)), color="#CFCFCF", lw=0,
                    label=f"1 subdomain: band of {len(band)} orders of the sweep")  # fmt: skip
    for run in band[1:]:
        ax.plot(strain, shown(run), color="#A8A8A8", lw=0.4)
    ax.plot(strain, shown(band[0]), color=BLACK, lw=1.2, label="1 subdomain, the first of them")
    for name, runs in splits.items():
        ax.plot(strain, shown(runs[0][curve]), color=SPLITS[name][2], lw=1.2, label=name)


def left_out_figure(runner, ones, splits):
    """Share inside and largest distance out: each run on one rank left out, and all split runs."""
    figure, axes = plt.subplots(2, 2, figsize=(8.0, 3.8), sharey=True, layout="constrained")
    names = ["1 subdomain, left out", *splits]
    for row, (curve, word) in zip(axes, CURVES.items()):
        band = together(ones, curve)
        values = [left_out(band)] + [np.array([newcomer(run[curve], band) for run in runs]) for runs in splits.values()]
        for column, (ax, label) in enumerate(zip(row, ("inside the band (% of the strain)", "largest distance out of it"))):
            scale = 100 if column == 0 else 1
            worst = scale * (values[0][:, 0].min() if column == 0 else values[0][:, 1].max())
            ax.axvline(worst, color="#808080", lw=0.8, ls="--")
            for y, (found, colour) in enumerate(zip(values, [BLACK, *(colour for _, _, colour in SPLITS.values())])):
                ax.plot(scale * found[:, column], np.full(len(found), y), "o", ms=5, color=colour, alpha=0.55, mew=0)
                if y > 0:
                    ax.plot(scale * found[0, column], y, "o", ms=8, mfc="none", mec=colour)
            ax.set_title(word, loc="left", fontsize=9)
            ax.set_yticks(range(len(names)), names, fontsize=8)
            ax.set_ylim(len(names) - 0.5, -0.5)
            ax.grid(axis="x", color="#E4E4E4")
            ax.set_axisbelow(True)
            if curve == list(CURVES)[-1]:
                ax.set_xlabel(label)
    figure.savefig(runner.folder / "biaxial_left_out.png", dpi=100)
    plt.close(figure)

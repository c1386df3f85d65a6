"""Why split runs of the biaxial test are not always like those on one rank: overlaps, kinds of orders, and the tolerance."""

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from biaxial import CURVES, SEEDS, SPLITS, name_of, over_band, sheared, together
from spread import difference, left_out, newcomer

SIXTEEN = "16 subdomains, boxes 4 x 4"
STEPS = 600  # half the strain of the study
TIGHT, TIGHT_SEEDS, TIGHT_STEPS = 1e-4, 20, 400
TIGHT_RUNS = {"4 subdomains, strips 4 x 1": 6, "4 subdomains, boxes 2 x 2": 3, SIXTEEN: 1}
SPATIAL = ("groups", "natural", "coloured")  # the orders that are not shuffled


def biaxial_overlaps(runner):
    """Mean overlap of pressed contacts, by where the cuts of a run on 16 subdomains lie; and the same split glued by `primal`."""
    pictures = {"every": 200}
    split = sheared(runner, "pics4x4", [4, 4], 1, STEPS, output=pictures)
    whole = sheared(runner, "picsone", [1, 1], 1, STEPS, output=pictures)
    rows = []
    places = [pressed(frame) for frame in frames(split["folder"])]
    for number, (frame, beside) in enumerate(zip(places, frames(whole["folder"]))):
        for name, contacts in ((SIXTEEN, frame), ("1 subdomain, same places", pressed(beside) | {"rank": frame["rank"]})):
            rows.append({"strain": f"{2 * (number + 1)} %", "run": name} | overlap_by_place(contacts))
    runner.write("biaxial_overlaps", rows)
    ones = cut([sheared(runner, "one", [1, 1], seed) for seed in range(1, 1 + SEEDS)], len(split["strain"]))
    band = together(ones, "compactness")
    primal = sheared(runner, "primal4x4", [4, 4], 1, STEPS, gluing="primal")
    rows = []
    for name, run in ((f"{SIXTEEN}, dual", split), (f"{SIXTEEN}, primal", primal)):
        inside, out = newcomer(run["compactness"], band)
        rows.append({"run": name, "inside the band": f"{100 * inside:.0f} %", "largest distance out": f"{out:.1e}",
                     "volume error": f"{run['volume_error'].mean():.1e}"})
    share, out = left_out(band).T
    rows.append({"run": "1 subdomain, left out: worst", "inside the band": f"{100 * share.min():.0f} %",
                 "largest distance out": f"{out.max():.1e}",
                 "volume error": f"{together(ones, 'volume_error').mean():.1e}"})
    runner.write("biaxial_primal", rows)


def frames(results):
    """The pictures of a run: contacts by row of their bodies, gaps, normal forces, and rank of each body."""
    import h5py

    with h5py.File(results / "bodies.vtkhdf") as file:
        bodies = file["VTKHDF"]
        identity, is_grain = bodies["PointData/id"][:], bodies["PointData/is_grain"][:] > 0
        ranks = bodies["PointData/rank"][:].reshape(-1, len(identity))
    place = np.argsort(identity)
    with h5py.File(results / "contacts.vtkhdf") as file:
        cells, begins = file["VTKHDF/CellData"], file["VTKHDF/Steps/CellOffsets"][:, 0]
        for rank, begin, count in zip(ranks, begins, file["VTKHDF/FieldData/ncontacts"][:]):
            pair = np.array([cells[side][begin : begin + count] for side in ("candidate", "antagonist")])
            yield {"pair": place[np.searchsorted(identity, pair, sorter=place)], "is_grain": is_grain, "rank": rank,
                   "gap": cells["gap"][begin : begin + count], "force": cells["force_normal"][begin : begin + count]}


def pressed(frame):
    """Only the contacts between grains that carry a force."""
    keep = (frame["force"] > 0) & frame["is_grain"][frame["pair"]].all(0)
    return {"pair": frame["pair"][:, keep], "gap": frame["gap"][keep], "rank": frame["rank"]}


def overlap_by_place(contacts):
    """Mean overlap of contacts between grains of two ranks, beside such grains, and of the others."""
    pair, rank = contacts["pair"], contacts["rank"]
    between = rank[pair[0]] != rank[pair[1]]
    at_cut = np.isin(pair, pair[:, between]).any(0) & ~between
    overlap = np.maximum(-contacts["gap"], 0)
    places = {"between subdomains": between, "next to those": at_cut, "inside": ~between & ~at_cut}
    return {name: f"{overlap[where].mean():.1e} m ({where.sum()})" for name, where in places.items()}


def cut(runs, count):
    """The first rows of runs."""
    return [{key: column if key == "folder" else column[:count] for key, column in run.items()} for run in runs]


def biaxial_tight(runner):
    """A third of the strain at a tolerance three times tighter: what of the scatter and of the splits' effect is the solver's?"""
    ones = [sheared(runner, "tight_one", [1, 1], seed, TIGHT_STEPS, TIGHT) for seed in range(1, 1 + TIGHT_SEEDS)]
    splits = {name: [sheared(runner, f"tight_{name_of(boxes)}", boxes, seed, TIGHT_STEPS, TIGHT)
                     for seed in range(1, 1 + TIGHT_RUNS[name])]
              for name, (boxes, _, _) in SPLITS.items()}  # fmt: skip
    loose = cut([sheared(runner, "one", [1, 1], seed) for seed in range(1, 1 + SEEDS)], len(ones[0]["strain"]))
    orders = {f"1 subdomain, {order}": [sheared(runner, f"tight_{order}", [1, 1], 1, TIGHT_STEPS, TIGHT, order=order)]
              for order in SPATIAL}  # fmt: skip
    rows = []
    for curve, word in CURVES.items():
        band = together(ones, curve)
        share, out = left_out(band).T
        for place, one_share, one_out in (("worst", share.min(), out.max()), ("median", np.median(share), np.median(out))):
            rows.append({"curve": word, "run": f"1 subdomain, shuffled, left out: {place}",
                         "inside the band": f"{100 * one_share:.0f} %", "largest distance out": f"{one_out:.1e}",
                         "within the worst": ""})
        for name, runs in {**orders, **splits}.items():
            for seed, run in enumerate(runs, 1):
                inside, beyond = newcomer(run[curve], band)
                rows.append({"curve": word, "run": f"{name}, seed {seed}" if name in splits else name,
                             "inside the band": f"{100 * inside:.0f} %", "largest distance out": f"{beyond:.1e}",
                             "within the worst": "yes" if inside >= share.min() and beyond <= out.max() else "NO"})
    runner.write("biaxial_tight", rows)
    rows = []
    late = ones[0]["strain"] > ones[0]["strain"][-1] / 2
    for curve, word in {**CURVES, "volume_error": "volume error", "sweeps": "sweeps per step"}.items():
        here, there = together(ones, curve), together(loose, curve)
        by, error = difference(here[:, late].mean(1), there[:, late].mean(1))
        rows.append({"quantity, 2 to 4 %": word, "3e-4": f"{there[:, late].mean():.4g}", "1e-4": f"{here[:, late].mean():.4g}",
                     "difference": f"{by:+.1e}", "standard error": f"{error:.1e}",
                     "scatter at 3e-4": f"{np.median(there[:, late].std(0, ddof=1)):.1e}",
                     "scatter at 1e-4": f"{np.median(here[:, late].std(0, ddof=1)):.1e}",
                     "16 subdomains at 1e-4": f"{together(splits[SIXTEEN], curve)[:, late].mean():.4g}"})
    runner.write("biaxial_tolerances", rows)
    tight_figure(runner, ones, loose, splits, orders)


def tight_figure(runner, ones, loose, splits, orders):
    """Compactness at both tolerances, and the scatter of either."""
    figure, (top, middle, bottom) = plt.subplots(3, 1, figsize=(6.6, 7.4), sharex=True, height_ratios=(3, 2, 1.6),
                                                 layout="constrained")  # fmt: skip
    strain = 100 * ones[0]["strain"]
    band = together(ones, "compactness")
    wide = together(loose, "compactness")
    top.fill_between(strain, wide.min(0), wide.max(0), color="#F0E0C8", lw=0, label=f"1 subdomain, e8 = 3e-4: {SEEDS} orders")
    over_band(top, strain, band, splits, "compactness", lambda y: y)
    over_band(middle, strain, band, splits, "compactness", lambda y: 1e3 * (y - band.mean(0)))
    drawn = [middle.plot(strain, 1e3 * (runs[0]["compactness"] - band.mean(0)), style, color="#0072B2", lw=1.2, label=name)[0]
             for (name, runs), style in zip(orders.items(), ("--", ":", "-."))]  # fmt: skip
    middle.legend(handles=drawn, fontsize=8, frameon=False, loc="lower left")
    for runs, colour, word in ((band, "#000000", "e8 = 1e-4"), (wide, "#B08030", "e8 = 3e-4")):
        bottom.semilogy(strain, runs.std(0, ddof=1), color=colour, lw=1.2, label=word)
    top.set_title("Biaxial test at e8 = 1e-4", loc="left", fontsize=10)
    top.legend(fontsize=8, frameon=False)
    bottom.legend(fontsize=8, frameon=False)
    top.set_ylabel("compactness")
    middle.set_ylabel("difference from the\nmean of one rank ($10^{-3}$)")
    bottom.set_ylabel("standard deviation\nover orders")
    bottom.set_xlabel("axial strain (%)")
    bottom.set_xlim(0, strain[-1])
    for ax in (top, middle, bottom):
        ax.grid(color="#E4E4E4")
        ax.set_axisbelow(True)
    figure.savefig(runner.folder / "biaxial_tight.png", dpi=100)
    plt.close(figure)


def biaxial_orders(runner):
    """At the tolerance of the study: spatial orders on one rank, against the shuffled ones; splits, against all of these orders."""
    shuffled = together([sheared(runner, "one", [1, 1], seed) for seed in range(1, 1 + SEEDS)], "compactness")
    spatial = together([sheared(runner, order, [1, 1], 1, order=order) for order in SPATIAL], "compactness")
    every = np.concatenate((shuffled, spatial))
    rows = [against("worst of the shuffled, left out", "shuffled", worst(shuffled))]
    rows += [against(f"1 subdomain, {order}", "shuffled", newcomer(run, shuffled)) for order, run in zip(SPATIAL, spatial)]
    rows += [against("worst of all orders, left out", "all orders", worst(every))]
    for name, (boxes, _, _) in SPLITS.items():
        run = sheared(runner, name_of(boxes), boxes, 1)["compactness"]
        rows.append(against(f"{name}, seed 1", "all orders", newcomer(run, every)))
    runner.write("biaxial_orders", rows)


def worst(runs):
    """The least share and the largest distance of runs that are left out."""
    share, out = left_out(runs).T
    return share.min(), out.max()


def against(run, band, found):
    """A row: what a run is held against, and with what outcome."""
    return {"run": run, "band of": band, "inside the band": f"{100 * found[0]:.0f} %", "largest distance out": f"{found[1]:.1e}"}

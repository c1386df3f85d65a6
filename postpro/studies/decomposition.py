"""Two figures of Alart's talk of 2010 as measurements: what splitting grains over ranks does to the answer, and to its price.

    python postpro/studies/decomposition.py PROGRAM FOLDER [biaxial] [convergence] [residuals] [sweeps] [relaxation]

runs PROGRAM (a build of splitgrain with MPI and HDF5) through mpiexec, all studies unless some are named, and writes CSV
files, Markdown tables and PNG figures to FOLDER. A state or a run that is in FOLDER already is not made again. It needs
numpy and matplotlib; doc/theory/decomposition_study.md shows what it gave. Iterations and messages are counted, no times.
"""

import argparse
import csv
import json
import os
import subprocess
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

DECKS = Path(__file__).resolve().parents[2] / "input_decks"
ROOT_IS_MEANT = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}

# Okabe and Ito (2008): told apart by colour-blind people.
BLACK, ORANGE, GREEN, BLUE, VERMILION = "#000000", "#E69F00", "#009E73", "#0072B2", "#D55E00"

METHODS = {"dual": (BLUE, "o"), "primal": (GREEN, "s"), "contacts": (VERMILION, "^")}

# epsilon_0 of the packing, the mean of the diagonal of W [1/kg]: of disks 2/m along a normal and 6/m along a tangent,
# with 1/m = 1/(pi rho r_least r_most) in the mean over radii that are spread evenly.
EPSILON_0 = 4 / (np.pi * 2500 * 0.008 * 0.012)
LAWS = {
    "no friction": {},
    "friction 0.5": {"law[1].friction": 0.5},
    "linear, eps0": {"law[1].kind": '"LINEAR"', "law[1].epsilon": round(EPSILON_0, 3)},
    "linear, 0.02 eps0": {"law[1].kind": '"LINEAR"', "law[1].epsilon": round(0.02 * EPSILON_0, 5)},
}
RANKS = (1, 2, 4, 8, 16, 32, 64)


class Runner:
    """Runs decks on ranks, each run in a folder of its own that stays."""

    def __init__(self, program, folder, launcher):
        self.program, self.folder, self.launcher = str(Path(program).resolve()), Path(folder), launcher.split()
        self.folder.mkdir(parents=True, exist_ok=True)

    def run(self, name, deck, ranks=1, state=None, **sections):
        """Run a deck, with `section={key: value}` laid over it, unless that was done; returns the folder of its results."""
        results = self.folder / name
        if (results / "run.json").exists() and json.loads((results / "run.json").read_text())["status"] == "done":
            return results
        words = [self.program, "run", str(DECKS / deck), "--output", str(results), "--quiet"]
        if ranks > 1:
            words = self.launcher + [str(ranks)] + words
        if state:
            words += ["--restart", str(state)]
        for section, keys in sections.items():
            for key, value in keys.items():
                words += ["--set", f"{key}={value}" if section == "anywhere" else f"{section}.{key}={value}"]
        print(name, flush=True)
        subprocess.run(words, check=True, env=os.environ | ROOT_IS_MEANT)
        return results

    def write(self, name, rows):
        """Write rows, dictionaries of the same keys, as CSV and as a Markdown table."""
        with open(self.folder / f"{name}.csv", "w", newline="") as file:
            writer = csv.DictWriter(file, rows[0].keys())
            writer.writeheader()
            writer.writerows(rows)
        lines = ["| " + " | ".join(rows[0]) + " |", "|" + "---|" * len(rows[0])]
        lines += ["| " + " | ".join(str(v) for v in row.values()) + " |" for row in rows]
        (self.folder / f"{name}.md").write_text("\n".join(lines) + "\n")


def record(results):
    """Columns of the record of a run."""
    return np.genfromtxt(results / "record.csv", delimiter=",", names=True)


def summary(results):
    """What a run says of itself."""
    return json.loads((results / "run.json").read_text())


# The biaxial test -----------------------------------------------------------------------------------------------------

SERIAL = {
    "reference": {},
    "natural order": {"order": '"natural"'},
    "relaxation 0.95": {"relaxation": 0.95},
    "relaxation 1.05": {"relaxation": 1.05},
    "tested every 7 sweeps": {"check_every": 7},
    "tested every 50 sweeps": {"check_every": 50},
    "tolerance 2e-4": {"tolerance": 2e-4},
    "tolerance 5e-4": {"tolerance": 5e-4},
}
SPLIT = {
    "4 subdomains, boxes 2 x 2": ([2, 2], GREEN, "-"),
    "4 subdomains, strips 4 x 1": ([4, 1], ORANGE, "-"),
    "16 subdomains, boxes 4 x 4": ([4, 4], VERMILION, "-"),
}


def biaxial(runner):
    """Compactness against strain: one rank in several orders, then the dual method on 4 and 16 subdomains."""
    state = runner.run("biaxial_start", "decomposition/biaxial_compression.toml", time={"steps": 600},
                       restart={"every": 600}, anywhere={"law[1].friction": 1e-6})
    first = summary(state)["time"]
    curves, rows = {}, []
    for name, keys in SERIAL.items():
        curves[name] = biaxial_run(runner, name, state, first, 1, keys, {})
    for name, (boxes, _, _) in SPLIT.items():
        curves[name] = biaxial_run(runner, name, state, first, boxes[0] * boxes[1], {}, {"boxes": boxes})
    serial = np.array([curves[name]["compactness"] for name in SERIAL])
    low, high = serial.min(0), serial.max(0)
    width = (high - low).max()
    for name, curve in curves.items():
        # A serial run is held against the others, without itself: the same question that is asked of a split run.
        others = np.array([curves[other]["compactness"] for other in SERIAL if other != name])
        low_of, high_of = others.min(0), others.max(0)
        beyond = np.maximum(np.maximum(curve["compactness"] - high_of, low_of - curve["compactness"]), 0)
        rows.append({
            "run": name,
            "compactness at the end": f"{curve['compactness'][-1]:.5f}",
            "largest distance from the reference": f"{np.abs(curve['compactness'] - serial[0]).max():.1e}",
            "largest distance out of the spread": f"{beyond.max():.1e}",
            "share of the strain within": f"{100 * np.mean(beyond == 0):.0f} %",
            "largest I": f"{np.nanmax(curve['inertia_number']):.1e}",
            "median I": f"{np.nanmedian(curve['inertia_number']):.1e}",
            "sweeps a step": f"{curve['sweeps'].mean():.0f}",
        })  # fmt: skip
    runner.write("biaxial", rows)
    print(f"spread of the serial runs: {width:.2e} at its widest, {np.median(high - low):.2e} in the median")
    with open(runner.folder / "biaxial_curves.csv", "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["strain", *curves])
        writer.writerows(zip(curves["reference"]["strain"], *(c["compactness"] for c in curves.values())))
    biaxial_figure(runner, curves, low, high)


def biaxial_run(runner, name, state, first, ranks, solver, partition):
    """One run of the shear, as columns."""
    folder = "biaxial_" + "".join(c if c.isalnum() else "_" for c in name)
    first_step = summary(state)["steps"]
    results = runner.run(folder, "decomposition/biaxial_compression.toml", ranks, newest(state), solver=solver,
                         partition=partition, time={"steps": first_step + BIAXIAL_STEPS})
    rows = record(results)
    rows = rows[rows["time"] > first]
    columns = {key: rows[key] for key in ("compactness", "inertia_number", "sweeps")}
    columns["strain"] = 0.1 * (rows["time"] - first)
    return columns


def newest(results):
    """The newest restart file of a run."""
    return max(results.glob("restart_*.h5"), key=lambda path: path.stat().st_mtime)


def biaxial_figure(runner, curves, low, high):
    """Curves over the spread of the serial runs, and below their distance from the reference."""
    figure, (top, bottom) = plt.subplots(2, 1, figsize=(6.4, 5.6), sharex=True, height_ratios=(3, 2), layout="constrained")
    strain = 100 * curves["reference"]["strain"]
    reference = curves["reference"]["compactness"]
    for ax, base, scale in ((top, 0, 1), (bottom, reference, 1e3)):
        ax.fill_between(strain, scale * (low - base), scale * (high - base), color="#C8C8C8", lw=0,
                        label=f"spread of {len(SERIAL)} runs on one rank")
        ax.plot(strain, scale * (reference - base), color=BLACK, lw=1.2, label="1 subdomain")
        for name, (_, colour, style) in SPLIT.items():
            ax.plot(strain, scale * (curves[name]["compactness"] - base), style, color=colour, lw=1.1, label=name)
        ax.grid(color="#E4E4E4")
        ax.set_axisbelow(True)
    top.set_ylabel("compactness")
    top.set_title("Biaxial test, 2400 disks, friction 0.5, dual gluing", loc="left", fontsize=10)
    top.legend(fontsize=8, frameon=False)
    bottom.set_ylabel("difference from 1 subdomain\n($10^{-3}$)")
    bottom.set_xlabel("axial strain (%)")
    bottom.set_xlim(0, strain[-1])
    figure.savefig(runner.folder / "biaxial.png", dpi=110)
    plt.close(figure)


# Convergence against the number of subdomains -------------------------------------------------------------------------


def packing(runner, law):
    """The settled packing, frictionless grains or rough ones: its restart file and the number of steps to it."""
    name, friction = ("packing", 0) if law == "no friction" else ("packing_rough", 0.5)
    results = runner.run(name, "decomposition/packing.toml", anywhere={"law[1].friction": friction})
    return newest(results), summary(results)["steps"]


def tolerance_of(law):
    """The e8 that is asked for: links are so much easier than contacts that a few sweeps would tell nothing."""
    return 1e-6 if law.startswith("linear") else 1e-3


def one_step(runner, name, law, ranks, solver, partition):
    """Solve one step of the packing from a cold start; returns what it took."""
    restart, steps = packing(runner, law)
    keys = {"warm_start": "false", "criterion": '"e8"', "tolerance": tolerance_of(law), "check_every": 1,
            "maximum_sweeps": 50000}
    results = runner.run(name, "decomposition/packing.toml", ranks, restart, time={"steps": steps + 1},
                         solver=keys | solver, partition=partition, output={"record_every": 1}, restart={"every": 0},
                         anywhere=LAWS[law])
    row, said = np.atleast_1d(record(results))[-1], summary(results)
    return {
        "sweeps": int(row["sweeps"]), "gluings": said.get("gluings", 0) if ranks > 1 else 0, "e8": float(row["e8"]),
        "violation": float(row["violation"]), "converged": bool(row["converged"]), "contacts": int(row["contacts"]),
        "updates": int(row["contact_updates"]), "imbalance": said.get("imbalance", 1.0),
        "messages": said.get("messages_per_gluing", 0.0), "bytes": said.get("bytes_per_gluing", 0.0),
    }  # fmt: skip


def name_of(*words):
    """A folder's name."""
    return "_".join(str(w).replace(" ", "").replace(",", "_").replace(".", "p") for w in words)


def convergence(runner):
    """Sweeps to a residual against the number of subdomains, every gluing and law."""
    rows = []
    for ranks in RANKS:
        for law in LAWS:
            for method in METHODS:
                name = name_of("step", law, method if ranks > 1 else "one", ranks)
                found = one_step(runner, name, law, ranks, {}, {"gluing": f'"{method}"'} if ranks > 1 else {})
                rows.append({"law": law, "gluing": method, "ranks": ranks} | found)
    runner.write("convergence", rows)
    pivot = []
    for law in LAWS:
        for method in METHODS:
            line = {"law": law, "gluing": method}
            for row in rows:
                if row["law"] == law and row["gluing"] == method:
                    line[str(row["ranks"])] = str(row["sweeps"]) + ("" if row["converged"] else " !")
            pivot.append(line)
    runner.write("convergence_sweeps", pivot)
    traffic = []
    for ranks in RANKS[1:]:
        line = {"ranks": ranks}
        for method in METHODS:
            row = next(r for r in rows if r["law"] == "friction 0.5" and r["gluing"] == method and r["ranks"] == ranks)
            line |= {f"{method}: messages": f"{row['messages']:.0f}", f"{method}: kB": f"{row['bytes'] / 1e3:.1f}"}
        traffic.append(line)
    runner.write("convergence_traffic", traffic)
    convergence_figure(runner, rows)


def convergence_figure(runner, rows):
    """A panel a law: sweeps against subdomains."""
    figure, axes = plt.subplots(1, 4, figsize=(10, 3.2), sharex=True, layout="constrained")
    for ax, law in zip(axes, LAWS):
        for method, (colour, marker) in METHODS.items():
            chosen = [r for r in rows if r["law"] == law and r["gluing"] == method]
            reached = [r for r in chosen if r["converged"]]
            ax.plot([r["ranks"] for r in reached], [r["sweeps"] for r in reached], marker=marker, ms=4, lw=1.2, color=colour,
                    label=method)
        ax.set_xscale("log", base=2)
        ax.set_xticks(RANKS, [str(r) for r in RANKS])
        ax.set_ylim(0, 1.08 * max(r["sweeps"] for r in rows if r["law"] == law))
        title = law.replace("eps0", r"$\epsilon_0$")
        ax.set_title(f"{title}\nto e8 = {tolerance_of(law):.0e}", loc="left", fontsize=9)
        ax.set_xlabel("subdomains")
        ax.grid(color="#E4E4E4")
        ax.set_axisbelow(True)
    axes[0].set_ylabel("sweeps, each followed by a gluing")
    axes[0].legend(fontsize=8, frameon=False, loc="lower left")
    figure.savefig(runner.folder / "convergence.png", dpi=100)
    plt.close(figure)


# Residual against iterations ------------------------------------------------------------------------------------------

RESIDUALS = (1e-1, 3e-2, 1e-2, 3e-3, 1e-3)


def residuals(runner):
    """Sweeps to falling residuals on 16 subdomains, with friction."""
    rows = []
    for method, ranks in (("one", 1), ("dual", 16), ("primal", 16), ("contacts", 16)):
        line = {"gluing": method, "ranks": ranks}
        for tolerance in RESIDUALS:
            found = one_step(runner, name_of("residual", method, tolerance), "friction 0.5", ranks, {"tolerance": tolerance},
                             {"gluing": f'"{method}"'} if ranks > 1 else {})
            line[f"{tolerance:g}"] = str(found["sweeps"]) + ("" if found["converged"] else " !")
        rows.append(line)
    runner.write("residuals", rows)


# Several sweeps between two gluings -----------------------------------------------------------------------------------


def sweeps(runner):
    """Several sweeps between two gluings, 16 subdomains."""
    rows = []
    for law in ("no friction", "friction 0.5"):
        for method in ("dual", "primal"):
            for count in (1, 2, 5, 10):
                found = one_step(runner, name_of("sweeps", law, method, count), law, 16, {},
                                 {"gluing": f'"{method}"', "sweeps": count})
                rows.append({"law": law, "gluing": method, "sweeps a gluing": count, "sweeps": found["sweeps"],
                             "gluings": found["gluings"], "converged": found["converged"],
                             "violation": f"{found['violation']:.1e}"})
    runner.write("sweeps", rows)


# Relaxation of exchanged momentum -------------------------------------------------------------------------------------


def relaxation(runner):
    """The share of each new impulse that `contacts` takes, 4 x 4 boxes."""
    rows = []
    for law in ("no friction", "friction 0.5"):
        for share in (1.0, 0.9, 0.8, 0.6, 0.4):
            found = one_step(runner, name_of("relaxation", law, share), law, 16, {"maximum_sweeps": 3000},
                             {"gluing": '"contacts"', "relaxation": share, "boxes": [4, 4]})
            rows.append({"law": law, "relaxation": share, "sweeps": found["sweeps"], "converged": found["converged"],
                         "e8": f"{found['e8']:.1e}", "violation": f"{found['violation']:.1e}"})
    runner.write("relaxation", rows)


BIAXIAL_STEPS = 600
STUDIES = {"biaxial": biaxial, "convergence": convergence, "residuals": residuals, "sweeps": sweeps, "relaxation": relaxation}


def main():
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("program", help="splitgrain, built with MPI and HDF5")
    parser.add_argument("folder", help="where runs, tables and figures go")
    parser.add_argument("studies", nargs="*", metavar="STUDY", help=f"which ones (default all): {', '.join(STUDIES)}")
    parser.add_argument("--launcher", default="mpiexec --oversubscribe -n",
                        help="what starts ranks, their number to follow (default: %(default)s)")
    arguments = parser.parse_args()
    for study in arguments.studies:
        if study not in STUDIES:
            parser.error(f"there is no study {study}")
    runner = Runner(arguments.program, arguments.folder, arguments.launcher)
    for study in arguments.studies or STUDIES:
        STUDIES[study](runner)


if __name__ == "__main__":
    main()

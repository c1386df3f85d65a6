"""Two figures of Alart's talk of 2010 as measurements: what splitting grains over ranks does to the answer, and to its price.

    python postpro/experiments/decomposition.py PROGRAM FOLDER [STUDY ...]

runs PROGRAM (a build of splitgrain with MPI and HDF5) through mpiexec, all studies (STUDIES below) unless some are named,
and writes CSV files, Markdown tables and PNG figures to FOLDER. A state or a run that is in FOLDER already is not made again.
It needs numpy, matplotlib and, for biaxial_overlaps, h5py; doc/theory/decomposition_study.md shows what it gave. Iterations
and messages are counted, no times.
"""

import argparse

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from biaxial import biaxial
from biaxial_causes import biaxial_orders, biaxial_overlaps, biaxial_tight
from runs import BLUE, GREEN, VERMILION, Runner, newest, record, summary

METHODS = {"dual": (BLUE, "o"), "primal": (GREEN, "s"), "momentum": (VERMILION, "^")}

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


# Convergence against the number of subdomains -------------------------------------------------------------------------


def packing(runner, law):
    """The settled packing, frictionless grains or rough ones: its restart file and the number of steps to it."""
    name, friction = ("packing", 0) if law == "no friction" else ("packing_rough", 0.5)
    results = runner.run(name, "decomposition/packing.toml", anywhere={"law[1].friction": friction})
    return newest(results), summary(results)["steps"]


def tolerance_of(law):
    """The e8 that is asked for: links are so much easier than contacts that a few sweeps would show nothing."""
    return 1e-6 if law.startswith("linear") else 1e-3


def one_step(runner, name, law, ranks, solver, partition):
    """Solve one step of the packing from a cold start; returns what it took."""
    restart, steps = packing(runner, law)
    keys = {"warm_start": "false", "criterion": '"e8"', "tolerance": tolerance_of(law), "check_every": 1,
            "maximum_sweeps": 50000}
    results = runner.run(name, "decomposition/packing.toml", ranks, restart, time={"steps": steps + 1},
                         solver=keys | solver, partition=partition, output={"record_every": 1}, restart={"every": 0},
                         anywhere=LAWS[law])
    row, message = np.atleast_1d(record(results))[-1], summary(results)
    return {
        "sweeps": int(row["sweeps"]), "gluings": message.get("gluings", 0) if ranks > 1 else 0, "e8": float(row["e8"]),
        "violation": float(row["violation"]), "converged": bool(row["converged"]), "contacts": int(row["contacts"]),
        "updates": int(row["contact_updates"]), "imbalance": message.get("imbalance", 1.0),
        "messages": message.get("messages_per_gluing", 0.0), "bytes": message.get("bytes_per_gluing", 0.0),
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
    for method, ranks in (("one", 1), ("dual", 16), ("primal", 16), ("momentum", 16)):
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
                rows.append({"law": law, "gluing": method, "sweeps per gluing": count, "sweeps": found["sweeps"],
                             "gluings": found["gluings"], "converged": found["converged"],
                             "violation": f"{found['violation']:.1e}"})
    runner.write("sweeps", rows)


# Relaxation of exchanged momentum -------------------------------------------------------------------------------------


def relaxation(runner):
    """The share of each new impulse that `momentum` takes, 4 x 4 boxes."""
    rows = []
    for law in ("no friction", "friction 0.5"):
        for share in (1.0, 0.9, 0.8, 0.6, 0.4):
            found = one_step(runner, name_of("relaxation", law, share), law, 16, {"maximum_sweeps": 3000},
                             {"gluing": '"momentum"', "momentum.relaxation": share, "boxes": [4, 4]})
            rows.append({"law": law, "relaxation": share, "sweeps": found["sweeps"], "converged": found["converged"],
                         "e8": f"{found['e8']:.1e}", "violation": f"{found['violation']:.1e}"})
    runner.write("relaxation", rows)


STUDIES = {
    study.__name__: study
    for study in (biaxial, biaxial_overlaps, biaxial_orders, biaxial_tight, convergence, residuals, sweeps, relaxation)
}


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

#!/usr/bin/env python3
"""Numerical homogenisation of a periodic cell: flow curve, effective stiffness, and what averages of boxes predict.

usage: flow_curve.py PROGRAM FOLDER

Writes flow_curve.csv, stiffness.csv, boxes.csv and flow_curve.png into the folder (doc/talk/homogenisation.md).
"""

import argparse
import csv
import subprocess
from math import pi, sqrt
from pathlib import Path

import h5py
import matplotlib
import numpy as np

matplotlib.use("agg")
import matplotlib.pyplot as plt

DECKS = Path(__file__).resolve().parents[2] / "input_decks/talk"
BLACK, ORANGE, BLUE = "#000000", "#E69F00", "#0072B2"

DENSITY, LEAST, LARGEST, PRESSURE = 2600.0, 4e-3, 6e-3, 1e4
"""Of the disks of both decks: kg/m3, radii in m, Pa."""
TIME = sqrt(DENSITY * pi * (LARGEST**3 - LEAST**3) / (3 * (LARGEST - LEAST)) / PRESSURE)
"""Root of the mean mass over the pressure [s]: the inertia number is the shear rate times it."""
RATES = (2.2, 6.6, 22.0, 44.0, 66.0)
STEADY, BLOCKS = 1.5, 5
"""Strain from which the flow is steady, and parts of the run whose means give the error of the mean."""

# da Cruz and others (2005), disks with diameters within 20 % of their mean, friction 0.4: mu = a + b I, phi = c - d I.
PUBLISHED = {"mu": (0.25, 1.1), "phi": (0.81, -0.3)}


def run(program, deck, folder, *settings):
    """Run a deck, and return the rows of its record as arrays of numbers."""
    words = [program, "run", str(deck), "--output", str(folder), "--force", "--quiet"]
    for setting in settings:
        words += ["--set", setting]
    subprocess.run(words, check=True)
    with open(folder / "record.csv", newline="") as lines:
        rows = list(csv.DictReader(lines))
    wanted = ("step", "stress_xx", "stress_xy", "stress_yy", "strain_xx", "strain_xy", "strain_yy", "compactness",
              "grain_coordination", "sweeps", "cpu_seconds", "mean_stress_xx", "mean_stress_xy", "mean_stress_yy")  # fmt: skip
    return {key: np.array([float(row[key]) for row in rows]) for key in wanted if key in rows[0]}


def means(values):
    """Mean, and its standard error from the means of a few blocks."""
    blocks = [block.mean() for block in np.array_split(values, BLOCKS)]
    return values.mean(), np.std(blocks, ddof=1) / sqrt(BLOCKS)


def flow_curve(program, folder):
    """Effective friction and compactness at five inertia numbers."""
    lines = []
    for rate in RATES:
        record = run(program, DECKS / "flow_curve.toml", folder / f"rate_{rate}", f"cell.shear_rate={rate}", "output.every=0")
        steady = record["strain_xy"] > STEADY
        # Stresses are positive in compression: positive shear has a negative xy.
        friction, friction_error = means(-record["mean_stress_xy"][steady] / record["mean_stress_yy"][steady].mean())
        fill, fill_error = means(record["compactness"][steady])
        lines.append({"rate": rate, "inertia": rate * TIME, "mu": friction, "mu_error": friction_error, "phi": fill,
                      "phi_error": fill_error,
                      "xx_over_yy": record["mean_stress_xx"][steady].mean() / record["mean_stress_yy"][steady].mean(),
                      "coordination": record["grain_coordination"][steady].mean(),
                      "sweeps": record["sweeps"][steady].mean(), "cpu_seconds": record["cpu_seconds"].max()})  # fmt: skip
    write(folder / "flow_curve.csv", lines)
    return lines


def stiffness(program, folder):
    """Slopes of stresses over small strains of a pack of elastic contacts, and those of affine motion."""
    lines = []
    for probe, rates in (("xx", (1e-3, 0, 0)), ("yy", (0, 1e-3, 0)), ("xy", (0, 0, 1e-3))):
        settings = [f"stage[2].cell.{key}={value}" for key, value in zip(("strain_rate_xx", "strain_rate_yy", "shear_rate"), rates)]
        record = run(program, DECKS / "stiffness.toml", folder / f"stiffness_{probe}", *settings)
        probed = record["step"] > 6000
        strain = record[f"strain_{probe}"][probed]
        slopes = {key: np.polyfit(strain, record[f"stress_{key}"][probed], 1)[0] for key in ("xx", "yy", "xy")}
        lines.append({"probe": probe, **slopes, "phi": record["compactness"][probed].mean(),
                      "coordination": record["grain_coordination"][probed].mean()})  # fmt: skip
    write(folder / "stiffness.csv", lines)
    return lines


def boxes(program, folder, curve):
    """How well the shear stress of a box in later steps is foreseen: by the mean of all, by its last value, and by the flow law of the
    cell from its pressure and shear rate; errors over the scatter of the stress."""
    law = np.polyfit([line["inertia"] for line in curve], [line["mu"] for line in curve], 1)
    lines = []
    for rate in RATES[0], RATES[2]:
        stress, gradient = box_averages(program, folder, rate)
        pressure, shear = (stress[..., 0] + stress[..., 4]) / 2, -stress[..., 1]
        inertia = np.abs(rate + gradient[..., 1]) * TIME / np.sqrt(np.maximum(pressure, PRESSURE / 100) / PRESSURE)
        homogenised = pressure * np.polyval(law, inertia)
        for lag in (0, 1, 10, 100):
            now, then = slice(None, -lag or None), slice(lag, None)
            guesses = {"mean": shear.mean(), "last_value": shear[now], "flow_law": homogenised[now]}
            errors = {key: rms(shear[then] - guess) / shear.std() for key, guess in guesses.items()}
            lines.append({"inertia": rate * TIME, "lag": lag, "strain": lag * rate * 1e-4, **errors,
                          "scatter": shear.std() / shear.mean()})  # fmt: skip
    write(folder / "boxes.csv", lines)


def box_averages(program, folder, rate):
    """Stresses, and rates of shear beyond the cell's, in nine boxes in each step of a steady flow."""
    deck, first = folder / "boxes.toml", int(STEADY / rate / 1e-4)
    deck.write_text((DECKS / "flow_curve.toml").read_text() + "[[field]]\nbox = [0.0, 0.0, 0.16, 0.15]\ncells = [3, 3]\nevery = 1\n"
                    'sample_every = 0\nkernel = "box"\n')  # fmt: skip
    results = folder / f"boxes_{rate}"
    run(program, deck, results, "output.every=0", f"time.steps={first + 2000}", f"cell.shear_rate={rate}")
    with h5py.File(results / "field_1.vtkhdf") as file:
        cells = file["VTKHDF/CellData"]
        return [cells[name][:].reshape(-1, 9, 9)[first:] for name in ("stress", "velocity_gradient")]


def rms(values):
    """Root of the mean square."""
    return float(np.sqrt(np.mean(values**2)))


def write(path, rows):
    """Write rows as CSV."""
    with open(path, "w", newline="") as file:
        writer = csv.DictWriter(file, rows[0].keys())
        writer.writeheader()
        writer.writerows(rows)


def draw(folder, lines):
    """Both curves next to the published ones."""
    figure, axes = plt.subplots(1, 2, figsize=(9, 3.8), layout="constrained")
    inertia = np.array([line["inertia"] for line in lines])
    dense = np.linspace(0, 0.32)
    for ax, key, label in zip(axes, ("mu", "phi"), (r"effective friction $\mu$ [-]", r"compactness $\varphi$ [-]"), strict=True):
        values = np.array([line[key] for line in lines])
        ax.errorbar(inertia, values, [line[key + "_error"] for line in lines], fmt="o", color=BLUE, capsize=3,
                    label="periodic cell, 248 disks")  # fmt: skip
        slope, start = np.polyfit(inertia, values, 1)
        ax.plot(dense, start + slope * dense, color=BLUE, lw=1, label=f"{start:.3f} {'+' if slope > 0 else '-'} {abs(slope):.2f} I")
        base, published = PUBLISHED[key]
        ax.plot(dense, base + published * dense, color=ORANGE, ls="--",
                label=f"da Cruz et al. (2005): {base} {'+' if published > 0 else '-'} {abs(published)} I")  # fmt: skip
        ax.set(xlabel="inertia number I [-]", ylabel=label, xlim=(0, 0.32))
        ax.legend(fontsize="small")
    figure.savefig(folder / "flow_curve.png", dpi=90)


def main():
    """Run all."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("folder", type=Path)
    words = parser.parse_args()
    words.folder.mkdir(parents=True, exist_ok=True)
    program = str(Path(words.program).resolve())
    curve = flow_curve(program, words.folder)
    draw(words.folder, curve)
    stiffness(program, words.folder)
    boxes(program, words.folder, curve)


if __name__ == "__main__":
    main()

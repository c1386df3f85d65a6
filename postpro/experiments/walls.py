"""The biaxial test between rigid walls beside that between membranes: deviatoric stress and compactness against axial strain.

usage: PYTHONPATH=postpro:postpro/experiments python3 -P postpro/experiments/walls.py WALLS MEMBRANES PNG

WALLS and MEMBRANES are what input_decks/talk/walls_biaxial.toml and membrane_biaxial.toml leave. The axial stress is the force on the
upper wall over the width between the walls aside; the compactness is the area of the grains over that between the four walls.
"""

import sys

import numpy as np
from membrane import CONFINING, curves
from splitgrain_postpro.results import Results
from splitgrain_postpro.style import BLUE, VERMILION, new_figure

HALF = 0.01  # half the thickness of a wall [m]: as in the deck; lower and left faces are at zero


def wall_curves(tracks, area_of_grains):
    """Axial strain, deviatoric over confining stress, and compactness, from the start of the second stage on."""
    top, right = tracks["top"], tracks["right"]
    height, width = top["y"] - HALF, right["x"] - HALF
    rows = np.flatnonzero(top["stage"] >= 2)
    strain = np.log(height[max(rows[0] - 1, 0)] / height[rows])
    axial = top["mean_force_y"][rows] / width[rows]
    return strain, (axial - CONFINING) / CONFINING, area_of_grains / (width * height)[rows]


def area_of_grains(results):
    """Area of the disks of a run [m2]."""
    data = results.scene(0).bodies.point_data
    return np.pi * (np.asarray(data["radius"])[np.asarray(data["is_grain"]) > 0] ** 2).sum()


def summary(strain, deviator, compactness):
    """Peak and where, mean of the last quarter with its angle of friction, and compactness at the start, densest and last."""
    peak, last = int(deviator.argmax()), deviator[-len(deviator) // 4 :].mean()
    return (f"peak {deviator[peak]:.2f} at {100 * strain[peak]:.1f} %, last quarter {last:.2f} "
            f"({np.degrees(np.arcsin(last / (last + 2))):.1f} degrees), compactness {compactness[0]:.3f}, "
            f"densest {compactness.max():.3f}, last {compactness[-1]:.3f}")  # fmt: skip


def main(walls, membranes, output):
    rigid = Results(walls)
    both = {"rigid walls": wall_curves(rigid.tracks, area_of_grains(rigid)), "membranes": curves(Results(membranes))}
    figure = new_figure(9, 4)
    axes = figure.subplots(1, 2)
    for (name, (strain, deviator, compactness)), colour in zip(both.items(), (BLUE, VERMILION)):
        for ax, values, label in ((axes[0], deviator, "deviatoric over confining stress"), (axes[1], compactness, "compactness")):
            ax.plot(100 * strain, values, color=colour, label=name)
            ax.set(xlabel="axial strain [%]", ylabel=label)
        print(f"{name}: {summary(strain, deviator, compactness)}")
    axes[0].legend()
    figure.savefig(output, dpi=110)


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    main(*sys.argv[1:])

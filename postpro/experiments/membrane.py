"""Deviatoric stress and compactness of a biaxial test between membranes, and its shear bands.

usage: PYTHONPATH=postpro python3 -P postpro/experiments/membrane.py RESULTS PNG

RESULTS is what input_decks/talk/membrane_biaxial.toml leaves. Draws stress and compactness against axial strain and the rotations
of grains, and prints some of the curve. The sample is the polygon of the two chains, by their centres; the axial stress is the
force on the upper platen over the mean width of that polygon, the lateral one the confining pressure.
"""

import sys

import numpy as np
from matplotlib.collections import EllipseCollection
from splitgrain_postpro.results import Results
from splitgrain_postpro.style import new_figure

CONFINING = 1e4  # Pa: as in the deck


def chain(tracks, name):
    """Centres of a chain of disks at all rows: shape (disks, rows, 2)."""
    count = sum(body.startswith(name + ".") for body in tracks)
    return np.array([np.column_stack([tracks[f"{name}.{i + 1}"][axis] for axis in "xy"]) for i in range(count)])


def areas(corners):
    """Areas of polygons that run counter-clockwise: corners of shape (corners, rows, 2)."""
    following = np.roll(corners, -1, axis=0)
    return 0.5 * (corners[..., 0] * following[..., 1] - corners[..., 1] * following[..., 0]).sum(axis=0)


def curves(results):
    """Axial strain, deviatoric over confining stress, and compactness, from the start of the second stage on."""
    tracks = results.tracks
    top = tracks["top"]
    corners = np.concatenate([chain(tracks, "left"), chain(tracks, "right")])
    area = areas(corners)
    height = top["y"] - 0.01  # face of the platen over that of the lower one, at zero
    grains = results.scene(0).bodies.point_data
    radius = np.asarray(grains["radius"])[np.asarray(grains["is_grain"]) > 0]
    axial = top["mean_force_y"] / (area / height)
    rows = np.flatnonzero(top["stage"] >= 2)
    # A run that goes on from the first stage has no row of it: its own first row is within 1e-5 of the height at the start.
    strain = np.log(height[max(rows[0] - 1, 0)] / height[rows])
    return strain, (axial[rows] - CONFINING) / CONFINING, np.pi * (radius**2).sum() / area[rows]


def draw_rotations(figure, ax, scene):
    """Grains in the colours of their rotation, and the disks of the membranes."""
    data = scene.bodies.point_data
    radius, angle = np.asarray(data["radius"]), np.degrees(np.asarray(data["angle"]))
    is_grain = np.asarray(data["is_grain"]) > 0
    points = scene.bodies.points[:, :2]
    grains = EllipseCollection(2 * radius[is_grain], 2 * radius[is_grain], 0 * radius[is_grain], units="xy",
                               offsets=points[is_grain], transOffset=ax.transData, cmap="RdBu", array=angle[is_grain])
    limit = np.quantile(np.abs(angle[is_grain]), 0.97)
    grains.set_clim(-limit, limit)
    ax.add_collection(grains)
    nodes = ~is_grain & (radius < radius[is_grain].min())
    ax.add_collection(EllipseCollection(2 * radius[nodes], 2 * radius[nodes], 0 * radius[nodes], units="xy", offsets=points[nodes],
                                        transOffset=ax.transData, facecolor="black"))
    shown = points[is_grain | nodes]
    ax.set(xlim=(shown[:, 0].min() - 0.02, shown[:, 0].max() + 0.02), ylim=(-0.01, shown[:, 1].max() + 0.02), aspect="equal")
    figure.colorbar(grains, ax=ax, label="rotation [degrees]")


def main(folder, output):
    results = Results(folder)
    strain, deviator, compactness = curves(results)
    figure = new_figure(10, 5.5)
    axes = figure.subplots(1, 3, width_ratios=[1, 1, 1.2])
    for ax, values, label in ((axes[0], deviator, "deviatoric over confining stress"), (axes[1], compactness, "compactness")):
        ax.plot(100 * strain, values)
        ax.set(xlabel="axial strain [%]", ylabel=label)
    draw_rotations(figure, axes[2], results.scene(-1))
    figure.savefig(output, dpi=110)
    print("axial strain [%], deviatoric over confining stress, compactness")
    for i in np.unique(np.linspace(0, len(strain) - 1, 13).astype(int)):
        print(f"{100 * strain[i]:6.2f} {deviator[i]:6.3f} {compactness[i]:6.4f}")
    peak, last = deviator.max(), deviator[-len(deviator) // 4 :].mean()
    for name, value in (("peak", peak), ("last quarter", last)):
        print(f"{name}: {value:.3f}, angle of friction {np.degrees(np.arcsin(value / (value + 2))):.1f} degrees")


if __name__ == "__main__":
    main(*sys.argv[1:])

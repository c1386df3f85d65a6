"""The angle of the shear bands of a biaxial test between membranes, beside Mohr-Coulomb, Roscoe and Arthur.

usage: PYTHONPATH=postpro:postpro/experiments python3 -P postpro/experiments/shear_band.py PNG RESULTS...

RESULTS is what input_decks/talk/membrane_biaxial.toml leaves; the first one is drawn, means are those of all.

From one picture to another the displacement of the grains is linear in each triangle of their Delaunay triangulation; its symmetric
gradient is the strain, of which the deviator is drawn. A band that makes an angle with the minor principal direction (horizontal
here) shows where the deviator is averaged in strips of that angle: of all angles it is the one whose means vary most, each against
what a field without bands gives, in which the same values are dealt to the triangles at random. The two families of bands, rising to
the right and to the left, are looked for apart.
"""

import sys

import matplotlib.tri as mtri
import numpy as np
from membrane import curves
from splitgrain_postpro.results import Results
from splitgrain_postpro.style import new_figure

ANGLES = np.arange(30.0, 76.0, 1.0)  # of a band to the minor principal direction [degrees]
SHUFFLES = 40


def deviator_field(before, after):
    """Triangles of the grains of a picture, and the shear strain (difference of principal strains) in each up to the next one."""
    grains = [np.asarray(scene.bodies.point_data["is_grain"]) > 0 for scene in (before, after)]
    start, end = (scene.bodies.points[is_grain, :2] for scene, is_grain in zip((before, after), grains))
    triangles = mtri.Triangulation(*start.T).triangles
    corners, moves = start[triangles], (end - start)[triangles]
    edges = corners[:, 1:] - corners[:, :1]
    length = np.sqrt((edges**2).sum(2)).max(1)
    is_inside = length < 2.5 * np.median(length)  # the others lie between a membrane and the rim of the hull
    triangles, corners, moves, edges = (values[is_inside] for values in (triangles, corners, moves, edges))
    gradient = np.linalg.solve(edges, moves[:, 1:] - moves[:, :1])  # gradient[t, j, i] = d move_i / d x_j
    strain = (gradient + gradient.transpose(0, 2, 1)) / 2
    shear = np.hypot(strain[:, 0, 0] - strain[:, 1, 1], 2 * strain[:, 0, 1])
    return start, triangles, corners.mean(1), np.abs(np.linalg.det(edges)) / 2, shear


def variation(centre, area, values, angle, width):
    """Variance, over strips that make an angle [degrees] with the horizontal, of the mean of values in them, weighted by area."""
    across = centre @ [-np.sin(np.radians(angle)), np.cos(np.radians(angle))]
    strip = ((across - across.min()) / width).astype(int)
    total = np.bincount(strip, area)
    kept = total > 0.2 * total.max()
    means = np.bincount(strip, area * values)[kept] / total[kept]
    return np.average((means - np.average(means, weights=total[kept])) ** 2, weights=total[kept])


def band_angle(centre, area, shear, width, sign):
    """The angle of the bands of one family [degrees], and by how many times the variance there exceeds that without bands."""
    capped = np.minimum(shear, np.quantile(shear, 0.98))
    random = np.random.default_rng(1)
    contrast = []
    for angle in ANGLES:
        shuffled = [variation(centre, area, random.permutation(capped), sign * angle, width) for _ in range(SHUFFLES)]
        contrast.append(variation(centre, area, capped, sign * angle, width) / np.mean(shuffled))
    contrast = np.array(contrast)
    best = contrast > 0.8 * contrast.max()  # the top of the peak, whose middle scatters less than its highest point
    near = best & (np.abs(ANGLES - ANGLES[contrast.argmax()]) <= 12)
    return np.average(ANGLES[near], weights=contrast[near]), contrast.max()


def theories(results):
    """Angles of Mohr-Coulomb, Roscoe and Arthur [degrees] from strength and dilatancy at the peak, which are returned first."""
    strain, deviator, compactness = curves(results)
    smooth = np.convolve(deviator, np.ones(5) / 5, mode="same")
    peak = int(smooth.argmax())
    friction = np.degrees(np.arcsin(smooth[peak] / (smooth[peak] + 2)))
    # From the peak on, over 4 % of strain: volume strain is that of the area, whose grains stay.
    later = np.searchsorted(strain, strain[peak] + 0.04)
    volume = np.log(compactness[peak] / compactness[min(later, len(strain) - 1)])
    axial = strain[min(later, len(strain) - 1)] - strain[peak]
    dilatancy = np.degrees(np.arcsin(volume / (2 * axial + volume)))  # sin psi = volume / (axial - lateral), lateral = -axial - volume
    return friction, dilatancy, 45 + friction / 2, 45 + dilatancy / 2, 45 + (friction + dilatancy) / 4


def windows(count):
    """First and last picture of the three windows of a run: about the peak, after it, and at the end."""
    return (count // 6, count // 2), (count // 2, 3 * count // 4), (3 * count // 4, count - 1)


def draw(ax, results, first, last, figure):
    """Shear strain from one picture to another."""
    start, triangles, _, _, shear = deviator_field(results.scene(first), results.scene(last))
    drawn = ax.tripcolor(*start.T, triangles, facecolors=np.minimum(shear, np.quantile(shear, 0.97)), cmap="magma")
    ax.set(aspect="equal", title=f"{results.picture_times[first]:.2f} s to {results.picture_times[last]:.2f} s", xlabel="x [m]")
    figure.colorbar(drawn, ax=ax, label="shear strain", shrink=0.6)


def main(output, *folders):
    runs = [Results(folder) for folder in folders]
    figure = new_figure(10, 5)
    axes = figure.subplots(1, 3)
    for i, ax in enumerate(axes):
        draw(ax, runs[0], *windows(len(runs[0].picture_times))[i], figure)
        angles, contrasts = [], []
        for results in runs:
            _, _, centre, area, shear = deviator_field(*map(results.scene, windows(len(results.picture_times))[i]))
            for sign in (1, -1):
                angle, contrast = band_angle(centre, area, shear, 2 * np.sqrt(area.mean()), sign)
                angles.append(angle)
                contrasts.append(contrast)
        error = np.std(angles, ddof=1) / np.sqrt(len(angles))
        print(f"window {i + 1}: {len(angles)} families of bands, {np.mean(angles):.1f} +- {error:.1f} degrees, weighted by contrast "
              f"{np.average(angles, weights=contrasts):.1f}; contrast {np.mean(contrasts):.0f}")  # fmt: skip
    figure.savefig(output, dpi=110)
    found = np.array([theories(results) for results in runs])
    names = ("friction", "dilatancy", "Mohr-Coulomb", "Roscoe", "Arthur")
    print("; ".join(f"{name} {mean:.1f} +- {spread:.1f}" for name, mean, spread in
                    zip(names, found.mean(0), found.std(0) / np.sqrt(max(1, len(runs) - 1)))), "degrees")  # fmt: skip


if __name__ == "__main__":
    main(*sys.argv[1:])

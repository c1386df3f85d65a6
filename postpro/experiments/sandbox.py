"""Surface slope of the wedge of a sandbox against critical-taper theory.

usage: PYTHONPATH=postpro python3 -P postpro/experiments/sandbox.py RESULTS [FRICTION_ANGLE]

RESULTS is what input_decks/talk/sandbox.toml leaves. Prints one line per picture: shortening, length of the wedge, surface slope,
friction that the base mobilises below the wedge, and the slope that theory gives a cohesionless wedge on a level base
[Davis1983] [Dahlen1990] for that base and the angle of friction of the sand (degrees, default 26).
"""

import sys

import numpy as np
from splitgrain_postpro.quantities import rows_of
from splitgrain_postpro.results import Results
from splitgrain_postpro.vtkhdf import VTK_LINE


def taper(phi, phi_base):
    """Surface slope of a critical wedge on a level base: alpha = psi_base - psi_0, all angles in radians."""
    psi_base = (np.arcsin(np.sin(phi_base) / np.sin(phi)) - phi_base) / 2
    alpha = np.linspace(0, phi, 20001)
    psi = (np.arcsin(np.minimum(np.sin(alpha) / np.sin(phi), 1)) - alpha) / 2
    return float(np.interp(psi_base, alpha + psi, alpha))


def surface(x, y, radius, width):
    """Highest point of the grains in columns of this width: places and heights."""
    columns = np.floor(x / width).astype(int)
    found = np.unique(columns)
    return (found + 0.5) * width, np.array([(y + radius)[columns == column].max() for column in found])


def wedge(scene, bed, wall):
    """Ends of the wedge, from the pushed wall to where the surface is last a third higher than the bed, and its slope [rad]. Grains
    behind the wall, which slipped under it, are left out."""
    data = scene.bodies.point_data
    grains = (np.asarray(data["is_grain"]) > 0) & (scene.bodies.points[:, 0] > wall)
    points, radius = scene.bodies.points[grains], np.asarray(data["radius"])[grains]
    x, height = surface(points[:, 0], points[:, 1], radius, 6 * radius.mean())
    high = np.flatnonzero(height > 4 / 3 * bed)
    if len(high) < 4:
        return None
    part = slice(1, high[-1] + 1)  # the first column is rounded off by the wall
    return x[0], x[high[-1]], -np.arctan(np.polyfit(x[part], height[part], 1)[0])


def base_friction(scene, start, end):
    """Shear over normal force on the base between two places."""
    contacts, data = scene.contacts, scene.bodies.point_data
    cells = np.flatnonzero(contacts.types == VTK_LINE)
    cell = contacts.cell_data
    on_base = np.zeros(len(cells), dtype=bool)
    for name in ("candidate", "antagonist"):
        on_base |= np.asarray(data["is_grain"])[rows_of(data["id"], cell[name][cells])] == 0
    point, normal = cell["point"][cells], np.abs(cell["normal"][cells])
    keep = on_base & (normal[:, 1] > 0.99) & (point[:, 0] > start) & (point[:, 0] < end)
    return abs(cell["force_tangential"][cells][keep].sum()) / cell["force_normal"][cells][keep].sum()


def main(folder, angle="26"):
    results = Results(folder)
    phi = np.radians(float(angle))
    first = results.scene(0)
    start = first.bodies.points[np.asarray(first.bodies.point_data["is_grain"]) > 0]
    x, height = surface(start[:, 0], start[:, 1], 0.0, (start[:, 0].max() - start[:, 0].min()) / 40)
    bed, left = np.median(height[20:]), start[:, 0].min()
    print(f"bed {1e3 * bed:.1f} mm; shortening [mm], length of the wedge [mm], slope, friction of the base, slope by theory")
    walls = results.tracks["wall.push"]
    for index, time in enumerate(results.picture_times):
        scene = results.scene(index)
        found = wedge(scene, bed, np.interp(time, walls["time"], walls["x"]))
        if found is None:
            continue
        friction = base_friction(scene, found[0], found[1])
        alpha = taper(phi, min(np.arctan(friction), phi))
        print(f"{1e3 * (found[0] - left):6.0f} {1e3 * (found[1] - found[0]):6.0f} {np.degrees(found[2]):6.1f} deg {friction:6.3f} "
              f"{np.degrees(alpha):6.1f} deg")


if __name__ == "__main__":
    main(*sys.argv[1:])

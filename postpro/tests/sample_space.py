"""A small scene in space as result folder: two spheres and a cube in a box of five planes, a capsule, a drum."""

import numpy as np
from sample_results import Writer, write_record

# Corners of a box and its faces, counter-clockwise seen from outside.
SIGNS = np.array([[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1], [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]])
FACES = ([0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7])
# Numbers of its own, so that what reads them must look up their names.
KINDS = "hollow cylinder", "sphere", "polyhedron", "cylinder", "plane"
HOLLOW, SPHERE, POLYHEDRON, CYLINDER, PLANE = range(1, 6)


def capsule(low, high, radius, sides=12):
    """Points from pole to pole along z, and polygons, of a cylinder with (here blunt) ends."""
    turn = 2 * np.pi * np.arange(sides) / sides
    ring = radius * np.column_stack([np.cos(turn), np.sin(turn), np.zeros(sides)])
    points = np.vstack([[low - [0, 0, radius]], low + ring, high + ring, [high + [0, 0, radius]]])
    after = np.roll(np.arange(sides), -1)
    cells = [[0, 1 + after[j], 1 + j] for j in range(sides)]
    cells += [[1 + j, 1 + after[j], 1 + sides + after[j], 1 + sides + j] for j in range(sides)]
    cells += [[1 + sides + j, 1 + sides + after[j], 2 * sides + 1] for j in range(sides)]
    return points, cells


def tube(centre, half_height, radius, sides=24):
    """Points and inward polygons of a hollow cylinder along z."""
    turn = 2 * np.pi * np.arange(sides) / sides
    ring = radius * np.column_stack([np.cos(turn), np.sin(turn), np.zeros(sides)])
    points = np.vstack([centre + ring - [0, 0, half_height], centre + ring + [0, 0, half_height]])
    after = np.roll(np.arange(sides), -1)
    return points, [[after[j], j, sides + j, sides + after[j]] for j in range(sides)]


def write_space_results(folder, walls=True, drum=False, periods=(0.0, 0.0), steps=2, held=False):
    """A folder of results; all grains touch the floor, and the two spheres each other with a force of 3 N. Held: a cube far above."""
    folder.mkdir(parents=True, exist_ok=True)
    centres = [[0.5, 0.5, 0.5], [1.5, 0.5, 0.5], [2.5, 0.5, 0.5], [1.0, 1.5, 0.2]]
    radii = [0.5, 0.5, (3 / (4 * np.pi)) ** (1 / 3), 0.3]
    shapes = [(SPHERE, 1, np.array([centres[0]]), [[0]], 0.5), (SPHERE, 2, np.array([centres[1]]), [[0]], 0.5),
              (POLYHEDRON, 3, centres[2] + 0.5 * SIGNS, FACES, 0.0),
              (CYLINDER, 4, *capsule(np.array([1, 1.5, 0.2]), np.array([1, 1.5, 0.8]), 0.2), 0.0)]
    boxes = []
    if walls:
        boxes = [([1.5, 1, -0.1], [1.7, 1.2, 0.1]), ([-0.1, 1, 1], [0.1, 1, 1.2]), ([3.1, 1, 1], [0.1, 1, 1.2]),
                 ([1.5, -0.1, 1], [1.5, 0.1, 1.2]), ([1.5, 2.1, 1], [1.5, 0.1, 1.2])]
    for centre, half in boxes:
        centres.append(centre)
        radii.append(0.5)
        shapes.append((PLANE, len(centres), centre + half * SIGNS, FACES, 0.0))
    if drum:
        centres.append([1.5, 1, 1])
        radii.append(0.0)
        shapes.append((HOLLOW, len(centres), *tube(np.array([1.5, 1, 1]), 1.0, 2.5), 0.0))
    if held:
        centres.append([1.0, 1.0, 6.0])
        radii.append(0.5)
        shapes.append((POLYHEDRON, len(centres), centres[-1] + 0.5 * SIGNS, FACES, 0.0))
    centres, radii, n = np.array(centres), np.array(radii), len(centres)
    points, cells, data, sphere_radii = [], [], {"body": [], "kind": [], "shape": []}, []
    for number, (kind, body, corners, faces, radius) in enumerate(shapes, 1):
        base = sum(map(len, points))
        points.append(corners)
        sphere_radii += [radius] * len(corners)
        cells += [base + np.array(face) for face in faces]
        for name, value in (("body", body), ("kind", kind), ("shape", number)):
            data[name] += [value] * len(faces)
    types = [1 if kind == SPHERE else 7 for kind in data["kind"]]
    files = {name: Writer(folder / f"{name}.vtkhdf") for name in ("bodies", "shapes", "contacts")}
    files["shapes"].file.attrs.create("shape_kinds", np.bytes_("|".join(KINDS)))
    for k in range(steps):
        fields = {"step": 10 * k, "period": periods[0], "period_y": periods[1]}
        velocity = np.zeros((n, 3))
        velocity[:4, 2] = [-1.0, -2.0, -3.0, -4.0]
        body_data = {"id": np.arange(1, n + 1), "radius": radii, "mass": np.ones(n), "velocity": velocity, "spin": velocity,
                     "material": np.ones(n, dtype=int), "orientation": np.tile([1.0, 0, 0, 0], (n, 1)),
                     "start_position": centres, "displacement": 0 * centres, "rank": np.zeros(n, dtype=int),
                     "is_grain": (np.arange(n) < 4).astype(int)}
        files["bodies"].step(0.1 * k, centres, np.arange(n)[:, None], 1, body_data, field_data=fields)
        files["shapes"].step(0.1 * k, np.vstack(points), cells, types, {"radius": np.array(sphere_radii)},
                             {name: np.array(values) for name, values in data.items()}, fields, static=True)
        # The two spheres push each other apart; the second and the cube share two points.
        ends = np.array([centres[[0, 1]], centres[[1, 2]], centres[[1, 2]]])
        force = np.array([[-3.0, 0, 0], [-1.0, 0, 0], [-2.0, 0, 0]])
        contact_data = {"force_normal": -force[:, 0], "force_tangential": np.zeros(3), "force": force, "gap": np.zeros(3),
                        "normal": np.tile([-1.0, 0, 0], (3, 1)), "status": np.full(3, 2), "law": np.ones(3, dtype=int),
                        "point": np.array([[1.0, 0.5, 0.5], [2.0, 0.5, 0.4], [2.0, 0.5, 0.6]]),
                        "candidate": np.array([1, 2, 2]), "antagonist": np.array([2, 3, 3])}
        files["contacts"].step(0.1 * k, ends.reshape(-1, 3), np.arange(6).reshape(3, 2), 3, cell_data=contact_data,
                               field_data={**fields, "ncontacts": 3})
    for file in files.values():
        file.close()
    write_record(folder, 10)
    return folder

#!/usr/bin/env python3
"""Make the stones of this folder: convex polyhedra as crushed rock has them, each the room between some planes at random.

The planes touch an ellipsoid of given axes at points spread over it; lengths are in millimetres. Usage: make_stones.py [FOLDER]
"""

import itertools
import sys
from pathlib import Path

import numpy

# Name, half axes, planes, seed: from cube-like to flat and long, as the classes of Zingg.
STONES = (
    ("cube_like", (25, 23, 21), 13, 1),
    ("rounded", (24, 22, 20), 22, 2),
    ("flat", (28, 24, 13), 14, 3),
    ("long", (34, 19, 17), 14, 4),
    ("blade", (35, 22, 12), 15, 5),
    ("wedge", (27, 21, 19), 9, 6),
)


def directions(n, random):
    """Unit vectors, each the farthest from those before of some tries."""
    chosen = [numpy.array([0.0, 0.0, 1.0])]
    while len(chosen) < n:
        tries = random.normal(size=(12, 3))
        tries /= numpy.linalg.norm(tries, axis=1)[:, None]
        chosen.append(tries[numpy.argmax([min(numpy.linalg.norm(numpy.array(chosen) - t, axis=1)) for t in tries])])
    return numpy.array(chosen)


def stone(axes, n, seed):
    """Triangles of the room between planes, shape (triangles, 3, 3)."""
    random = numpy.random.default_rng(seed)
    normal = directions(n, random) / numpy.array(axes)
    height = numpy.ones(n) * random.uniform(0.85, 1.0, n)
    vertex, faces = [], [[] for _ in range(n)]
    for three in itertools.combinations(range(n), 3):
        matrix = normal[list(three)]
        if abs(numpy.linalg.det(matrix)) < 1e-9:
            continue
        point = numpy.linalg.solve(matrix, height[list(three)])
        if numpy.all(normal @ point <= height + 1e-9):
            for face in three:
                faces[face].append(len(vertex))
            vertex.append(point)
    triangles = []
    for plane, face in zip(normal, faces):
        if len(face) < 3:
            continue
        points = numpy.array([vertex[i] for i in face])
        first = points[0] - points.mean(axis=0)
        second = numpy.cross(plane, first)
        turn = numpy.arctan2((points - points.mean(axis=0)) @ second / numpy.linalg.norm(plane), (points - points.mean(axis=0)) @ first)
        points = points[numpy.argsort(turn)]
        triangles += [(points[0], points[k], points[k + 1]) for k in range(1, len(points) - 1)]
    return numpy.array(triangles)


def main(folder):
    for name, axes, n, seed in STONES:
        triangles = stone(axes, n, seed)
        with open(folder / f"{name}.stl", "w", encoding="ascii") as file:
            file.write(f"solid {name}\n")
            for a, b, c in triangles:
                normal = numpy.cross(b - a, c - a)
                normal /= numpy.linalg.norm(normal)
                file.write("facet normal {:.6f} {:.6f} {:.6f}\nouter loop\n".format(*normal))
                for point in (a, b, c):
                    file.write("vertex {:.9f} {:.9f} {:.9f}\n".format(*point))
                file.write("endloop\nendfacet\n")
            file.write(f"endsolid {name}\n")
        print(f"{name}: {len(triangles)} triangles")


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).parent))

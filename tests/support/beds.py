"""Beds of grains that fall from a lattice into a box, as the end of a deck."""

PLANE_WALLS = """[[wall]]
from = [-0.1, -0.05]
to = [1.1, -0.05]
thickness = 0.1
[[wall]]
from = [-0.05, 0.0]
to = [-0.05, 0.6]
thickness = 0.1
[[wall]]
from = [1.05, 0.0]
to = [1.05, 0.6]
thickness = 0.1
"""
SPACE_WALLS = """[[container]]
name = "box"
size = [0.6, 0.3, 0.5]
"""


def bed(dimension, shape, radius):
    """Walls and grains of a shape; radius: a number, or the least and the largest one [m]."""
    walls, box = (PLANE_WALLS, [0.0, 0.0, 1.0, 0.5]) if dimension == 2 else (SPACE_WALLS, [0.0, 0.0, 0.0, 0.6, 0.3, 0.45])
    return f'{walls}[[sample]]\nkind = "lattice"\nshape = "{shape}"\nbox = {box}\nradius = {radius}\nspacing = 1.1\n'

"""A mesh of trimesh as a body, and the mesh where the run has left it (PyPI: trimesh).

    python3 trimesh_stone.py [MESH]
"""

import sys
from tempfile import TemporaryDirectory

import trimesh

import splitgrain as sg


def dropped(mesh, folder, steps=300):
    """Drop the hull of a mesh on a floor; returns the mesh as it lies then, and the run."""
    stone = mesh.convex_hull
    height = 0.02 * stone.scale - stone.bounds[0, 2]
    deck = sg.Deck({
        "scene": {"dimension": 3}, "time": {"step": 1e-3, "steps": steps}, "output": {"every": steps, "record_every": 10},
        "material": [{"name": "stone", "density": 2600.0}], "law": [{"friction": 0.5}],
        "body": [sg.polyhedron(stone.vertices + [0.0, 0.0, height], name="stone", material="stone")],
        "wall": [{"name": "floor", "material": "stone", "centre": [0.0, 0.0, 0.0], "size": [9.0 * stone.scale] * 2,
                  "thickness": 0.1 * stone.scale}],
    })  # fmt: skip
    run = deck.run(folder)
    moved = stone.copy()
    moved.apply_translation([0.0, 0.0, height])
    moved.apply_transform(run.transformations()["stone"])
    return moved, run


if __name__ == "__main__":
    mesh = trimesh.load_mesh(sys.argv[1]) if len(sys.argv) > 1 else trimesh.creation.icosphere(subdivisions=1, radius=0.1)
    with TemporaryDirectory() as place:
        print("bounds of the stone where it lies:", dropped(mesh, f"{place}/stone")[0].bounds.round(4).tolist())

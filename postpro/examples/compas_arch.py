"""A block model of compas_dem to a deck, and the motions of a run back to the model (PyPI: compas_dem).

    python3 compas_arch.py [FOLDER]
"""

import sys
from tempfile import TemporaryDirectory

from compas.geometry import Transformation
from compas_dem.models import BlockModel
from compas_dem.problem.results import Results
from compas_dem.templates import ArchTemplate

import splitgrain as sg


def deck_of(model, density=2400.0, friction=0.7):
    """The deck of a block model: one polyhedron per block, named after its place in the graph; supports stand still."""
    bodies = []
    for block in model.elements():
        vertices, _ = block.modelgeometry.to_vertices_and_faces()
        keys = {"fixed": True} if block.is_support else {}
        bodies.append(sg.polyhedron(vertices, name=f"block.{block.graphnode}", material="stone", **keys))
    return sg.Deck({
        "scene": {"dimension": 3}, "time": {"step": 1e-3, "steps": 200}, "output": {"every": 200, "record_every": 10},
        "solver": {"tolerance": 1e-3}, "material": [{"name": "stone", "density": density}], "law": [{"friction": friction}], "body": bodies,
    })  # fmt: skip


def results_of(run, model):
    """Results as compas_dem keeps them: the motion of each block by its place in the graph, and the normal force of each pair."""
    results = Results(str(model.guid), str(run.folder))
    motions, names = run.transformations(), run.names()
    node = {number: int(name.partition(".")[2]) for number, name in names.items()}
    for block in model.elements():
        matrix = motions[f"block.{block.graphnode}"]
        results.set_node(block.graphnode, "transformation", Transformation.from_matrix(matrix.tolist()))
    faces = run.contacts()
    for one, other, force in zip(faces["candidate"], faces["antagonist"], faces["force_normal"], strict=True):
        edge = node[int(one)], node[int(other)]
        results.set_edge(edge, "normal_force", (results.edge_attribute(edge, "normal_force") or 0.0) + float(force))
    return results


def arch(blocks=15):
    """A semicircular arch of a span of 4 m, whose two ends are held."""
    model = BlockModel()
    for place, mesh in enumerate(ArchTemplate(rise=2.0, span=4.0, thickness=0.4, depth=0.5, n=blocks).blocks()):
        add = model.add_support_from_mesh if place in (0, blocks - 1) else model.add_block_from_mesh
        add(mesh)
    return model


if __name__ == "__main__":
    with TemporaryDirectory() as place:
        model = arch()
        results = results_of(deck_of(model).run(sys.argv[1] if len(sys.argv) > 1 else f"{place}/arch"), model)
        for block in model.elements():
            print(f"block {block.graphnode}: moved by {max(map(abs, results.displacement(block.graphnode))):.2e} m")

"""The examples of doc/guide/python.md that need packages of their own: each is skipped where its package is not installed."""

import os

import numpy as np
import pytest

import splitgrain as sg

pytestmark = pytest.mark.skipif("SPLITGRAIN_PROGRAM" not in os.environ, reason="no SPLITGRAIN_PROGRAM")


def test_grainlearning_finds_the_friction(tmp_path, monkeypatch):
    pytest.importorskip("grainlearning")
    import grainlearning_friction

    # GrainLearning leaves files in the current folder.
    monkeypatch.chdir(tmp_path)
    friction, spread = grainlearning_friction.calibrate(tmp_path, iterations=3, samples=8)
    # The samples begin between 0.05 and 0.6, a spread of 0.5 of their mean.
    assert friction == pytest.approx(0.2, abs=0.02) and 0 <= spread < 0.2
    assert sum(len(list(folder.glob("*.json"))) for folder in tmp_path.glob("iteration_*")) >= 24


def test_compas_model_to_a_deck_and_back(tmp_path):
    pytest.importorskip("compas_dem")
    import compas_arch

    model = compas_arch.arch()
    deck = compas_arch.deck_of(model)
    deck["solver"]["tolerance"] = 1e-6
    deck["time"]["steps"] = deck["output"]["every"] = 100
    run = deck.run(tmp_path / "arch")
    results = compas_arch.results_of(run, model)
    blocks = list(model.elements())
    assert len(blocks) == 15 and {block.graphnode for block in blocks} == set(results.nodes())
    # An arch of this thickness stands: its blocks creep by less than a micrometre in 0.1 s, in which a free one falls by 49 mm.
    assert max(max(map(abs, results.displacement(block.graphnode))) for block in blocks) < 1e-6
    assert [results.node_attribute(node, "transformation").matrix[0][3] for node in (0, 14)] == pytest.approx([0.0, 0.0], abs=1e-14)
    # Each joint of the chain carries: 14 pairs, the crown by the thrust alone, the springings by more.
    forces = {tuple(sorted(edge)): results.edge_attribute(edge, "normal_force") for edge in results.edges()}
    assert set(forces) == {(k, k + 1) for k in range(14)} and forces[0, 1] > forces[6, 7] > 0
    assert forces[0, 1] == pytest.approx(forces[13, 14], rel=1e-2)


def test_compas_blocks_that_fall_move_as_the_run_says(tmp_path):
    pytest.importorskip("compas_dem")
    import compas_arch
    from compas.geometry import Box, Frame
    from compas_dem.models import BlockModel

    model = BlockModel.from_boxes([Box(1.0, 0.5, 0.3, Frame([0.0, 0.0, 1.0], [1, 1, 0], [-1, 1, 0]))])
    deck = compas_arch.deck_of(model)
    deck["time"]["steps"] = deck["output"]["every"] = 100
    results = compas_arch.results_of(deck.run(tmp_path / "box"), model)
    # A free fall from rest; the mid-point rule has no error in it.
    assert results.displacement(0) == pytest.approx([0.0, 0.0, -0.5 * 9.81 * 0.1**2], abs=1e-12)


def test_mesh_of_trimesh_lies_where_the_run_left_it(tmp_path):
    trimesh = pytest.importorskip("trimesh")
    import trimesh_stone

    mesh = trimesh.creation.box((0.2, 0.12, 0.1))
    mesh.apply_transform(trimesh.transformations.rotation_matrix(0.3, [0, 1, 0]))
    moved, run = trimesh_stone.dropped(mesh, tmp_path / "stone", steps=400)
    # The box has tipped onto its face: it lies on the floor, its least height is its own.
    low, high = moved.bounds[:, 2]
    assert abs(low) < 1e-4 and high == pytest.approx(0.1, abs=1e-4)
    assert moved.volume == pytest.approx(mesh.volume, rel=1e-9)
    shapes = run.results.scene(-1).shapes
    # Every corner of the mesh is one of the pictures.
    ways = np.linalg.norm(moved.vertices[:, np.newaxis] - shapes.points[np.newaxis], axis=2)
    assert ways.min(axis=1).max() < 1e-9


def test_the_hull_of_points_is_a_body():
    block = sg.polyhedron(np.eye(3), name="stone", material="granite")
    assert block == {"shape": "polyhedron", "vertices": np.eye(3).tolist(), "name": "stone", "material": "granite"}

#!/usr/bin/env python3
"""A wall of bricks by SplitGrain and by LMGC90's own solver of polyhedra, which the PyPI package compas-lmgc90 carries.

usage: compare_compas_lmgc90.py PROGRAM [--write FILE]

Run it with a Python that has compas_lmgc90, h5py and numpy:

    python3 -m venv build/compas && build/compas/bin/pip install compas-lmgc90 h5py
    build/compas/bin/python tests/decks/compare_compas_lmgc90.py build/release/splitgrain

Without compas_lmgc90 one sentence is said and nothing is done. --write puts the table between the two markers of FILE
(doc/verification.md). Exit code 1 when what has one solution differs: points of each joint, what each course carries, for
stacks also the centre of pressure of each joint; and the way of the brick that moves farthest in two scenes that fall.
Single forces, and the share of each joint of a wall, have many solutions.
"""

import json
import subprocess
import sys
import tempfile
from importlib.util import find_spec
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from manual_pages import put, table

LENGTH, DEPTH, HEIGHT = 0.236, 0.115, 0.071
PITCH = 0.24
DENSITY, FRICTION, ALERT, STEP, THETA, GRAVITY = 1800.0, 0.6, 1e-3, 1e-3, 0.5, 9.81
FACES = [[3, 2, 1, 0], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
# Of the weight above a joint: LMGC90 stops at 1e-4 of its own criterion, which looks at increments.
SAME = 2e-3


def box(centre, size):
    """Corners of a box in the order that FACES expects."""
    signs = [(-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, -1), (-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, 1, 1)]
    return [[c + s * d / 2 for c, s, d in zip(centre, sign, size)] for sign in signs]


GROUND = ([0.6, 0.0, -0.1], [3.0, 1.0, 0.2])


def wall(columns=6, rows=5, shorter=1):
    """Centres and sizes of a wall in running bond, a gap between the bricks of a course; and the course of each block.

    Courses are each one brick shorter, so that every brick lies on two; or, all alike, the last ones tip over the end."""
    places = [(row, column) for row in range(rows) for column in range(columns - shorter * row)]
    shifts = [0.5 * (row if shorter else row % 2) for row in range(rows)]
    bricks = [([(column + shifts[row]) * PITCH, 0.0, (row + 0.5) * HEIGHT], [LENGTH, DEPTH, HEIGHT]) for row, column in places]
    return [GROUND, *bricks], [0, *(row + 1 for row, _ in places)]


def stack(overhang, rows=5):
    """A stack in which each brick stands out over the one below."""
    bricks = [([row * overhang, 0.0, (row + 0.5) * HEIGHT], [LENGTH, DEPTH, HEIGHT]) for row in range(rows)]
    return [GROUND, *bricks], [*range(rows + 1)]


def run_there(blocks, steps):
    """LMGC90: joints, displacements of the blocks [m], deepest gap [m]."""
    import numpy as np
    from compas_lmgc90.solver import Solver

    solver = Solver(dt=STEP, theta=THETA, density=DENSITY)
    solver.geometry_from_v_f([{"vertices": box(*block), "faces": FACES} for block in blocks], density=DENSITY)
    solver.set_supports(z_threshold=0.0)
    solver.contact_law("IQS_CLB", FRICTION, alert=ALERT)
    solver.preprocess()
    solver.run(steps)
    last = solver.last_result
    pairs = [tuple(sorted(body - 1 for body in pair)) for pair in last.interaction_bodies]
    return (joints(pairs, np.array(last.interaction_coords), np.array(last.interaction_force_global)),
            np.array(last.bodies) - np.array(last.init_bodies), min(last.interaction_gap, default=0.0))


def deck(blocks, steps):
    """The same scene as a deck."""
    bodies = "".join(f"[[body]]\nfixed = {'false' if n else 'true'}\nshape = \"polyhedron\"\nvertices = {json.dumps(box(*block))}\n"
                     for n, block in enumerate(blocks))
    return (f"[scene]\ndimension = 3\ngravity = [0.0, 0.0, -{GRAVITY}]\n[time]\nstep = {STEP}\ntheta = {THETA}\n"
            f"steps = {steps}\n[solver]\ncriterion = \"e8\"\ntolerance = 1e-6\nmaximum_sweeps = 100000\n[output]\nevery = {steps}\n"
            f"[[material]]\nname = \"brick\"\ndensity = {DENSITY}\n[[law]]\nkind = \"IQS_CLB\"\nfriction = {FRICTION}\n"
            f"[[interaction]]\nalert = {ALERT}\n{bodies}")


def run_here(program, blocks, steps):
    """SplitGrain: the same."""
    import h5py

    with tempfile.TemporaryDirectory() as place:
        file, results = Path(place) / "wall.toml", Path(place) / "results"
        file.write_text(deck(blocks, steps))
        subprocess.run([program, "run", file, "--output", results, "--quiet", "--force"], check=True)
        with h5py.File(results / "contacts.vtkhdf") as pictures:
            first = pictures["VTKHDF/Steps/CellOffsets"][-1, 0]
            names = ("candidate", "antagonist", "point", "force", "gap")
            candidate, antagonist, point, force, gap = (pictures["VTKHDF/CellData"][name][first:] for name in names)
        with h5py.File(results / "bodies.vtkhdf") as pictures:
            moved = pictures["VTKHDF/PointData/displacement"][-len(blocks):]
    pairs = [tuple(sorted((int(c) - 1, int(a) - 1))) for c, a in zip(candidate, antagonist)]
    return joints(pairs, point, force), moved, min(gap, default=0.0)


def joints(pairs, points, forces):
    """For each pair of blocks: number of points, force that it carries upwards [N], its centre of pressure along x [m]."""
    found = {}
    for pair in sorted(set(pairs)):
        rows = [row for row, other in enumerate(pairs) if other == pair]
        upwards = abs(forces[rows, 2])
        found[pair] = (len(rows), upwards.sum(), upwards @ points[rows, 0] / max(upwards.sum(), 1e-300))
    return found


def compare(name, scene, runs, single):
    """Rows of the table, and what is wrong as sentences; with a single solution joints are compared too."""
    blocks, course = scene
    (here, moved_here, gap_here), (there, moved_there, gap_there) = runs
    weight = DENSITY * GRAVITY * LENGTH * DEPTH * HEIGHT
    rows, wrong = [], []
    if {pair: joint[0] for pair, joint in here.items()} != {pair: joint[0] for pair, joint in there.items()}:
        wrong.append(f"{name}: joints or their points differ")
    rows.append([name, "joints; points", *(f"{len(side)}; {sum(joint[0] for joint in side.values())}" for side in (here, there))])
    for level in range(1, max(course) + 1):
        above = weight * sum(c >= level for c in course)
        carried = [sum(joint[1] for pair, joint in side.items() if course[pair[1]] == level) for side in (here, there)]
        rows.append([name, f"under course {level}: carried, over the weight", *(f"{c / above - 1:+.1e}" for c in carried)])
        if max(abs(c / above - 1) for c in carried) > SAME:
            wrong.append(f"{name}: course {level} carries {carried}, {above} lies on it")
        if single:
            pair = (level - 1, level)
            centres = [side[pair][2] for side in (here, there)]
            rows.append([name, f"under course {level}: centre of pressure [m]", *(f"{c:.7f}" for c in centres)])
            if abs(centres[0] - centres[1]) > SAME * LENGTH:
                wrong.append(f"{name}: centres of pressure under course {level} are {centres}")
    rows.append([name, "farthest way of a brick [m]", *(f"{abs(m).max():.1e}" for m in (moved_here, moved_there))])
    rows.append([name, "smallest gap [m]", f"{gap_here:.1e}", f"{gap_there:.1e}"])
    return rows, wrong


def main():
    if find_spec("compas_lmgc90") is None:
        print(f"skipped: {sys.executable} has no compas_lmgc90 (PyPI: compas-lmgc90)")
        return
    program = str(Path(sys.argv[1]).resolve())
    rows, wrong = [], []
    for name, scene, steps, single in (("wall, courses each one brick shorter", wall(), 200, False),
                                       ("stack, each 20 mm out", stack(0.02), 200, True)):
        # LMGC90 keeps one simulation a process, which a new solver resets.
        runs = run_here(program, scene[0], steps), run_there(scene[0], steps)
        more = compare(name, scene, runs, single)
        rows, wrong = rows + more[0], wrong + more[1]
    for name, scene, steps in (("stack, each 60 mm out: it falls", stack(0.06), 150),
                               ("wall without shorter courses: its end tips", wall(4, 5, 0), 300)):
        (_, here, _), (_, there, _) = run_here(program, scene[0], steps), run_there(scene[0], steps)
        brick = abs(there).max(axis=1).argmax()
        for axis in (0, 2):
            rows.append([name, f"way of brick {brick} after {steps * STEP:g} s, {'xyz'[axis]} [m]",
                         f"{here[brick][axis]:.5f}", f"{there[brick][axis]:.5f}"])
        if abs(here[brick] - there[brick]).max() > 0.05 * abs(there[brick]).max():
            wrong.append(f"{name}: not the same way")
    text = table(["scene", "", "ours", "LMGC90"], rows)
    print(text, end="")
    if sys.argv[2:3] == ["--write"]:
        put(sys.argv[3], "compas", text)
    sys.exit("\n".join(wrong) or 0)


if __name__ == "__main__":
    if len(sys.argv) not in (2, 4):
        sys.exit(__doc__)
    main()

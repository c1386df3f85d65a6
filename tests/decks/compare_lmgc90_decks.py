#!/usr/bin/env python3
"""Run the small decks of LMGC90 that have its own trajectories beside them, and compare step by step.

Usage: compare_lmgc90_decks.py PROGRAM [--only DECK ...] [--write FILE] [--check]

The decks are looked for in ${SPLITGRAIN_SHARED}/decks/lmgc90, else in ../shared beside the source; without them one line is
printed and nothing is done; so without numpy and h5py. Each deck runs twice: with the parameters of its script (own) and solved far (tight), as LMGC90 did.
--write puts the table between the two markers of FILE (doc/verification.md). --check fails where free flight differs by more
than the digits of the DATBOX, or where a deck listed in MUST_RUN is refused. Needs numpy and h5py.
"""

import argparse
import csv
import importlib.util
import json
import subprocess
import sys
import tempfile
from pathlib import Path

from compare_lmgc90 import shared_decks
from lmgc90_reference import CRITERIA, SCHEME

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from manual_pages import put, table

TIGHT = {"solver.criterion": "qm16", "solver.tolerance": 1e-9, "solver.check_every": 50, "solver.maximum_sweeps": 200000}
FREE_FLIGHT = 1e-6
"""Largest difference in free flight, as a share of the size of the scene: a DATBOX holds seven digits"""
WITHIN = {"2_briques_cablees_2D": 1e-7, "4POLYG_SHEAR_CYCLE_CZM": 1e-12, "Beam_ClusterPR": 1e-4, "Couette": 1e-12,
          "ViscoElasticRepell_BouncingBall_2D": 1e-12, "arche_plein_ceintre_2D": 1e-10, "clusterDKPL_GroundJC": 1e-12}
"""Largest difference of places at the end of the run that is solved far, as a share of the size of the scene, that --check takes.
Rounding where the problem has one answer; in Beam_ClusterPR normals of tilted faces differ, in 2_briques_cablees_2D
masses by the 2.8e-8 of LMGC90's pi in single precision"""


def keys_of(reference, dimension, folder, way):
    """Deck keys that repeat the reference's run."""
    norm, tolerance, relaxation, between, blocks = reference["solver"]
    keys = {**SCHEME, "scene.dimension": dimension, "scene.datbox": str(folder), "time.step": reference["time_step"],
            "time.theta": reference["theta"], "time.steps": reference[way]["steps"], "solver.method": "nlgs",
            "solver.criterion": CRITERIA[norm.strip()],
            "solver.tolerance": tolerance, "solver.check_every": between, "solver.maximum_sweeps": between * blocks,
            "output.every": 1, "output.record_every": 1}
    for name, words, _ in reference["calls"] if way == "own" else ():
        if name in ("PLPLx_ShrinkPolygFaces", "PRPRx_ShrinkPolyrFaces"):
            keys["scene.shrink_faces"] = float(words[0])
    return keys | (TIGHT if way == "tight" else {})


def run(program, keys, work):
    """Run a deck; the folder of results, or the first sentence of what refuses it."""
    sections = {}
    for key, value in keys.items():
        section, word = key.split(".")
        sections.setdefault(section, []).append(f"{word} = {json.dumps(value)}")
    deck, results = work / "deck.toml", Path(tempfile.mkdtemp(dir=work)) / "results"
    deck.write_text("".join(f"[{section}]\n" + "\n".join(lines) + "\n" for section, lines in sections.items()))
    done = subprocess.run([program, "run", deck, "--output", results, "--quiet"], capture_output=True, text=True, check=False)
    if done.returncode == 0:
        return results, ""
    refusals = [line for line in done.stderr.splitlines() if "error: " in line]
    return None, refusals[0].split("error: ")[1] if refusals else done.stderr.strip()


def trajectory(results, steps):
    """Positions and velocities at some steps, shape (steps, bodies, components); spins in space about principal axes."""
    import h5py
    import numpy as np

    with h5py.File(results / "bodies.vtkhdf") as file:
        root = file["VTKHDF"]
        starts, data = root["Steps/PointOffsets"][:], root["PointData"]
        n = root["NumberOfPoints"][0]
        places, speeds = [], []
        for step in steps:
            bodies = slice(starts[step], starts[step] + n)
            place = root["Points"][bodies]
            spin = data["spin"][bodies] if "spin" in data else np.zeros(n)
            if "orientation" in data:
                turn = data["orientation"][bodies] * [1, -1, -1, -1]
                across = 2 * np.cross(turn[:, 1:], spin)
                spin = spin + turn[:, :1] * across + np.cross(turn[:, 1:], across)
            flat = spin.ndim == 1
            d = 2 if flat else 3
            places.append(np.column_stack([place[:, :d], data["angle"][bodies]]) if flat and "angle" in data else place[:, :d])
            speeds.append(np.column_stack([data["velocity"][bodies][:, :d], spin]))
    return np.array(places), np.array(speeds)


def differences(results, arrays, way, time_step):
    """Largest differences of positions and velocities at the steps of the reference, as shares of the size of the scene and of
    the largest velocity of the run, or of a millionth of the size per length of the run where nothing moves faster."""
    import numpy as np

    steps = arrays[f"steps_{way}"]
    there, speed = arrays[f"X_{way}"], arrays[f"V_{way}"]
    places, speeds = trajectory(results, steps)
    d = 2 if there.shape[2] == 3 else 3
    size = np.ptp(there[0, :, :d], axis=0).max()
    fastest = max(np.linalg.norm(speed[..., :d], axis=2).max(), 1e-6 * size / (steps[-1] * time_step))
    return (np.linalg.norm(places[..., :d] - there[..., :d], axis=2).max(axis=1) / size,
            np.linalg.norm(speeds[..., :d] - speed[..., :d], axis=2).max(axis=1) / fastest)


def rows_of(program, folder, work, faults):
    """Rows of one deck."""
    import numpy as np

    reference = json.loads((folder / "reference.json").read_text())
    arrays = np.load(folder / "reference.npz")
    dimension = 2 if arrays["X_own"].shape[2] == 3 else 3
    rows = []
    for way in ("own", "tight"):
        results, refusal = run(program, keys_of(reference, dimension, folder, way), work)
        if refusal:
            if folder.name in WITHIN:
                faults.append(f"{folder.name} is refused: {refusal}")
            return [[folder.name, "", f"refused: {refusal}", "", "", "", "", ""]]
        place, speed = differences(results, arrays, way, reference["time_step"])
        steps, carrying = arrays[f"steps_{way}"], arrays[f"contacts_{way}"][:, 1]
        first = int(np.argmax(carrying > 0)) + 1 if carrying.any() else len(carrying) + 1
        free = [i for i, step in enumerate(steps) if 0 < step < first]
        later = [i for i, step in enumerate(steps) if step >= first]
        with open(results / "record.csv", newline="") as file:
            last = list(csv.DictReader(file))[-1]
        if free and place[free].max() > FREE_FLIGHT:
            faults.append(f"{folder.name}, {way}: free flight differs by {place[free].max():.1e} of the size of the scene")
        if way == "tight" and place[-1] > WITHIN.get(folder.name, 1):
            faults.append(f"{folder.name}: the end differs by {place[-1]:.1e} of the size of the scene")
        rows.append([folder.name, way, f"{steps[-1]}", f"{place[free].max():.0e}" if free else "",
                     *([f"{steps[later[0]]}: {place[later[0]]:.0e}, {speed[later[0]]:.0e}",
                        f"{place[-1]:.0e}, {speed[-1]:.0e}"] if later else ["none", f"{place[-1]:.0e}, {speed[-1]:.0e}"]),
                     f"{last['contacts']}, {last['active_contacts']}", ", ".join(map(str, arrays[f'contacts_{way}'][-1]))])
    return rows


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", type=Path)
    parser.add_argument("--only", nargs="+", metavar="DECK")
    parser.add_argument("--write", type=Path, metavar="FILE")
    parser.add_argument("--check", action="store_true")
    arguments = parser.parse_args()
    if any(importlib.util.find_spec(name) is None for name in ("numpy", "h5py")):
        print("skipped: numpy and h5py are not at hand")
        return
    decks = shared_decks()
    folders = sorted((decks / "lmgc90").glob("*/reference.npz")) if decks else []
    if not folders:
        print("skipped: no decks of LMGC90 with trajectories in ${SPLITGRAIN_SHARED} or ../shared")
        return
    rows, faults = [], []
    with tempfile.TemporaryDirectory() as work:
        for file in folders:
            if file.parent.name in (arguments.only or (WITHIN if arguments.check else [file.parent.name])):
                rows += rows_of(arguments.program.resolve(), file.parent, Path(work), faults)
    text = table(["deck", "parameters", "steps", "free flight", "first contact, step: place, velocity", "end: place, velocity",
                  "contacts, with impulse", "LMGC90"], rows)
    if arguments.write:
        put(arguments.write, "lmgc90 decks", text)
    else:
        print(text)
    if arguments.check and faults:
        sys.exit("\n".join(faults))


if __name__ == "__main__":
    main()

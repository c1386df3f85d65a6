#!/usr/bin/env python3
"""Run the real decks of LMGC90 by their reference parameters and lay both codes' figures side by side.

Usage: compare_lmgc90.py PROGRAM [--only DECK ...] [--write FILE] [--check]

PROGRAM is the splitgrain executable. The decks are looked for in ${SPLITGRAIN_SHARED}, else in ../shared beside the
source; without them one line is said and nothing is done. --write puts the tables between the two markers of FILE
(doc/verification.md); otherwise they are printed. --check fails where contacts that LMGC90 found in its last configuration are
not found there: their deepest penetration to seven digits, and of disks their number. Needs numpy and h5py, as postpro does, and
does nothing without.
"""

import argparse
import csv
import json
import os
import re
import resource
import subprocess
import sys
import tempfile
from dataclasses import dataclass, field
from importlib.util import find_spec
from pathlib import Path
from textwrap import fill

from lmgc90_reference import SCHEME, Reference, read_references, read_steps

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from manual_pages import put, table

SOURCE = Path(__file__).resolve().parents[2]
# The method, the criterion, the test frequency and the sweeps that a deck has by default, at a tolerance somewhat looser than its default.
ESTIMATED = dict.fromkeys(("solver.method", "solver.criterion", "solver.check_every", "solver.maximum_sweeps")) \
            | {"solver.tolerance": 3e-2}
TIGHT = {"solver.criterion": "e8", "solver.tolerance": 1e-6, "solver.check_every": 100, "solver.maximum_sweeps": 200000}

# Walls 1 (up), 2 (left), 3 (right), 4 (down), each pressed inwards over the free distance of its two neighbours.
BIAXIAL = "".join(f"[[pressure]]\nbody = {body}\ndirection = {direction}\nbetween = {between}\nvalue = 10000.0\n"
                  for body, direction, between in ((4, [0, 1], [2, 3]), (3, [-1, 0], [4, 1]),
                                                   (1, [0, -1], [2, 3]), (2, [1, 0], [4, 1])))


@dataclass
class Case:
    """One run of a deck that LMGC90 has made too."""

    name: str
    folder: Path
    reference: Reference
    final: Path = None
    """State of LMGC90 at the end, an npz file"""
    blocks: str = ""
    """More blocks of the deck"""


@dataclass
class Result:
    """One run of ours."""

    run: dict
    rows: list
    cpu: float
    """User and system seconds of the whole process"""
    state: dict = field(default_factory=dict)
    """Arrays of bodies.vtkhdf at the end"""
    folder: Path = None


def shared_decks():
    """Folder of the real decks, or None."""
    top = Path(os.environ.get("SPLITGRAIN_SHARED", SOURCE.parent / "shared"))
    return top / "decks" if (top / "decks").is_dir() else None


def cases(decks):
    """All cases; those of DDM_2d_rough_box come from a reference of its own form."""
    found = []
    for name, blocks in (("BouncingBallsDK", ""), ("1024DK_BoxJC", ""), ("500PL_PerioBoxJC", ""), ("WallPL_GroundJC", ""),
                         ("MembraneBiaxialDK_Iso", BIAXIAL), ("Wall_PR", "")):
        for reference in read_references(decks / name / "reference.txt"):
            steps = reference.parameters["time.steps"]
            files = [decks / name / f"final_{name}{tail}.npz" for tail in (f"_{steps}", "")]
            final = next((file for file in files if file.exists()), None)
            found.append(Case(f"{name}, {steps} steps", decks / name, reference, final, blocks))
    folder = decks / "DDM_2d_rough_box"
    sweeps = [int(w) for w in re.search(r"^serial: ([\d ]+)", (folder / "reference.txt").read_text(), re.M)[1].split()]
    keys = {**SCHEME, "time.step": 5e-3, "time.theta": 0.5, "solver.method": "nlgs", "solver.criterion": "qm16",
            "solver.tolerance": 1e-4, "solver.check_every": 1, "solver.maximum_sweeps": 10000}
    for steps in (8, 50):
        reference = Reference(keys | {"time.steps": steps}, {"sweeps_total": sum(sweeps[:steps])}, sweeps[:steps])
        found.append(Case(f"DDM_2d_rough_box, {steps} steps", folder, reference, folder / f"final_step{steps}_serial.npz"))
    folder = decks / "945_SP_Box_PL"
    for reference in read_steps(folder / "reference.txt"):
        found.append(Case(f"945_SP_Box_PL, {reference.parameters['time.steps']} steps", folder, reference))
    return found


def run(program, case, work, changes=(), options=()):
    """Run a case by its reference parameters and some changes to them; a key that is changed to None is left to its default."""
    keys = {key: value for key, value in (case.reference.parameters | dict(changes)).items() if value is not None}
    deck, results = work / "deck.toml", Path(tempfile.mkdtemp(dir=work))
    sections = {}
    for key, value in ({"scene.datbox": str(case.folder / "DATBOX"), "output.every": keys["time.steps"],
                        "output.record_every": 1} | keys).items():
        section, word = key.split(".")
        sections.setdefault(section, []).append(f"{word} = {json.dumps(value)}")
    deck.write_text("".join(f"[{section}]\n" + "\n".join(lines) + "\n" for section, lines in sections.items()) + case.blocks)
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([program, "run", deck, "--output", results, "--quiet", "--force", *options],
                          capture_output=True, text=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode != 0:
        sys.exit(f"{case.name}: {done.stderr}")
    with open(results / "record.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return Result(json.loads((results / "run.json").read_text()), rows, cpu, read_state(results), results)


def read_state(results):
    """Last picture of the bodies: positions, velocities, angles."""
    import h5py
    import numpy as np

    with h5py.File(results / "bodies.vtkhdf") as file:
        root = file["VTKHDF"]
        bodies = slice(root["Steps/PointOffsets"][-1], None)
        data = root["PointData"]
        n = len(root["Points"][bodies])
        moving = {name: data[name][-n:] for name in ("velocity", "spin", "angle", "displacement") if name in data}
        # In the plane the third coordinate is zero, and a spin is one number.
        dimension = 2 if "angle" in data else 3
        if dimension == 3:
            # The pictures hold spins in the world, LMGC90's last state those about principal axes.
            turn = data["orientation"][-n:] * [1, -1, -1, -1]
            across = 2 * np.cross(turn[:, 1:], moving["spin"])
            moving["spin"] = moving["spin"] + turn[:, :1] * across + np.cross(turn[:, 1:], across)
        state = {"position": root["Points"][bodies][:, :dimension], "mass": data["mass"][:n], "is_grain": data["is_grain"][:n] > 0,
                 "velocity": np.column_stack([moving["velocity"][:, :dimension], moving["spin"]])}
        return state | ({"angle": moving["angle"]} if "angle" in data else {})


def dimension_of(case):
    """Dimension of space."""
    return case.reference.parameters.get("scene.dimension", 2)


def figures(result):
    """Our figures, counted as the references count: over all bodies, walls too."""
    import numpy as np

    dimension = result.state["position"].shape[1]
    speed = np.linalg.norm(result.state["velocity"][:, :dimension], axis=1)
    run_json = result.run
    return {"contacts": run_json["contacts"], "active_contacts_rn>0": run_json["active_contacts"],
            "KE_postpro": run_json["kinetic_energy"], "v_mean": speed.mean(), "v_max": speed.max(),
            "v_mean_grains": speed[result.state["is_grain"]].mean(),
            "max_penetration": run_json["max_penetration"],
            "coordination_2Nc/Nb": 2 * run_json["active_contacts"] / run_json["bodies"],
            "sweeps_mean": run_json["sweeps"] / run_json["steps"], "sweeps_total": run_json["sweeps"],
            "total_user": result.cpu}


def show(value, digits=6):
    """A number as a word of a table; nothing where there is none."""
    if value is None:
        return ""
    if isinstance(value, int) or float(value).is_integer() and abs(value) < 1e7:
        return str(int(value))
    return f"{value:.{digits}g}"


def final_table(case, ours):
    """End of the run, both codes."""
    names = {"contacts": "contacts", "active_contacts_rn>0": "with an impulse", "KE_postpro": "kinetic energy [J]",
             "v_mean": "mean velocity, all bodies [m/s]", "v_mean_grains": "mean velocity, grains [m/s]",
             "v_max": "largest velocity [m/s]",
             "max_penetration": "deepest penetration [m]", "coordination_2Nc/Nb": "coordination 2 Nc/Nb",
             "sweeps_mean": "sweeps per step", "sweeps_total": "sweeps in all", "total_user": "CPU [s]"}
    mine = figures(ours)
    theirs = dict(case.reference.figures)
    rows = []
    for key, name in names.items():
        if key == ("v_mean" if "v_mean_grains" in theirs else "v_mean_grains"):
            continue
        if key not in theirs:
            rows.append([name, show(mine[key]), "", ""])
            continue
        a, b = mine[key], theirs[key]
        rows.append([name, show(a, 8), show(b, 8), f"{a / b - 1:+.1e}" if b else ""])
    if "center_of_mass" in theirs and not case.reference.parameters.get("scene.period_x"):
        centre = ours.state["mass"] @ ours.state["position"] / ours.state["mass"].sum()
        for axis, a, b in zip("xyz", centre, theirs["center_of_mass"]):
            rows.append([f"centre of mass, {axis} [m]", show(a, 10), show(b, 10), f"{a / b - 1:+.1e}"])
    first = ours.rows[0]
    for key, name in (("kinetic_energy", "step 1: kinetic energy [J]"), ("contacts", "step 1: contacts"),
                      ("max_penetration", "step 1: deepest penetration [m]")):
        if key in case.reference.first:
            a, b = float(first[key]), case.reference.first[key]
            rows.append([name, show(a, 8), show(abs(b), 8), f"{a / b - 1:+.1e}" if b else ""])
    return table(["", "ours", "LMGC90", "ours / theirs - 1"], rows)


def sweeps_line(case, ours):
    """Sweeps of the first steps."""
    mine = [int(row["sweeps"]) for row in ours.rows[:50]]
    n = min(len(mine), len(case.reference.sweeps))
    return fill(f"Sweeps of steps 1 to {n}, ours: {' '.join(map(str, mine[:n]))}; "
                f"LMGC90: {' '.join(map(str, case.reference.sweeps[:n]))}.", 120) + "\n"


def coordinates(case):
    """LMGC90's last coordinates and velocities (x, y, angle)."""
    import numpy as np

    final = np.load(case.final)
    if "C" in final:
        return final["C"], final["V"]
    lines = (case.folder / "DATBOX/BODIES.DAT").read_text().splitlines()
    nodes = np.array([[float(line[a:a + 14].replace("D", "e")) for a in (34, 55, 76)] for line in lines if line[1:6] == "NO3xx"])
    return nodes + final["X"], final["V"]


def distances(case, places, others):
    """How far bodies lie from where they lie in another run, over the border of the period too."""
    import numpy as np

    away = places - others
    period = case.reference.parameters.get("scene.period_x", 0)
    if period:
        away[:, 0] -= period * np.round(away[:, 0] / period)
    return np.linalg.norm(away, axis=1)


def spread_rows(case, ours, natural, estimated):
    """How far apart runs of the same deck end: ours in another order, by another criterion, and LMGC90's."""
    import numpy as np

    mine = ours.state["position"]
    others = [("another order of the sweep", natural.state["position"], natural.run["kinetic_energy"]),
              ("estimate 0.03", estimated.state["position"], estimated.run["kinetic_energy"]),
              ("LMGC90", coordinates(case)[0][:, :dimension_of(case)], case.reference.figures.get("KE_postpro"))]
    rows = []
    for name, places, energy in others:
        quantiles = np.quantile(distances(case, mine, places), [0.25, 0.5, 0.9, 1])
        rows.append([case.name, name, *(f"{q:.1e}" for q in quantiles),
                     f"{energy / ours.run['kinetic_energy'] - 1:+.1e}" if energy else ""])
    return rows


def position_rows(case, ours):
    """Differences of places and velocities at the end."""
    import numpy as np

    there, speed = coordinates(case)
    d = dimension_of(case)
    faster = ours.state["velocity"] - speed
    away = distances(case, ours.state["position"], there[:, :d])
    differences = [("place [m]", away, None)]
    if d == 2:
        turned = ours.state["angle"] - there[:, 2]
        differences.append(("angle [rad]", abs(turned - 2 * np.pi * np.round(turned / (2 * np.pi))), None))
    for name, part in (("velocity [m/s]", slice(0, d)), ("spin [rad/s]", slice(d, None))):
        differences.append((name, np.linalg.norm(faster[:, part], axis=1), np.linalg.norm(speed[:, part], axis=1)))
    rows = []
    for name, difference, scale in differences:
        rows.append([case.name, name, *(f"{q:.1e}" for q in np.quantile(difference, [0.1, 0.5, 0.9, 1])),
                     f"{np.sqrt((difference**2).mean()):.1e}", "" if scale is None else f"{np.sqrt((scale**2).mean()):.1e}"])
    return rows


def detect_there(program, case, work):
    """Our contacts in the configuration where LMGC90 sought its last ones: X - theta h V of its last state.

    A restart file is brought there and given no velocity, so that our next step seeks contacts exactly there.
    """
    import h5py
    from checkpoints import replace

    start = run(program, case, work, {"time.steps": 1}, ["--set", "restart.every=1"])
    there, speed = coordinates(case)
    keys = case.reference.parameters
    there = there - keys["time.theta"] * keys["time.step"] * speed
    file = start.folder / start.run["file_restart"].split("/")[-1]
    with h5py.File(file, "r+") as state:
        bodies = state["bodies"]
        replace(bodies["position"], there[:, :2])
        replace(bodies["angle"], there[:, 2])
        replace(bodies["velocity"], 0)
    result = run(program, case, work, {"time.steps": 2, "solver.maximum_sweeps": 1, "solver.check_every": 1}, ["--restart", file])
    return result.run["contacts"], result.run["max_penetration"]


def last_violation(case):
    """Deepest penetration where LMGC90 sought its last contacts, to eight digits."""
    lines = re.findall(r"^VIOLATION_EVOLUTION last:.*$", (case.folder / "reference.txt").read_text(), re.M)
    steps = case.reference.parameters["time.steps"]
    step = case.reference.parameters["time.step"]
    fits = [line.split() for line in lines if abs(float(line.split()[2]) / step - steps) < 0.5 or len(lines) == 1]
    return float(fits[0][-1])


def wall_table(program, case, work):
    """The first step of the masonry wall from two starts, solved far."""
    rows = []
    for start, warm in (("impulses of Vloc_Rloc.INI", True), ("zero", False)):
        for order in ("natural", "groups"):
            for name, changes in (("quad 1.666e-4", {}), ("e8 1e-6", TIGHT)):
                changes = changes | {"time.steps": 1, "solver.warm_start": warm, "solver.order": order}
                result = run(program, case, work, changes).run
                rows.append([start, order, name, result["sweeps"], f"{result['worst_e8']:.1e}", show(result["kinetic_energy"])])
    first = case.reference
    rows.append(["LMGC90", "", "quad 1.666e-4", first.sweeps[0], "", show(first.first["kinetic_energy"])])
    return table(["started from", "order", "until", "sweeps", "e8", "kinetic energy [J]"], rows)


def membrane_table(program, case, work):
    """The first step of the biaxial test, solved far."""
    rows = []
    for name, changes in (("quad 1e-5", {}), ("e8 1e-9", TIGHT | {"solver.tolerance": 1e-9})):
        result = run(program, case, work, changes | {"time.steps": 1}).run
        rows.append(["ours", name, result["sweeps"], f"{result['worst_e8']:.1e}", show(result["kinetic_energy"], 8)])
    first = case.reference
    rows.append(["LMGC90", "quad 1e-5", first.sweeps[0], "", show(first.first["kinetic_energy"], 8)])
    return table(["", "until", "sweeps", "e8", "kinetic energy [J]"], rows)


def bench_table(program, folder, work):
    """Throughput on a compressed lattice."""
    theirs = json.loads((folder / "reference_SDL.json").read_text())
    keys = {**SCHEME, "time.step": 1e-3, "time.steps": 3, "solver.method": "nlgs", "solver.criterion": "quad",
            "solver.tolerance": 1e-40, "solver.check_every": 50, "solver.maximum_sweeps": theirs["iters"]}
    if theirs["kind"] != "disk":
        keys["scene.dimension"] = 3
    ours = run(program, Case("bench", folder, Reference(keys, {})), work)
    total = {key: sum(step[key] for step in theirs["steps"]) for key in ("det", "prep", "iter", "check")}
    updates = sum(step["nc"] for step in theirs["steps"]) * theirs["iters"]
    phase = {key: float(ours.run[f"cpu_{key}"]) for key in ("detect", "assemble", "solve")}
    rows = [["contacts of the steps", " ".join(row["contacts"] for row in ours.rows),
             " ".join(str(step["nc"]) for step in theirs["steps"])],
            ["contact updates", ours.run["contact_updates"], updates],
            ["detect [s]", show(phase["detect"], 3), show(total["det"], 3)],
            ["assemble [s]", show(phase["assemble"], 3), show(total["prep"], 3)],
            ["sweeps and tests [s]", show(phase["solve"], 3), show(total["iter"] + total["check"], 3)],
            ["updates per CPU second", f"{ours.run['contact_updates'] / phase['solve']:.3g}",
             f"{updates / (total['iter'] + total['check']):.3g}"]]
    return table(["", "ours", "LMGC90"], rows)


def missed(case, contacts, depth):
    """What is not as LMGC90 found it."""
    theirs, faults = case.reference.figures.get("contacts"), []
    if theirs is None:
        return faults
    # Its polygons keep other points of a pair (doc/verification.md).
    if "DK" in case.folder.name and contacts != theirs:
        faults.append(f"{case.name}: {contacts} contacts, not {theirs}")
    if abs(depth / last_violation(case) - 1) > 1e-7:
        faults.append(f"{case.name}: deepest penetration {depth}, not {last_violation(case)}")
    return faults


def all_tables(program, decks, chosen, work, faults):
    """The text between the markers; what is not as LMGC90 found it is added to the faults."""
    chosen_cases = [case for case in cases(decks) if not chosen or case.folder.name in chosen]
    text, summary, places, found, by_residual, spread = [], [], [], [], [], []
    for case in chosen_cases:
        print(case.name, file=sys.stderr, flush=True)
        ours = run(program, case, work)
        text += [f"### {case.name}\n", final_table(case, ours), sweeps_line(case, ours)]
        if case.folder.name == "WallPL_GroundJC":
            text += ["Step 1 from two starts:\n", wall_table(program, case, work)]
        if case.folder.name == "MembraneBiaxialDK_Iso":
            text += ["Step 1 solved far:\n", membrane_table(program, case, work)]
        theirs = case.reference.figures
        user = theirs.get("total_user")
        summary.append([case.name, show(ours.run["contacts"]), show(theirs.get("contacts")),
                        show(ours.run["kinetic_energy"]), show(theirs.get("KE_postpro")),
                        ours.run["sweeps"], show(theirs["sweeps_total"]), show(ours.cpu, 3), show(user, 4),
                        show(user / ours.cpu, 3) if user else "", f"{ours.run['converged_steps']} of {ours.run['steps']}"])
        estimated = run(program, case, work, ESTIMATED)
        if case.final:
            spread += spread_rows(case, ours, run(program, case, work, {"solver.order": "natural"}), estimated)
            places += position_rows(case, ours)
            # The last state of a deck in space tells no orientation: LMGC90's configuration cannot be set up.
            if dimension_of(case) == 2:
                contacts, depth = detect_there(program, case, work)
                faults += missed(case, contacts, depth)
                found.append([case.name, contacts, show(theirs.get("contacts")), show(depth, 8),
                              show(last_violation(case), 8) if "contacts" in theirs else ""])
        for result in (ours, estimated):
            by_residual.append([case.name, f"{result.run['criterion']} {result.run['tolerance']:g}",
                                f"{result.run['converged_steps']} of {result.run['steps']}",
                                result.run["sweeps"], show(result.cpu, 3), f"{result.run['worst_e8']:.1e}",
                                show(result.run["kinetic_energy"]), show(result.run["max_penetration"], 3),
                                show(result.run["floor_share"], 4)])
    head = ["deck", "contacts", "LMGC90", "kinetic energy [J]", "LMGC90", "sweeps", "LMGC90", "CPU [s]", "LMGC90", "times less",
            "converged steps"]
    result = ["### All decks, reference parameters, end of the run\n", table(head, summary)]
    result += ["### Detection in LMGC90's last configuration\n",
               table(["deck", "contacts", "LMGC90", "deepest penetration [m]", "LMGC90"], found),
               "### Places and velocities at the end, ours less LMGC90's\n",
               table(["deck", "", "a tenth below", "half below", "nine tenths below", "largest", "rms", "rms of LMGC90's"], places),
               "### How far apart runs end: ours by the reference parameters, and\n",
               table(["deck", "", "a quarter within [m]", "half within", "nine tenths within", "all within",
                      "kinetic energy / ours - 1"], spread),
               "### Stopping on increments and on a residual\n",
               table(["deck", "criterion", "converged steps", "sweeps", "CPU [s]", "worst e8", "kinetic energy [J]",
                      "deepest penetration [m]", "floor share"], by_residual), *text]
    for name, sweeps in (("bench_disk_45", 50), ("bench_sphere_12", 50), ("bench_poly_10", 30)):
        if not chosen or name in chosen:
            result += [f"### {name}, 3 steps of {sweeps} sweeps\n", bench_table(program, decks / name, work)]
    return "\n".join(result)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", type=Path)
    parser.add_argument("--only", nargs="+", metavar="DECK")
    parser.add_argument("--write", type=Path, metavar="FILE")
    parser.add_argument("--check", action="store_true")
    arguments = parser.parse_args()
    if any(find_spec(name) is None for name in ("numpy", "h5py")):
        print("skipped: numpy and h5py are not at hand")
        return
    decks = shared_decks()
    if decks is None:
        print("skipped: no decks of LMGC90 in ${SPLITGRAIN_SHARED} or ../shared")
        return
    with tempfile.TemporaryDirectory() as work:
        faults = []
        tables = all_tables(arguments.program.resolve(), decks, arguments.only, Path(work), faults)
    if arguments.write is None:
        print(tables)
    else:
        put(arguments.write, "tables", tables)
    if arguments.check and faults:
        sys.exit("\n".join(faults))


if __name__ == "__main__":
    main()

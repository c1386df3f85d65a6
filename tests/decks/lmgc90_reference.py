"""What LMGC90 computed for a deck: the figures of a reference.txt, which stands beside the deck's DATBOX."""

import json
import re
from dataclasses import dataclass, field

CRITERIA = {"Quad": "quad", "QM/16": "qm16", "Maxm": "maxm"}
# LMGC90 leaves overlap that was made, and looks for all contacts in every step.
SCHEME = {"time.recovery": 0.0, "scene.kept_motion": 0.0}
NUMBER = r"[-+]?\d[\d.]*(?:[eEdD][-+]?\d+)?"


@dataclass
class Reference:
    """One run of LMGC90."""

    parameters: dict
    """Keys of SplitGrain's deck, as section.key, that repeat the run"""
    figures: dict
    """All figures at the end: the groups ref, nlgs and run, laid flat"""
    sweeps: list = field(default_factory=list)
    """Sweeps of the first steps"""
    first: dict = field(default_factory=dict)
    """Kinetic energy, deepest penetration and number of contacts of the first step, as far as they are given"""


def number(text):
    """A number as Fortran writes it."""
    return float(text.replace("D", "e").replace("d", "e"))


def parameters(text):
    """Deck keys from the commands of an LMGC90 script."""
    def value(name):
        return re.search(rf"^\s*{name}\s*=\s*(\S.*)$", text, re.M)[1].strip().strip("'").strip()

    keys = {**SCHEME, "time.step": float(value("dt")),
        "time.steps": int(value("nb_steps")),
        "time.theta": float(value("theta")),
        "solver.method": "nlgs",
        "solver.criterion": CRITERIA[value("norm")],
        "solver.tolerance": float(value("tol")),
        "solver.check_every": int(value("gs_it1")),
        "solver.maximum_sweeps": int(value("gs_it1")) * int(value("gs_it2")),
    }
    if re.search(r"^\s*dim\s*=\s*3", text, re.M):
        keys["scene.dimension"] = 3
    if "SetPeriodicCondition" in text:
        keys["scene.period_x"] = float(value("lx"))
    return keys


def read_references(file):
    """All runs of a reference.txt that has the common form."""
    references = []
    for text in file.read_text().split("LMGC90 reference, run ")[1:]:
        end = text.index("RESULTS AT FINAL STEP")
        groups, length = json.JSONDecoder().raw_decode(text[text.index("{", end):])
        tail = text[text.index("{", end) + length:]
        reference = Reference(parameters(text[:end]), {k: v for group in groups.values() for k, v in group.items()})
        reference.sweeps = [int(w) for w in re.search(r"sweeps per step[^:]*:([ \d]+)", tail)[1].split()]
        for name, key, column in (("KINETIC_ENERGY", "kinetic_energy", 2), ("VIOLATION_EVOLUTION", "max_penetration", 4),
                                  ("SOLVER_INFORMATIONS", "contacts", 5)):
            row = re.search(rf"^{name} first:(.*)$", tail, re.M)
            reference.first[key] = [number(w) for w in re.findall(NUMBER, row[1])][column]
        references.append(reference)
    return references


def read_steps(file):
    """Runs of different length of a reference.txt that gives a line of figures at some of its steps (945_SP_Box_PL)."""
    text = file.read_text()

    def value(name):
        return re.search(rf"\b{name}=(\S+)", text)[1].strip("';")

    step, every = float(value("dt")), int(value("gs_it1"))
    keys = {**SCHEME, "scene.dimension": 3, "time.step": step, "time.theta": float(value("theta")),
            "solver.method": "nlgs", "solver.criterion": CRITERIA[value("norm")], "solver.tolerance": float(value("tol")),
            "solver.check_every": every, "solver.maximum_sweeps": every * int(value("gs_it2"))}
    sweeps = [int(w) for w in re.search(r"sweeps per step:\s*([ \d]+)", text)[1].split()]
    references = []
    for line in re.findall(r"^step .*$", text, re.M):
        figure = dict(re.findall(rf"(step|KE|vmean|vmax|\bn|rn>0|pen|Nact/N) ({NUMBER})", line))
        steps = int(figure["step"])
        figures = {"KE_postpro": number(figure["KE"]), "v_mean_grains": number(figure["vmean"]), "v_max": number(figure["vmax"]),
                   "contacts": int(figure["n"]), "active_contacts_rn>0": int(figure["rn>0"]),
                   "max_penetration": number(figure["pen"]), "sweeps_total": sum(sweeps[:steps]),
                   "sweeps_mean": sum(sweeps[:steps]) / steps}
        references.append(Reference(keys | {"time.steps": steps}, figures, sweeps[:steps]))
    return references

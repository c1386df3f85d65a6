"""What LMGC90 computed for a deck: the figures of a reference.txt, which stands beside the deck's DATBOX."""

import json
import re
from dataclasses import dataclass, field

CRITERIA = {"Quad": "quad", "QM/16": "qm16", "Maxm": "maxm"}
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

    keys = {
        "time.step": float(value("dt")),
        "time.steps": int(value("nb_steps")),
        "time.theta": float(value("theta")),
        "solver.criterion": CRITERIA[value("norm")],
        "solver.tolerance": float(value("tol")),
        "solver.check_every": int(value("gs_it1")),
        "solver.maximum_sweeps": int(value("gs_it1")) * int(value("gs_it2")),
    }
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

#!/usr/bin/env python3
"""Run LMGC90's deck MembraneBiaxialDK_Iso to its end and compare with the state that MembraneBiaxialDK_Defo starts from.

Usage: compare_defo.py PROGRAM

The DOF.INI of _Defo is what LMGC90 had after 100 steps of _Iso. The exit code is 1 where grains lie farther from theirs than a tenth of
their mean way, in the mean: what the order of sweeps leaves at this tolerance is a fortieth. Where the decks are looked for, and
where they are not there: see compare_lmgc90.py. Needs numpy and h5py, and does nothing without.
"""

import re
import sys
import tempfile
from importlib.util import find_spec
from pathlib import Path

from compare_lmgc90 import cases, run, shared_decks

BODY = r"RBDY2\s+\d+\s(?:(?!RBDY2)[\s\S])*?NO3xx\s+1\s+"
STEPS = 100


def values(path, names):
    """Two numbers of each body of a DATBOX file, in the order of the file (two numbers stand twice in BODIES.DAT of these decks)."""
    import numpy as np

    pattern = re.compile(BODY + r"\s+".join(rf"{re.escape(name)}=\s*(\S+)" for name in names))
    return np.array([[float(word.replace("D", "E")) for word in pair] for pair in pattern.findall(path.read_text())])


def main(program):
    if any(find_spec(name) is None for name in ("numpy", "h5py")):
        print("skipped: numpy and h5py are not at hand")
        return 0
    import numpy as np

    decks = shared_decks()
    if decks is None:
        print("compare_defo: no shared decks, nothing compared")
        return 0
    case = next(case for case in cases(decks) if case.name.startswith("MembraneBiaxialDK_Iso"))
    start = values(decks / "MembraneBiaxialDK_Iso/DATBOX/BODIES.DAT", ("coo1", "coo2"))
    way = values(decks / "MembraneBiaxialDK_Defo/DATBOX/DOF.INI", ("X(1)", "X(2)"))
    with tempfile.TemporaryDirectory() as work:
        result = run(program, case, Path(work), {"time.steps": STEPS, "solver.method": "nesterov"})
    ours = result.state["position"] - start
    grains = result.state["is_grain"]
    distance, size = np.linalg.norm((ours - way)[grains], axis=1), np.linalg.norm(way[grains], axis=1)
    print(f"{STEPS} steps, {result.cpu:.1f} CPU s, {grains.sum()} grains: way mean {size.mean():.2e} m, largest {size.max():.2e} m; "
          f"distance between both codes mean {distance.mean():.2e} m, largest {distance.max():.2e} m")  # fmt: skip
    for wall, (own, other) in enumerate(zip(ours[:4], way[:4]), 1):
        axis = int(np.abs(other).argmax())
        print(f"wall {wall}: way {own[axis]:.4e} m, LMGC90 {other[axis]:.4e} m")
    return int(distance.mean() > 0.1 * size.mean())


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    sys.exit(main(sys.argv[1]))

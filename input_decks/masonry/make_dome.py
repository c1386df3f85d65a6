#!/usr/bin/env python3
"""Write the voussoirs of a dome as objects of four OBJ files: make_dome.py [FOLDER] [THICKNESS]

Half a sphere of mean radius 1 m, in rings about its axis z and sectors; the crown is open. Each voussoir is a hexahedron with plane
faces: its edges along a ring are chords. dome_RS.obj holds the voussoirs whose ring has the parity R and whose sector the parity S:
colours of their own, by which voussoirs that share an edge alone do not touch."""

import math
import sys
from pathlib import Path

RINGS, SECTORS, OPENING = 6, 12, math.radians(15)


def corner(radius, ring, sector):
    """A corner of a voussoir at a radius [m], the lower edge of a ring and the first side of a sector, from 0."""
    polar = math.pi / 2 - (math.pi / 2 - OPENING) * ring / RINGS
    turn = 2 * math.pi * sector / SECTORS
    return radius * math.sin(polar) * math.cos(turn), radius * math.sin(polar) * math.sin(turn), radius * math.cos(polar)


def files(thickness=0.08):
    """Texts of the four files by their names; thickness over mean radius."""
    lines = {}
    for ring in range(RINGS):
        for sector in range(SECTORS):
            own = lines.setdefault(f"dome_{ring % 2}{sector % 2}.obj", [])
            before = sum(line.startswith("v ") for line in own)
            own.append(f"o ring.{ring + 1}.{sector + 1}")
            for radius in (1 - thickness / 2, 1 + thickness / 2):
                for r, s in ((ring, sector), (ring, sector + 1), (ring + 1, sector + 1), (ring + 1, sector)):
                    own.append("v {:.9f} {:.9f} {:.9f}".format(*corner(radius, r, s)))
            for face in ((1, 4, 3, 2), (5, 6, 7, 8), (1, 2, 6, 5), (2, 3, 7, 6), (3, 4, 8, 7), (4, 1, 5, 8)):
                own.append("f " + " ".join(str(before + k) for k in face))
    return {name: "\n".join(own) + "\n" for name, own in lines.items()}


if __name__ == "__main__":
    for file, text in files(*map(float, sys.argv[2:])).items():
        (Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent).joinpath(file).write_text(text)

"""Disks on a triangular lattice between three walls, each body written by itself: as [[body]] blocks or as a DATBOX.

    written_bodies.py deck|datbox COLUMNS ROWS FOLDER

`deck` writes FOLDER/bodies.toml; `datbox` writes FOLDER/DATBOX with states and the contacts of neighbours in a row, and
FOLDER/datbox.toml. Both make one step, with few sweeps: they are there to measure what a rank needs while it reads.
"""

import pathlib
import sys

RADIUS = 0.01
RUN = """[time]
step = 1e-4
steps = 1
[solver]
maximum_sweeps = 3
check_every = 3
"""


def lattice(columns, rows):
    """Places of the disks, row by row."""
    for row in range(rows):
        for column in range(columns):
            yield RADIUS * (1 + 2 * column + row % 2), RADIUS * (1 + row * 3**0.5)


def walls(columns, rows):
    """Middle, half length and angle of floor and sides."""
    width, height = RADIUS * (2 * columns + 1), RADIUS * (2 + rows * 3**0.5)
    yield (width / 2, -RADIUS), width / 2, 0.0
    for x in (-RADIUS, width + RADIUS):
        yield (x, height / 2), height / 2, 1.5707963267948966


def write_deck(columns, rows, folder):
    """Blocks [[body]] and [[wall]]."""
    with open(folder / "bodies.toml", "w", encoding="utf8") as deck:
        deck.write(RUN + '[[material]]\nname = "stone"\ndensity = 2600.0\n[[law]]\nfriction = 0.3\n')
        for (x, y), half, angle in walls(columns, rows):
            dx, dy = (half, 0.0) if angle == 0 else (0.0, half)
            deck.write(f"[[wall]]\nfrom = [{x - dx}, {y - dy}]\nto = [{x + dx}, {y + dy}]\nthickness = {2 * RADIUS}\n")
        for x, y in lattice(columns, rows):
            deck.write(f'[[body]]\nshape = "disk"\nradius = {RADIUS}\nposition = [{x:.9f}, {y:.9f}]\n')


def number(value):
    """A number as LMGC90 writes it, in 14 columns."""
    return f"{value:14.7E}".replace("E", "D")


def triple(names, values):
    """Three named numbers of a line."""
    return "  ".join(name + number(value) for name, value in zip(names, values))


def body(index, radius, gyration, place, angle, contactor):
    """A block of BODIES.DAT."""
    return (
        f"$bdyty\n RBDY2{index:9d}\n$blmty\n PLAIN      1  behav  stone  {triple(['avrd=', 'gyrd='], [radius, gyration])}\n"
        f"$nodty\n NO3xx      1                {triple(['coo1=', 'coo2=', 'coo3='], [*place, angle])}\n"
        f"$tacty\n {contactor}\n$$$$$$\n"
    )


def state(index):
    """A block of DOF.INI."""
    rest = [0.0, 0.0, 0.0]
    return (
        f"$bdyty\n RBDY2{index:9d}\n$nodty\n NO3xx      1                {triple(['X(1)=', 'X(2)=', 'X(3)='], rest)}\n"
        f"                             {triple(['V(1)=', 'V(2)=', 'V(3)='], rest)}\n$$$$$$\n"
    )


def contact(index, left, place):
    """A block of Vloc_Rloc.INI: a disk and its right neighbour."""
    lines = [
        triple(["rlt/H", "rln/H", "rls/H"], [0.0, 0.5, 0.0]),
        triple(["vlt =", "vln =", "vls ="], [0.0, 0.0, 0.0]),
        "gapTT" + number(0.0),
        triple(["n(1)=", "n(2)=", "n(3)="], [-1.0, 0.0, 0.0]),
        triple(["coo1=", "coo2=", "coo3="], [place[0] + RADIUS, place[1], 0.0]),
    ]
    return (
        f"$icdan  DKDKx{index:9d}\n cdbdy  numbr  cdtac  numbr  behav  anbdy  numbr  antac  numbr  sttus\n"
        f" RBDY2{left:7d}  DISKx      1  rough  RBDY2{left + 1:7d}  DISKx      1  stick\n"
        + "".join(" " * 29 + line + "\n" for line in lines)
    )


def write_datbox(columns, rows, folder):
    """A DATBOX and a deck that uses it."""
    box = folder / "DATBOX"
    box.mkdir(exist_ok=True)
    (folder / "datbox.toml").write_text('[scene]\ndatbox = "DATBOX"\n' + RUN, encoding="utf8")
    (box / "BULK_BEHAV.DAT").write_text(
        "$gravy\n                   " + triple(["grv1=", "grv2=", "grv3="], [0.0, -9.81, 0.0]) + "\n"
        "$behav  lawty\n stone  RIGID                           Umas=" + number(2600.0) + "\n"
    )
    sees = "".join(
        "$seety\n cdbdy  cdtac  cdcol  behav  anbdy  antac  ancol       alert\n"
        f" RBDY2  DISKx  grain  rough  RBDY2  {kind}      {number(1e-3)}\n"
        for kind in ("DISKx  grain", "JONCx  wall ")
    )
    law = "$behav  lawty\n rough  IQS_CLB                         fric=" + number(0.3) + "\n"
    (box / "TACT_BEHAV.DAT").write_text(law + sees)
    n = columns * rows
    with open(box / "BODIES.DAT", "w") as bodies, open(box / "DRV_DOF.DAT", "w") as drives:
        for index, place in enumerate(lattice(columns, rows), 1):
            disk = "DISKx      1  color  grain  byrd=" + number(RADIUS)
            bodies.write(body(index, RADIUS, RADIUS / 2**0.5, place, 0.0, disk))
        for index, (place, half, angle) in enumerate(walls(columns, rows), n + 1):
            wall = "JONCx      1  color  wall   " + triple(["axe1=", "axe2="], [half, RADIUS])
            bodies.write(body(index, RADIUS, RADIUS, place, angle, wall))
            drives.write(f"$bdyty\n RBDY2{index:9d}\n$nodty\n NO3xx      1\n$dofty\n")
            for component in (1, 2, 3):
                values = "".join(" " + number(value) for value in (0.0, 0.0, 0.0, 0.0, 1.0, 0.0))
                drives.write(f" vlocy{component:7d}{values}\n")
            drives.write("$$$$$$\n")
    with open(box / "DOF.INI", "w") as states:
        states.write(f"$steps{1:9d}{'':14}time=" + number(1e-4) + "\n")
        for index in range(1, n + 4):
            states.write(state(index))
    with open(box / "Vloc_Rloc.INI", "w") as contacts:
        contacts.write(f"$steps{1:9d}{'':14}time=" + number(1e-4) + "\n")
        known = 0
        for index, place in enumerate(lattice(columns, rows), 1):
            if index % columns == 0:
                continue
            known += 1
            contacts.write(contact(known, index, place))


def main():
    """Write what is asked for."""
    kind, columns, rows, folder = sys.argv[1], int(sys.argv[2]), int(sys.argv[3]), pathlib.Path(sys.argv[4])
    folder.mkdir(parents=True, exist_ok=True)
    if kind == "deck":
        write_deck(columns, rows, folder)
    else:
        write_datbox(columns, rows, folder)


if __name__ == "__main__":
    main()

"""The rooms of the house: folders of sources, in the only order in which `use` may point, and what each holds.

A file may use modules of its own room and of rooms above it. `check_layers` guards this order, and `draw_rooms` writes the
table of doc/guide/architecture.md from it.
"""

ROOMS = {
    "base": "kinds, errors, text, numerals, growing lists, sorting, random numbers, parcels of reals, lists of fields, timers",
    "base/system": "the operating system: signals, memory, processes, shared libraries, threads",
    "base/files": "text files, written whole or not at all; lines on standard output; JSON",
    "numerics": "vectors, rotations, dense and sparse factors, Fourier transform, convex hull, welding of points",
    "parallel": "messages between ranks: sums, swaps, plans for neighbours, blocks by number; the only folder that names MPI",
    "bodies": "bodies as a structure of arrays, driven degrees of freedom, functions of time",
    "contactors/polyhedra": "polyhedra: made, checked, weighed",
    "contactors": "the shapes through which bodies touch, their moments, their records for messages",
    "laws": "contact laws, cohesive zones, laws of links, internal values of contacts",
    "scene": "all that exists, interactions, links, the options of a run, and the plan",
    "detection/search": "broad phase: cells, bounds of distances, neighbour lists",
    "detection/plane": "narrow phase in the plane: one file per pair of shapes",
    "detection/space": "narrow phase in space: one file per pair of shapes, clipping, separation of polyhedra",
    "detection": "contacts, their history from step to step, `detect`",
    "partition/share": "the part of a scene that a rank holds: share while reading, halo, migration, copies",
    "partition/split": "which rank gets which grain: boxes, contact graph, clusters, load, report of a split",
    "partition": "the decomposition of a run from its first step on",
    "datbox/format": "LMGC90 files as fixed columns: lines, laws, internal values, evolution files",
    "datbox/read": "reader of a DATBOX folder",
    "datbox/write": "writer of a DATBOX folder",
    "problem": "the contact problem of a step: records, mapping, Delassus blocks, bonds, statuses",
    "problem/matrices": "the contact problem as sparse matrices, on one rank or several",
    "solvers/common": "what every solver has: its type, its report, its trace",
    "solvers/errors": "residuals and errors of a solution",
    "solvers/sweeps": "nonlinear Gauss-Seidel: kernels, orders, active set, stopping",
    "solvers/coupled": "sweeps on several ranks: dual, primal, momentum; shared bodies; errors of the whole problem",
    "solvers/matrices": "solvers on stored matrices: sweeps, proximal points, interior points, turns of methods",
    "solvers": "from a name to a solver",
    "input/toml": "TOML text to entries",
    "input/keys": "THE key table of decks, and the deck reference made from it",
    "input/blocks": "blocks of values: collected, checked against the key table, overlaid by --set",
    "input/generators": "samples: sizes, shapes, lattices, random insertion",
    "input/meshes": "mesh files: STL, OBJ",
    "input/build": "from blocks to the scene: one `*_from_deck` per section",
    "input/checks": "blocks and scenes that make no sense: contradictions, overlaps at the start",
    "input": "`read_deck`, the effective deck, files that a deck names",
    "measures/overlap": "areas and volumes that two shapes share: one file per pair",
    "measures": "one indicator per file: energy, penetration, compactness, coordination, stress, spectra, structure",
    "measures/local": "measures of places: tracked bodies, the cell between walls, cells of a grid",
    "output/hdf5": "HDF5 behind few operations",
    "output/pictures": "pictures for ParaView: bodies, shapes, contacts",
    "output/fclib": "contact problems in FCLIB files",
    "output/restart": "restart files",
    "output": "record, run.json, tagged numbers, traces, progress, verdict, lock of a folder",
    "run": "a simulation: the step, the loop over steps, guards, limits, checkpoints, dumps, memory report",
    "tools": "`bench`, `partition` and `solve` behind their subcommands: benchmarks, cost model, tables",
    "commands": "what subcommands share: command line, help, the scene and the run that a command line asks for",
    "drivers": "the program: one file per subcommand, under 80 lines: arguments, objects, one call, exit code",
}

#: Names that a folder may hold: what fits on one screen
MOST_NAMES = 24

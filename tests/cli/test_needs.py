#!/usr/bin/env python3
"""Test what a run needs, scene by scene: the tables that it holds, their bytes, the libraries that it opens, what it calls.

usage: test_needs.py PROGRAM [MPIEXEC [unittest options]]
       test_needs.py PROGRAM --table              print the table of doc/performance.md instead, with the cost of an update
"""

import json
import os
import re
import shutil
import subprocess
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from program_case import ProgramCase, take_program

COMMON = """[time]
step = 1e-3
steps = 150
[solver]
criterion = "e8"
tolerance = 1e-3
[[material]]
name = "stone"
density = 2600.0
[[law]]
friction = {friction}
[[interaction]]
# What falls from the top moves by as much in a step: contacts are many, and tables as full as they get.
alert = 8e-3
"""
WALL = "[[wall]]\nfrom = {}\nto = {}\nthickness = 0.02\n"
WALLS = "".join(
    WALL.format(*ends)
    for ends in (([-0.5, -0.01], [1.5, -0.01]), ([-0.01, 0.0], [-0.01, 4.0]), ([1.01, 0.0], [1.01, 4.0]))
)
GRAINS = 1000


def in_plane(shape, friction):
    sample = f'[[sample]]\nshape = "{shape}"\nbox = [0.0, 0.0, 1.0, 4.0]\nkind = "lattice"\ncount = {GRAINS}\n'
    return COMMON.format(friction=friction) + WALLS + sample + "radius = [0.023, 0.025]\n"


def in_space(shape, friction):
    sample = f'[[sample]]\nshape = "{shape}"\nbox = [0.0, 0.0, 0.0, 0.4, 0.4, 2.0]\nkind = "lattice"\ncount = {GRAINS}\n'
    container = "[[container]]\nsize = [0.4, 0.4, 2.0]\n"
    return "[scene]\ndimension = 3\n" + COMMON.format(friction=friction) + container + sample + "radius = [0.022, 0.025]\n"


# Tables that all scenes have: bodies where they are and how they move, contactors, pairs, contacts, the problem, the order, and what
# momentum on sweeps holds of the sweep before.
# Sweeps over solids side by side store no start.
MOMENTUM = "nesterov.before nesterov.body nesterov.carried"
ALWAYS = f"""bodies.position bodies.velocity bodies.middle bodies.mass bodies.inverse_mass bodies.force bodies.free_velocity
bodies.area bodies.crossings bodies.is_grain bodies.material
contactors.kind contactors.body contactors.row contactors.colour contactors.shift contactors.reach contactors.centre
neighbours.body_of neighbours.slot_of neighbours.built neighbours.margin pairs.contactor pairs.image pairs.see
contacts.contactor contacts.body contacts.feature contacts.law contacts.normal contacts.point contacts.gap contacts.image
contacts.impulse contacts.status
history.contactor history.image history.first history.feature history.impulse history.status history.past
problem.pair problem.record problem.impulse problem.opening problem.body problem.moves
order.contact order.chosen order.missed order.dealt order.is_dealt order.moves order.groups_of
active_set.closing active_set.is_wanted active_set.is_ordered errors.bounds
{MOMENTUM}"""
PLANE = "contactors.segment_size contactors.segment_axis"
SPACE = "bodies.crossings_y contactors.plane_half contactors.plane_rim contactors.plane_frame contactors.plane_world pairs.image_y contacts.image_y"
POLYGONS = "contactors.polygon_first contactors.polygon_vertex contactors.polygon_world contactors.polygon_edge contactors.polygon_turn contactors.polygon_path contactors.polygon_placed contacts.is_kept contacts.kept history.is_kept history.kept history.face history.clearance"
ONE_BY_ONE = "order.pair order.record order.impulse nesterov.start"
LANES = "order.group_size order.lane_pair order.lane_record order.lane_impulse nesterov.start"
# Errors of contacts side by side, on one rank.
LANE_ERRORS = "order_errors.closing order_errors.bounds order_errors.other"
SOLID_LANES = "order.solid_last_row order.solid_row_size order.solid_pair order.solid_row"
# Those of clusters come with the first step that takes 200 sweeps, copies of contacts that sweeps leave out with the first order that
# leaves out some, but few, and present impulses with the first order that changes under momentum.
LONG_SOLVES = """clusters.squares clusters.parent clusters.members clusters.excess order_errors.bounds_of_others order_errors.pair
order_errors.record order_errors.impulse order_errors.closing_of_others nesterov.present"""

# Those of pushes come with the first overlap that is undone.
PUSHES = "push.pair push.record push.impulse push.body push.before push.past"

# Scene: deck, tables beside those of all, libraries, and upper bounds of bytes per grain and per contact. A grain and a contact of the
# plane take least; turning bodies have angles and a third velocity, in space quaternions and spins, and where nothing turns there
# are orientations if the deck turns a body, as it does sides of a container in the plane; polygons and polyhedra
# their corners twice (in the body's frame and in the world); a contact with friction has a second impulse, one with arms a longer
# record; lanes hold a copy of the record beside that of the order. Room is kept for half as many contacts again as there were
# (a list grows by half), and for the contacts near enough to be watched: the bounds are a quarter above what was measured.
SCENES = {
    "disks, no friction": (in_plane("disk", 0.0), f"{PLANE} {ONE_BY_ONE} bodies.angle bodies.inertia contactors.disk_radius", [], 400, 450),
    "disks": (in_plane("disk", 0.3), f"{PLANE} {LANES} {LANE_ERRORS} bodies.angle bodies.inertia plan.radius contactors.disk_radius", [], 430, 530),
    "polygons": (in_plane("polygon", 0.3), f"{PLANE} {LANES} {LANE_ERRORS} {POLYGONS} bodies.angle bodies.inertia", [], 900, 930),
    "spheres, no friction": (in_space("sphere", 0.0), f"{SPACE} {ONE_BY_ONE} bodies.principal contactors.sphere_radius", [], 470, 620),
    "spheres": (
        in_space("sphere", 0.3),
        f"{SPACE} {LANES} {LANE_ERRORS} bodies.orientation bodies.principal plan.radius contactors.sphere_radius", [], 740, 900,
    ),
    "polyhedra": (
        in_space("polyhedron", 0.3), f"{SPACE} {SOLID_LANES} bodies.orientation bodies.principal contactors.polyhedra contactors.polyhedron_path contacts.is_kept contacts.kept history.is_kept history.kept history.face history.clearance", ["Qhull"],
        5700, 2150,
    ),
}  # fmt: skip

# What ranks hold beside that: which body is which in the whole scene and whose, who shares what, messages about it; and by gluing.
# Contacts stand in several sets.
ON_RANKS = """bodies.id bodies.owner contactors.id subdomain.neighbour subdomain.first subdomain.body subdomain.owner subdomain.replicated
halo.placed interface.is_here interface.is_there interface.slot interface.multiplicity interface.item interface.first
interface.contact interface.is_between interface.activity contact_sets.set_of contact_sets.shared"""
GLUINGS = {
    "dual": """interface.total interface.sums interface.send_slots interface.receive_slots interface.to_idle
contact_sets.contact contact_sets.record masses.divided masses.whole
gluing.before gluing.change gluing.jump""",
    "primal": "edges.colour edges.lent_first edges.lent edges.borrowed_first edges.borrowed edges.messages",
}

# Small blocks that the C library keeps for reuse by the thread would count as memory in use.
os.environ["GLIBC_TUNABLES"] = "glibc.malloc.tcache_count=0"
# Memory outside of all tables: that of the program itself and its libraries at rest, and what polyhedra lose to being many.
AT_REST = 351_000
PER_POLYHEDRON = 8 * 24
# Tables of ranks are as full after 60 steps as after 150, with all contacts of the rows that touch.
SHORT, SHORT_WIDE = (["--set", f"time.steps={steps}"] for steps in (60, 160))
# HDF5 holds memory of its own once it has written a checkpoint; and pushes are a test of their own.
LEFT_OUT = ["--set", "restart.at_end=false", "--set", "time.recovery=0"]


class Needs(ProgramCase):
    def needs(self, deck, *words):
        (self.place / "deck.toml").write_text(deck)
        self.run_program("run", "deck.toml", "--quiet", "--force", "--needs", "--output", "out", *LEFT_OUT, *words)
        return json.loads((self.place / "out/needs.json").read_text())

    def test_each_scene_holds_what_it_needs_and_nothing_else(self):
        for name, (deck, more, libraries, *bounds) in SCENES.items():
            if not all(map(self.has_library, libraries)):
                continue
            with self.subTest(name):
                needs = self.needs(deck)
                held = {table for table, bytes_held in needs.items() if "." in table and bytes_held > 0}
                self.assertEqual(held - set(LONG_SOLVES.split()), set(ALWAYS.split()) | set(more.split()))
                self.assertEqual(needs["libraries"].split(), libraries)
                self.assertEqual(needs["messages"], 0)
                self.assertGreater(needs["contacts"], GRAINS / 2)
                self.assertLess(needs["bytes_per_grain"], bounds[0])
                self.assertLess(needs["bytes_per_contact"], bounds[1])
                # What the list of tables leaves out is what the program has without any grain.
                if needs["memory_bytes"] > 0:
                    other = needs["memory_bytes"] - needs["table_bytes"]
                    self.assertLess(other, AT_REST + PER_POLYHEDRON * GRAINS * ("polyhedra" in name))
                self.assertGreater(needs["contacts_compared"], 0)
                self.assertGreater(needs["solver_over_kernel"], 0)

    def test_pushes_hold_their_records_and_nothing_else(self):
        """A run that undoes overlap holds the problem of a push beside the rest."""
        deck, tables, *_ = SCENES["disks"]
        needs = self.needs(deck, "--set", "time.recovery=1e-6")
        held = {table for table, bytes_held in needs.items() if "." in table and bytes_held > 0}
        self.assertEqual(held - set(LONG_SOLVES.split()), set(f"{ALWAYS} {tables} {PUSHES}".split()))
        rows = sum(needs[table] for table in ("push.pair", "push.record", "push.impulse", "push.before"))
        # 8 bytes of slots, eleven reals, an impulse and that of the sweep before: 112 for each contact, of twice as many at most.
        self.assertLess(rows, 2 * 112 * needs["contacts"] + 4000)

    def test_plain_sweeps_hold_nothing_for_momentum(self):
        needs = self.needs(in_plane("disk", 0.3), "--set", "solver.method=nlgs")
        self.assertEqual([needs.get(table, 0) for table in f"{MOMENTUM} nesterov.present nesterov.start".split()], 5 * [0])

    def needs_of_two(self, deck, *words):
        """The same of a run on two ranks: sums over both."""
        if self.launcher is None:
            self.skipTest("no program that starts ranks")
        (self.place / "deck.toml").write_text(deck)
        environment = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
        environment.pop("TMPDIR", None)
        words = [self.launcher, "--oversubscribe", "-n", "2", self.program, "run", "deck.toml", "--quiet", "--force", "--needs",
                 "--output", "two", *LEFT_OUT, *words]  # fmt: skip
        done = subprocess.run(words, cwd=self.place, env=environment, capture_output=True, text=True, timeout=self.timeout)
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads((self.place / "two/needs.json").read_text())

    def test_two_ranks_hold_no_more_than_their_parts(self):
        two = self.needs_of_two(in_plane("disk", 0.3), *SHORT)
        alone = self.needs(in_plane("disk", 0.3), *SHORT)
        self.assertGreater(alone["contacts"], GRAINS / 2)
        self.assertEqual((two["ranks"], two["grains"]), (2, GRAINS))
        self.assertGreater(two["messages"], 0)
        # Copies along the cut: a tenth of 20 by 50 grains at most, at either side.
        self.assertLess(two["bodies.position"], 1.2 * alone["bodies.position"])
        # Which rank is whose home, and the numbers of the whole scene: 12 bytes per body and its contactor.
        self.assertLess(two["bytes_per_grain"], 1.2 * (alone["bytes_per_grain"] + 12))

    def test_two_ranks_hold_what_they_need_and_nothing_else(self):
        for gluing, more in GLUINGS.items():
            for name in ("disks", "spheres"):
                with self.subTest(f"{name}, {gluing}"):
                    deck, tables, *_ = SCENES[name]
                    deck += f'[partition]\ngluing = "{gluing}"\n'
                    two = self.needs_of_two(deck)
                    held = {table for table, bytes_held in two.items() if "." in table and bytes_held > 0}
                    tables = set(f"{ALWAYS} {ON_RANKS} {tables} {more}".split()) - set(LANE_ERRORS.split())
                    self.assertEqual(held - set(LONG_SOLVES.split()), tables)

    def test_ranks_hold_nothing_that_is_not_listed(self):
        """What 3000 grains hold in memory beyond what 1000 do is in the list: what MPI holds from its start is in neither."""
        for gluing in GLUINGS:
            with self.subTest(gluing):
                deck = in_plane("disk", 0.3) + f'[partition]\ngluing = "{gluing}"\n'
                few, many = self.needs_of_two(deck, *SHORT), self.needs_of_two(wider(deck), *SHORT_WIDE)
                if few["memory_bytes"] == 0:
                    self.skipTest("the system does not tell what memory is in use")
                listed, held = (many[key] - few[key] for key in ("table_bytes", "memory_bytes"))
                self.assertGreater(listed, 1_000_000)
                # Of 1.3 MB; MPI has more room for longer messages, a few pages a rank.
                self.assertLess(abs(held - listed), 250_000)

    def test_outputs_that_nobody_asked_for_cost_nothing(self):
        """Nothing is opened, written, or asked of the system for them, however many steps there are."""
        off = ["--set", "output.every=0", "--set", "output.record_every=0", "--set", "restart.every=0", *LEFT_OUT]
        self.needs(in_plane("disk", 0.3), *off)
        files = sorted(path.name for path in (self.place / "out").iterdir())
        self.assertEqual(files, ["effective.toml", "needs.json", "numbers.tag", "run.json"])
        if shutil.which("strace") is None:
            self.skipTest("no strace")
        deck = in_plane("disk", 0.3).replace("1000", "60")
        (self.place / "deck.toml").write_text(deck)
        calls = []
        for steps in (200, 400):
            words = [self.program, "run", "deck.toml", "--quiet", "--force", "--output", "out", *off, "--set", f"time.steps={steps}"]
            traced = subprocess.run(["strace", "-f", "-c", "-U", "name,calls", "-o", "calls", *words], cwd=self.place,
                                    capture_output=True, text=True, timeout=self.timeout)  # fmt: skip
            if traced.returncode != 0:
                self.skipTest("strace may not trace here: " + traced.stderr)
            found = re.findall(r"^(\w+)\s+(\d+)", (self.place / "calls").read_text(), re.M)
            calls.append({name: int(number) for name, number in found if name != "total"})
        # What the solver and the phases ask for the time; memory may grow with the number of contacts.
        more = {name for name, number in calls[1].items() if number > calls[0].get(name, 0)}
        self.assertLessEqual(more, {"getrusage", "clock_gettime", "brk", "mmap", "munmap", "mremap"}, (calls[0], calls[1]))


def wider(deck):
    """The same scene three times as wide (four times in space), until it is as dense as it gets."""
    for old, new in ((f"count = {GRAINS}", f"count = {3 * GRAINS}"), ("1.01,", "3.01,"), ("1.5,", "3.5,"), (", 1.0, 4.0]", ", 3.0, 4.0]"),
                     ("0.4, 0.4, 2.0", "0.8, 0.8, 2.0"), ("step = 1e-3\nsteps = 150", "step = 5e-4\nsteps = 400")):  # fmt: skip
        deck = deck.replace(old, new)
    return deck


def print_table():
    """Print a table of all scenes in Markdown; the cost of an update is the least of three runs."""
    print("| scene | bytes per grain | per contact | libraries | bare kernel, ns | sweeps | whole solver | sweeps per solve |")
    print("|---|---|---|---|---|---|---|---|")
    case = Needs()
    for name, (deck, _, libraries, *_) in SCENES.items():
        case.setUp()
        runs = [case.needs(wider(deck)) for _ in range(3)]
        kernel = min(run["kernel_seconds_per_update"] for run in runs) * 1e9
        ratios = [min(run[f"{part}_over_kernel"] for run in runs) for part in ("sweeps", "solver")]
        print(f"| {name} | {runs[0]['bytes_per_grain']:.0f} | {runs[0]['bytes_per_contact']:.0f} | "
              f"{runs[0]['libraries'] or 'none'} | {kernel:.1f} | {ratios[0]:.2f} | {ratios[1]:.2f} | "
              f"{runs[0]['sweeps_compared']} |")  # fmt: skip
        case.doCleanups()


if __name__ == "__main__":
    take_program()
    if "--table" in sys.argv:
        print_table()
        sys.exit()
    unittest.main()

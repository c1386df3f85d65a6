"""What the tests of the periodic cell share: decks, places of bodies, samples."""

from program_case import ProgramCase

HEAD = """[scene]
dimension = {dimension}
[time]
step = {step}
steps = {steps}
{more}[solver]
method = "nlgs"
criterion = "e8"
tolerance = 1e-12
maximum_sweeps = 100000
[output]
record_every = 1
[[material]]
name = "stone"
density = 1000.0
"""
LAW = '[[law]]\nname = "contact"\nfriction = {friction}\n'
ROUNDING = 1e-11
"""Places, works and energies after some hundred steps, relative to the largest: rounding of each is 1e-16."""
SOLVED = 1e-8
"""What solutions within 1e-12 of the same problem, in another order of its contacts, leave after some ten steps."""
AXES = "xyz"


def grain(name, place, radius, velocity=None):
    shape = "disk" if len(place) == 2 else "sphere"
    text = f'[[body]]\nname = "{name}"\nshape = "{shape}"\nradius = {radius}\nposition = {list(place)}\n'
    return text + (f"velocity = {list(velocity)}\n" if velocity else "")


def stretched(rates, shear, step, steps):
    """Place after some steps of a point that moves with the cell, from its own equation: x' = x + h G (x + x')/2."""

    def move(place):
        place = list(place)
        for _ in range(steps):
            new = [x * (1 - step * r / 2) / (1 + step * r / 2) for x, r in zip(place, rates, strict=True)]
            mean = (place[1] + new[1]) / 2
            new[0] = (place[0] * (1 - step * rates[0] / 2) + step * shear * mean) / (1 + step * rates[0] / 2)
            place = new
        return place

    return move


class CellCase(ProgramCase):
    def write(self, cell, body, dimension=2, name="deck", step=1e-3, steps=100, law=LAW.format(friction=0.3), more=""):
        text = HEAD.format(dimension=dimension, step=step, steps=steps, more=more) + cell + law + body
        if "name = " in body:
            text += '[[track]]\nbody = "*"\n'
        (self.place / f"{name}.toml").write_text(text)

    def places(self, output="out"):
        """Places and velocities of all bodies in each recorded step, by name."""
        found = {}
        for row in self.rows(output, "tracks.csv"):
            axes = [a for a in AXES if a in row]
            found.setdefault(int(row["step"]), {})[row["body"]] = [float(row[key]) for key in axes + [f"velocity_{a}" for a in axes]]
        return found

    def cell(self, size, rates, shear=0.0):
        lines = [f"strain_rate_{2 * a} = {rate!r}" for a, rate in zip(AXES, rates)]
        return "\n".join(["[cell]", f"size = {list(size)}", *lines, f"shear_rate = {shear!r}"]) + "\n"

    def assert_closed(self, output="out"):
        self.assertLess(max(float(row["energy_closure"]) for row in self.rows(output)), ROUNDING)

    def pressed(self, size, stresses, shear=None):
        lines = [f"stress_{2 * a} = {stress!r}" for a, stress in zip(AXES, stresses)]
        return "\n".join(["[cell]", f"size = {list(size)}", *lines] + ([f"shear_stress = {shear!r}"] if shear else [])) + "\n"

    def write_pressed_sample(self, dimension, shape, steps, recovery=0.0):
        """Grains at random that collide while stresses close the cell, and shear it; overlap stays, since pushes end before they are
        solved as far as a step is."""
        self.write(self.pressed((1.0,) * dimension, (6e3, 5e3, 7e3)[:dimension], 500.0), self.sample(dimension, shape), dimension, steps=steps,
                   more=f"recovery = {recovery}\n")

    def assert_same_motion(self, one, output, shape, within=1e-6):
        """Rows of a run agree with those of another output to what the tolerance leaves after some collisions; the balance closes."""
        # Gyroscopic torques of polyhedra do some work in steps with impacts.
        if shape != "polyhedron":
            self.assert_closed(output)
        for left, right in zip(one, self.rows(output), strict=True):
            for key in ("cell_x", "cell_y", "strain_xy", "kinetic_energy", "external_work", "stress_xx", "stress_yy"):
                self.assertAlmostEqual(float(left[key]), float(right[key]), delta=within * max(1.0, abs(float(left[key]))),
                                       msg=f"{output} step {left['step']} {key}")  # fmt: skip

    def spots(self, dimension):
        """Places of grains that do not overlap, and velocities, from a simple generator."""
        found, state, number = [], 12345, 14 if dimension == 2 else 45
        while len(found) < number:
            values = []
            for _ in range(2 * dimension):
                state = (1103515245 * state + 12345) % 2**31
                values.append(state / 2**31)
            place, velocity = values[:dimension], [0.4 * (v - 0.5) for v in values[dimension:]]
            if all(sum(((x - y + 0.5) % 1.0 - 0.5) ** 2 for x, y in zip(place, other, strict=True)) > 0.21**2 for other, _ in found):
                found.append((place, velocity))
        return found

    def sample(self, dimension, shape):
        box = [0.0] * dimension + [1.0] * dimension
        return (f'[[sample]]\nkind = "random"\nshape = "{shape}"\nbox = {box}\nfill = {0.45 if dimension == 2 else 0.25}\n'
                f"radius = {[0.06, 0.09] if dimension == 2 else [0.1, 0.14]}\nseed = 5\n")  # fmt: skip

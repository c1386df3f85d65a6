"""Scenes at random that are right as far as their keys go: bodies do not overlap, and what a key needs is there."""

import math
import re

from reference_keys import draw, number

# Keys whose values are chosen here, or that only a person knows.
PICKED = {"steps", "step", "maximum_sweeps", "threads", "dimension", "datbox", "file", "faces", "scale", "hull", "every", "seed",
          "period_x", "period_y", "shape", "inertia"}


class Scene:
    """A deck that is right, as a list of blocks."""

    def __init__(self, rng, sections):
        self.rng, self.sections, self.blocks = rng, sections, []
        self.dimension = rng.choice([2, 3])
        self.length = 10 ** rng.choice([0, 0, 0, rng.uniform(-6, 6)])
        self.wild = rng.random() < 0.3
        self.spread = 12 if self.wild else 1.5
        self.names = []
        self.make()

    def chance(self, share):
        return self.rng.random() < share

    def add(self, heading, **values):
        """Add a block, with some more keys of its section at random."""
        block = {name: value if isinstance(value, str) else self.say(value) for name, value in values.items()}
        for key in self.sections.get(heading, []):
            if key.name in block or key.name in PICKED or not self.chance(0.06 if heading.startswith("[[") else 0.15):
                continue
            if key.name in ("name", "colour", "material", "law", "body", "between", "candidate", "antagonist", "position", "box",
                            "size", "thickness", "corner", "centre", "radius", "pressure", "direction", "structure_box"):
                continue
            if key.fits(self.dimension, block):
                text = key.text(self.rng, self.dimension, self.spread)
                if text:
                    block[key.name] = text
        self.make_sense(heading, block)
        self.blocks.append((heading, block))

    def make_sense(self, heading, block):
        """Mend values that contradict each other."""
        if heading == "[[body]]" and block.get("fixed") == "true":
            block.pop("velocity", None)
            block.pop("spin", None)
        if self.in_cell:
            block.pop("substeps", None)
            block.pop("gravity", None)
        if heading == "[cell]":
            for axes, rate in (("stress_xx", "strain_rate_xx"), ("stress_yy", "strain_rate_yy"), ("stress_zz", "strain_rate_zz"),
                               ("shear_stress", "shear_rate")):
                if axes in block:
                    block.pop(rate, None)
                if rate in block:
                    # A step may strain the cell by 1 at most.
                    block[rate] = self.say(self.rng.uniform(-0.3, 0.3) / self.step)
        if "omega" in block:
            block.pop("frequency", None)
        if heading == "[[sample]]" and "radius" in block:
            block.pop("curve", None)
            block.pop("sieve", None)
        if heading == "[[container]]":
            lacking = {"stress_xx": self.period or block.get("sides") == "false", "stress_zz": block.get("lid") != "true",
                       "stress_yy": self.period_y or block.get("sides") == "false"}
            for stress in (name for name, lacks in lacking.items() if lacks):
                block.pop(stress, None)
        if heading == "[[law]]":
            if block["kind"] == '"LINEAR"' and "relative_epsilon" not in block:
                block.setdefault("epsilon", self.say(10 ** self.rng.uniform(-6, 2)))
            rest = float(block.get("friction", 0))
            if float(block.get("static_friction", rest)) < float(block.get("dynamic_friction", rest)):
                block["static_friction"] = block.get("dynamic_friction", block.get("friction"))
            if "normal_bond_stress" in block or "tangential_bond_stress" in block:
                block.pop("normal_cohesion", None)
                block.pop("tangential_cohesion", None)
            if block["kind"].endswith('_CZM"'):
                self.make_zone(block)

    def make_zone(self, block):
        """Numbers of a cohesive zone that fit each other: openings in the order in which a bond passes them."""
        for mode in ("normal", "tangential"):
            if f"{mode}_strength" not in block:
                continue
            strength = float(block[f"{mode}_strength"])
            first = strength / float(block[f"{mode}_stiffness"])
            plateau = first * (1 + 10 ** self.rng.uniform(-self.spread, self.spread))
            energy = strength * (plateau - first / 2) * (1 + 10 ** self.rng.uniform(-self.spread, self.spread))
            if f"{mode}_plateau" in block:
                block[f"{mode}_plateau"] = self.say(plateau)
            if f"{mode}_opening" in block:
                # Two lines meet, where a share of the energy is gone, after the peak and before the end.
                share = float(block["knee_share"])
                energy += strength * first / (2 * share)
                least = max(4 * energy * share / strength, 2 * math.sqrt(energy * first / strength))
                block[f"{mode}_opening"] = self.say(least * (1 + 10 ** self.rng.uniform(-self.spread, self.spread)))
            block[f"{mode}_energy"] = self.say(energy)

    def say(self, value):
        if isinstance(value, bool):
            return "true" if value else "false"
        if isinstance(value, (list, tuple)):
            return "[" + ", ".join(self.say(item) for item in value) + "]"
        return str(value) if isinstance(value, int) else number(value)

    def quote(self, word):
        return f'"{word}"'

    def make(self):
        rng, d = self.rng, self.dimension
        self.cell = self.length
        self.columns = rng.randint(1, 4)
        scene = {"dimension": d} if d == 3 or self.chance(0.3) else {}
        self.in_cell = self.chance(0.12)
        self.period = (self.columns + 1) * self.cell if not self.in_cell and self.chance(0.25) else 0.0
        if self.period:
            scene["period_x"] = self.period
        self.period_y = 1.2 * self.cell if d == 3 and not self.in_cell and self.chance(0.15) else 0.0
        if self.period_y:
            scene["period_y"] = self.period_y
        if not self.in_cell and self.chance(0.3):
            scene["gravity"] = [draw(rng, -math.inf, math.inf, self.spread) * self.length for _ in range(d)]
        if scene or self.chance(0.5):
            self.add("[scene]", **scene)
        self.step = 10 ** rng.choice([-3.0, rng.uniform(-6, 0)]) * self.length**0.5
        self.add("[time]", step=self.step, steps=rng.choice([0, 1, 2, 3, 6]))
        self.add("[solver]", maximum_sweeps=rng.choice([1, 5, 40]))
        for heading in self.sections:
            # What is repeated needs room, which these scenes have none of.
            if heading not in ("[scene]", "[time]", "[solver]", "[cell]", "[repeat]") and not heading.startswith("[[") and self.chance(0.4):
                self.add(heading)
        if self.in_cell:
            size = [(self.columns + 1) * self.cell, 11 * self.cell]
            self.add("[cell]", size=size if d == 2 else [size[0], 1.2 * self.cell, size[1]])
        materials = rng.randint(1, 2)
        for i in range(materials):
            self.add("[[material]]", name=self.quote(f"m{i}"), density=10 ** rng.uniform(-3, 4))
        self.material = {"material": self.quote("m0")} if materials > 1 else {}
        self.make_bodies()
        if not self.in_cell:
            self.make_walls()
            self.make_sample()
        self.make_laws()
        if not self.in_cell:
            self.make_drives()
        if self.chance(0.1):
            self.make_removal()

    def make_laws(self):
        kinds = re.findall(r"`([^`]*)`", next(key for key in self.sections["[[law]]"] if key.name == "kind").value)
        # Laws of links join points, which these scenes have none of.
        kinds = [kind for kind in kinds if kind not in ("ROD", "WIRE", "RIGID_WIRE", "NARD_ROD")]
        n = self.rng.choice([0, 1, 1, 1, 2])
        for i in range(n):
            kind = self.rng.choice(kinds) if not self.in_cell and self.chance(0.5) else "IQS_CLB"
            more = {"wet_thickness": 0.01 * self.cell, "epsilon": 10 ** self.rng.uniform(-6, 2), "stiffness": 10 ** self.rng.uniform(2, 8)}
            fitting = [key for key in self.sections["[[law]]"] if key.fits(self.dimension, {"kind": self.quote(kind)})]
            needed = [key for key in fitting if key.default == "required"]
            more = {key.name: more.get(key.name) or key.text(self.rng, self.dimension, self.spread) for key in needed}
            if any(key.name == "friction" for key in fitting) and self.chance(0.8):
                more["friction"] = self.rng.choice([0.0, 0.3, 1.0, 10.0, 100.0, 1e-8])
            self.add("[[law]]", name=self.quote(f"law{i}"), kind=self.quote(kind), **more)
        # Overlap is undone under laws of rigid contact alone.
        if any(block["kind"] != '"IQS_CLB"' for heading, block in self.blocks if heading == "[[law]]"):
            for block in (block for heading, block in self.blocks if heading == "[time]"):
                block.pop("recovery", None)
        self.bound_moments()
        for i in range(n if n > 1 or n and self.chance(0.3) else 0):
            self.add("[[interaction]]", law=self.quote(f"law{i}"))

    def bound_moments(self):
        """Moments against rolling are for sweeps, and not beside cohesive zones or for links."""
        laws = [block for heading, block in self.blocks if heading == "[[law]]"]
        if any(block["kind"].endswith('_CZM"') for block in laws):
            for block in laws:
                for key in [key for key in block if key.startswith(("rolling_", "twisting_"))]:
                    del block[key]
        if any(key.startswith(("rolling_", "twisting_")) for block in laws for key in block):
            for heading, block in self.blocks:
                if heading == "[solver]" and block.get("method") not in ('"nlgs"', '"nesterov"'):
                    block.pop("method", None)
                if heading == "[partition]":
                    block.pop("gluing", None)

    def shape(self, size):
        """A shape within a sphere of a radius, as keys."""
        rng = self.rng
        thin = size * 10 ** rng.choice([-0.5, rng.uniform(-6, -0.3) if self.wild else -0.4])
        if self.dimension == 2:
            kind = rng.choice(["disk", "disk", "segment", "polygon"])
            if kind == "polygon":
                n = rng.randint(3, 8)
                turn = rng.uniform(0, 7)
                points = [[size * math.cos(turn + 2 * math.pi * i / n), size * math.sin(turn + 2 * math.pi * i / n)] for i in range(n)]
                return kind, {"vertices": points}
            return kind, {"radius": size} if kind == "disk" else {"half_length": size - thin, "half_thickness": thin}
        kind = rng.choice(["sphere", "sphere", "box", "cylinder", "polyhedron"])
        if kind == "sphere":
            return kind, {"radius": size}
        if kind == "box":
            return kind, {"half_axes": [size / 1.8, size / 1.8, min(thin, size / 1.8)]}
        if kind == "cylinder":
            return kind, {"half_height": size - thin, "radius": thin}
        return kind, {"vertices": [[size, 0, 0], [-size, 0, 0], [0, size, 0], [0, -size, 0], [0, 0, size], [0, 0, -thin]]}

    def make_bodies(self):
        rng, d = self.rng, self.dimension
        for i in range(rng.randint(1, 10)):
            place = [(i % self.columns + 0.55) * self.cell, (i // self.columns + 0.55) * self.cell]
            if d == 3:
                place.insert(1, 0.55 * self.cell)
            size = self.cell / 2 * rng.choice([1.0, rng.uniform(0.1, 1.0), 10 ** rng.uniform(-4, 0) if self.wild else 0.9])
            more = dict(self.material)
            if self.chance(0.3):
                self.names.append(f"b{i}")
                more["name"] = self.quote(f"b{i}")
            if self.chance(0.2):
                more["velocity"] = [draw(rng, -math.inf, math.inf, self.spread) * self.length for _ in range(d)]
            if self.chance(0.2):
                more["spin"] = draw(rng, -math.inf, math.inf, self.spread) if d == 2 else [rng.uniform(-9, 9) for _ in range(3)]
            if not self.in_cell and self.chance(0.1):
                more["fixed"] = True
            if self.chance(0.06):
                more["inertia"] = self.inertia()
            if self.wild and self.chance(0.3):
                more["mass"] = 10 ** rng.uniform(-9, 9)
            if self.chance(0.2):
                self.add("[[body]]", position=place, **more)
                for _ in range(rng.randint(1, 3)):
                    kind, sizes = self.shape(size / 2)
                    self.add("[[body.shape]]", kind=self.quote(kind), centre=[rng.uniform(-0.5, 0.5) * size for _ in range(d)], **sizes)
            else:
                kind, sizes = self.shape(size)
                self.add("[[body]]", position=place, shape=self.quote(kind), **sizes, **more)

    def inertia(self):
        """Moments of inertia that a body may have: in space none is larger than the sum of the others."""
        size = 10 ** self.rng.uniform(-self.spread, self.spread)
        if self.dimension == 2:
            return size
        two = [size * self.rng.uniform(0.1, 1.0), size]
        moments = two + [self.rng.uniform(two[1] - two[0], two[0] + two[1])]
        self.rng.shuffle(moments)
        return moments

    def make_walls(self):
        if self.chance(0.2):
            return
        width = 40 * self.cell
        self.names.append("floor")
        if self.dimension == 2:
            self.add("[[wall]]", name='"floor"', **{"from": [-width, -0.2 * self.cell], "to": [width, -0.2 * self.cell]},
                     thickness=0.4 * self.cell, **self.material)
            if self.chance(0.3):
                self.names.append("lid")
                top = 20 * self.cell
                self.add("[[wall]]", name='"lid"', **{"from": [0.0, top], "to": [self.cell * 4, top]}, thickness=0.4 * self.cell,
                         pressure=10 ** self.rng.uniform(0, 5), direction=[0, -1], **self.material)
        elif self.chance(0.5):
            self.add("[[wall]]", name='"floor"', centre=[0.0, 0.0, 0.0], size=[width, width], thickness=self.cell, **self.material)
        else:
            self.names.append("box.floor")
            self.names.remove("floor")
            self.add("[[container]]", size=[(self.columns + 1) * self.cell, 1.2 * self.cell, 30 * self.cell], **self.material)

    def make_sample(self):
        if not self.chance(0.35):
            return
        d, cell = self.dimension, self.cell
        low = [0.0, 12 * cell] if d == 2 else [0.0, 0.05 * cell, 12 * cell]
        high = [(self.columns + 1) * cell, 15 * cell] if d == 2 else [(self.columns + 1) * cell, 1.15 * cell, 15 * cell]
        shape = self.rng.choice(["disk", "polygon"] if d == 2 else ["sphere", "polyhedron"])
        lattice = self.chance(0.5)
        more = {"kind": self.quote("lattice")} if lattice else {"count": self.rng.randint(1, 8)}
        self.add("[[sample]]", box=low + high, radius=[0.15 * cell, 0.25 * cell], shape=self.quote(shape), **more, **self.material)

    def make_removal(self):
        low = [self.rng.uniform(-2, 3) * self.cell for _ in range(self.dimension)]
        high = [place + self.rng.uniform(0.1, 9) * self.cell for place in low]
        self.add("[[remove]]", box=low + high)

    def make_drives(self):
        axes = ["x", "y", "rotation"] if self.dimension == 2 else ["x", "y", "z", "rotation_x", "rotation_y", "rotation_z"]
        pairs = [(name, axis) for name in self.names for axis in axes]
        for name, axis in self.rng.sample(pairs, min(len(pairs), self.rng.choice([0, 0, 1, 2]))):
            self.add("[[drive]]", body=self.quote(name), component=self.quote(axis), value=draw(self.rng, -math.inf, math.inf, self.spread))

    def lines(self):
        """The deck as lines."""
        for heading, block in self.blocks:
            yield heading
            for name, value in block.items():
                yield f"{name} = {value}"

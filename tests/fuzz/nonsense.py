"""Values that a key of a deck must refuse, or warn of, by the kinds and ranges of `splitgrain reference`; decks that hold every section."""

import re
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "stiff"))
from reference_keys import Key, read_reference  # noqa: E402, F401

COMMON = """[time]
step = 1e-3
steps = 10
[solver]
[partition]
[output]
[restart]
[guard]
[report]
[[material]]
name = "stone"
density = 2000.0
[[law]]
name = "rough"
kind = "{law}"
{law_keys}
[[interaction]]
law = "rough"
"""
PLANE = COMMON + """[scene]
period_x = 0.0
[[body]]
name = "ball"
{body}
position = [0.0, 5.0]
{fixed}
[[body]]
name = "twin"
position = [4.0, 5.0]
[[body.shape]]
{shape}
[[wall]]
name = "floor"
from = [-9.0, 0.0]
to = [9.0, 0.0]
thickness = 0.1
{wall}
[[sample]]
{sample}
box = [-9.0, 10.0, 9.0, 20.0]
count = 3
radius = 0.5
[[drive]]
body = "floor"
component = "rotation"
[[pressure]]
body = "ball"
direction = [0.0, 1.0]
length = 1.0
"""
SPACE = COMMON + """[scene]
dimension = 3
[[body]]
name = "ball"
{body}
position = [0.0, 0.0, 5.0]
{fixed}
[[body]]
name = "twin"
position = [4.0, 0.0, 5.0]
[[body.shape]]
{shape}
[[wall]]
name = "floor"
centre = [0.0, 0.0, -5.0]
size = [90.0, 90.0]
thickness = 0.1
{wall}
[[container]]
size = [30.0, 30.0, 30.0]
corner = [-15.0, -15.0, -4.0]
[[brick_wall]]
position = [-12.0, -12.0, -4.0]
rows = 1
columns = 1
brick = [1.0, 0.5, 0.5]
[[arch]]
centre = [0.0, 8.0, -4.0]
voussoirs = 3
inner_radius = 2.0
outer_radius = 3.0
depth = 1.0
[[sample]]
{sample}
box = [-9.0, -9.0, 10.0, 9.0, 9.0, 20.0]
count = 3
radius = 0.5
[[drive]]
body = "floor"
component = "x"
[[pressure]]
body = "ball"
direction = [0.0, 0.0, 1.0]
area = 1.0
"""
SHAPES = {
    "disk": "radius = 0.5", "hollow disk": "radius = 0.5", "segment": "half_length = 0.5\nhalf_thickness = 0.1",
    "polygon": "vertices = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]", "sphere": "radius = 0.5", "cylinder": "radius = 0.2\nhalf_height = 0.5",
    "hollow cylinder": "radius = 0.2\nhalf_height = 0.5", "plane": "half_axes = [1.0, 1.0, 0.1]", "box": "half_axes = [0.3, 0.2, 0.1]",
    "polyhedron": "vertices = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]",
}
LAWS = {"IQS_CLB": "", "IQS_WET_DS_CLB": "wet_thickness = 1e-3", "ELASTIC_REPELL_CLB": "stiffness = 1e6", "LINEAR": "epsilon = 1e-3"}


def base(dimension, shape=None, law="IQS_CLB", wall="", sample="", fixed=""):
    """A deck with a block of every section that its dimension has."""
    shape = shape or ("disk" if dimension == 2 else "sphere")
    mass = 'mass = 1.0\ninertia = ' + ("1.0" if dimension == 2 else "[1.0, 1.0, 1.0]") + "\n" if shape.startswith("hollow") else ""
    plain = "disk" if dimension == 2 else "sphere"
    return (PLANE if dimension == 2 else SPACE).format(
        law=law, law_keys=LAWS[law], body=f'shape = "{shape}"\n{mass}{SHAPES[shape]}', shape=f'kind = "{plain}"\n{SHAPES[plain]}',
        wall=wall, sample=sample, fixed=fixed)


def spoilt(key, dimension):
    """Values that a key must refuse."""
    kind = key.value
    if ", in space " in kind or "; in space " in kind:
        halves = re.split(r"[,;] in space ", kind)
        kind = halves[dimension == 3] + (re.search(r"(?:, (?:at|above).*)?$", halves[1])[0] if dimension == 2 else "")
    if kind.startswith("`"):
        return ['"nowhere"', "1", "true", "[]"]
    if kind.startswith("true or false"):
        return ["1", '"yes"', "[true]", "0.0"]
    if kind.startswith("a string"):
        return ["1", "true", '""', "[]"]
    if kind.startswith(("the name or number", "a list of 2 bodies")):
        return ["true", "1.5", '["x"]']
    values = ['"x"', "true", "nan", "inf", "1e51", "1e-51", "{a = 1}", "1979-05-27"]
    if "integer" in kind:
        values += ["1.5", "99999999999999999999", "3000000000", '["x"]', "[]"]
    elif kind.startswith("a number") and "list" not in kind:
        values += ["[1.0]", "[]", "99999999999999999999999999999999999999999999999999999"]
    else:
        values += ["[]", '["x"]', "[[[1.0]]]"]
    if "expression" in kind or "name of a stage" in kind:
        # A string may be one; its mistakes have sentences of their own.
        values.remove('"x"')
    low, high = Key.bound(kind, "at least"), Key.bound(kind, "at most")
    above = re.search(r"above ([-+.\de]+)", kind)
    wrap = "{}" if not kind.startswith(("a list of ", )) else "[" + ", ".join(["{}"] * int((re.search(r"a list of (\d)", kind) or [0, 1])[1])) + "]"
    whole = "integer" in kind
    if low > -1e300:
        values.append(wrap.replace("{}", str(int(low) - 1) if whole else repr(low - 0.5)))
    if above:
        values.append(wrap.replace("{}", repr(float(above[1].rstrip(".")))))
    if high < 1e300:
        values.append(wrap.replace("{}", str(int(high) + 1) if whole else repr(high * 1.01)))
    return [value for value in values if not (value == "1e-51" and whole)]

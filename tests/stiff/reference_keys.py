"""Keys of decks as `splitgrain reference` lists them, and values of their kinds and ranges at random."""

import math
import re
import subprocess


class Key:
    """One line of the reference."""

    def __init__(self, name, value, default, meaning):
        self.name, self.value, self.default, self.meaning = name, value, default, meaning

    def fits(self, dimension, block):
        """Does it apply in a scene and to a block?"""
        if "Only in space" in self.meaning and dimension == 2 or "Only in the plane" in self.meaning and dimension == 3:
            return False
        given = re.search(r"Only with `(\w+)`", self.meaning)
        if given and given[1] not in block:
            return False
        only = re.search(r"Only for (\w+) ((?:`[^`]*`(?:, )?)+)", self.meaning)
        return not only or block.get(only[1], '""').strip('"') in re.findall(r"`([^`]*)`", only[2])

    def text(self, rng, dimension, spread):
        """A value as TOML; nothing where only a person knows one."""
        kind = self.value
        if ", in space " in kind or "; in space " in kind:
            halves = re.split(r"[,;] in space ", kind)
            bounds = re.search(r", (?:at|above).*", halves[1])
            kind = halves[1] if dimension == 3 else halves[0] + (bounds[0] if bounds else "")
        low, high = self.bound(kind, "at least"), self.bound(kind, "at most")
        above = self.bound(kind, "above")
        if kind.startswith("`"):
            return f'"{rng.choice(re.findall(r"`([^`]*)`", kind))}"'
        if kind == "true or false":
            return rng.choice(["true", "false"])
        if kind.startswith("an integer"):
            return str(rng.randint(int(max(low, -5)), int(min(high, max(low, 0) + 6))))
        if kind.startswith("a number") and "list" not in kind:
            return number(draw(rng, low, high, spread, above))
        count = re.match(r"a list of (\d) numbers", kind)
        if count:
            return "[" + ", ".join(number(draw(rng, low, high, spread, above)) for _ in range(int(count[1]))) + "]"
        return None

    @staticmethod
    def bound(kind, word):
        """A bound of the range."""
        found = re.search(word + r" ([-+.\de]+)", kind)
        if found:
            return float(found[1].rstrip("."))
        return math.inf if "most" in word else -math.inf


def number(value):
    """A real as TOML."""
    text = repr(float(value))
    return text if re.search(r"[.e]", text) else text + ".0"


def draw(rng, low, high, spread, above=-math.inf):
    """A number of any size within a range, its ends at times where they belong to it."""
    if math.isfinite(low) and rng.random() < 0.1:
        return low
    if math.isfinite(high) and rng.random() < 0.1:
        return high
    value = 10 ** rng.uniform(-spread, spread)
    if math.isfinite(above):
        return min(above + value, high)
    if low >= 0:
        return min(max(value, low * (1 + 1e-9)), high)
    return max(low, min(high, rng.choice([-1, 1]) * value))


def read_reference(program):
    """Sections and their keys."""
    sections = {}
    text = subprocess.run([program, "reference"], capture_output=True, text=True, check=True).stdout
    for block in re.split(r"^## ", text, flags=re.M)[1:]:
        heading = re.match(r"`(\[+[\w.]+\]+)`", block)
        if not heading:
            continue
        rows = re.findall(r"^\| `(\w+)` \| (.*?) \| .*? \| (.*?) \| (.*?) \|$", block, re.M)
        sections[heading[1]] = [Key(*row) for row in rows]
    return sections

"""Decks and DATBOX folders spoilt at random: as text, as bytes, number by number."""

import re

VALUES = ["nan", "inf", "-inf", "+nan", "1e999", "-1e300", "1e300", "1e-300", "-1", "0", "-0.0", "1e18", "9223372036854775807",
          "99999999999999999999", "2147483648", '""', '"x"', "[]", "[[]]", "[1, 2]", '["a", 1]', "true", "{}", "{a = 1}", "[nan, 0]",
          "1979-05-27", "0x1F", "1_000", "'''", '"\\u0000"', '"\\uD800"', "é", "[[1, 2], [3]]", "NaN", "1.", ".5", "1d3",
          "[" * 300, "{a." + "a." * 300 + "a = 1}"]
GROWING = re.compile(r"^(radius|box|count|fill|rows|columns|voussoirs|steps|maximum_sweeps|threads|sides|vertices|spacing|size|"
                     r"position|period_.|trace_steps|half_\w+|from|to|structure_box)\b")


def spoil(rng, lines):
    """A deck spoilt as text, as bytes."""
    lines = list(lines)
    for _ in range(rng.randint(1, 3)):
        at = rng.randrange(len(lines))
        way = rng.randrange(12)
        if way <= 3 and "=" in lines[at] and not GROWING.match(lines[at]):
            lines[at] = lines[at].split("=")[0] + "= " + rng.choice(VALUES)
        elif way <= 3 and "=" in lines[at]:
            lines[at] = lines[at].split("=")[0] + "= " + rng.choice([value for value in VALUES if not re.match(r"\d|1_|0x|-?1e-", value)])
        elif way == 4:
            del lines[at]
        elif way == 5:
            lines.insert(at, lines[at])
        elif way == 6:
            lines.insert(at, rng.choice(["[[nowhere]]", "[time]", "[[body]]", "[[body.shape]]", "[[drive]]", "[[wall]]", "[body]",
                                         "colour = 3", "a.b.c = 1", "= 1", "[", "]]", "# \x00\x01", "[[sample]]", "[[pressure]]",
                                         "a" + ".a" * rng.choice([9, 99, 50000]) + " = 1"]))
        elif way == 7 and lines[at]:
            letters = list(lines[at])
            letters[rng.randrange(len(letters))] = rng.choice("abcxyz_=[]\"'#{}.,0 9-")
            lines[at] = "".join(letters)
        elif way == 8:
            other = rng.randrange(len(lines))
            lines[at], lines[other] = lines[other], lines[at]
        elif way == 9:
            lines[at] = lines[at][: rng.randrange(len(lines[at]) + 1)]
        elif way == 10:
            lines[at] = lines[at] + " " * rng.choice([1, 300, 70000]) + rng.choice(["", "#", "x"])
        if not lines:
            lines = [""]
    return spoil_bytes(rng, ("\n".join(lines) + "\n").encode("utf8", "surrogatepass"), 0.25)


def spoil_bytes(rng, data, share):
    """Bytes cut off, changed, or put in."""
    if rng.random() > share or not data:
        return data
    at = rng.randrange(len(data))
    way = rng.randrange(5)
    if way == 0:
        return data[:at]
    if way == 1:
        return data[:at] + bytes(rng.randrange(256) for _ in range(rng.randint(1, 40))) + data[at:]
    if way == 2:
        return data[:at] + bytes([rng.randrange(256)]) + data[at + 1:]
    if way == 3:
        return b"\xef\xbb\xbf" + data.replace(b"\n", b"\r\n")
    return bytes(rng.randrange(256) for _ in range(rng.randint(0, 400)))


def spoil_datbox(rng, folder):
    """One or two files of a DATBOX spoilt."""
    files = sorted(path for path in folder.iterdir() if path.stat().st_size > 0)
    for _ in range(rng.randint(1, 2)):
        path = rng.choice(files)
        if not path.exists():
            continue
        if rng.random() < 0.1:
            path.unlink()
            continue
        lines = path.read_bytes().decode("latin1").split("\n")
        for _ in range(rng.randint(1, 4)):
            at = rng.randrange(len(lines))
            line = lines[at]
            way = rng.randrange(7)
            numbers = list(re.finditer(r"[-+ ]\d\.\d{7}D[-+]\d\d", line))
            if way <= 2 and numbers:
                one = rng.choice(numbers)
                new = rng.choice(["           NaN", "      Infinity", "-1.0000000D+00", " 0.0000000D+00", " 1.0000000D+60", " 1.0000000D-60",
                                  " 1.0000000D+99", "              ", " 1.00e00000000", "\t", " 1.0000000E-310",
                                  " 1.000000D-308", " 1.000000D+308"])
                lines[at] = line[: one.start()] + new + line[one.end():]
            elif way == 3:
                lines[at] = re.sub(r"\d+", lambda _: rng.choice(["0", "-1", "99999999", "7"]), line, count=1)
            elif way == 4:
                del lines[at]
                lines = lines or [""]
            elif way == 5:
                lines.insert(at, line)
            else:
                lines[at] = line[: rng.randrange(len(line) + 1)]
        path.write_bytes(spoil_bytes(rng, "\n".join(lines).encode("latin1"), 0.2))

"""Where in a TOML text a key stands: the library that reads it reports no lines."""

import re

HEADER = re.compile(r"^\s*(\[\[?)\s*([^\[\]]+?)\s*\]\]?\s*(#.*)?$")


def line_of(text: str, section: str = "", number: int = 1, key: str = "") -> int:
    """Line of a key of a section, of the section's head where the key is not there, else 1.

    `number` counts sections of one name from 1. A key "set.solver.order" is found as `set`, or in a section [case.set].
    """
    current, count, seen, found = "", 1, {}, 1
    for line, words in enumerate(text.splitlines(), 1):
        if head := HEADER.match(words):
            current = head[2].replace('"', "").replace(" ", "")
            seen[current] = seen.get(current, 0) + 1
            count = seen[current]
            if current == section and count == number:
                found = line
        elif key and current == section and count == number and _starts_with(words, key):
            return line
    return found


def _starts_with(words, key):
    """Does a line set this key, or the table that the key is in?"""
    name = re.match(r'^\s*["\']?([\w.-]+)["\']?\s*=', words)
    return name is not None and (key == name[1] or key.startswith(name[1] + "."))

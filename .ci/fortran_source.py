"""Reading Fortran sources for the checks: which files there are, and their code without comments and strings."""

import re
from pathlib import Path

# The only direction in which `use` may point: a file may use its own folder and those before it.
LAYERS = [
    "base", "parallel", "bodies", "contactors", "laws", "scene", "deck", "detection", "partition", "problem",
    "solvers", "monitors", "output", "step", "drivers",
]  # fmt: skip

STRING = re.compile(r"'[^'\n]*'|\"[^\"\n]*\"")


def sources(top, *folders):
    """All Fortran files below the folders of the project, sorted."""
    return sorted(path for folder in folders for path in (Path(top) / folder).rglob("*.f90"))


def code_lines(text):
    """(line number, line without strings and comments, in lower case) of every line."""
    for number, line in enumerate(text.splitlines(), 1):
        code = STRING.sub("''", line) if not line.lstrip().startswith("!") else ""
        yield number, code.split("!", 1)[0].lower()


def layer(top, path):
    """The folder of a source that the order of layers speaks of; None for the tests, which may use all."""
    parts = path.relative_to(top).parts
    if parts[0] == "src":
        return parts[1]
    return "drivers" if parts[0] == "drivers" else None


def report(name, findings, n_files):
    """Print findings as file:line: sentence; return the exit code."""
    for finding in findings:
        print(finding)
    print(f"{name}: {n_files} files, {len(findings)} findings")
    return 1 if findings or not n_files else 0

"""Reading Fortran sources for the checks: which files there are, and their code without comments and strings."""

import re
from pathlib import Path

MODULE = re.compile(r"^\s*module\s+(?!procedure\b)(\w+)\s*$")
USE = re.compile(r"^\s*use\b\s*(?:,\s*\w+\s*)?(?:::)?\s*(\w+)")
PARENT = re.compile(r"^\s*submodule\s*\(\s*(\w+)")
STRING = re.compile(r"'[^'\n]*'|\"[^\"\n]*\"")


def sources(top, *folders):
    """All Fortran files below the folders of the project, sorted."""
    return sorted(path for folder in folders for path in (Path(top) / folder).rglob("*.f90"))


def code_lines(text):
    """(line number, line without strings and comments, in lower case) of every line."""
    for number, line in enumerate(text.splitlines(), 1):
        code = STRING.sub("''", line) if not line.lstrip().startswith("!") else ""
        yield number, code.split("!", 1)[0].lower()


def room(top, path):
    """The room of a source; None for the tests, which may use all."""
    folder = path.relative_to(top).parent
    return folder.as_posix().removeprefix("src/") if folder.parts[0] in ("src", "drivers") else None


def uses(top, texts):
    """(file, line, module used, room of the file, room of the module) of every use of a module of the
    project, from the code lines of its files."""
    homes = {match[1]: room(top, path) for path, lines in texts.items() for _, line in lines
             if (match := MODULE.match(line))}
    for path, lines in texts.items():
        for number, line in lines:
            used = USE.match(line) or PARENT.match(line)
            if used and used[1] in homes:
                yield path, number, used[1], room(top, path), homes[used[1]]


def report(name, findings, n_files):
    """Print findings as file:line: sentence; return the exit code."""
    for finding in findings:
        print(finding)
    print(f"{name}: {n_files} files, {len(findings)} findings")
    return 1 if findings or not n_files else 0

"""Calls of one time step, in their order: each verb of src/run/advance.f90, the procedures that it calls, and their files.

Only names that sources declare count: procedures imported by `use ..., only`, procedures of the file, and procedures bound to
the components of `simulation_t`. Procedures of the room `run` are followed, each once; all others are the ends of branches.
"""

import re

from fortran_source import MODULE, code_lines, room, sources

PROCEDURE = re.compile(r"(?:(?:pure|elemental|impure|recursive)\s+)*(?:subroutine|(?:[\w()]+\s+)?function)\s+(\w+)")
END = re.compile(r"end (?:subroutine|function)")
IMPORT = re.compile(r"use\s*(?:,\s*\w+\s*)?(?:::)?\s*(\w+)\s*,\s*only\s*:\s*(.+)")
COMPONENT = re.compile(r"(?:type|class)\((\w+)\)(?:,\s*\w+)*\s*::\s*(.+)")
BOUND = re.compile(r"(?:procedure|generic)\b[^:]*::\s*(.+)")
TIMED = re.compile(r"call timed\((\w+), sim, phase_(\w+),")
NAME = re.compile(r"\b\w+(?:%\w+)*")


class Source:
    """One file: what it imports, its procedures with their statements, and names of bound procedures."""

    def __init__(self, top, path):
        self.room = room(top, path)
        self.place = f"{self.room}/{path.stem}"
        self.modules, self.imports, self.procedures, self.bound, self.components = [], {}, {}, set(), {}
        open_procedures, statement = [], ""
        for _, line in code_lines(path.read_text()):
            statement += line.strip().removeprefix("&").removesuffix("&") if line.strip() else ""
            if line.rstrip().endswith("&"):
                continue
            self.add(statement, open_procedures)
            statement = ""

    def add(self, statement, open_procedures):
        """Add one statement."""
        if match := MODULE.match(statement):
            self.modules.append(match[1])
        elif match := IMPORT.match(statement):
            self.imports |= {name.strip(): match[1] for name in match[2].split(",")}
        elif END.match(statement):
            open_procedures[-1:] = []
        elif match := PROCEDURE.match(statement):
            open_procedures.append(match[1])
            self.procedures[match[1]] = []
        elif open_procedures:
            self.procedures[open_procedures[-1]].append(statement)
        elif match := BOUND.match(statement):
            self.bound |= {name.split("=>")[0].strip() for name in match[1].split(",")}
        elif match := COMPONENT.match(statement):
            self.components |= {name.split("=")[0].strip(): match[1] for name in match[2].split(",")}


class Step:
    """All sources of a project, and the tree of calls in its step."""

    def __init__(self, top):
        files = [Source(top, path) for path in sources(top, "src")]
        self.module = {name: file for file in files for name in file.modules}
        self.owner = self.module["sg_simulation"]
        self.advance = self.module["sg_advance"]
        self.followed = set()

    def bound_to(self, name):
        """Place of the procedure that `sim%component%procedure` calls; None where it is no procedure."""
        parts = name.split("%")
        kind = self.owner.components.get(parts[1]) if len(parts) == 3 and parts[0] == "sim" else None
        file = self.module.get(self.owner.imports.get(kind))
        return file.place if file and parts[2] in file.bound else None

    def calls(self, file, procedure):
        """(name, place, file to follow) of each procedure called, in order, each once; helpers of the file are looked into."""
        found = {}
        for name in NAME.findall(" ".join(file.procedures[procedure])):
            home = self.module.get(file.imports.get(name))
            if name in file.procedures and name != procedure:
                if file is self.advance:
                    found.setdefault(name, (None, file))
                else:
                    found |= {key: value for key, value in self.calls(file, name).items() if key not in found}
            elif home and name in home.procedures and not home.room.startswith("base") and name != "timed":
                found.setdefault(name, (home.place, home if home.room == "run" else None))
            elif place := self.bound_to(name):
                found.setdefault(name.removeprefix("sim%"), (place, None))
        return found

    def branches(self, file, procedure, depth):
        """Lines of the drawing below one procedure."""
        for name, (place, follow) in self.calls(file, procedure).items():
            yield f"{'  '*depth + name:<44}{place or ''}".rstrip()
            if follow and name not in self.followed:
                self.followed.add(name)
                yield from self.branches(follow, name, depth + 1)

    def drawing(self):
        """The drawing, verb by verb."""
        for verb, phase in TIMED.findall("\n".join(self.advance.procedures["advance"])):
            yield f"{phase:<12}{verb}"
            yield from self.branches(self.advance, verb, 7)


def drawing_of_step(top):
    """The step as a block of Markdown."""
    return "\n".join(["```", *Step(top).drawing(), "```"])

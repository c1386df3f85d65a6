"""Decks: TOML tables that can be changed, checked and run."""

import math
import os
import tomllib
from collections.abc import Callable, Iterator, Mapping, MutableMapping, Sequence
from contextlib import contextmanager
from copy import deepcopy
from pathlib import Path
from threading import get_ident
from typing import TYPE_CHECKING, Any

from .errors import error_of
from .program import call

if TYPE_CHECKING:
    from .run import Run


class Deck(MutableMapping):
    """A deck from a file, or a new one. `deck["law"][0]["friction"] = 0.4` changes it in memory alone.

    A run takes the file as it stands, and values that were changed as settings over it, so that errors show the line of the file.
    Where blocks or keys came or went, a file with the whole deck stands next to it while the program runs.
    """

    def __init__(self, deck: str | Path | Mapping[str, Any]):
        """deck: a file, or a table of sections as `tomllib` reads them."""
        self.path: Path | None = None
        if isinstance(deck, Mapping):
            self._table: dict[str, Any] = deepcopy(dict(deck))
            self._original: dict[str, Any] | None = None
            return
        self.path = Path(deck)
        with open(self.path, "rb") as file:
            try:
                self._table = tomllib.load(file)
            except tomllib.TOMLDecodeError:
                # The program has the better sentence, with a caret.
                code, errors = call(["check", str(self.path)])
                if code:
                    raise error_of(errors, code) from None
                raise
        self._original = deepcopy(self._table)

    def __getitem__(self, name: str) -> Any:
        return self._table[name]

    def __setitem__(self, name: str, value: Any) -> None:
        self._table[name] = value

    def __delitem__(self, name: str) -> None:
        del self._table[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._table)

    def __len__(self) -> int:
        return len(self._table)

    def copy(self) -> "Deck":
        """A deck of its own, from the same file."""
        other = Deck(self._table)
        other.path, other._original = self.path, deepcopy(self._original)
        return other

    def toml(self) -> str:
        """The deck as text."""
        return "\n".join(_lines(self._table)) + "\n"

    def write(self, path: str | Path) -> Path:
        """Write the deck as it is now."""
        Path(path).write_text(self.toml())
        return Path(path)

    def settings(self) -> dict[str, Any] | None:
        """What was changed since the file was read, as keys of `--set`; None where settings cannot express it."""
        if self._original is None:
            return None
        return _changes(self._original, self._table, "")

    def check(self, set: Mapping[str, Any] | None = None) -> str:
        """Check the deck as `splitgrain check` does, without a run; returns what it prints."""
        lines: list[str] = []
        with self._words(Path.cwd(), set) as words:
            code, errors = call(["check", *words], progress=lines.append)
        if code:
            raise error_of(errors, code)
        return "\n".join(lines)

    def run(
        self, output: str | Path | None = None, ranks: int = 1, set: Mapping[str, Any] | None = None, restart: str | Path | None = None,
        force: bool = False, walltime: float | None = None, progress: Callable[[str], object] | bool = False,
    ) -> "Run":
        """Run the deck and return its results.

        output: folder of the results (default: NAME.results here); ranks: processes of MPI; set: settings over the deck by their keys,
        such as "law[1].friction"; restart: file or folder to go on from; force: replace results of another run; walltime [s];
        progress: True prints what the program prints, a function takes each line. Mistakes in the deck raise `DeckError`, a stop
        before the end `Stopped`, all else that ends a run early `RunError`.
        """
        from .run import Run

        folder = Path(output) if output is not None else Path(f"{self.path.stem if self.path else 'deck'}.results")
        options = ["--output", str(folder)]
        if restart is not None:
            options += ["--restart", str(restart)]
        if force:
            options += ["--force"]
        if walltime is not None:
            options += ["--walltime", f"{walltime:g}"]
        with self._words(folder.parent, set) as words:
            code, errors = call(["run", *words, *options], ranks, progress)
        if code:
            raise error_of(errors, code)
        return Run(folder)

    @contextmanager
    def _words(self, folder, set):
        """The file of the deck, and the settings over it. Relative paths of a deck count from where it lies, so that a file made
        for the program stands there, hidden and without an ending that lists of decks look for, and goes when the program has ended."""
        changed, path, made = self.settings(), self.path, None
        if changed is None:
            name = f".{self.path.stem if self.path else 'deck'}.{os.getpid()}.{get_ident()}"
            path = made = self.write((self.path.parent if self.path else folder) / name)
            changed = {}
        options = []
        for key, value in {**changed, **(set or {})}.items():
            options += ["--set", f"{key}={_value(value)}"]
        try:
            yield [str(path), *options]
        finally:
            if made is not None:
                made.unlink(missing_ok=True)


def polyhedron(vertices: Sequence[Sequence[float]], **keys: Any) -> dict[str, Any]:
    """A block [[body]] of a convex polyhedron from points, such as those of a `trimesh` mesh, and its other keys.

    The points are those of the hull about them: `sg.polyhedron(mesh.convex_hull.vertices, name="stone", position=[0.0, 0.0, 1.0])`.
    """
    return {"shape": "polyhedron", "vertices": [[float(x) for x in point] for point in vertices], **keys}


def _changes(old, new, path):
    """Settings that make one table the other; None where there are none that do."""
    settings = {}
    if old.keys() - new.keys():
        return None
    for name, value in new.items():
        before, key = old.get(name), f"{path}.{name}" if path else name
        if name in old and type(before) is type(value) and before == value:
            continue
        if isinstance(value, Mapping):
            inner = None if path or not isinstance(before, Mapping | None) else _changes(before or {}, value, key)
        elif _is_list_of_tables(value):
            inner = None if path or not _is_list_of_tables(before) or len(before) != len(value) else {}
            for number, (one, other) in enumerate(zip(before, value, strict=True), 1) if inner is not None else ():
                block = _changes(one, other, f"{key}[{number}]")
                if block is None:
                    return None
                inner |= block
        else:
            inner = {key: value}
        if inner is None:
            return None
        settings |= inner
    return settings


def _is_list_of_tables(value):
    return isinstance(value, list) and bool(value) and all(isinstance(item, Mapping) for item in value)


def _lines(table, path=()):
    """Lines of TOML: values first, then sections and blocks."""
    for name, value in table.items():
        if not isinstance(value, Mapping) and not _is_list_of_tables(value):
            yield f"{name} = {_value(value)}"
    for name, value in table.items():
        place = ".".join((*path, name))
        if isinstance(value, Mapping):
            yield from ["", f"[{place}]", *_lines(value, (*path, name))]
        elif _is_list_of_tables(value):
            for block in value:
                yield from ["", f"[[{place}]]", *_lines(block, (*path, name))]


def _value(value):
    """A value as TOML; numbers of numpy are numbers."""
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        escaped = value.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n").replace("\t", "\\t")
        return f'"{escaped}"'
    if isinstance(value, int):
        return str(value)
    if isinstance(value, float):
        return repr(value) if math.isfinite(value) else str(value)
    if isinstance(value, Sequence | range):
        return f"[{', '.join(_value(item) for item in value)}]"
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{name} = {_value(item)}" for name, item in value.items()) + "}"
    raise TypeError(f"no value of a deck: {value!r}")

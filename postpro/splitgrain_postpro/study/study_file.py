"""The text of a study file: its table, and one sentence with its line for every mistake."""

import difflib
import tomllib
from pathlib import Path
from typing import NoReturn

from ..errors import StudyError
from .toml_lines import line_of


class StudyFile:
    """A study file that is open for reading."""

    def __init__(self, path: str | Path):
        self.path = Path(path)
        try:
            self.text = self.path.read_text()
            self.table = tomllib.loads(self.text)
        except tomllib.TOMLDecodeError as error:
            sentence, _, place = str(error).partition(" (at ")
            line = int(place.split()[1].strip(",")) if place.startswith("line") else len(self.text.splitlines())
            raise StudyError(sentence[0].lower() + sentence[1:], self.path, line) from error
        except OSError as error:
            raise StudyError(f"cannot read the study: {error.strerror}", self.path) from error
        except UnicodeDecodeError as error:
            raise StudyError("the study is no text in UTF-8", self.path) from error

    def fail(self, sentence: str, section: str = "", number: int = 1, key: str = "") -> NoReturn:
        """Report what is wrong, and where."""
        line = line_of(self.text, section, number, key)
        # At the top a key may be the head of a section.
        raise StudyError(sentence, self.path, line_of(self.text, key) if line == 1 and key and not section else line)

    def check(self, table: dict, known: dict[str, tuple], section: str = "", number: int = 1) -> None:
        """Are all keys known and of their kind?"""
        where = f" of [{section}]" if section else ""
        for key, value in table.items():
            if key not in known:
                near = difflib.get_close_matches(key, known, 1)
                hint = f"; did you mean '{near[0]}'?" if near else f"; there are {', '.join(known)}"
                self.fail(f"unknown key '{key}'{where}{hint}", section, number, key)
            kinds = known[key]
            if not isinstance(value, kinds) or (isinstance(value, bool) and bool not in kinds):
                names = {str: "a text", int: "a whole number", float: "a number", bool: "true or false",
                         list: "a list", dict: "a table"}  # fmt: skip
                self.fail(f"'{key}'{where} should be {' or '.join(names[kind] for kind in kinds)}", section, number, key)

    def positive(self, key: str, default: float) -> float:
        """A number above 0."""
        value = self.table.get(key, default)
        if key in self.table and not 0 < value < 1e300:
            self.fail(f"'{key}' should be above 0", key=key)
        return value

    def table_of(self, block: dict, known: dict[str, tuple], section: str, number: int) -> None:
        """Is a block a table with known keys, and are its settings single values?"""
        if not isinstance(block, dict):
            self.fail(f"'{section}' should be written as [[{section}]]", key=section)
        self.check(block, known, section, number)
        for name in ("set", "then"):
            for key, value in block.get(name, {}).items():
                if isinstance(value, dict):
                    self.fail(f"a setting is written \"section.key\" = value, with quotes, not as the table '{key}'",
                              section, number, name)  # fmt: skip

"""Errors of the program as exceptions; their text is what the program prints, with the line of the deck and its caret."""

import re

PLACE = re.compile(r"^(?P<file>.*?):(?P<line>\d+):(?P<column>\d+): error: (?P<sentence>.*)$", re.MULTILINE)
SENTENCE = re.compile(r"\berror: (.*)")
EXIT_BAD_INPUT, EXIT_STOPPED = 2, 75


class RunError(RuntimeError):
    """A run that did not end well."""

    def __init__(self, text: str, code: int):
        super().__init__(text.strip() or f"splitgrain ended with code {code}")
        self.code = code
        """Exit code of the program: 3 not converged, 4 not finite, 5 not written, 6 energy, 7 memory, ..."""
        found = SENTENCE.search(text)
        self.sentence = found[1] if found else text.strip()
        """The error without its place"""


class DeckError(RunError):
    """A mistake in a deck, a setting or another input."""

    def __init__(self, text: str, code: int = EXIT_BAD_INPUT):
        super().__init__(text, code)
        found = PLACE.search(text)
        self.file: str | None = found["file"] if found else None
        """File of the mistake, where there is one; line and column count from 1"""
        self.line: int | None = int(found["line"]) if found else None
        self.column: int | None = int(found["column"]) if found else None


class Stopped(RunError):
    """A run that was stopped on request: it goes on with `restart`."""


def error_of(text: str, code: int) -> RunError:
    """The exception for what the program printed and its exit code."""
    kind = {EXIT_BAD_INPUT: DeckError, EXIT_STOPPED: Stopped}.get(code, RunError)
    return kind(text, code)

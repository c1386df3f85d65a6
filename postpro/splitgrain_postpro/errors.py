"""What a user can cause: one clear line, and exit code 2."""

from pathlib import Path


class ResultsError(Exception):
    """Results that are not there, or cannot be read or written."""

    code = 2


class StudyError(ResultsError):
    """A mistake in a study, with its file and line where they are known."""

    def __init__(self, sentence: str, file: Path | None = None, line: int = 0, code: int = 2):
        super().__init__(sentence)
        self.file, self.line, self.code = file, line, code

    def report(self) -> str:
        """`file:line: error: sentence`, as the program prints it."""
        place = f"{self.file}:{self.line}: " if self.file and self.line else f"{self.file}: " if self.file else ""
        return f"{place}error: {self}"


class ScriptError(ResultsError):
    """A script that cannot be read, with the line and a caret where they are known."""

    def __init__(self, sentence: str, file: Path, line: int = 0, column: int = 0, lines: list[str] | None = None):
        super().__init__(sentence)
        self.file, self.line, self.column, self.lines = file, line, column, lines or []

    def report(self, kind: str = "error") -> str:
        """`file:line:column: error: sentence`, the line and a caret, as the program prints it."""
        place = f"{self.file}:{self.line}:{self.column}:" if self.line else f"{self.file}:"
        text = f"{place} {kind}: {self}"
        if 0 < self.line <= len(self.lines):
            line = self.lines[self.line - 1]
            before = "".join("\t" if letter == "\t" else " " for letter in line[: self.column - 1])
            text += f"\n  {line}\n  {before}^"
        return text

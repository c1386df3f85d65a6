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

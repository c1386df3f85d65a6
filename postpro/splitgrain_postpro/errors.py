"""What a user can cause: one clear line, and exit code 2."""


class ResultsError(Exception):
    """Results that are not there, or cannot be read or written."""

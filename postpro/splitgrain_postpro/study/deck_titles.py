"""Titles of the decks of a study, and their purposes."""

import tomllib
from html import escape

from .model import Case, Section


def deck_section(cases: list[Case]) -> list[Section]:
    """A section of the page with the titles of the decks, each once; none where no deck has one."""
    lines = []
    for path in dict.fromkeys(case.file for case in cases if case.file.suffix == ".toml"):
        title, about = _words(path)
        if title or about:
            words = escape(about) if not title else f"<b>{escape(title)}</b>" + (f": {escape(about)}" if about else "")
            lines.append(f"<li>{escape(path.name)}: {words}</li>")
    return [("Decks", None, f"<ul>{''.join(lines)}</ul>")] if lines else []


def _words(path):
    """Title and purpose of a deck; empty where it has none, or cannot be read."""
    try:
        deck = tomllib.loads(path.read_text(encoding="utf8"))
    except (OSError, ValueError):
        return "", ""
    return [word if isinstance(word := deck.get(name), str) else "" for name in ("title", "about")]

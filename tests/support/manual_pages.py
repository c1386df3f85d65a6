"""Tables of figures, and their place in the pages of the manual."""

from pathlib import Path


def table(head, rows):
    """A table in Markdown."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(map(str, line)) + " |" for line in lines) + "\n"


def put(file, name, text):
    """Replace what is between the markers of this name in a page."""
    begin, end = (f"<!-- {name}: {side} -->" for side in ("begin", "end"))
    before, rest = Path(file).read_text().split(begin)
    Path(file).write_text(f"{before}{begin}\n\n{text}\n{end}{rest.split(end)[1]}")

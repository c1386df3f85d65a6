"""An index of studies: one page that lists the pages of all studies in a folder."""

import re
from html import unescape
from pathlib import Path

from ..errors import StudyError
from .page import link_list, page

TITLE = re.compile(r"<h1>(.*?)</h1>", re.DOTALL)
FACTS = re.compile(r'<p class="quiet">(.*?)</p>', re.DOTALL)


def write_index(folder: Path) -> str:
    """Write `index.html` into a folder of studies; returns the line to print."""
    entries = []
    for study in sorted(folder.glob("*/study.html")):
        text = study.read_text(errors="replace")
        title, facts = (unescape(found[1]) if (found := pattern.search(text)) else "" for pattern in (TITLE, FACTS))
        entries.append((f"{study.parent.name}/study.html", title or study.parent.name, facts))
    if not entries:
        raise StudyError("there is no study in this folder: none of its folders has a study.html", folder)
    count = f"{len(entries)} stud{'y' if len(entries) == 1 else 'ies'}"
    try:
        (folder / "index.html").write_text(page("Studies", "", f"{count} in {folder.resolve().name}.", [("Pages", None, link_list(entries))]))
    except OSError as error:
        raise StudyError(f"cannot write {folder / 'index.html'}: {error.strerror}", code=5) from error
    return f"wrote {folder / 'index.html'}: {count}"

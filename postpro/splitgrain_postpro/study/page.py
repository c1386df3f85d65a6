"""One HTML page with everything in it: it opens without a network, and can be read without its script."""

from collections.abc import Iterable, Sequence
from html import escape
from urllib.parse import quote

from .model import Section
from .svg import SCRIPT

# Parts beyond which a page has a list of them.
FEW = 3
STYLE = """
:root { color-scheme: light; }
body { font: 16px/1.5 system-ui, "Liberation Sans", Arial, sans-serif; color: #1c1c1c; background: #fff; margin: 0 auto; max-width: 76rem;
       padding: 1rem clamp(.8rem, 3vw, 2.5rem); overflow-wrap: break-word; }
h1 { font-size: 1.6rem; line-height: 1.2; margin: .4rem 0; } h2 { font-size: 1.2rem; margin: 2rem 0 .5rem; }
p { max-width: 46rem; } .quiet { color: #555; font-size: .875rem; }
.figures { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 22rem), 1fr)); gap: .8rem; }
figure { margin: 0; max-width: 34rem; } img { width: 100%; height: auto; display: block; }
.wide { overflow-x: auto; max-height: 32rem; border: 1px solid #ddd; }
label { display: inline-block; margin-right: .6rem; }
table { border-collapse: collapse; font-size: .875rem; font-variant-numeric: tabular-nums; white-space: nowrap; }
th, td { padding: .2rem .6rem; text-align: right; border-bottom: 1px solid #eee; }
th { background: #f3f5f7; position: sticky; top: 0; } .words { text-align: left; }
nav a { margin-right: 1rem; } svg { display: block; }
details { border-top: 1px solid #ddd; padding: .4rem 0; } summary { cursor: pointer; font-weight: 600; padding: .25rem 0; }
"""


def page(title: str, about: str, facts: str, sections: list[Section]) -> str:
    """The page: `sections` are (heading, is it open?, content in HTML); None for those that do not fold."""
    body = [f"<h1>{escape(title)}</h1>"]
    body += [f"<p>{escape(part)}</p>" for part in about.strip().split("\n\n") if part]
    body.append(f'<p class="quiet">{escape(facts)}</p>')
    if len(sections) > FEW:
        body.append(f"<nav>{' '.join(_link(number, heading) for number, (heading, *_) in enumerate(sections, 1))}</nav>")
    for number, (heading, is_open, content) in enumerate(sections, 1):
        if is_open is None:
            body.append(f'<h2 id="part{number}">{escape(heading)}</h2>\n{content}')
        else:
            body.append(f'<details id="part{number}"{" open" if is_open else ""}><summary>{escape(heading)}</summary>\n{content}</details>')
    if any(mark in part for part in body for mark in ("-entry", "data-series")):
        body.append(SCRIPT)
    return (
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n<link rel="icon" href="data:,">\n'
        f"<title>{escape(title)}</title>\n<style>{STYLE}</style></head>\n<body>\n" + "\n".join(body) + "\n</body></html>\n"
    )


def _link(number, heading):
    """A link to a part of the page."""
    return f'<a href="#part{number}">{escape(heading)}</a>'


def link_list(entries: Iterable[tuple[str, str, str]]) -> str:
    """A list of links: each an address relative to the page, its title, and a sentence."""
    lines = (f'<li><a href="{quote(address)}">{escape(title)}</a> <span class="quiet">{escape(sentence)}</span></li>'
             for address, title, sentence in entries)
    return f"<ul>{''.join(lines)}</ul>"


def pictures(items: Iterable[str]) -> str:
    """Figures side by side as far as there is room."""
    return f'<div class="figures">{"".join(items)}</div>'


def table(names: Sequence[str], rows: Sequence[Sequence]) -> str:
    """A table that scrolls by itself."""
    kinds = [words(cell) for cell in rows[0]] if rows else [""] * len(names)
    head = "".join(f"<th{kind}>{escape(str(name))}</th>" for name, kind in zip(names, kinds, strict=True))
    lines = ["".join(f"<td{words(cell)}>{escape(shown(cell))}</td>" for cell in row) for row in rows]
    return (f'<div class="wide" tabindex="0"><table><thead><tr>{head}</tr></thead><tbody>'
            + "".join(f"<tr>{line}</tr>" for line in lines) + "</tbody></table></div>")


def words(cell: object) -> str:
    """Texts stand at the left."""
    return ' class="words"' if isinstance(cell, str) else ""


def shown(cell: object) -> str:
    """A cell as text: numbers in three digits, nothing for what is not known."""
    if cell is None:
        return ""
    return f"{cell:.3g}" if isinstance(cell, float) else str(cell)

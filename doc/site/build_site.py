#!/usr/bin/env python3
"""The pages of this project as one offline site that can be searched, with the APIs in Fortran and Python; dead links are errors.

usage: build_site.py FOLDER [--without-fortran] (mkdocs-material, latex2mathml and ford from PyPI: `./start docs`)
"""

import ast
import os
import re
import shutil
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urldefrag

TOP = Path(__file__).resolve().parents[2]
CONFIG = """site_name: SplitGrain
site_url: ""
use_directory_urls: false
docs_dir: {folder}/pages
site_dir: {folder}/site
theme: {{name: material, font: false, features: [navigation.sections, search.highlight]}}
plugins: [search, offline]
hooks: [{hook}]
markdown_extensions:
  - tables
  - fenced_code
  - attr_list
  - toc: {{slugify: !!python/object/apply:pymdownx.slugs.slugify {{kwds: {{case: lower}}}}}}
validation: {{links: {{not_found: warn, anchors: warn, unrecognized_links: warn}}}}
"""
FORD = """project: SplitGrain
src_dir: {top}/src
         {top}/drivers
output_dir: {folder}/site/fortran
graph: false
search: false
preprocess: false
warn: false
max_frontpage_items: 20
"""


def write_pages(pages, has_fortran):
    """README, guides, theory, reference and decks, with links between them as the site has them."""
    shutil.copytree(TOP / "doc", pages, ignore=shutil.ignore_patterns("site"))
    # A changed deck that Python runs stands hidden beside its deck for as long.
    shutil.copytree(TOP / "input_decks", pages / "input_decks", ignore=shutil.ignore_patterns(".*"))
    for name in ("LICENSE", "CHANGELOG.md"):
        shutil.copy(TOP / name, pages)
    text = (TOP / "README.md").read_text()
    (pages / "index.md").write_text(re.sub(r'(\]\(|src=")doc/', r"\1", text))
    for page in (pages / "guide").glob("*.md"):
        page.write_text(page.read_text().replace("](../../input_decks", "](../input_decks").replace("](../../README.md", "](../index.md"))
    decks = pages / "input_decks/README.md"
    decks.write_text(re.sub(r'(\]\(|src=")\.\./doc/', r"\1../", decks.read_text()).replace("](../README.md", "](../index.md"))
    if (pages.parent / "gallery").is_dir():
        shutil.copytree(pages.parent / "gallery", pages / "gallery")
    (pages / "gallery.md").write_text(gallery(pages))
    (pages / "python_api.md").write_text(python_api())
    if has_fortran:
        text = '# Fortran API\n\n<a href="fortran/index.html">Modules, types and procedures of the sources</a>, made by FORD.\n'
        (pages / "fortran_api.md").write_text(text)


def gallery(pages):
    """All decks with a picture of their start, as far as one was drawn, and their first sentence; then the pictures of the other pages."""
    lines = ["# Gallery", "", "## Decks", "", "[All decks](input_decks/README.md), with their times and what to expect of them.", "",
             "| start | deck |", "| --- | --- |"]
    for deck in sorted((pages / "input_decks").rglob("*.toml")):
        comment = []
        for line in deck.read_text().splitlines():
            if not line.startswith("#"):
                break
            comment.append(line.lstrip("# "))
        name = deck.relative_to(pages)
        picture = (Path("gallery") / name.relative_to("input_decks")).with_suffix(".png")
        shown = f"![Start of {deck.stem}]({picture}){{ loading=lazy style='min-width:11rem' }}" if (pages / picture).exists() else ""
        lines.append(f"| {shown} | [{name.relative_to('input_decks')}]({name})<br>{' '.join(comment).replace('|', '/')} |")
    lines += ["", "## Pictures of other pages", ""]
    for picture in sorted([*(TOP / "doc/images").glob("*.png"), *(TOP / "doc/images").glob("*.webp")]):
        lines += [f"![{picture.stem.replace('_', ' ')}](images/{picture.name}){{ loading=lazy }}", ""]
    return "\n".join(lines) + "\n"


def python_api():
    """Classes and functions of the package `splitgrain` from their docstrings."""
    lines = ["# Python API", ""]
    for path in sorted((TOP / "postpro/splitgrain").glob("*.py")):
        tree = ast.parse(path.read_text())
        lines += [f"## splitgrain.{path.stem}" if path.stem != "__init__" else "## splitgrain", "", *_document(tree)]
        for node in tree.body:
            if isinstance(node, ast.ClassDef | ast.FunctionDef) and not node.name.startswith("_"):
                lines += _entry(node, "###")
                for part in node.body if isinstance(node, ast.ClassDef) else []:
                    if isinstance(part, ast.FunctionDef) and not part.name.startswith("_") or getattr(part, "name", "") == "__init__":
                        lines += _entry(part, "####")
    return "\n".join(lines) + "\n"


def _entry(node, level):
    """Heading, signature and docstring of a class or function."""
    if isinstance(node, ast.ClassDef):
        return [f"{level} class {node.name}", "", *_document(node)]
    result = f" -> {ast.unparse(node.returns)}" if node.returns else ""
    return [f"{level} {node.name}", "", "```python", f"{node.name}({ast.unparse(node.args)}){result}", "```", "", *_document(node)]


def _document(node):
    """A docstring as text; what is indented stays code."""
    text = ast.get_docstring(node) or ""
    return [text, ""] if text else []


def make_offline(site):
    """Scripts that pages would fetch from elsewhere: that of the search is one of ours, the others are for old browsers or are there twice."""
    shutil.copy(Path(__file__).with_name("frame_worker.js"), site / "assets")
    for path in site.rglob("*.html"):
        text = path.read_text(errors="replace")
        ours = f'"{os.path.relpath(site / "assets/frame_worker.js", path.parent)}"'
        offline = re.sub(r'<script src="https?://[^"]*"></script>\s*', "", text.replace('"https://unpkg.com/iframe-worker/shim"', ours))
        if offline != text:
            path.write_text(offline)


class Links(HTMLParser):
    """Targets of a page, and the anchors that it has."""

    def __init__(self, text):
        super().__init__()
        self.targets, self.anchors = [], {""}
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        values = dict(attrs)
        self.anchors |= {values[name] for name in ("id", "name") if values.get(name)}
        target = values.get("href" if tag in ("a", "link") else "src")
        if target:
            self.targets.append(target)


def dead_links(site):
    """Links of all pages that lead nowhere within the site, and all that lead out of it for what a page shows."""
    pages = {path: Links(path.read_text(errors="replace")) for path in site.rglob("*.html") if "fortran" not in path.parts}
    found = []
    for path, page in pages.items():
        for target in page.targets:
            if re.match(r"(https?|mailto|data|javascript):", target) or path.name == "404.html":
                continue
            name, anchor = urldefrag(target)
            to = (path.parent / unquote(name)).resolve() if name else path
            if not to.exists():
                found.append(f"{path.relative_to(site)}: {target}")
            elif anchor and to in pages and unquote(anchor) not in pages[to].anchors:
                found.append(f"{path.relative_to(site)}: {target} has no such heading")
    return found, len(pages)


def main(folder, *words):
    """Build the site below a folder; the exit code is 1 where links are dead."""
    for name in ("pages", "site"):
        shutil.rmtree(folder / name, ignore_errors=True)
    folder.mkdir(parents=True, exist_ok=True)
    has_fortran = "--without-fortran" not in words
    write_pages(folder / "pages", has_fortran)
    (folder / "mkdocs.yml").write_text(CONFIG.format(folder=folder, hook=Path(__file__).with_name("formulas.py")))
    tools = Path(sys.executable).parent
    subprocess.run([tools / "mkdocs", "build", "--quiet", "-f", folder / "mkdocs.yml"], check=True,
                   env={**os.environ, "NO_MKDOCS_2_WARNING": "1"})
    if has_fortran:
        (folder / "ford.md").write_text(FORD.format(top=TOP, folder=folder))
        subprocess.run([tools / "ford", "--quiet", folder / "ford.md"], check=True)
    make_offline(folder / "site")
    dead, count = dead_links(folder / "site")
    for line in dead:
        print(f"dead link: {line}")
    print(f"{count} pages in {folder / 'site/index.html'}, {len(dead)} dead links")
    return 1 if dead else 0


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    sys.exit(main(Path(sys.argv[1]).resolve(), *sys.argv[2:]))

"""Formulas between dollars as MathML, which browsers show without scripts: a hook of mkdocs."""

import re

from latex2mathml.converter import convert

CODE = re.compile(r"(```.*?```|`[^`\n]*`)", re.DOTALL)
FORMULA = re.compile(r"\$\$(?P<block>.+?)\$\$|(?<![\w$\\])\$(?P<inline>[^$\n]+(?:\n[^$\n]+)*?)\$(?![\w$])", re.DOTALL)


def on_page_markdown(markdown, page, **_):
    """Take the formulas out of a page, so that they are no Markdown."""
    page.meta["formulas"] = formulas = []

    def taken(match):
        is_block = match["block"] is not None
        text = convert(match["block"] if is_block else match["inline"], display="block" if is_block else "inline")
        # A long one scrolls by itself.
        formulas.append(f'<span style="display:block;overflow-x:auto">{text}</span>' if is_block else text)
        return f"FORMULA{len(formulas) - 1}END"

    parts = CODE.split(markdown)
    return "".join(part if k % 2 else FORMULA.sub(taken, part) for k, part in enumerate(parts))


def on_page_content(html, page, **_):
    """Put them back."""
    return re.sub(r"FORMULA(\d+)END", lambda match: page.meta["formulas"][int(match[1])], html)

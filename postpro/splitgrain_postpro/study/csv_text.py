"""Rows of CSV files that spreadsheets open as text and numbers, never as formulas."""

import csv
import io
from collections.abc import Iterable

FORMULA = ("=", "+", "-", "@", "\t", "\r")
"""How a cell begins that a spreadsheet may compute"""


def csv_text(rows: Iterable[Iterable]) -> str:
    """Rows as the text of a CSV file. A text that begins like a formula gets an apostrophe before it; numbers stay numbers."""
    text = io.StringIO()
    csv.writer(text).writerows([_cell(cell) for cell in row] for row in rows)
    return text.getvalue()


def _cell(cell):
    """One cell."""
    if cell is None:
        return ""
    return f"'{cell}" if isinstance(cell, str) and cell.startswith(FORMULA) else cell

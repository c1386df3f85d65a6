"""Figures as SVG within a page: each line is one series, which a click on its entry in a legend shows and hides in all figures."""

import io
import re
from html import escape

import matplotlib
from matplotlib.figure import Figure
from matplotlib.legend import Legend

# What may reach out of a figure [inch].
EDGE = 0.02
# A click, or the enter key, on an entry of a legend, or a box of its own, shows and hides a series in all figures.
SCRIPT = """<script>
const show = (series, shown) => {
  for (const part of document.querySelectorAll(`g[id$="-series${series}"]`)) part.style.display = shown ? "" : "none";
  for (const part of document.querySelectorAll(`g[id$="-entry${series}"]`)) part.style.opacity = shown ? "" : 0.3;
  for (const box of document.querySelectorAll(`input[data-series="${series}"]`)) box.checked = shown;
};
for (const part of document.querySelectorAll('g[id*="-entry"]')) {
  const series = part.id.split("-entry")[1];
  const turn = () => show(series, part.style.opacity !== "");
  part.style.cursor = "pointer";
  part.style.pointerEvents = "bounding-box";
  part.setAttribute("tabindex", 0);
  part.setAttribute("role", "button");
  part.addEventListener("click", turn);
  part.addEventListener("keydown", event => { if (event.key === "Enter") turn(); });
}
for (const box of document.querySelectorAll("input[data-series]")) box.onchange = () => show(box.dataset.series, box.checked);
</script>"""


def embedded(figure: Figure, number: int, words: str, series: list[str] | None = None) -> str:
    """A figure of a page, with its number on the page. `series` lists the names of lines on all figures, and grows by those met here;
    without it the parts of the figure keep the marks that they have."""
    if series is not None:
        _mark(figure, series)
    text = io.StringIO()
    with matplotlib.rc_context({"svg.hashsalt": f"{number}"}):
        figure.savefig(text, format="svg", metadata={"Date": None})
    svg = text.getvalue()
    svg = svg[svg.index("<svg") :]
    # A page needs neither comments nor the addresses of name spaces.
    svg = re.sub(r"<!--.*?-->\s*|<metadata>.*?</metadata>\s*| xmlns(:\w+)?=\"[^\"]*\"", "", svg, flags=re.DOTALL)
    # Names within one figure must not meet those of the next.
    svg = re.sub(r' id="|xlink:href="#|url\(#', lambda found: f"{found[0].replace('xlink:', '')}figure{number}-", svg)
    start = f'<svg role="img" aria-label="{escape(words, quote=True)}" style="width:100%;height:auto" '
    return f"<figure>{svg.replace('<svg ', start, 1)}</figure>"


def _mark(figure, series):
    """Mark lines that have a label, those of the same colour behind them, and the entries of legends."""
    for axes in figure.axes:
        before = None
        for line in axes.get_lines():
            label = line.get_label()
            if line.get_gid():
                continue
            if not label.startswith("_"):
                before = (_number(label, series), line.get_color())
            if before and line.get_color() == before[1]:
                line.set_gid(f"series{before[0]}")
    for legend in _legends(figure):
        for handle, text in zip(_handles(legend), legend.get_texts(), strict=True):
            for part in (handle, text):
                part.set_gid(f"entry{_number(text.get_text(), series)}")


def _legends(figure) -> list[Legend]:
    """Legends of a figure and of its panels."""
    return [*figure.legends, *(legend for axes in figure.axes if (legend := axes.get_legend()) is not None)]


def _handles(legend):
    """Marks of a legend: Matplotlib 3.7 has another name for them."""
    return legend.legend_handles if hasattr(legend, "legend_handles") else legend.legendHandles


def _number(label, series):
    """Number of a series on the page: a label without its order, which differs from figure to figure."""
    name = label.partition(", order ")[0]
    if name not in series:
        series.append(name)
    return series.index(name)


def is_cut_off(figure: Figure) -> bool:
    """Does anything of a figure reach out of it?"""
    figure.draw_without_rendering()
    box, (width, height) = figure.get_tightbbox(), figure.get_size_inches()
    return box.x0 < -EDGE or box.y0 < -EDGE or box.x1 > width + EDGE or box.y1 > height + EDGE

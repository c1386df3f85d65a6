"""The pages that the commands write."""

from dataclasses import replace

from matplotlib.figure import Figure

from . import plots, traces
from .errors import ResultsError
from .quantities import need_quantity, relative_to
from .results import Results
from .scene import draw_scene, draw_split, proportions
from .space import View
from .style import new_figure, say_nothing_there
from .text import headline

# A scene this many times as wide as high goes over the curves rather than beside them.
WIDE = 1.9


def scene_figure(
    results: Results, picture: int = -1, quantity: str = "speed", view: View | None = None, body: str | None = None,
) -> tuple[Figure, list[str]]:
    """The scene alone; its page has the proportions of the scene. body: displacement and speed are relative to it."""
    scene = results.scene(picture)
    need_quantity(scene, quantity)
    if body is not None:
        scene = relative_to(scene, results.number_of_body(body))
    figure, ax = _page_of(scene, results, view)
    missing = draw_scene(ax, scene, quantity, results.periods, view)
    return figure, missing


def thrust_figure(results: Results, picture: int = -1, view: View | None = None) -> tuple[Figure, list[str]]:
    """The thrust lines of a scene over its bodies."""
    scene = results.scene(picture)
    if scene.contacts is None or scene.bodies is None:
        raise ResultsError(f"{results.folder} has no pictures of bodies and contacts: set output.every in the deck")
    view = replace(view or View(), thrust=True)
    figure, ax = _page_of(scene, results, view)
    return figure, draw_scene(ax, scene, "none", results.periods, view)


def split_figure(results: Results, picture: int = -1, view: View | None = None) -> tuple[Figure, list[str]]:
    """The scene by ranks; its page has the proportions of the scene."""
    scene = results.scene(picture)
    figure, ax = _page_of(scene, results, view)
    return figure, draw_split(ax, scene, results.periods, view)


def _page_of(scene, results, view):
    """As large a page whatever the proportions of the scene, with room for the scale at its right."""
    ratio = proportions(scene, results.periods, view)
    figure = new_figure(7 * ratio**0.5 + 1.4, 7 / ratio**0.5 + 1)
    figure.suptitle(results.name)
    return figure, figure.add_subplot()


def energy_figure(results: Results) -> tuple[Figure, list[str]]:
    """Energies, and how far their balance is from closing."""
    _need_record(results)
    figure = new_figure(8, 7)
    upper, lower = figure.subplots(2, 1, height_ratios=[2, 1])
    plots.draw_energies(upper, results.record, results.is_in_space)
    plots.draw_closure(lower, results.record)
    figure.suptitle(results.name)
    return figure, []


def solver_figure(results: Results) -> tuple[Figure, list[str]]:
    """What the solver did: sweeps, contacts, residuals, cost by phase."""
    _need_record(results)
    figure = new_figure(11, 7.5)
    panels = figure.subplots(2, 2)
    plots.draw_sweeps(panels[0, 0], results.record)
    plots.draw_contacts(panels[0, 1], results.record)
    plots.draw_residuals(panels[1, 0], results.record)
    plots.draw_phases(panels[1, 1], results.record)
    figure.suptitle(results.name)
    return figure, []


def trace_figure(results: Results) -> tuple[Figure, list[str]]:
    """Errors against CPU time and against contact updates within traced steps, and what these steps cost."""
    points, steps = results.trace
    if not points or not len(points["step"]):
        raise ResultsError(f"{results.folder} has no traces: set [report] trace = true in the deck")
    figure = new_figure(11, 7.5)
    panels = figure.subplots(2, 2)
    traces.draw_history(panels[0, 0], points, "e1", "cpu_seconds")
    traces.draw_history(panels[0, 1], points, "e8", "cpu_seconds")
    traces.draw_history(panels[1, 0], points, "e1", "contact_updates")
    traces.draw_costs(panels[1, 1], steps)
    figure.suptitle(results.name)
    return figure, []


def summary_figure(results: Results, picture: int = -1) -> tuple[Figure, list[str]]:
    """One page: the scene with its force chains, energies, effort, residuals, error against cost."""
    scene = results.scene(picture) if len(results.picture_times) else None
    figure = new_figure(15, 8.4)
    if scene is not None and proportions(scene, results.periods) > WIDE:
        place, rest = figure.subfigures(2, 1, height_ratios=[1.25, 1], hspace=0.02)
        panels = rest.subplots(1, 4)
    else:
        place, rest = figure.subfigures(1, 2, width_ratios=[1.05, 1.2], wspace=0.02)
        panels = rest.subplots(2, 2).ravel()
    plots.draw_energies(panels[0], results.record, results.is_in_space)
    plots.draw_effort(panels[1], results.record)
    plots.draw_residuals(panels[2], results.record)
    plots.draw_residuals(panels[3], results.record, against="cpu")
    missing = [] if results.record else ["no record.csv"]
    ax = place.subplots()
    if scene is None:
        say_nothing_there(ax, "no pictures (bodies, shapes, contacts.vtkhdf):\nset [output] every in the deck")
        missing.append("no pictures")
    else:
        missing += draw_scene(ax, scene, "speed", results.periods)
    figure.suptitle(headline(results), x=0.01, ha="left")
    return figure, missing


def _need_record(results):
    """These pages are made of the record alone."""
    if not results.record or not len(next(iter(results.record.values()))):
        raise ResultsError(f"{results.folder} has no row in record.csv to draw")


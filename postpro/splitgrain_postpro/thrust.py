"""Resultants between pairs of bodies in a picture, their centres of pressure, and the thrust lines that lead through them."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection

from .quantities import carrying, forces_of, links, rows_of
from .results import Scene
from .style import BLACK, VERMILION, number


@dataclass
class Resultants:
    """What the contacts of each pair of bodies in a picture amount to; one row per pair."""

    bodies: np.ndarray
    """Rows of the two bodies among those of the picture"""
    force: np.ndarray
    """Force on the first body [N]"""
    centre: np.ndarray
    """Centre of pressure: mean of the points, weighted by their normal forces [m]"""
    ends: np.ndarray
    """Where a line of force begins and ends: at the centres of both bodies, at a wall at the centre of pressure [m]"""


def resultants(scene: Scene) -> Resultants:
    """The resultants of all pairs whose contacts carry force, without links."""
    contacts = scene.contacts
    carries = carrying(contacts)
    carries[links(contacts)[0]] = False
    cells = np.flatnonzero(carries)
    data = contacts.cell_data
    pairs, first, own = np.unique(np.column_stack([data["candidate"], data["antagonist"]])[cells], axis=0,
                                  return_index=True, return_inverse=True)
    own = np.ravel(own)
    force, pressure, moment = np.zeros((len(pairs), 3)), np.zeros(len(pairs)), np.zeros((len(pairs), 3))
    weight = np.abs(np.asarray(data["force_normal"], dtype=float)[cells])
    np.add.at(force, own, forces_of(contacts)[cells])
    np.add.at(pressure, own, weight)
    np.add.at(moment, own, weight[:, None] * np.asarray(data["point"], dtype=float)[cells])
    centre = moment / pressure[:, None]
    places = np.add.outer(np.asarray(contacts.offsets)[cells[first]], [0, 1])
    ends = np.array(contacts.points[contacts.connectivity[places]], dtype=float)
    rows = rows_of(scene.bodies.point_data["id"], pairs.ravel()).reshape(-1, 2)
    is_grain = np.asarray(scene.bodies.point_data["is_grain"])[rows] > 0
    ends[~is_grain] = np.repeat(centre[:, None], 2, axis=1)[~is_grain]
    return Resultants(rows, force, centre, ends)


def lines_of_force(found: Resultants) -> np.ndarray:
    """From the centre of the first body through the centre of pressure to that of the second one, shape (pairs, 3, 3) [m]."""
    return np.stack([found.ends[:, 0], found.centre, found.ends[:, 1]], axis=1)


def thrust_lines(scene: Scene, found: Resultants) -> tuple[np.ndarray, np.ndarray]:
    """Lines through the centres of pressure within the bodies, shape (lines, 2, 3) [m], and the force along each [N].

    In a body with two joints the line leads from one to the other; in one with another number from each to the centre of mass.
    """
    data = scene.bodies.point_data
    size = np.linalg.norm(found.force, axis=1)
    own, pair = found.bodies.T.ravel(), np.tile(np.arange(len(size)), 2)
    order = np.argsort(own, kind="stable")
    lines, forces = [], []
    for group in np.split(order, np.flatnonzero(np.diff(own[order])) + 1) if len(order) else []:
        body, joints = own[group[0]], np.sort(pair[group])
        if not data["is_grain"][body] > 0:
            continue
        if len(joints) == 2:
            lines.append(found.centre[joints])
            forces.append(size[joints].mean())
        else:
            lines += [np.array([found.centre[joint], scene.bodies.points[body]]) for joint in joints]
            forces += list(size[joints])
    return np.array(lines).reshape(-1, 2, 3), np.array(forces)


def draw_thrust(ax: Axes, scene: Scene, show: Callable[[np.ndarray], np.ndarray], straight: Callable[[np.ndarray], np.ndarray]) -> None:
    """Draw the thrust lines and the centres of pressure; `show` brings points onto the page, `straight` a line to near images."""
    found = resultants(scene)
    lines, forces = thrust_lines(scene, found)
    if not len(lines):
        say_no_force(ax)
        return
    thick = forces.max()
    lines = [show(straight(line)) for line in lines]
    ax.add_collection(LineCollection(lines, linewidths=0.8 + 2.2 * forces / thick, colors=VERMILION, capstyle="round", zorder=5),
                      autolim=False)
    ax.scatter(*show(found.centre).T, s=9, c=BLACK, linewidths=0, zorder=6)
    ax.text(0.01, 0.99, f"dots: centres of pressure; thickest line: {number(thick)} N", transform=ax.transAxes, va="top", fontsize=8)


def say_no_force(ax: Axes) -> None:
    """A note where a picture has no force to draw."""
    ax.text(0.01, 0.99, "no contact carries force", transform=ax.transAxes, va="top", fontsize=8)

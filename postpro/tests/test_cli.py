"""The commands write pages of the expected size, whatever part of the results is there."""

import json
import struct

import h5py
import numpy as np
import pytest
from matplotlib.collections import LineCollection, PolyCollection
from sample_results import CORNERS, write_record, write_results, write_traces

from splitgrain_postpro import Results, ResultsError
from splitgrain_postpro.cli import main
from splitgrain_postpro.quantities import of_bodies
from splitgrain_postpro.results import LAYERS
from splitgrain_postpro.scene import QUANTITIES, draw_scene, draw_split
from splitgrain_postpro.space import View
from splitgrain_postpro.style import new_figure
from splitgrain_postpro.traces import draw_costs, draw_history
from splitgrain_postpro.tracks import regions_figure, tracks_figure, walls_figure


@pytest.fixture
def folder(tmp_path):
    return write_results(tmp_path / "run", columns=6, rows=4)


def size_of(path):
    """Width and height of a PNG [pixels]."""
    head = path.read_bytes()[:24]
    assert head[:8] == b"\x89PNG\r\n\x1a\n"
    return struct.unpack(">II", head[16:])


def drawn(results, quantity="speed", picture=-1):
    """Axes with one picture of a run, and what was missing."""
    ax = new_figure(6, 6).add_subplot()
    missing = draw_scene(ax, results.scene(picture), quantity, results.periods)
    return ax, missing


def grains_of(ax):
    """The collection of grains: it comes after that of the walls."""
    return [c for c in ax.collections if isinstance(c, PolyCollection)][1]


def chains_of(ax):
    """The collections of lines that hold force chains: those with a width a line."""
    return [c for c in ax.collections if isinstance(c, LineCollection) and len(c.get_linewidth()) > 1]


@pytest.mark.parametrize("command, size", [("summary", (2250, 1260)), ("energy", (1200, 1050)), ("solver", (1650, 1125))])
def test_pages_have_their_size(folder, capsys, command, size):
    """The summary also prints what it saves."""
    assert main([command, str(folder)]) == 0
    path = folder / f"{command}.png"
    assert size_of(path) == size and path.stat().st_size > 30_000
    printed = capsys.readouterr().out
    assert "wrote" in printed
    if command == "summary":
        assert (folder / "summary.txt").read_text() in printed and "CPU time" in printed


def test_traces(folder, capsys, unarranged):
    assert main(["trace", str(folder)]) == 2
    assert "has no traces: set [report] trace = true" in capsys.readouterr().err
    write_traces(folder)
    assert main(["trace", str(folder)]) == 0
    assert size_of(folder / "trace.png") == (1650, 1125)
    points, steps = Results(folder).trace
    left, right = new_figure(8, 4).subplots(1, 2)
    draw_history(left, points, "e1", "cpu_seconds")
    # Step 30 met no contact: it has no point.
    assert [line.get_label() for line in left.lines] == ["step 10", "step 20"]
    assert np.allclose(left.lines[1].get_ydata(), [1e-1, 1e-2, 1e-3]) and np.allclose(left.lines[0].get_xdata(), [0, 1e-3, 2e-3])
    draw_costs(right, steps)
    tops = {patch.get_x(): patch.get_y() + patch.get_height() for patch in right.patches}
    assert np.allclose(list(tops.values()), 1e3 * steps["cpu_seconds"])


def test_tracks(folder, capsys, unarranged):
    assert main(["tracks", str(folder)]) == 2
    assert 'set [[track]] body = "NAME" in the deck' in capsys.readouterr().err
    header = "step,time,body,x,force_x,force_y,mean_force_x,mean_force_y,mean_torque,contact_work,displacement,contacts\n"
    rows = [f"{step},{step}e-3,{body},1,2,{step},4,5,6,7,8,2\n" for step in (1, 2, 3) for body in range(10)]
    (folder / "tracks.csv").write_text(header + "".join(rows))
    assert main(["tracks", str(folder)]) == 0
    assert size_of(folder / "tracks.png") == (1650, 1110)
    assert "2 bodies are not drawn: --body PATTERN chooses" in capsys.readouterr().err
    assert main(["tracks", str(folder), "--body", "[13]", "--columns", "force_y"]) == 0
    assert size_of(folder / "tracks.png") == (825, 555)
    assert main(["tracks", str(folder), "--columns", "force_z"]) == 2
    assert "tracks.csv has no column force_z" in capsys.readouterr().err
    assert main(["tracks", str(folder), "--body", "wall"]) == 2
    assert "no tracked body matches wall" in capsys.readouterr().err
    figure, _ = tracks_figure(Results(folder), "3", ["force_y"])
    assert figure.axes[0].lines[0].get_ydata().tolist() == [1, 2, 3]


def test_regions(folder, capsys, unarranged):
    assert main(["regions", str(folder)]) == 2
    assert "set [[region]] box = [...] in the deck" in capsys.readouterr().err
    header = "step,time,stage,region,grains,single_contacts,double_contacts,compactness,coordination,mean_velocity,max_velocity\n"
    rows = [f"{step},{step}e-3,1,below.{place},30,{step},9,0.6,4,1,{place}\n" for step in (1, 2, 3) for place in range(10)]
    (folder / "regions.csv").write_text(header + "".join(rows))
    assert main(["regions", str(folder)]) == 0
    assert size_of(folder / "regions.png") == (1650, 1665)
    assert "2 regions are not drawn: --region PATTERN chooses" in capsys.readouterr().err
    assert main(["regions", str(folder), "--columns", "pressure"]) == 2
    assert "regions.csv has no column pressure" in capsys.readouterr().err
    assert main(["regions", str(folder), "--region", "above"]) == 2
    assert "no region matches above; there are below.0, " in capsys.readouterr().err
    run = json.loads((folder / "run.json").read_text())
    (folder / "run.json").write_text(json.dumps(run | {"stages": [{"start_time": 0.0}, {"start_time": 2e-3}]}))
    figure, _ = regions_figure(Results(folder), "below.[34]")
    contacts, speeds = figure.axes[3], figure.axes[4]
    assert [line.get_label() for line in contacts.lines[:2]] == ["below.3, single", "below.3, double"]
    assert contacts.lines[0].get_ydata().tolist() == [1, 2, 3] and contacts.lines[0].get_linestyle() == "-"
    assert [line.get_label() for line in speeds.lines[:4]] == [f"below.{place}, {word}" for place in (3, 4) for word in ("mean", "max")]
    # The last line of a panel is where the second stage begins.
    assert all(list(ax.lines[-1].get_xdata()) == [2e-3, 2e-3] for ax in figure.axes)


def test_walls(folder, capsys, unarranged):
    assert main(["walls", str(folder)]) == 2
    assert "has no walls.csv" in capsys.readouterr().err
    header = "step,time,wall,x,y,force_x,mean_force_x,mean_force_y,pressure,mean_pressure,area,contacts\n"
    rows = [f"{step},{step}e-3,box.{wall},1,2,3,4,5,{step},{step},8,2\n" for step in (1, 2, 3) for wall in range(10)]
    (folder / "walls.csv").write_text(header + "".join(rows))
    assert main(["walls", str(folder)]) == 0
    assert size_of(folder / "walls.png") == (1650, 1110)
    assert "2 walls are not drawn: --wall PATTERN chooses" in capsys.readouterr().err
    assert main(["walls", str(folder), "--wall", "lid"]) == 2
    assert "no wall matches lid" in capsys.readouterr().err
    figure, _ = walls_figure(Results(folder), "box.3")
    assert figure.axes[0].lines[0].get_ydata().tolist() == [1, 2, 3]


def test_field(folder, capsys, unarranged):
    assert main(["field", str(folder)]) == 2
    assert "has no field_1.vtkhdf: set [[field]] in the deck" in capsys.readouterr().err
    with h5py.File(folder / "field_1.vtkhdf", "w") as file:
        root = file.create_group("VTKHDF")
        root.attrs.update({"Origin": [0.0, 0.0, 0.0], "Spacing": [0.5, 0.25, 1.0]})
        root.create_group("Steps").attrs["NSteps"] = 2
        root["Steps/Values"], file["step"] = [0.1, 0.2, 0.3], [10, 20, 30]
        for name, n in (("density", 1), ("solid_fraction", 1), ("velocity", 3), ("stress", 9), ("velocity_gradient", 9)):
            values = np.arange(3 * 1 * 5 * 4 * n, dtype=float).reshape(3, 1, 5, 4, n)
            root.create_dataset(f"CellData/{name}", data=values[..., 0] if n == 1 else values)
    field = Results(folder).field()
    assert field.cells == (4, 5, 1) and field.volume == 0.125 and field["velocity"].shape == (2, 4, 5, 1, 3)
    assert field["density"][1, 3, 0, 0] == 23 and field.centres(1).tolist() == [0.125, 0.375, 0.625, 0.875, 1.125]
    assert main(["field", str(folder), "--at", "15"]) == 0
    assert size_of(folder / "field.png")[0] == 1650
    assert main(["field", str(folder), "--at", "5"]) == 2
    assert "no grid up to step 5: the first is of step 10" in capsys.readouterr().err
    with pytest.raises(ResultsError, match="no array x"):
        field["x"]


def test_scene_has_its_own_proportions(folder, tmp_path):
    assert main(["scene", str(folder), "--output", str(tmp_path / "out.png"), "--dpi", "50"]) == 0
    width, height = size_of(tmp_path / "out.png")
    assert width > height and 200 < height < 500


@pytest.mark.parametrize("quantity", QUANTITIES)
def test_every_quantity_fills_the_grains(folder, quantity):
    ax, missing = drawn(Results(folder), quantity)
    assert missing == [] and len(grains_of(ax).get_paths()) == 24


def test_split_shows_contacts_between_ranks(folder, unarranged):
    with h5py.File(folder / "bodies.vtkhdf", "r+") as file:
        data = file["VTKHDF/PointData"]
        data["rank"][...] = data["start_position"][:, 0] > 3
    results = Results(folder)
    ax = new_figure(6, 6).add_subplot()
    assert draw_split(ax, results.scene(), results.periods) == []
    scene = results.scene()
    ranks = dict(zip(scene.bodies.point_data["id"], scene.bodies.point_data["rank"], strict=True))
    walls = set(np.asarray(scene.bodies.point_data["id"])[np.asarray(scene.bodies.point_data["is_grain"]) == 0])
    ends = np.column_stack([scene.contacts.cell_data["candidate"], scene.contacts.cell_data["antagonist"]])
    between = sum(ranks[a] != ranks[b] and not {a, b} & walls for a, b in ends)
    lines = [c for c in ax.collections if isinstance(c, LineCollection)]
    assert between > 0 and max(len(c.get_segments()) for c in lines) == between
    assert f"2 parts, {between} of" in ax.get_title()
    assert main(["split", str(folder)]) == 0 and size_of(folder / "split.png")[0] > 500


def test_speed_is_that_of_the_body(folder):
    ax, _ = drawn(Results(folder), "speed", picture=0)
    with h5py.File(folder / "bodies.vtkhdf") as file:
        velocity = file["VTKHDF/PointData/velocity"][:24]
    assert np.asarray(grains_of(ax).get_array()) == pytest.approx(np.linalg.norm(velocity, axis=1))


def test_layers_are_of_equal_thickness_at_the_start(folder):
    scene = Results(folder).scene()
    height = np.asarray(scene.bodies.point_data["start_position"])[:, 1]
    grains = np.asarray(scene.bodies.point_data["is_grain"]) > 0
    layer = of_bodies(scene, "layer")[grains]
    low, high = height[grains].min(), height[grains].max()
    assert layer[height[grains] == low].tolist()[0] == 1 and layer[height[grains] == high].tolist()[0] == LAYERS
    for n in set(layer.tolist()):
        inside = height[grains][layer == n]
        assert inside.max() - inside.min() <= (high - low) / LAYERS * (1 + 1e-12)


def test_coordination_counts_bodies(folder):
    ax, _ = drawn(Results(folder), "coordination")
    counts = grains_of(ax).get_array().reshape(4, 6)
    # In a hexagonal lattice every disk inside has six neighbours.
    assert np.all(counts[1:-1, 1:-1] == 6) and counts[0, 0] == 2


def test_line_width_is_in_proportion_to_force(folder):
    results = Results(folder)
    ax, _ = drawn(results)
    widths = np.asarray(chains_of(ax)[0].get_linewidth())
    force = results.scene().contacts.cell_data["force_normal"]
    below = force < np.quantile(force, 0.99)
    ratio = widths[below] / force[below]
    assert ratio == pytest.approx(np.full(len(ratio), ratio[0]))
    assert widths.max() == pytest.approx(widths[force.argmax()])


def test_forces_go_through_centres_of_pressure(folder, unarranged):
    results = Results(folder)
    ax = new_figure(6, 6).add_subplot()
    draw_scene(ax, results.scene(), "none", results.periods, View(forces=True))
    chains, = chains_of(ax)
    assert all(len(line) == 3 for line in chains.get_segments())
    ax = new_figure(6, 6).add_subplot()
    draw_scene(ax, results.scene(), "none", results.periods, View(thrust=True))
    assert any("centres of pressure" in text.get_text() for text in ax.texts)
    assert main(["thrust", str(folder)]) == 0 and main(["scene", str(folder), "--forces"]) == 0
    # The first picture has no contact.
    assert main(["thrust", str(folder), "--step", "0"]) == 0
    (folder / "contacts.vtkhdf").unlink()
    assert main(["thrust", str(folder)]) == 2


def test_step_without_contacts_draws_no_chain(folder, unarranged):
    ax, missing = drawn(Results(folder), picture=0)
    assert not chains_of(ax) and missing == []
    assert "no contact carries force" in [text.get_text() for text in ax.texts]
    assert main(["summary", str(folder), "--step", "0"]) == 0


def test_periodic_scene_shows_one_period_without_long_lines(tmp_path):
    results = Results(write_results(tmp_path / "run", columns=8, rows=4, period=True))
    ax, _ = drawn(results)
    assert ax.get_xlim() == (0, 8)
    lines = np.array(chains_of(ax)[0].get_segments())
    assert np.linalg.norm(lines[:, 1] - lines[:, 0], axis=1).max() == pytest.approx(1)
    # Half of the rows are shifted by half a disk: their last disk is seen at both borders.
    assert len(grains_of(ax).get_paths()) == 8 * 4 + 2


@pytest.mark.parametrize("tilt", [0.0, 3.0, 5.0, -22.0])
def test_cell_shows_each_grain_once_within_its_outline(tmp_path, tilt):
    height = 4 * np.sqrt(3) / 2
    results = Results(write_results(tmp_path / "run", columns=8, rows=4, period=True, cell=(height, [0.0, 1.0, tilt])))
    ax, _ = drawn(results)
    # Of tilts that differ by whole lengths of 8 m the smallest is drawn.
    nearest = {0.0: 0.0, 3.0: 3.0, 5.0: -3.0, -22.0: 2.0}[tilt]
    edges = np.array([[8.0, 0.0], [nearest, height]])
    assert results.scene().cell == pytest.approx(edges)
    assert results.scene(1).cell[1, 0] == pytest.approx(1.0)
    outline = ax.patches[-1].get_xy()[:4]
    assert outline == pytest.approx(np.array([[0, 0], edges[0], edges[0] + edges[1], edges[1]]))
    middles = np.array([path.vertices[:CORNERS].mean(axis=0) for path in grains_of(ax).get_paths()])
    places = middles @ np.linalg.inv(edges)
    # The rounding of a middle on the border: a billionth of the cell.
    assert np.sum(((places > -1e-9) & (places < 1 - 1e-9)).all(axis=1)) == 8 * 4
    # The pack closes on itself over the cell: at any tilt by whole disks images touch, and none overlap.
    apart = np.linalg.norm(middles[:, None] - middles, axis=2)
    assert apart[apart > 0].min() == pytest.approx(1)
    for collection in ax.collections:
        assert collection.get_clip_path() is not None
    lines = np.array(chains_of(ax)[0].get_segments())
    assert np.linalg.norm(lines[:, 1] - lines[:, 0], axis=1).max() == pytest.approx(1)


@pytest.mark.parametrize("gone", ["bodies", "shapes", "contacts"])
def test_what_is_missing_is_said(folder, capsys, unarranged, gone):
    (folder / f"{gone}.vtkhdf").unlink()
    assert main(["scene", str(folder)]) == 0
    assert f"no {gone}.vtkhdf" in capsys.readouterr().err
    assert size_of(folder / "scene.png")[0] > 500


def test_summary_without_record(folder, capsys, unarranged):
    (folder / "record.csv").unlink()
    assert main(["summary", str(folder)]) == 0
    assert "no record.csv" in capsys.readouterr().out


@pytest.mark.parametrize("rows", [0, 1, 5000])
def test_records_of_any_length(tmp_path, capsys, unarranged, rows):
    """A record alone: the summary reports that there are no pictures."""
    write_record(tmp_path, rows or 1)
    if rows == 0:
        path = tmp_path / "record.csv"
        path.write_text(path.read_text().splitlines()[0] + "\n")
    assert main(["summary", str(tmp_path), "--dpi", "50"]) == 0
    assert "no pictures" in capsys.readouterr().out
    assert main(["solver", str(tmp_path), "--dpi", "50"]) == (0 if rows else 2)


@pytest.mark.parametrize("words, message", [
    (["scene", "nowhere"], "there is no folder nowhere"),
    (["scene", "empty"], "holds no results"),
    (["scene", "bare"], "has no pictures"),
    (["energy", "bare"], "no row in record.csv"),
    (["scene", "run", "--step", "-5"], "no picture at or before step -5"),
    (["scene", "run", "--output", "nowhere/x.png"], "cannot write nowhere/x.png"),
])  # fmt: skip
def test_mistakes_give_one_line_and_code_2(folder, capsys, monkeypatch, words, message):
    monkeypatch.chdir(folder.parent)
    (folder.parent / "empty").mkdir()
    (folder.parent / "bare").mkdir()
    (folder.parent / "bare" / "run.json").write_text("{}")
    assert main(words) == 2
    printed = capsys.readouterr()
    assert printed.out == "" and printed.err.count("\n") == 1 and message in printed.err


def test_unknown_command_is_code_2(capsys):
    with pytest.raises(SystemExit) as stop:
        main(["paint", "run"])
    assert stop.value.code == 2

"""Pictures of scenes in space: the depth buffer, what hides what, colours, cuts and forces."""

import numpy as np
import pytest
from matplotlib.collections import PathCollection
from sample_results import write_results
from sample_space import FACES, SIGNS, write_space_results

from splitgrain_postpro import Results, drawing
from splitgrain_postpro.cli import main
from splitgrain_postpro.command_line import parser
from splitgrain_postpro.lattice import Lattice, cell_of
from splitgrain_postpro.quantities import is_in_space, of_bodies, rows_of
from splitgrain_postpro.raster import Canvas, normal_of
from splitgrain_postpro.scene import QUANTITIES, _view, draw_scene, proportions
from splitgrain_postpro.space import View, _box, _clipped, _corners, _folded, _wall_faces
from splitgrain_postpro.style import new_figure
from splitgrain_postpro.thrust import lines_of_force, resultants, thrust_lines

@pytest.fixture(autouse=True)
def few_pixels(monkeypatch):
    """Pictures small enough for many of them."""
    monkeypatch.setattr("splitgrain_postpro.space.PIXELS", 300)


SQUARE = np.array([[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]])


def canvas():
    return Canvas((-2.0, 2.0, -2.0, 2.0), 100)


def share(c, item):
    """Share of the canvas that an item covers."""
    return np.mean(c.item == item)


def test_sphere_covers_its_disk_and_bulges():
    c = canvas()
    c.add_spheres(np.array([[0.5, -0.5, 3.0]]), [1.0], [7])
    # Pixels of 2 cm: a rim of half a pixel on a circle of 6.3 m.
    assert share(c, 7) * 16 == pytest.approx(np.pi, abs=0.03)
    assert c.depth.max() == pytest.approx(4.0, abs=1e-3)
    row, column = np.unravel_index(c.depth.argmax(), c.depth.shape)
    assert (c.u[column], c.v[row]) == pytest.approx((0.5, -0.5), abs=0.03)


def test_nearer_hides_farther_in_any_order():
    for order in ([0, 1], [1, 0]):
        c = canvas()
        centres = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 5.0]])
        c.add_spheres(centres[order], np.array([1.0, 0.5])[order], order)
        assert c.item[100, 100] == 1
        assert share(c, 1) * 16 == pytest.approx(np.pi / 4, abs=0.02)
        assert share(c, 0) * 16 == pytest.approx(3 * np.pi / 4, abs=0.04)


def test_polygon_is_seen_from_outside_only():
    c = canvas()
    c.add_polygons([SQUARE[::-1]], [1])
    assert share(c, 1) == 0
    c.add_polygons([SQUARE + [0, 0, -1]], [1])
    assert share(c, 1) == pytest.approx(0.25, abs=1e-3)
    assert c.hidden_by([SQUARE]) == np.count_nonzero(c.item == 1)
    assert c.hidden_by([SQUARE - [0, 0, 3]]) == 0


def test_slanted_polygon_has_the_depth_of_its_plane():
    c = canvas()
    slanted = SQUARE.copy()
    slanted[:, 2] = 0.5 * slanted[:, 0] - 0.25 * slanted[:, 1] + 1
    c.add_polygons([slanted], [0])
    rows, columns = np.nonzero(c.item == 0)
    assert c.depth[rows, columns] == pytest.approx(0.5 * c.u[columns] - 0.25 * c.v[rows] + 1, abs=1e-9)


@pytest.mark.parametrize("end", [(1.5, 0.0, 0.0), (1.0, 1.0, 2.0), (0.0, 0.0, 3.0)])
def test_tube_is_round_about_its_axis(end):
    c = canvas()
    c.add_tubes(np.zeros((1, 3)), np.array([end]), [0.3], [0])
    rows, columns = np.nonzero(c.item == 0)
    surface = np.column_stack([c.u[columns], c.v[rows], c.depth[rows, columns]])
    along = np.clip(surface @ end / np.dot(end, end), 0, 1)
    assert np.linalg.norm(surface - along[:, None] * end, axis=1) == pytest.approx(0.3, abs=1e-6)
    assert np.linalg.norm(c.normal[rows, columns], axis=1) == pytest.approx(1, abs=1e-5)


def test_image_is_clear_where_nothing_is_and_has_the_colour_of_what_is_there():
    c = canvas()
    c.add_spheres(np.zeros((1, 3)), [1.0], [0])
    image = c.image(np.array([[1.0, 0.0, 0.0]], dtype=np.float32), 0.5)
    assert image.shape == (100, 100, 4) and image[0, 0, 3] == 0 and image[50, 50, 3] == 1
    red, green, blue = image[50, 45, :3]
    assert red > 0.6 and green < 0.4 and blue < 0.4
    assert image[..., :3].min() >= 0 and image[..., :3].max() <= 1


def test_faces_of_a_box_look_outside_and_clipping_keeps_what_is_before_a_plane():
    for face in FACES:
        assert normal_of(SIGNS[face].astype(float)) @ SIGNS[face].mean(axis=0) == pytest.approx(1)
    half = _clipped(SQUARE, [(np.array([1.0, 0, 0]), np.zeros(3))])
    assert half[:, 0].min() == 0 and np.ptp(half, axis=0) == pytest.approx([1, 2, 0])
    assert np.ptp(_clipped(SQUARE, [(np.array([1.0, 0, 0]), np.array([5.0, 0, 0]))]), axis=0) == pytest.approx([0, 0, 0])


def test_only_the_inside_of_a_box_of_planes_is_shown(tmp_path):
    results = Results(write_space_results(tmp_path / "run"))
    scene = results.scene()
    assert is_in_space(scene)
    faces = _wall_faces(scene)
    assert len(faces) == 5
    low, high = np.concatenate(list(faces.values())).min(axis=0), np.concatenate(list(faces.values())).max(axis=0)
    # Walls 0.2 thick that overlap: what is left is the room within, 3 x 2 and up to the walls' upper ends.
    assert low == pytest.approx([0, 0, 0]) and high == pytest.approx([3, 2, 2.2])
    assert _box(scene, (0, 0))[0] == pytest.approx([0, 0, 0])


def drawn(results, **options):
    figure = new_figure(5, 4)
    ax = figure.add_subplot()
    missing = draw_scene(ax, results.scene(), options.pop("quantity", "speed"), results.periods, View(**options))
    return ax, missing


def test_walls_before_the_grains_do_not_hide_them(tmp_path):
    with_walls, _ = drawn(Results(write_space_results(tmp_path / "walls")))
    assert with_walls.collections, "outlines of the walls in front"
    picture = with_walls.images[0].get_array()
    coloured = np.ptp(picture[..., :3], axis=2) > 0.25  # walls are grey
    assert np.mean(coloured) > 0.08


def test_options_say_how_to_look():
    """Each option of the command line sets its own field."""
    words = ["scene", "out", "--azimuth", "10", "--elevation", "20", "--cut", "y=0.15"]
    assert drawing._view(parser().parse_args(words)) == View(azimuth=10, elevation=20, cut=(1, 0.15))
    assert drawing._view(parser().parse_args([*words[:2], "--forces"])) == View(forces=True)


def test_cut_leaves_out_grains_before_it(tmp_path):
    results = Results(write_space_results(tmp_path / "run"))
    def coloured(**options):
        ax, _ = drawn(results, **options)
        return np.count_nonzero(np.ptp(ax.images[0].get_array()[..., :3], axis=2) > 0.25)
    # The viewer stands at negative y: of four grains the capsule at y = 1.5 is left.
    assert 0 < coloured(cut=(1, 1.0)) < 0.5 * coloured()
    assert coloured(cut=(1, 3.0)) == 0


def test_forces_are_drawn_over_pale_grains(tmp_path):
    ax, missing = drawn(Results(write_space_results(tmp_path / "run")), forces=True)
    assert missing == [] and len(ax.images) == 2
    pale = ax.images[0].get_array()
    assert pale[..., :3][pale[..., 3] > 0.99].min() > 0.7
    assert np.count_nonzero(ax.images[1].get_array()[..., 3]) > 100


def test_resultants_of_pairs_and_lines_through_their_centres(tmp_path):
    scene = Results(write_space_results(tmp_path / "run")).scene()
    found = resultants(scene)
    # Forces of 1 N and 2 N at heights 0.4 and 0.6 are one of 3 N at a third of the way from the larger one.
    assert found.bodies.tolist() == [[0, 1], [1, 2]] and found.force.tolist() == [[-3, 0, 0], [-3, 0, 0]]
    assert found.centre == pytest.approx(np.array([[1, 0.5, 0.5], [2, 0.5, 0.4 + 0.2 * 2 / 3]]))
    assert lines_of_force(found)[1] == pytest.approx(np.array([[1.5, 0.5, 0.5], found.centre[1], [2.5, 0.5, 0.5]]))
    lines, forces = thrust_lines(scene, found)
    # Through the middle sphere from joint to joint; of the other two from the joint to the centre of mass.
    assert forces.tolist() == [3, 3, 3] and lines[1] == pytest.approx(found.centre)
    assert lines[2] == pytest.approx(np.array([found.centre[1], [2.5, 0.5, 0.5]]))
    ax, missing = drawn(Results(tmp_path / "run"), thrust=True)
    assert missing == [] and any("thickest line: 3 N" in text.get_text() for text in ax.texts)
    dots, = [c for c in ax.collections if isinstance(c, PathCollection)]
    assert len(dots.get_offsets()) == 2


@pytest.mark.parametrize(("options", "dots"), [({"azimuth": -95.0, "elevation": 0.0}, 3), ({"azimuth": -85.0, "elevation": 0.0}, 1),
                                               ({"azimuth": -90.0, "elevation": 0.0, "cut": (1, 1.0)}, 0)])
def test_bonds_are_dots_where_nothing_hides_them(tmp_path, options, dots):
    # Points between the grains in a row along x: from one side of y all are seen, from the other the cube hides its two.
    scene = Results(write_space_results(tmp_path / "run")).scene()
    scene.contacts.cell_data["damage"] = np.array([1.0, 0.0, 0.5])
    ax = new_figure(4, 3).subplots()
    draw_scene(ax, scene, view=View(**options))
    drawn_damage = [list(c.get_array()) for c in ax.collections if isinstance(c, PathCollection)]
    assert drawn_damage == [[[0.0, 0.5, 1.0], [1.0]][dots == 1] if dots else []]


def test_points_behind_a_sphere_are_not_seen():
    c = canvas()
    c.add_spheres(np.zeros((1, 3)), [1.0], [1])
    points = np.array([[0, 0, 1.0], [0, 0, -1.0], [0, 0, 0.95], [1.5, 0, -5.0], [5.0, 0, 9.0], [0, -5.0, 9.0]])
    assert list(c.sees(points, 0.1)) == [True, False, True, True, False, False]


@pytest.mark.parametrize("quantity", QUANTITIES)
def test_every_quantity_can_fill_grains_in_space(tmp_path, quantity):
    assert drawn(Results(write_space_results(tmp_path / "run")), quantity=quantity)[1] == []


@pytest.mark.parametrize("options", [{"azimuth": 200.0, "elevation": -30.0}, {"elevation": 90.0}, {"azimuth": 0.0, "elevation": 0.0}])
def test_any_way_of_looking(tmp_path, options):
    assert drawn(Results(write_space_results(tmp_path / "run", drum=True)), **options)[1] == []


def test_many_faces_at_once_are_what_single_polygons_give():
    rng = np.random.default_rng(5)
    points, faces = [], []
    for centre in rng.uniform(-1.6, 1.6, (60, 3)):
        turned = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        turned *= np.sign(np.linalg.det(turned))
        faces += [len(points) * 8 + np.array(face) for face in FACES]
        points.append(centre + rng.uniform(0.05, 0.5) * SIGNS @ turned)
    points = np.vstack(points)
    items = np.arange(len(faces)) // 6
    one, all_ = canvas(), canvas()
    one.add_polygons([points[face] for face in faces], items)
    all_.add_faces(points, np.concatenate(faces), np.arange(0, 4 * len(faces) + 1, 4), items)
    # Pixels on an edge may fall to either face.
    assert np.mean(one.item != all_.item) < 2e-3
    same = (one.piece == all_.piece) & (one.item >= 0)
    assert np.mean(same[one.item >= 0]) > 0.99
    assert all_.depth[same] == pytest.approx(one.depth[same], abs=1e-9)
    assert all_.normal[same] == pytest.approx(one.normal[same], abs=1e-6)


@pytest.mark.parametrize("walls", [True, False])
def test_held_body_above_the_grains_is_drawn_whole(tmp_path, walls):
    results = Results(write_space_results(tmp_path / "run", walls, held=True))
    scene = results.scene()
    assert _box(scene, (0, 0))[1, 2] == pytest.approx(6.5)
    ax = new_figure(5, 5).add_subplot()
    draw_scene(ax, scene, "speed", results.periods, View())
    picture, (left, right, low, high) = ax.images[0].get_array(), ax.images[0].get_extent()
    u, v = (View().axes() @ [1.0, 1.0, 6.0])[:2]
    column, row = int((u - left) / (right - left) * picture.shape[1]), int((v - low) / (high - low) * picture.shape[0])
    grey = picture[row, column]
    assert grey[3] == 1 and np.ptp(grey[:3]) < 0.1 and grey[:3].mean() < 0.7


def test_held_polygon_above_the_disks_is_in_the_picture(tmp_path):
    scene = Results(write_results(tmp_path / "run", 3, 3)).scene()
    scene.shapes.kind_names = ("polygon", "segment")
    scene.shapes.points[-4:, 1] += 10
    for kind, is_whole in ((1, True), (2, False)):  # what was the floor: a held polygon, or a wall that is far away
        scene.shapes.cell_data["kind"] = np.append(np.ones(9), kind)
        assert (_view(scene, Lattice.of(0.0, None))[3] > 10) == is_whole


def test_periodic_scene_shows_the_period(tmp_path):
    results = Results(write_space_results(tmp_path / "run", walls=False, periods=(4.0, 3.0)))
    assert results.periods == (4.0, 3.0)
    assert _box(results.scene(), results.periods)[:, :2] == pytest.approx(np.array([[0, 0], [4, 3]]))
    assert drawn(results)[1] == []
    assert proportions(results.scene(), results.periods) > 0.5


def test_tilted_cell_holds_the_centres(tmp_path):
    results = Results(write_space_results(tmp_path / "run", walls=False))
    scene = results.scene()
    scene.cell = cell_of([2.0, 1.5, 3.0], 2.5)
    assert scene.cell == pytest.approx(np.array([[2, 0, 0], [0.5, 1.5, 0], [0, 0, 3]]))
    folded = _folded(scene)
    places = folded.bodies.points @ np.linalg.inv(scene.cell)
    assert (places > -1e-9).all() and (places < 1 + 1e-9).all()
    ways = folded.bodies.points - scene.bodies.points
    assert (ways @ np.linalg.inv(scene.cell)) == pytest.approx(np.round(ways @ np.linalg.inv(scene.cell)))
    # Shapes go with their bodies, and lines of contacts keep their length.
    rows = np.repeat(rows_of(scene.bodies.point_data["id"], scene.shapes.cell_data["body"]), np.diff(scene.shapes.offsets))
    moved = (folded.shapes.points - scene.shapes.points)[scene.shapes.connectivity]
    assert moved == pytest.approx(ways[rows])
    for one in (scene, folded):
        ends = one.contacts.points[one.contacts.connectivity].reshape(-1, 2, 3)
        assert np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1) == pytest.approx(
            np.linalg.norm(np.diff(scene.contacts.points[scene.contacts.connectivity].reshape(-1, 2, 3), axis=1)[:, 0], axis=1))
    assert _corners(_box(scene, (0.0, 0.0)), 0.5)[7] == pytest.approx([2.5, 1.5, 3])
    ax = new_figure(5, 5).add_subplot()
    assert draw_scene(ax, scene) == []


def test_mean_stress_of_two_spheres_pressed_together(tmp_path):
    pressure = of_bodies(Results(write_space_results(tmp_path / "run")).scene(), "pressure")
    volume = 4 / 3 * np.pi * 0.5**3
    # One force of 3 N at half a metre; the second sphere feels it from both sides.
    assert pressure[:2] == pytest.approx([3 * 0.5 / (3 * volume), 2 * 3 * 0.5 / (3 * volume)])
    assert pressure[4:] == pytest.approx(0)


def test_scenes_without_shapes_or_contacts(tmp_path):
    folder = write_space_results(tmp_path / "run")
    (folder / "shapes.vtkhdf").unlink()
    (folder / "contacts.vtkhdf").unlink()
    assert drawn(Results(folder))[1] == ["no shapes.vtkhdf", "no contacts.vtkhdf"]


def test_commands_in_space(tmp_path, capsys, unarranged):
    folder = write_space_results(tmp_path / "run")
    for words in (["scene"], ["scene", "--forces", "--azimuth", "-30", "--elevation", "40", "--cut", "z=0.9"], ["thrust"], ["summary"], ["energy"]):
        assert main([words[0], str(folder), "--dpi", "40", *words[1:]]) == 0
        assert (folder / f"{words[0]}.png").stat().st_size > 5000
    capsys.readouterr()
    with pytest.raises(SystemExit):
        main(["scene", str(folder), "--cut", "0.5"])
    assert "a cut is written like y=0.15" in capsys.readouterr().err

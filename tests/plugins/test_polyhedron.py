"""Polyhedron as an inclusion: mesh files, winding number, volume, refusals."""

import time
from types import SimpleNamespace

import meshio
import numpy as np
import pytest

import eigencontact
from close import close
from eigencontact.halfspace.voxels import Voxels, volume_fractions, voxels_across
from eigencontact.plugin import SceneError
from eigencontact_plugins.shapes.polyhedron import Polyhedron
from eigencontact_plugins.shapes.polyhedron_rays import TURN, sorted_into_bins

CUBE = np.array([(x, y, z) for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)])
SIDES = np.array([(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)])
TRIANGLES = np.concatenate([SIDES[:, [0, 1, 2]], SIDES[:, [0, 2, 3]]])
LETTER = np.array([(0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3.0)])  # an L, not convex


@pytest.fixture
def mesh_file(tmp_path):
    """Write a surface mesh."""

    def write(suffix=".ply", points=CUBE, cells=(("triangle", TRIANGLES),), **options):
        path = tmp_path / f"body{suffix}"
        meshio.Mesh(points, list(cells)).write(path, **options)
        return str(path)

    return write


def bipyramid(n):
    """Two cones of n sides each: volume n/3 sin(2π/n) for unit radius and height."""
    turn = 2 * np.pi * np.arange(n) / n
    points = np.concatenate([np.stack([np.cos(turn), np.sin(turn), 0 * turn], axis=1), [(0, 0, 1.0), (0, 0, -1.0)]])
    i, j = np.arange(n), (np.arange(n) + 1) % n
    return points, np.concatenate([np.stack([i, j, 0 * i + n], axis=1), np.stack([j, i, 0 * i + n + 1], axis=1)])


def prism(outline, height):
    """Walls as quadrilaterals, bottom and top as one polygon each, cut by hand for the L."""
    n = len(outline)
    points = np.concatenate([np.c_[outline, np.zeros(n)], np.c_[outline, np.full(n, height)]])
    i, j = np.arange(n), (np.arange(n) + 1) % n
    walls = np.stack([i, j, j + n, i + n], axis=1)
    fan = np.array([(0, 1, 2), (0, 2, 3), (0, 3, 4), (0, 4, 5)])
    return points, [("quad", walls), ("triangle", np.concatenate([fan[:, ::-1], fan + n]))]


@pytest.mark.parametrize("suffix", [".stl", ".ply", ".obj", ".off", ".vtk", ".vtu"])
def test_every_format_gives_the_same_body(mesh_file, suffix):
    shape = Polyhedron(file=mesh_file(suffix))
    assert len(shape.surface.vertices) == 8
    assert len(shape.surface.triangles) == 12
    assert shape.volume == close(1.0, rel=1e-14)
    assert shape.bounds == ((0, 0, 0), (1, 1, 1))


def test_contains_agrees_with_the_cuboid(mesh_file):
    points = np.random.default_rng(2).uniform(-0.3, 1.3, (3, 3000))
    body = Polyhedron(file=mesh_file(), scale=2e-6, offset=(0, 1e-6, 3e-6))
    cuboid = eigencontact.make("cuboid", center=(1e-6, 2e-6, 4e-6), edges=(2e-6, 2e-6, 2e-6))
    points = points * 2e-6 + np.array([[0], [1e-6], [3e-6]])
    assert np.array_equal(body.contains(*points), cuboid.contains(*points))
    assert 0 < body.contains(*points).sum() < 3000


@pytest.mark.parametrize("extra", ["edges", "vertices"])
def test_points_in_line_with_edges_and_vertices_are_decided(mesh_file, extra):
    """Rays would pass through edges and corners here; the solid angle knows no direction."""
    axis = np.array([-0.5, 0.0, 0.25, 0.5, 1.0, 1.5]) if extra == "edges" else np.array([-1.0, 0.5, 2.0])
    x, y, z = np.meshgrid(axis, axis, axis)
    inside = Polyhedron(file=mesh_file()).contains(x, y, z)
    strictly = (x > 0) & (x < 1) & (y > 0) & (y < 1) & (z > 0) & (z < 1)
    border = ~strictly & (x >= 0) & (x <= 1) & (y >= 0) & (y <= 1) & (z >= 0) & (z <= 1)
    assert inside.shape == x.shape
    assert np.array_equal(inside[~border], strictly[~border])


def test_a_body_that_is_not_convex_and_has_polygons(mesh_file):
    points, cells = prism(LETTER, 2.0)
    shape = Polyhedron(file=mesh_file(".vtu", points, cells))
    assert shape.volume == close(10.0, rel=1e-14)
    x, y = np.array([0.5, 2.5, 0.5, 2.0, 1.5]), np.array([0.5, 0.5, 2.5, 2.0, 1.5])
    assert shape.contains(x, y, np.ones(5)).tolist() == [True, True, True, False, False]


def off(points, faces, head="OFF", tail=""):
    """Text of an OFF file."""
    rows = [f"{head}\n{len(points)} {len(faces)} 0", *(" ".join(map(str, point)) for point in points)]
    return "\n".join([*rows, *(" ".join(map(str, (len(face), *face))) + tail for face in faces)]) + "\n"


def obj(points, faces, corner="{}", first=1):
    """Text of an OBJ file."""
    rows = ["v " + " ".join(map(str, point)) for point in points]
    rows += ["vt 0 0", "vn 0 0 1", *("f " + " ".join(corner.format(i + first) for i in face) for face in faces)]
    return "\n".join(rows) + "\n"


HEXAGON = np.array([(1, 0), (2, 0), (3, 1), (2, 2), (1, 2), (0, 1.0)])
SIX = [tuple(range(6))[::-1], tuple(range(6, 12)), *((i, (i + 1) % 6, (i + 1) % 6 + 6, i + 6) for i in range(6))]


def standing(outline):
    return np.concatenate([np.c_[outline, np.zeros(6)], np.c_[outline, np.ones(6)]]).tolist()


@pytest.mark.parametrize(
    ("name", "text", "volume"),
    [
        ("quads.off", off(CUBE, SIDES), 1.0),
        ("mixed.off", off(CUBE, [*SIDES[:3].tolist(), *TRIANGLES[3:6].tolist(), *TRIANGLES[9:].tolist()]), 1.0),
        ("coloured.off", off(CUBE, SIDES, tail=" 255 0 0"), 1.0),
        ("one-line.off", off(CUBE, SIDES).replace("OFF\n", "OFF "), 1.0),
        ("remarks.off", "# by hand\n" + off(CUBE, SIDES).replace("OFF\n", "OFF # head\n\n"), 1.0),
        ("coloured-points.off", off(np.c_[CUBE, 0 * CUBE], SIDES, head="COFF"), 1.0),
        ("hexagons.off", off(standing(HEXAGON), SIX), 4.0),
        ("letter.off", off(standing(LETTER), SIX), 5.0),  # not convex
        ("quads.obj", obj(CUBE, SIDES), 1.0),
        ("textured.obj", obj(CUBE, SIDES, corner="{}/1/1"), 1.0),
        ("normals.obj", obj(CUBE, SIDES, corner="{}//1"), 1.0),
        ("counted-back.obj", obj(CUBE, SIDES, first=-8), 1.0),
        ("letter.obj", obj(standing(LETTER), SIX), 5.0),
    ],
)
def test_faces_of_many_corners(tmp_path, name, text, volume):
    (tmp_path / name).write_text(text, encoding="utf-8")
    shape = Polyhedron(file=str(tmp_path / name))
    assert shape.volume == close(volume, rel=1e-14)
    low, high = (np.array(corner) for corner in shape.bounds)
    at = np.random.default_rng(1).uniform(low, high, (2000, 3)).T
    assert shape.contains(*at).mean() * np.prod(high - low) == close(volume, rel=0.1)
    if volume == 5.0:
        assert np.array_equal(shape.contains(*at), (at[0] < 1) | (at[1] < 1))


def test_points_and_faces_of_a_ply_of_polygons(mesh_file):
    cells = [("polygon", [SIX[0], SIX[1]]), ("quad", np.array(SIX[2:]))]
    assert Polyhedron(file=mesh_file(".ply", np.array(standing(HEXAGON)), cells)).volume == close(4.0)


def test_bent_faces_are_cut_around_their_middle(tmp_path):
    """A quadrilateral whose fourth corner is pulled out: the same volume from whichever corner it begins."""
    points = CUBE.copy()
    points[7] = (1.0, 1.0, 1.2)
    volumes = []
    for turn in range(4):
        faces = np.roll(SIDES, turn, axis=1)
        (tmp_path / "bent.off").write_text(off(points, faces), encoding="utf-8")
        volumes.append(Polyhedron(file=str(tmp_path / "bent.off")).volume)
    assert volumes == close([1.05] * 4, rel=1e-14)  # 0.2 / 4 above the old top


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        (
            "folded.off",
            off([*CUBE[:7].tolist(), [-0.5, -0.5, 1.5]], SIDES),
            r"flat faces: 1 are folded, one of them at \(",
        ),
        ("index.off", off(CUBE, [*SIDES[:5].tolist(), [1, 5, 7, 30]]), "name its 8 points; one names point number 31"),
        ("index.obj", obj(CUBE, SIDES, first=0), "name its 8 points; one names point number 0"),
        ("short.off", off(CUBE, SIDES)[:-10], "declares 8 points and 6 faces and has 13 lines"),
        ("face.off", off(CUBE, SIDES)[:-3], "has fewer corners than it declares"),
        ("number.off", off(CUBE, SIDES).replace("4 0 1 3 2", "4 0 1 3 2.5"), "readable mesh .*2.5"),
        ("nan.off", off(CUBE, SIDES).replace("0.0 0.0 0.0", "nan 0 0"), "finite coordinates"),
        ("head.off", "ON\n8 6 0\n", r"first line must be OFF \(got ON\)"),
        ("empty.off", "", "readable mesh"),
        ("edge.obj", obj(CUBE, [[0, 1]]), r"a face must have three corners or more \(got 2\)"),
        ("none.obj", obj(CUBE, []), "a mesh with triangles; it holds none"),
    ],
)
def test_faces_that_cannot_be_used_are_refused(tmp_path, name, text, message):
    (tmp_path / name).write_text(text, encoding="utf-8")
    with pytest.raises(SceneError, match=message):
        Polyhedron(file=str(tmp_path / name))


@pytest.mark.parametrize("n", [3, 7, 200])
def test_volume_is_that_of_the_points_inside(mesh_file, n):
    shape = Polyhedron(file=mesh_file(".obj", *[bipyramid(n)[0]], [("triangle", bipyramid(n)[1])]))
    assert shape.volume == close(n / 3 * np.sin(2 * np.pi / n), rel=1e-5)  # OBJ holds few digits
    low, high = (np.array(corner) for corner in shape.bounds)
    x, y, z = (low[:, None] + (high - low)[:, None] * (np.arange(31) + 0.5) / 31).reshape(3, 31)
    share = shape.contains(x[:, None, None], y[:, None], z).mean() * np.prod(high - low)
    assert share == close(shape.volume, rel=2e-2)


@pytest.mark.parametrize("n", [3, 7, 200])
@pytest.mark.parametrize("cells", [1, 5, 16])
def test_fractions_add_up_to_the_volume(mesh_file, n, cells):
    points, faces = bipyramid(n)
    shape = Polyhedron(file=mesh_file(".ply", points, [("triangle", faces)]), rotation=(0.4, 0.3, 0.2), scale=1e-6)
    voxels = voxels_across(shape.bounds, cells)
    fractions = volume_fractions(shape, voxels)
    assert fractions.sum() * np.prod(voxels.edges) == close(shape.volume, rel=1e-13, abs=0.0)


@pytest.mark.parametrize("part", [False, True], ids=["all", "part"])
def test_fractions_are_those_that_samples_find(mesh_file, part):
    """Of a lattice that holds the body, and of one that holds a part of it."""
    points, faces = bipyramid(7)
    shape = Polyhedron(file=mesh_file(".ply", points, [("triangle", faces)]), rotation=(0.4, 0.3, 0.2), scale=1e-6)
    voxels = voxels_across(shape.bounds, 4)
    if part:
        voxels = Voxels(voxels.low + 0.8 * voxels.edges, 0.7 * voxels.edges, (2, 3, 1))
    exact = volume_fractions(shape, voxels)
    sampled = volume_fractions(SimpleNamespace(bounds=shape.bounds, contains=shape.contains), voxels)
    assert 0 < exact.sum() < exact.size
    assert np.abs(exact - sampled).max() < 0.015


def test_faces_in_the_planes_of_the_lattice_leave_nothing_beside(mesh_file):
    shape = Polyhedron(file=mesh_file(), scale=3e-6, offset=(0.1, 0.2, 0.3))
    low, edges = (0.1 - 2e-6, 0.2 - 1e-6, 0.3 - 1e-6), (1e-6, 1e-6, 1e-6)
    fractions = shape.volume_fractions(low, edges, (5, 6, 7))
    expected = np.zeros((5, 6, 7))
    expected[1:4, 1:4, 2:5] = 1.0
    assert fractions == close(expected, abs=1e-9)  # 0.1 m away its coordinates carry 1e-17 m


def test_parts_that_overlap_are_sampled(mesh_file):
    points = np.concatenate([CUBE, CUBE + 0.5])
    shape = Polyhedron(file=mesh_file(points=points, cells=[("triangle", np.concatenate([TRIANGLES, TRIANGLES + 8]))]))
    assert shape.volume == close(2.0)
    voxels = voxels_across(shape.bounds, 6)
    assert shape.volume_fractions((0, 0, 0), (0.25, 0.25, 0.25), (6, 6, 6)) is None
    assert volume_fractions(shape, voxels).sum() * np.prod(voxels.edges) == close(1.875, rel=1e-12)


def test_few_points_of_a_polyhedron_take_no_time(mesh_file):
    """Took 20 s: a quarter of a million samples, and as many cuboids as cells are cut."""
    points, faces = bipyramid(40)
    body = Polyhedron(file=mesh_file(".ply", points, [("triangle", faces)]), rotation=(0.4, 0.3, 0.2), offset=(0, 0, 2))
    at = np.random.default_rng(9).uniform(0.0, 3.0, (8, 3))
    given = {"young_modulus": 1.0, "poisson_ratio": 0.3, "quantity": "stress", "cells": 32}
    started = time.perf_counter()
    eigencontact.inclusion_field(body, np.eye(3), at, **given)
    assert time.perf_counter() - started < 2.0


def test_winding_number_is_one_inside_and_zero_outside(mesh_file):
    surface = Polyhedron(file=mesh_file()).surface
    points = np.random.default_rng(3).uniform(-1, 2, (3, 200))
    inside = np.all((points > 0) & (points < 1), axis=0)
    for pairs in (1, 100, 10**6):  # in parts of any size
        assert surface.winding_number(*points, pairs=pairs) == close(inside.astype(float), abs=1e-13)


@pytest.mark.parametrize("n", [3, 7, 200])
def test_rays_and_solid_angles_agree(mesh_file, n):
    points, cells = bipyramid(n)
    shape = Polyhedron(file=mesh_file(".ply", points, [("triangle", cells)]), rotation=(0.4, 0.3, 0.2), scale=1e-6)
    at = np.random.default_rng(6).uniform(-1e-6, 1e-6, (3, 2000))
    at[:, :50] = 0.5 * at[:, :50]
    expected = shape.surface.winding_number(*at, pairs=1 << 17) > 0.5
    assert np.array_equal(shape.contains(*at), expected)
    assert 100 < expected.sum() < 1900


def test_a_ray_through_a_corner_is_left_to_the_solid_angle(mesh_file):
    """The point lies behind the middle vertex of a face that is cut into four, seen along the rays."""
    middle = np.array([0.5, 0.5, 1.0])
    points = np.concatenate([CUBE, [middle]])
    top = [(a, b, 8) for a, b in ((1, 5), (5, 7), (7, 3), (3, 1))]
    keep = [face for face in TRIANGLES.tolist() if not {1, 3, 5, 7} >= set(face)]
    shape = Polyhedron(file=mesh_file(points=points, cells=[("triangle", np.array(keep + top))]))
    assert shape.volume == close(1.0)
    behind = np.stack([middle - 0.3 * TURN[:, 2], middle + np.array([0.3, 0.1, 0.2])])
    winding, doubt = sorted_into_bins(shape.surface.vertices[shape.surface.triangles]).winding(behind)
    assert doubt.tolist() == [True, False]
    assert winding[1] == 0
    assert shape.contains(*behind.T).tolist() == [True, False]


def test_faces_that_look_inwards_are_turned(mesh_file):
    shape = Polyhedron(file=mesh_file(cells=[("triangle", TRIANGLES[:, ::-1])]))
    assert shape.volume == close(1.0)
    assert shape.contains(np.array(0.5), np.array(0.5), np.array(0.5))


def test_a_cavity_is_outside(mesh_file):
    points = np.concatenate([CUBE, 0.25 + 0.5 * CUBE])
    shape = Polyhedron(
        file=mesh_file(points=points, cells=[("triangle", np.concatenate([TRIANGLES, TRIANGLES[:, ::-1] + 8]))])
    )
    assert shape.volume == close(0.875)
    assert shape.contains(np.array([0.5, 0.1]), np.array([0.5, 0.1]), np.array([0.5, 0.1])).tolist() == [False, True]


def test_rotation_turns_about_the_origin_of_the_mesh(mesh_file):
    shape = Polyhedron(file=mesh_file(), rotation=(np.pi / 2, 0, 0), scale=2.0, offset=(5.0, 0.0, 1.0))
    assert np.allclose(shape.bounds, ((3, 0, 1), (5, 2, 3)), atol=1e-14)


def test_used_by_the_field_like_any_other_shape(mesh_file):
    """A cube from a mesh equals the cuboid when its cells do: exact, not only close."""
    body = eigencontact.make("polyhedron", file=mesh_file(), offset=(0.0, 0.0, 0.5))
    cuboid = eigencontact.make("cuboid", center=(0.5, 0.5, 1.0), edges=(1.0, 1.0, 1.0))
    at = np.array([[0.3, 0.1, 0.0], [2.0, -1.0, 1.0]])
    fields = [
        eigencontact.inclusion_field(
            s, np.diag([1e-3, 0, 0]), at, young_modulus=1.0, poisson_ratio=0.3, quantity="stress"
        )
        for s in (body, cuboid)
    ]
    assert fields[0] == close(fields[1], rel=1e-9, abs=1e-15)


# refusals -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("cells", "message"),
    [
        ([("triangle", TRIANGLES[1:])], r"closed surface: 3 of its 18 edges have no second face; close its holes"),
        (
            [("triangle", np.concatenate([TRIANGLES[:1, ::-1], TRIANGLES[1:]]))],
            r"surface of one sense: the faces at 3 of its 18 edges look to opposite sides",
        ),
        ([("line", np.array([[0, 1]]))], r"a mesh with triangles; it holds none"),
        ([("tetra", np.array([[0, 1, 2, 4]]))], r"surface mesh without tetra cells; extract its surface"),
        ([("triangle", np.array([[0, 1, 2], [2, 1, 0]]))], r"surface that encloses a volume"),
    ],
)
def test_unusable_meshes_are_refused(mesh_file, cells, message):
    with pytest.raises(SceneError, match=message):
        Polyhedron(file=mesh_file(".vtu", cells=cells))


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ({"file": "nowhere.stl"}, r"polyhedron.file must be an existing file; .* \(got 'nowhere.stl'\)"),
        ({"scale": 0.0}, r"polyhedron.scale must be positive and finite \[m\] \(got 0.0\)"),
        ({"offset": (0.0, 1.0)}, r"polyhedron.offset must be three finite"),
        ({"rotation": (1.0, np.nan, 0.0)}, r"polyhedron.rotation must be"),
    ],
)
def test_refusals(mesh_file, table, message):
    with pytest.raises(SceneError, match=message):
        Polyhedron(**({"file": mesh_file()} | table))


@pytest.mark.parametrize(
    ("name", "message"),
    [("body.xyz", "of one of the types .stl"), ("body.vtu", "readable mesh"), ("body.ply", "readable mesh")],
)
def test_files_of_other_kinds_are_refused(tmp_path, name, message):
    (tmp_path / name).write_text("no mesh\n", encoding="utf-8")
    with pytest.raises(SceneError, match=message):
        Polyhedron(file=str(tmp_path / name))

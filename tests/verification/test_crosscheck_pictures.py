"""Pictures of a case: what the files hold, how lines are drawn, and that a machine without rendering loses nothing."""

import dataclasses
import re

import meshio
import numpy as np
import pytest

from analytic_cases import analytic
from close import close
from eigencontact_verification.crosscheck import cases
from eigencontact_verification.crosscheck.figures import draw, gaps_of
from eigencontact_verification.crosscheck.inclusions import inclusion_case, shape_of, unit_length
from eigencontact_verification.crosscheck.judge import JudgedCase, judge
from eigencontact_verification.crosscheck.lines import STRESSES
from eigencontact_verification.crosscheck.pictures import fields, section, space
from eigencontact_verification.crosscheck.run import Solved, tasks_of
from eigencontact_verification.crosscheck.tractions import rectangle_case
from eigencontact_verification.crosscheck.whole import _pictures
from eigencontact_verification.crosscheck.worker import perform

CUBE = {"key": "cuboid", "center": [0.0, 0.0, 1.5], "edges": [1.0, 1.0, 1.0]}
BALL = {"key": "sphere", "center": [0.0, 0.0, 1.5], "radius": 0.5}
TURNED = {"key": "ellipsoid", "center": [0.0, 0.0, 1.0], "semi_axes": [0.5, 0.35, 0.25], "rotation": [0.5, 0.0, 0.0]}


def coarse(case):
    """The same case with a mesh that takes no time."""
    return dataclasses.replace(case, parameters={**case.parameters, "refine": [2, 3, 4]})


CASES = {
    "quarter": lambda: coarse(inclusion_case(CUBE, "xz", 0.3, name="cube")),
    "whole": lambda: coarse(inclusion_case(TURNED, "zz", 0.3, name="turned", mirrored=(False, False))),
    "half": lambda: coarse(inclusion_case(CUBE, "zz", 0.3, name="half", mirrored=(False, True))),
    "revolved": lambda: coarse(inclusion_case(BALL, "zz", 0.3, name="ball", revolved=True)),
    "traction": lambda: coarse(rectangle_case("shear-x", 0.3)),
}


@pytest.fixture(
    scope="module",
    params=[name if name == "revolved" else pytest.param(name, marks=pytest.mark.slow) for name in CASES],
)
def written(request, tmp_path_factory):
    pytest.importorskip("pyvista")
    case = CASES[request.param]()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(space, "_PIXELS", (800, 700))
        patch.setattr(fields, "SAMPLES", 30)
        for module in (space, section):
            patch.setattr(module, "OUTLINE_SAMPLES", 200)
        files = case.pictures(tmp_path_factory.mktemp(request.param) / "fields")
    return case, {file.name: file for file in files}


def test_the_mesh_holds_named_fields(written):
    case, files = written
    read = meshio.read(files["mesh.vtu"])
    stress = read.cell_data["stress"][0].reshape(-1, 3, 3)
    assert np.array_equal(stress, stress.swapaxes(1, 2))
    deviator = stress - np.trace(stress, axis1=1, axis2=2)[:, None, None] / 3 * np.eye(3)
    expected = np.sqrt(1.5 * (deviator**2).sum(axis=(1, 2)))
    np.testing.assert_allclose(read.cell_data["von_mises"][0], expected, rtol=1e-12)
    assert read.point_data["displacement"].shape == read.points.shape
    marks = np.unique(read.cell_data["region"][0])
    assert len(marks) == (1 if case.subject == "shear-x" else 2)


def test_the_mesh_opens_in_a_viewer(written):
    import pyvista as pv

    case, files = written
    mesh = pv.read(files["mesh.vtu"])
    assert {"displacement", "stress", "von_mises", "region"} <= {*mesh.point_data, *mesh.cell_data}
    reach = case.parameters["reach"]
    sides = 2 - np.array([plane != "none" for plane in case.parameters.get("symmetry", ["odd", "even"])])
    if case.parameters.get("elements") == "axisymmetric":
        assert mesh.area == close(reach**2, rel=1e-3)  # the viewer draws curved sides as chords
    else:
        assert mesh.volume == close(reach**3 * np.prod(sides), rel=1e-6)


def test_the_source_is_marked(written):
    case, files = written
    if case.subject == "shear-x":
        pytest.skip("a traction has no region")
    low, high = np.asarray(shape_of(case.parameters["shape"]).bounds)
    read = meshio.read(files["mesh.vtu"])
    middle = read.points[read.cells[0].data].mean(axis=1)
    marked = middle[read.cell_data["region"][0] == read.cell_data["region"][0].max()]
    assert len(marked) > 3
    assert np.all((marked >= low - 1e-9) & (marked <= high + 1e-9))


@pytest.mark.parametrize("name", ["mesh.png", "section.png"])
def test_pictures_show_something(written, name):
    from matplotlib.image import imread

    image = imread(written[1][name])[..., :3]
    assert min(image.shape[:2]) > 400
    inked = (image < 0.98).any(axis=2)
    assert 0.1 < inked.mean() < 0.95
    border = np.concatenate([inked[:4].ravel(), inked[-4:].ravel(), inked[:, :4].ravel(), inked[:, -4:].ravel()])
    assert not border.any()  # nothing is cut off
    vermilion = np.abs(image - np.array([0xD5, 0x5E, 0x00]) / 255).max(axis=2) < 0.12
    assert vermilion.sum() > 150  # the outline of the source


@pytest.mark.slow
def test_a_machine_that_cannot_render_keeps_the_rest(tmp_path, monkeypatch):
    pytest.importorskip("pyvista")

    def broken(*_args):
        raise RuntimeError("no display")

    monkeypatch.setattr(fields, "draw_space", broken)
    case = CASES["traction"]()
    found = JudgedCase(case=case, rows=(), outcomes=(), judged={}, estimates={})
    (note,) = _pictures([found], tmp_path)
    assert "mesh.png could not be drawn (no display); mesh.vtu and section.png were" in note
    assert sorted(file.name for file in next(tmp_path.iterdir()).iterdir()) == ["mesh.vtu", "section.png"]


@pytest.mark.parametrize(
    ("along", "gaps"),
    [
        (np.arange(9.0), []),
        (np.array([0.0, 1.0, 2.0, 5.0, 6.0, 7.0]), [(2.0, 5.0)]),
        (np.array([0.0, 1.0, 2.0, 4.0, 5.0, 8.0, 9.0]), [(2.0, 4.0), (5.0, 8.0)]),
        (np.array([0.0, 5.0]), []),
    ],
)
def test_gaps(along, gaps):
    assert gaps_of(along) == gaps


def test_lines_pass_through_what_is_compared_and_break_at_the_source():
    case = inclusion_case(CUBE, "zz", 0.3, name="cube")
    judged = case.judged()
    for profile in case.profiles:
        along, values = case.curve(profile)
        broken = np.isnan(values).all(axis=1)
        crossings = {"through-stress": 2, "across-stress": 1}.get(profile.name, 0)
        assert broken.sum() == crossings
        assert np.all(np.diff(along) > 0)
        at = np.searchsorted(along, profile.along - 1e-9)
        same = np.isclose(along[at], profile.along, atol=1e-9)
        assert same.sum() >= 2
        np.testing.assert_allclose(values[at[same]], judged[profile.name][same], rtol=1e-9, atol=1e-12)
    _, across = case.curve(next(profile for profile in case.profiles if profile.name == "across-stress"))
    jump = int(np.flatnonzero(np.isnan(across[:, 0]))[0])
    steps = dict(zip(STRESSES, across[jump + 1] - across[jump - 1], strict=True))
    # traction on the face x = 1/2 is continuous; s_zz loses the -E / (1 - nu^2) of a plate that may not expand
    assert max(abs(steps[name]) for name in ("s_xx", "s_xz", "s_xy")) < 0.02
    assert steps["s_zz"] == close(1 / (1 - 0.3**2), rel=0.02)
    assert steps["s_yy"] == close(0.3 / (1 - 0.3**2), rel=0.02)


def test_the_surface_above_a_flush_source_is_compared():
    flush = inclusion_case({**CUBE, "center": [0.0, 0.0, 0.5]}, "zz", 0.3, name="flush")
    for profile, edge in zip(flush.profiles[:3], (0.5, 0.5, 0.5 * 2**0.5), strict=True):
        assert profile.along[0] == 0.0
        ((low, high),) = gaps_of(profile.along)
        assert low < edge < high


@pytest.mark.parametrize("kernel", cases.kernels())
def test_figures_say_units(kernel):
    for case in cases.cases_of(kernel)[:3]:
        assert kernel in case.words or kernel.partition("-")[0] in ("shear", "pressure")
        assert f"ν = {case.parameters['poisson_ratio']:g}" in case.words
        for profile in case.profiles:
            assert re.fullmatch(r".+ \[.+\]", profile.label)
            assert (
                profile.unit
                in {
                    "displacement": {"p a / E", "q a / E", "a²/R", f"ε* {profile.label.rpartition('[')[2][:-1]}"},
                    "stress": {"p", "q", "p0", "E ε*"},
                    "strain": {"1"},
                }[profile.quantity]
            )


@pytest.mark.parametrize(
    ("key", "extents", "name"),
    [
        ("cuboid", (1.0, 1.0, 1.0), "edge"),
        ("cuboid", (1.6, 1.0, 0.6), "width"),
        ("cylinder", (1.0, 0.8, 0.8), "length"),
        ("ellipsoid", (0.5, 0.5, 1.0), "height"),
        ("layer", (1.0, 1.0, 0.25), "width"),
        ("torus", (1.4, 1.4, 0.4), "length unit"),
    ],
)
def test_the_unit_of_length_has_a_name(key, extents, name):
    assert unit_length(key, extents) == name


@pytest.mark.parametrize("fault", ["", "raises"])
def test_a_figure_is_drawn_of_whatever_was_solved(tmp_path, fault):
    case = analytic("case", fault)
    found = judge(Solved(case=case, outcomes=tuple((task, perform(task)) for task in tasks_of(case))))
    assert draw(found, tmp_path / "case.png").read_bytes().startswith(b"\x89PNG")

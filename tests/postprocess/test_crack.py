"""Cracks of stored results: stress along the path, mirror symmetry, thresholds of a caller, refusals, the command."""

import json

import numpy as np
import pytest

import eigencontact as ec
from close import close
from eigencontact.halfspace.edge_crack import edge_crack

LIMITS = {"length": "20 um", "threshold": "2 MPa sqrt(m)", "limit_amplitude": "400 MPa", "cycle": "all"}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A sphere that is pressed on steel and pulled to and fro, stored with the plane y = 0."""
    changes = ["grid.cells-per-contact-radius=8", "stress.0.depth-cells=20", "output.pictures=false"]
    scene = ec.load_scene("cattaneo-mindlin", changes).resolved()
    steps = [{"normal-load": 12.307}, {"tangential-load-x": 3.0}, {"tangential-load-x": -3.0}]
    place = tmp_path_factory.mktemp("crack")
    ec.run({**scene, "steps": steps}, place).dataset.close()
    return place


@pytest.mark.slow
def test_factors_are_those_of_the_stress_along_the_path(folder):
    """At 20 degrees, with the stress that another region at the points of the crack gives."""
    angle = np.radians(20.0)
    answer = ec.crack(folder, at=("-18 um", 0), angle=angle, **LIMITS)
    longest = 20e-6
    weights = edge_crack(angle)
    distances = longest * weights.places
    points = [[-18e-6 + s * np.sin(angle), 0.0, s * np.cos(angle)] for s in distances]
    with ec.region(folder, {"name": "own", "shape": "points", "points": points}, step=2) as data:
        xx, _, zz, _, xz, _ = data.own_stress.values[0].reshape(6, -1)
    n, t = np.array([-np.cos(angle), np.sin(angle)]), np.array([np.sin(angle), np.cos(angle)])
    tensor = np.array([[xx, xz], [xz, zz]])
    normal, shear = (np.einsum("i,ijp,j->p", way, tensor, n) for way in (n, t))
    expected = weights.factors(longest, normal, shear)
    computed = [float(answer.dataset[name].sel(step=2)[-1]) for name in ("mode_1", "mode_2")]
    np.testing.assert_allclose(computed, expected, rtol=0, atol=2e-3 * np.abs(expected).max())


def test_mirrored_cracks_under_a_symmetric_cycle_are_alike(folder):
    left, right = (
        ec.crack(folder, at=(f"{sign * 18} um", 0), angle=f"{sign * 20} deg", region="section", **LIMITS).dataset
        for sign in (-1, 1)
    )
    np.testing.assert_allclose(left.mode_1.sel(step=2), right.mode_1.sel(step=3), rtol=2e-3, atol=2e4)
    np.testing.assert_allclose(left.mode_2.sel(step=2), -right.mode_2.sel(step=3), rtol=2e-3, atol=2e4)


@pytest.mark.slow
def test_section_and_fresh_points_agree(folder):
    place = {"at": ("-18 um", 0), "angle": 0}
    fresh, section = (ec.crack(folder, **place, region=name, **LIMITS).dataset for name in (None, "section"))
    scale = float(fresh.effective_range.max())
    np.testing.assert_allclose(section.effective_range, fresh.effective_range, rtol=0, atol=0.06 * scale)


def test_threshold_of_the_caller_decides_the_arrest(folder):
    place = {"at": ("-21 um", 0), "angle": 0, "length": "20 um", "cycle": "all", "mode": "opening", "region": "section"}
    ranges = ec.crack(folder, threshold="1 Pa sqrt(m)", **place).dataset
    halfway = float(ranges.mode_1_range[20])
    assert ranges.mode_1_range.values[:20].min() > halfway > ranges.mode_1_range.values[21] > 0
    answer = ec.crack(folder, threshold=lambda lengths, ratios: np.full(lengths.shape, halfway), **place)  # noqa: ARG005
    assert answer.summary["outcome"] == "stops"
    assert answer.summary["arrest_length"] == close(float(ranges.length[20]), rel=1e-9)


@pytest.mark.slow
def test_hot_spot_gives_the_plane_of_the_criterion(folder):
    criterion = {"type": "findley", "slope": 0.3, "limit-amplitude": "500 MPa"}
    spot = ec.fatigue(folder, criterion, region="section", cycle="all").summary
    answer = ec.crack(folder, criterion=criterion, region="section", **LIMITS).summary
    assert answer["place"] == spot["place"][:2]
    across = np.array([spot["normal"][0], spot["normal"][2]])
    along = np.array([np.sin(answer["angle"]), np.cos(answer["angle"])])
    assert abs(across @ along) < 1e-12
    assert {caution["code"] for caution in answer["warnings"]} >= {"crack-plane-strain"}


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"at": ("1 um", 0, "2 um")}, "at must lie on the surface, at depth 0 (got 2 um)"),
        ({"at": ("1 m", 0)}, "place must lie within the window, x = "),
        ({"at": None}, "crack must start at a place (at) or at the hot spot"),
        ({"angle": None}, "angle must be given with at"),
        ({"angle": "80 deg"}, "crack.angle must be within 1.309 of the normal [rad]"),
        ({"threshold": "-2 MPa sqrt(m)"}, "threshold must be positive and finite"),
        ({"threshold": "2 MPa"}, "threshold must be a stress times a root of metres"),
        ({"rule": "el-hadad"}, "did you mean 'el-haddad'?"),
        ({"mode": "shear"}, "mode must be 'both' or 'opening'"),
        ({"length": "0.2 mm", "region": "section"}, "path must stay within region 'section'"),
        ({"cycle": (2, 2)}, "cycle must have two load steps or more"),
        ({"cycle": "last"}, "cycle must be given where the load history has no closed cycle"),
    ],
)
def test_refusals(folder, changes, words):
    arguments = {"at": ("-18 um", 0), "angle": 0, **LIMITS, **changes}
    with pytest.raises(ec.EigencontactError) as caught:
        ec.crack(folder, **arguments)
    assert words in str(caught.value)


def test_command_stores_table_and_picture(folder, capsys):
    from eigencontact.postprocess.crack_command import crack

    crack(
        folder,
        at="-18 um, 0 um",
        angle="10 deg",
        length="20 um",
        threshold="2 MPa sqrt(m)",
        cycle="all",
        region="section",
    )
    assert "dK_eff" in capsys.readouterr().out
    stored = json.loads((folder / "crack.json").read_text(encoding="utf-8"))
    assert stored["outcome"] in ("does not grow", "stops", "grows")
    assert (folder / "crack.png").stat().st_size > 10_000

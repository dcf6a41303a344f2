"""The cross-check can fail: faults planted in the code of the half-space, or in the model, turn agreement around.

The reference is solved once for the sound code. Each fault then changes a form of `eigencontact.halfspace.theorem` or
the conversion of the eigenstrain; what is judged runs through the same public call as always.
"""

from dataclasses import replace

import numpy as np
import pytest

from eigencontact.core.tensors import to_mandel
from eigencontact.halfspace import theorem
from eigencontact.halfspace.forms import Form
from eigencontact.library import inclusions
from eigencontact_verification.crosscheck.inclusions import InclusionCase, inclusion_case
from verdicts import references, words

BALL = {"key": "sphere", "center": [0.0, 0.0, 1.0], "radius": 0.5}
CUBE = {"key": "cuboid", "center": [0.0, 0.0, 1.0], "edges": [1.0, 1.0, 1.0]}
SOUND = {name: getattr(theorem, name) for name in ("_displacement", "_image", "_volume_strain")}


def wrong_residual(e, nu, *, half):
    """(1-2nu) for (1-nu) in the normal displacement by e_zz, of the region and of its image."""
    u = SOUND["_displacement"](e, nu, half=half)
    scale = 4.0 * nu * float(e[2, 2]) / (8.0 * np.pi * (1.0 - nu))
    u[2] = u[2] + scale * Form.potential("real", "phi").d(2)
    if half:
        u[2] = u[2] - scale * Form.potential("image", "phi").d(2)
    return u


def wrong_image(part):
    """The sign of one of the image's contractions: A of Psi, B of Phi, v of Phi, C of Chi."""

    def image(e):
        a, b, v, c, phi = SOUND["_image"](e)
        return {
            "A": (-1.0 * a, b, v, c, phi),
            "B": (a, -1.0 * b, v, c, phi),
            "v": (a, b, [-1.0 * row for row in v], c, phi),
            "C": (a, b, v, -1.0 * c, phi),
        }[part]

    return image


def unmirrored_shear(e):
    """e_13 and e_31 mirrored with the wrong sign."""
    wrong = e.copy()
    wrong[0, 2] = wrong[2, 0] = -e[0, 2]
    return SOUND["_image"](wrong)


def without_eigenstress_of_dilatation(e, nu, *, half):
    """The eigenstress lambda e_kk left out of the sources: displacement of a region that has only 2 mu e."""
    scale, trace = 1.0 / (8.0 * np.pi * (1.0 - nu)), float(np.trace(e))
    u, phi = SOUND["_displacement"](e, nu, half=half), Form.potential("real", "phi")
    u = [form + 2.0 * nu * trace * scale * phi.d(i) for i, form in enumerate(u)]
    if half:
        phi = Form.potential("image", "phi")
        for i, sign in enumerate((1.0, 1.0, -1.0)):
            u[i] = u[i] + 2.0 * nu * trace * scale * (
                (3.0 - 4.0 * nu) * sign * phi.d(i) + 2.0 * phi.d(2).d(i).times_z()
            )
    return u


def without_volume_stress(e, nu, *, half):
    """No lambda times the elastic volume strain in Hooke's law."""
    return Form()


def twice_the_shear(components):
    """Engineering shear taken for tensor shear."""
    return to_mandel([*components[:3], *(2.0 * part for part in components[3:])])


@pytest.fixture
def plant(monkeypatch):
    """Replace a function of the theorem for one test; its cached forms are made anew before and after."""

    def set_fault(name, function):
        monkeypatch.setattr(theorem, name, function)
        theorem.response.cache_clear()

    theorem.response.cache_clear()
    yield set_fault
    monkeypatch.undo()
    theorem.response.cache_clear()


@pytest.fixture(scope="module")
def ball():
    """A ball that expands along z: axisymmetric elements; and what these say."""
    case = inclusion_case(BALL, "zz", 0.3, name="faults", revolved=True)
    return case, references(case)


AXISYMMETRIC = [
    pytest.param("_displacement", wrong_residual, {"displacement"}, id="(1-2nu) for (1-nu)"),
    pytest.param("_image", wrong_image("A"), {"displacement", "stress"}, id="sign of image A"),
    pytest.param("_image", wrong_image("B"), {"stress"}, id="sign of image B"),
    pytest.param("_image", wrong_image("v"), {"displacement", "stress"}, id="sign of image v"),
    pytest.param("_image", wrong_image("C"), {"displacement", "stress"}, id="sign of image C"),
    pytest.param("_displacement", without_eigenstress_of_dilatation, {"displacement"}, id="no lambda trace: source"),
    pytest.param("_volume_strain", without_volume_stress, {"stress"}, id="no lambda trace: Hooke's law"),
]


@pytest.mark.slow
def test_sound_code_agrees(ball):
    assert words(*ball) == {"displacement": "agrees", "stress": "agrees"}


@pytest.mark.slow
@pytest.mark.parametrize(("name", "fault", "seen_in"), AXISYMMETRIC)
def test_fault_disagrees(ball, plant, name, fault, seen_in):
    plant(name, fault)
    found = words(*ball)
    assert {quantity for quantity, word in found.items() if word == "disagrees"} >= seen_in


@pytest.mark.slow
@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_shifted_mesh_disagrees(ball, monkeypatch, direction):
    """The region of the elements lies 5 % of its extent too deep or too high."""
    case, _ = ball
    step = 0.05 * direction
    sound = InclusionCase.axisymmetric_model

    def shifted(self, level, outer):
        model = sound(self, level, outer)
        (region,) = model.regions
        (low, high), contains = region.bounds, region.contains
        bounds = ((low[0], low[1] + step), (high[0], high[1] + step))
        return replace(model, regions=(replace(region, contains=lambda r, z: contains(r, z - step), bounds=bounds),))

    monkeypatch.setattr(InclusionCase, "axisymmetric_model", shifted)
    assert words(case, references(case)) == {"displacement": "disagrees", "stress": "disagrees"}


@pytest.fixture(scope="module")
def sheared_cube():
    """A cube that shears in xz, a quarter of it meshed."""
    case = inclusion_case(CUBE, "xz", 0.3, name="faults")
    kept = tuple(profile for profile in case.profiles if profile.name != "beside-stress")  # needs still finer meshes
    case = replace(case, profiles=kept)
    return case, references(case)


@pytest.mark.slow
def test_sound_shear_agrees(sheared_cube):
    assert words(*sheared_cube) == {"displacement": "agrees", "stress": "agrees"}


@pytest.mark.slow
def test_wrong_mirror_sign_of_shear_disagrees(sheared_cube, plant):
    plant("_image", unmirrored_shear)
    assert words(*sheared_cube) == {"displacement": "disagrees", "stress": "disagrees"}


@pytest.mark.slow
def test_twice_the_shear_disagrees(sheared_cube, monkeypatch):
    monkeypatch.setattr(inclusions, "to_mandel", twice_the_shear)
    assert words(*sheared_cube) == {"displacement": "disagrees", "stress": "disagrees"}

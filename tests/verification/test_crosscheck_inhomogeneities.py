"""Cross-check of spheres of other material and of bonded layers: what is judged is right, faults are found."""

from dataclasses import replace

import numpy as np
import pytest

import eigencontact as ec
from close import close
from eigencontact_verification.crosscheck import cases, inhomogeneities, layers
from eigencontact_verification.crosscheck.equivalent import Cellwise, Sphere, by_cells, by_one_eigenstrain
from eigencontact_verification.crosscheck.judge import judge
from eigencontact_verification.crosscheck.run import Solved, tasks_of
from eigencontact_verification.crosscheck.worker import perform
from eigencontact_verification.oracles.hertz import axis_stress

POINTS = np.array([[0.0, 0.0, 0.0], [0.9, 0.0, 0.0], [2.0, 0.0, 0.0]])


def sphere(**changes):
    given = {
        "depth": 1.0, "radius": 0.5, "poisson_ratio": 0.3, "young_modulus_inside": 4.0, "poisson_ratio_inside": 0.3,
        "pressure": 1.0, "prestrain": 0.0,
    }  # fmt: skip
    return Sphere(**{**given, **changes})


def coarser(case, fine):
    """The same case with two of its lines, on meshes that take half a second."""
    return replace(case, profiles=case.profiles[:2], parameters={**case.parameters, "fine": fine})


def solved(case):
    return Solved(case=case, outcomes=tuple((task, perform(task)) for task in tasks_of(case)))


def judged_again(found, case):
    """Verdicts on another problem's semi-analytical answer, with the finite elements that are there."""
    outcomes = tuple((task, perform(replace(task, case=case)) if task.level is None else outcome)
                     for task, outcome in found.outcomes)  # fmt: skip
    return judge(replace(found, outcomes=outcomes))


def parts(case, path, factor):
    """A case whose parameter at `path` is multiplied by a factor."""
    *folders, last = path

    def changed(tree, keys):
        if not keys:
            return {**tree, last: tree[last] * factor}
        inner = changed(tree[keys[0]], keys[1:])
        if isinstance(tree, list):
            return [inner if number == keys[0] else value for number, value in enumerate(tree)]
        return {**tree, keys[0]: inner}

    return replace(case, parameters=changed(case.parameters, folders))


# --- the two resolutions -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("answer", [lambda one: by_cells(one, 6), by_one_eigenstrain], ids=["cells", "one"])
def test_a_sphere_of_the_same_material_changes_nothing(answer):
    found = answer(sphere(young_modulus_inside=1.0))
    assert np.abs(found.eigenstrain).max() < 1e-12


@pytest.mark.parametrize("ratio", [0.5, 4.0, 1e3])
def test_one_eigenstrain_of_a_deep_misfit(ratio):
    """Far below the surface a sphere of bulk modulus K_i that misfits in a matrix keeps K_i / (K_i + 4 G / 3) of it."""
    found = by_one_eigenstrain(sphere(depth=100.0, young_modulus_inside=ratio, pressure=0.0, prestrain=1.0))
    bulk, shear = ratio / (3 * (1 - 0.6)), 1.0 / 2.6
    effective = bulk / (bulk + 4 / 3 * shear) * (1 + 4 / 3 * shear / (1.0 / (3 * (1 - 0.6))))
    assert found.eigenstrain == close([effective] * 3 + [0.0] * 3, rel=1e-6, abs=1e-9)
    assert np.abs(found.remainder).max() < 1e-5


@pytest.mark.slow
@pytest.mark.parametrize(("ratio", "bound"), [(0.5, 0.02), (4.0, 0.02)])
def test_cells_and_one_eigenstrain_where_the_load_is_wide(ratio, bound):
    """What one eigenstrain leaves is about what it is off by."""
    problem = sphere(depth=0.4, radius=0.1, young_modulus_inside=ratio)
    one, points = by_one_eigenstrain(problem), POINTS * 0.2
    cells, whole = (found.field(points, "displacement")[:, 2] for found in (by_cells(problem, 12), one))
    corrected = whole + one.correction(points, "displacement")[:, 2]
    size = np.abs(cells).max()
    assert np.abs(corrected - cells).max() < bound * size
    assert np.abs(corrected - cells).max() < np.abs(whole - cells).max() + 0.01 * size


@pytest.mark.parametrize("quantity", ["displacement", "stress"])
def test_field_between_the_cells(quantity):
    """Cubics between the lattice's points against the closed form of the cuboid that the cells make up."""
    box = by_cells(sphere(pressure=0.0, prestrain=1.0), 8).box
    strain = np.zeros((6, *box.shape))
    strain[0], strain[2], strain[4] = 1.0, -0.5, 0.3 * 2**0.5
    found = Cellwise(box=box, eigenstrain=strain, matrix=sphere().matrix)
    edge = 8 * box.pitch[0]
    cube = ec.make("cuboid", kind="inclusion-shape", center=(0.0, 0.0, 1.0), edges=(edge,) * 3)
    tensor = np.array([[1.0, 0, 0.3], [0, 0, 0], [0.3, 0, -0.5]])
    points = POINTS if quantity == "displacement" else np.array([[1.5, 0.1, 0.11], [0.2, 0.0, 1.03], [0.0, 1.3, 2.2]])
    expected = ec.inclusion_field(cube, tensor, points, young_modulus=1.0, poisson_ratio=0.3, quantity=quantity)
    assert np.abs(found.field(points, quantity) - expected).max() < 2e-3 * np.abs(expected).max()


# --- the sum over waves ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("pressure", ["hertz", "uniform"])
def test_layers_of_one_material_are_the_half_space(pressure):
    """Closed forms below the middle; its lift is 2 (1 - ν²) p a / E by uniform pressure, π/4 of that by Hertz's."""
    case = layers.layered_case(((0.3, 1.0, 0.3), (0.5, 1.0, 0.3)), name="same", pressure=pressure)
    z = np.array([0.2, 0.3, 0.7, 2.0])
    points = np.stack([0 * z, 0 * z, z], axis=1)
    found = case.field(points, "stress")
    if pressure == "hertz":
        down, out = axis_stress(z, 0.3)
    else:
        root = np.sqrt(1 + z * z)
        down, out = (z / root) ** 3 - 1, -0.8 + 1.3 * z / root - 0.5 * (z / root) ** 3
    assert found[:, 2, 2] == close(down, abs=1e-6)
    assert found[:, 0, 0] == close(out, abs=1e-6)
    assert found[:, 1, 1] == close(out, abs=1e-6)
    lift = 2 * (1 - 0.09) * (np.pi / 4 if pressure == "hertz" else 1.0)
    assert case.field(np.zeros((1, 3)), "displacement")[0, 2] == close(lift, rel=2e-5)


def test_interfaces_are_met_from_both_sides():
    """Traction passes an interface, the stress along it jumps."""
    case = layers.layered_case(((0.5, 4.0, 0.3),), name="both")
    profile = next(profile for profile in case.profiles if profile.name == "half-radius-stress")
    near = np.flatnonzero(np.abs(profile.along - 0.5) < 1e-3)
    assert near.size == 2
    above, below = case.field(profile.points[near], "stress")
    assert above[2] == close(below[2], abs=1e-4)
    assert abs(above[0, 0] - below[0, 0]) > 0.1


# --- the elements, and faults ------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def misfit():
    case = inhomogeneities.inhomogeneity_case(0.5, 4.0, pressure=0.0, prestrain=1.0, whole=True)
    return solved(coarser(case, 0.5))


@pytest.fixture(scope="module")
def coated():
    return solved(coarser(layers.layered_case(((0.5, 4.0, 0.3),), name="faults"), 1.5))


@pytest.mark.slow
def test_sound_code_agrees(misfit, coated):
    assert judge(misfit).word == "agrees"
    assert judge(coated).word == "agrees"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("path", "factor"),
    [
        (("sphere", "young_modulus_inside"), 1.1),
        (("sphere", "depth"), 1.05),
    ],
)
def test_a_wrong_sphere_disagrees(misfit, path, factor):
    assert judged_again(misfit, parts(misfit.case, path, factor)).word == "disagrees"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("path", "factor"),
    [
        (("layers", 0, "thickness"), 1.05),
        (("layers", 0, "young_modulus"), 1.1),
        (("layers", 0, "poisson_ratio"), 1.05),
    ],
)
def test_a_wrong_layer_disagrees(coated, path, factor):
    assert judged_again(coated, parts(coated.case, path, factor)).word == "disagrees"


@pytest.mark.slow
def test_cells_under_load():
    """The quick case of cells, its elements solved once: nothing disagrees, and a modulus 10 % off does."""
    case = next(case for case in cases.cases_of("inhomogeneity") if case.quick and not case.whole)
    known = solved(case)
    for factor in (1.0, 1.1):
        found = judged_again(known, parts(case, ("sphere", "young_modulus_inside"), factor))
        assert (found.word == "disagrees") == (factor != 1.0)

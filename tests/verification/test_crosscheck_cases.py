"""The list of cases: what it covers, that its planes of symmetry are those of the fields, and strangers' shapes."""

import json
import pickle

import numpy as np
import pytest

import eigencontact as ec
from eigencontact_verification.crosscheck import cases, strangers
from eigencontact_verification.crosscheck.inclusions import EIGENSTRAINS, InclusionCase, shape_of, tensor_of
from eigencontact_verification.crosscheck.lines import VECTORS, clear_of, inner_lines, planes_of, surface_lines
from eigencontact_verification.crosscheck.store import content_hash
from eigencontact_verification.crosscheck.tractions import TRACTIONS

MATERIAL = {"young_modulus": 1.0, "poisson_ratio": 0.3}
CUBE = {"key": "cuboid", "center": (0.0, 0.0, 1.5), "edges": (1.0, 1.4, 0.8)}
OWN = (
    "pressure", "shear-x", "shear-y", "cuboid", "sphere", "ellipsoid", "cylinder", "layer", "polyhedron",
    "inhomogeneity", "polynomial-eigenstrain", "bonded-layers", "plasticity", "wear",
)  # fmt: skip

LENS = """
from dataclasses import dataclass
from typing import ClassVar
from eigencontact.plugin import InclusionShape, Length, Place, hookimpl

@dataclass(frozen=True, kw_only=True)
class Lens(InclusionShape):
    key: ClassVar[str] = "lens"
    references: ClassVar[tuple[str, ...]] = ("elementary",)
    {example}
    center: Place
    radius: Length
    height: Length
    {more}

    def __post_init__(self):
        from eigencontact.plugin import require
        require(self.height < 0.5 * self.radius, self.key, "height", self.height, "below half the radius [m]")

    @property
    def bounds(self):
        (x, y, z), r, h = self.center, self.radius, self.height
        return (x - r, y - r, z - h), (x + r, y + r, z + h)

    def contains(self, x, y, z):
        a, b, c = self.center
        return abs(z - c) <= self.height * (1 - ((x - a) ** 2 + {squeeze} * (y - b) ** 2) / self.radius ** 2)

@hookimpl
def eigencontact_register():
    return [Lens]
"""


def lens(*, example="", more="", squeeze=1):
    return LENS.format(example=example, more=more, squeeze=squeeze)


def fields_at(source, points, quantity):
    """Semi-analytical field of one eigenstrain or traction component."""
    if source in ("x", "y", "z"):
        load = [float(axis == source) for axis in "xyz"]
        return ec.rectangle_field(load, (1.0, 0.6), points, quantity=quantity, **MATERIAL)
    return ec.inclusion_field(shape_of(CUBE), tensor_of(source), points, quantity=quantity, **MATERIAL)


@pytest.mark.parametrize("source", [*EIGENSTRAINS, "x", "y", "z"])
def test_planes_are_those_of_the_fields(source):
    """Mirrored points have the mirrored field on an even plane, its negative on an odd one."""
    components = EIGENSTRAINS.get(source, [source])
    points = np.abs(np.random.default_rng(3).normal(size=(40, 3))) + 0.02
    for axis, plane in enumerate(planes_of(components)):
        assert plane in ("even", "odd")
        mirror = np.eye(3)
        mirror[axis, axis] = -1.0
        sign = 1.0 if plane == "even" else -1.0
        u, v = (fields_at(source, at, "displacement") for at in (points, points @ mirror))
        assert np.abs(v - sign * u @ mirror).max() <= 1e-12 * np.abs(u).max()
        s, t = (fields_at(source, at, "stress") for at in (points, points @ mirror))
        assert np.abs(t - sign * mirror @ s @ mirror).max() <= 1e-12 * np.abs(s).max()


def test_components_that_disagree_have_no_plane():
    assert planes_of(["xx", "xz"]) == ("none", "even")
    assert planes_of(["xy", "zz"]) == ("none", "none")


@pytest.mark.parametrize("source", ["xx", "xy", "xz", "yz"])
def test_components_left_out_vanish(source):
    """On a line in a plane of symmetry only components that can differ from zero are compared, and those do."""
    for profile in surface_lines(3.0, planes_of([source])):
        values = fields_at(source, profile.points, "displacement")
        for column, name in enumerate(VECTORS):
            size = np.abs(values[:, column]).max()
            if name not in profile.components:
                assert size <= 1e-14
        assert max(np.abs(values[:, VECTORS.index(name)]).max() for name in profile.components) > 1e-3


def test_kernels():
    assert cases.kernels()[: len(OWN)] == OWN
    with pytest.raises(ValueError, match=r"kernel must be one of pressure, .*'cube'.*install its plugin"):
        cases.cases_of("cube")


@pytest.mark.parametrize("kernel", OWN)
def test_cases_are_well_formed(kernel):
    """Names are unique, parameters are JSON, cases travel to other processes, points are in the body and off faces."""
    found = cases.cases_of(kernel)
    assert len({case.name for case in found}) == len(found)
    assert len({json.dumps(case.parameters, sort_keys=True) for case in found}) == len(found)
    for case in found:
        assert set(case.name) <= set("abcdefghijklmnopqrstuvwxyz0123456789-")
        assert {profile.quantity for profile in case.profiles} - {"strain"} == {"displacement", "stress"}
        for profile in case.profiles:
            assert profile.points[:, 2].min() >= 0
            assert np.abs(profile.points).max() < 0.5 * case.parameters["reach"]
            assert len(profile.points) >= (4 if profile.name == "depth" else 10)
    case = pickle.loads(pickle.dumps(found[0]))
    assert case.parameters == found[0].parameters


def test_coverage_of_the_cuboid():
    """Six components and the five loadings of Table 2.3, at three depths, for three Poisson's ratios."""
    found = {
        (case.parameters["shape"]["center"][2], case.parameters["poisson_ratio"], case.parameters["eigenstrain"])
        for case in cases.cases_of("cuboid")
    }
    names = ("xx", "yy", "zz", "xy", "xz", "yz", "xx-yy", "xx-zz")
    assert {(d, nu, name) for d in (0.5, 1.5, 5.0) for nu in (0.0, 0.3, 0.45) for name in names} <= found


@pytest.mark.parametrize("kernel", TRACTIONS)
def test_coverage_of_tractions(kernel):
    assert {case.parameters["poisson_ratio"] for case in cases.cases_of(kernel)} == {0.0, 0.3, 0.45}


@pytest.mark.parametrize("kernel", OWN)
def test_size_of_solid_models(kernel):
    """The finest solid model of every case has fewer than 2.6 million unknowns (some 4 GB when solved)."""
    from eigencontact_verification.fem.mesh import build_grid

    sizes = {}
    for case in cases.cases_of(kernel):
        if kernel in TRACTIONS:
            model = case.model(2, reach=case.parameters["reach"])
        elif case.parameters.get("elements") == "solid":
            model = case.solid_model(2, "fixed")
        else:
            continue
        x, y, z = build_grid(model).shape
        sizes[case.name] = 3 * (2 * x + 1) * (2 * y + 1) * (2 * z + 1)
    assert max(sizes.values(), default=0) < 2_600_000


def test_lines_keep_off_the_boundary():
    cube = shape_of(CUBE)
    lines = inner_lines(cube.contains, cube.bounds, (0.1, 0.1, 1.4), margin=0.1)
    faces = np.array(cube.bounds)
    for line in lines:
        inside = cube.contains(*line.points.T)
        gap = np.abs(line.points[:, None, :] - faces[None]).min(axis=1)
        assert np.all(gap[inside] >= 0.05)
    assert {bool(line_has) for line in lines for line_has in cube.contains(*line.points.T)} == {True, False}
    at = np.array([[0.0, 0.0, 1.5], [0.49, 0.0, 1.5], [0.55, 0.0, 1.5], [0.7, 0.0, 1.5]])
    assert clear_of(cube.contains, at, 0.1).tolist() == [True, False, False, True]


def test_stranger_without_a_word(install):
    """A shape that only says bounds and contains is built, found to be of revolution and given two cases."""
    install(lens())
    assert cases.kernels()[-1] == "lens"
    expansion, shear = cases.cases_of("lens")
    assert isinstance(expansion, InclusionCase)
    assert (expansion.parameters["elements"], shear.parameters["elements"]) == ("axisymmetric", "solid")
    assert (expansion.parameters["eigenstrain"], shear.parameters["eigenstrain"]) == ("uniform", "xz")
    assert shear.parameters["symmetry"] == ["odd", "even"]
    assert shape_of(expansion.parameters["shape"]).bounds[0][2] > 0
    assert expansion.quick
    assert not shear.quick


def test_stranger_that_declares_an_example(install):
    declared = "example: ClassVar = {'center': (0.0, 0.0, 3e-6), 'radius': 2e-6, 'height': 5e-7}"
    install(lens(example=declared, squeeze=2))
    expansion, _ = cases.cases_of("lens")
    assert expansion.parameters["shape"] == {
        "key": "lens", "center": (0.0, 0.0, 3e-6), "radius": 2e-6, "height": 5e-7
    }  # fmt: skip
    assert expansion.parameters["elements"] == "solid"
    assert expansion.parameters["symmetry"] == ["even", "even"]
    assert not expansion.quick


def test_stranger_that_cannot_be_guessed_is_a_gap(install):
    install(lens(more="name: str"))
    assert "lens" not in cases.kernels()
    expected = (
        "shape 'lens' must be buildable from lengths (got none that it accepts); give its class an attribute example, "
        "a mapping of its parameters"
    )
    assert [gap.reason for gap in cases.gaps() if gap.subject == "lens"] == [expected]


def test_symmetry_of_shapes():
    """Found from `contains` alone; a shape off the axis or turned has none."""
    ball = ec.make("sphere", kind="inclusion-shape", center=(0, 0, 2.0), radius=1.0)
    cube = shape_of(CUBE)
    aside = ec.make("sphere", kind="inclusion-shape", center=(0.3, 0, 2.0), radius=1.0)
    turned = ec.make(
        "ellipsoid", kind="inclusion-shape", center=(0, 0, 2.0), semi_axes=(1, 0.5, 0.5), rotation=(0.5, 0, 0)
    )
    assert [strangers.is_revolved(shape) for shape in (ball, cube, aside, turned)] == [True, False, False, False]
    assert [strangers.is_mirrored(shape, 0) for shape in (ball, cube, aside, turned)] == [True, True, False, False]
    assert [strangers.is_mirrored(shape, 1) for shape in (ball, cube, aside, turned)] == [True, True, True, False]
    for shape in (ball, cube, aside, turned):
        assert shape.contains(*strangers.point_inside(shape))


def test_the_code_that_decides_a_solution_is_found():
    """A module that moves must not leave its old name in the hash of stored solutions."""
    kinds = {type(case): case for key in cases.kernels() for case in cases.cases_of(key)}
    assert len(kinds) >= 6
    assert all(content_hash(case, 0, "fixed") for case in kinds.values())

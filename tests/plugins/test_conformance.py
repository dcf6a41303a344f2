"""Bundled shapes, fields, geometries, laws and layered media pass the kit that a stranger's must pass."""

from pathlib import Path

import numpy as np
import pytest

import eigencontact as ec
from eigencontact.core.held_arrays import hold
from eigencontact_verification.conformance import checks_for, parametrize_with_checks

GRAIN = hold(labels=np.array([[[0, 2], [2, 2], [2, 1]], [[0, 0], [0, 2], [1, 1]]]))
BOWL = hold(x=np.arange(-3.0, 4.0), y=np.arange(-2.0, 3.0), gap=np.hypot(*np.ogrid[-2:3, -3:4]) ** 2)
STYLUS = hold(x=np.arange(-3.0, 4.0), height=-(np.arange(-3.0, 4.0) ** 2))


def shape(key, **parameters):
    return ec.make(key, kind="inclusion-shape", **parameters)


#: Of each class the one that is hardest on it.
SHAPES = [
    shape("cuboid", center=(0.1, 0.2, 1.5), edges=(1.0, 2.0, 3.0), rotation=("30 deg", 0.0, 0.0)),  # flush, turned
    shape("sphere", center=(0.1, 0.2, 1.3), radius=1.3),  # tangent to the surface
    shape("ellipsoid", center=(0.0, 1e-6, 5e-6), semi_axes=(1e-6, 2e-6, 3e-6), rotation=(0.3, 0.5, 0.7)),
    shape("cylinder", center=(0.0, 0.0, 1.0), radius=1.0, length=4.0, axis="x"),
    shape("polyhedron", file=str(Path(__file__).with_name("wedge.off")), scale="1 um", rotation=(0.3, 0.0, 0.0)),
    shape("layer", size=(2.0, 1.0), thickness=0.1, top=0.2),
    shape("voxels", file=GRAIN.name, value=2, spacing=(0.4, 0.5, 0.3), origin=(0.1, 0.2, 0.3)),
]
MORE_SHAPES = [
    shape("ellipsoid", center=(0.0, 0.0, 0.02), semi_axes=(1.0, 0.5, 0.02)),  # a disc that touches the surface
    shape("cuboid", center=(0.1, 0.2, 3.0), edges=(1.0, 2.0, 3.0)),
    shape("cuboid", center=(0.1, 0.2, 1.5), edges=(1.0, 2.0, 3.0)),  # flush with the surface
    shape("cuboid", center=(1e-4, 0.0, 2e-6), edges=(1e-3, 2e-6, 3e-6)),
    shape("cuboid", center=(0.1, 0.2, 1.0), edges=(1.0, 2.0, 3.0), rotation=(0.3, 0.0, "90 deg")),  # flush, lying
    shape("cuboid", center=(0.0, 0.0, 0.71), edges=(1.0, 20.0, 1.0), rotation=(0.1, "45 deg", 0.0)),  # a bar on edge
    shape("sphere", center=(1e-6, 2e-6, 3e-6), radius=2e-6),
    shape("cylinder", center=(0.0, 1e-6, 5e-6), radius=1e-6, length=4e-6),
    shape("layer", size=(2e-3, 1e-3), thickness=1e-4, center=(1e-3, 0.0)),
]


@parametrize_with_checks(SHAPES)
def test_shapes_conform(component, check):
    check(component)


@pytest.mark.slow
@parametrize_with_checks(MORE_SHAPES)
def test_other_places_and_sizes_conform(component, check):
    check(component)


TILTED = shape("cuboid", center=(0.0, 1e-6, 5e-6), edges=(1e-6, 2e-6, 3e-6), rotation=(0.3, 0.5, 0.7))


@parametrize_with_checks(
    [TILTED], waive={"check_quadrature": "its two rules differ by 2.3 % where all faces are tilted"}
)
def test_a_tilted_cuboid_conforms(component, check):
    check(component)


def field(key, **parameters):
    return ec.make(key, kind="eigenstrain-field", **parameters)


FIELDS = [
    field("uniform", value=1e-3),
    field(
        "uniform", value=((1e-3, 2e-4, 0.0), (2e-4, 0.0, 0.0), (0.0, 0.0, -1e-3)), times=(0.0, 2.0), factors=(0.0, 1.0)
    ),
    field("depth-profile", depths=(0.0, 2e-3), values=(4e-3, 0.0), direction="in-plane"),
    field("thermal", expansion=1e-5, temperature=100.0),
    field("thermal", expansion=1e-5, temperature=100.0, decay_depth=1e-4),
    field("peened-layer", peak=2e-3, peak_depth=1e-4, width=5e-5),
]


@parametrize_with_checks(FIELDS)
def test_fields_conform(component, check):
    check(component)


GEOMETRIES = [
    ec.make("sphere", kind="geometry", radius=1e-3),
    ec.make("ellipsoid", kind="geometry", radius_x=1e-3, radius_y=2e-3, angle=0.3),
    ec.make("cylinder", kind="geometry", radius=1e-3, length=2e-3),
    ec.make("rounded-punch", kind="geometry", flat_radius=1e-4, edge_radius=1e-5),
    ec.make("rounded-cone", kind="geometry", half_angle=1.4, tip_radius=1e-5),
    ec.make("topography", kind="geometry", file="gallery:rough_surface.npz"),
    ec.make("random-rough", kind="geometry", size=(1e-4, 5e-5), short_cutoff=1e-5, rms_slope=0.1),
    ec.make("gap-map", file=BOWL.name),
    ec.make("wedge", half_angle=1.4, angle=0.3),
    ec.make("profile", file=STYLUS.name),
]


@parametrize_with_checks(GEOMETRIES)
def test_geometries_conform(component, check):
    check(component)


def law(key, **parameters):
    return ec.make(key, kind="friction-law", **parameters)


LAWS = [
    law("coulomb", coefficient=0.3),
    law("coulomb", coefficient=5.0),
    law("shear-cap", coefficient=0.3, cap="200 MPa"),
    law("by-material", coefficients={"substrate": 0.3}),
    law("coulomb-map", coefficient=0.2, regions=[{"radius": 1e-6, "coefficient": 0.6}]),
    law(
        "coulomb-map",
        coefficient=0.2,
        regions=[{"center": (1e-6, 0.0), "size": (1e-6, 2e-6), "angle": 0.3, "coefficient": 0.0}],
    ),
]


@parametrize_with_checks(LAWS)
def test_friction_laws_conform(component, check):
    check(component)


def wear(key, **parameters):
    return ec.make(key, kind="wear-law", **parameters)


WEAR = [
    wear("archard", coefficient="1e-13 m^3/(N m)"),
    wear("archard", coefficient=1e-4, hardness="2 GPa"),
    wear("dissipated-energy", coefficient="1e-3 mm^3/J"),
    wear("dissipated-energy", coefficient=0.0),
    wear("amplitude-scaled", coefficient="1e4 mm^3/(J mm)"),
    wear("threshold-energy", coefficient="1e-3 mm^3/J", threshold="1 kJ/m^2"),
    wear("threshold-energy", coefficient="1e-3 mm^3/J", threshold=0.0),
    wear("by-material", laws={"substrate": {"type": "archard", "coefficient": 1e-13}}),
]


@parametrize_with_checks(WEAR)
def test_wear_laws_conform(component, check):
    check(component)


def stack(*layers, substrate=(210e9, 0.3)):
    """Bonded layers of (thickness, E, nu) on a substrate of (E, nu)."""
    tables = [{"thickness": h, "young_modulus": E, "poisson_ratio": nu} for h, E, nu in layers]
    foundation = {"young_modulus": substrate[0], "poisson_ratio": substrate[1]}
    return ec.make("bonded-layers", kind="layered-medium", layers=tables, substrate=foundation)


MEDIA = [
    stack((1e-6, 420e9, 0.3)),
    stack((1e-6, 1e9, 0.5), (1e-3, 4e11, -0.5), (2e-9, 2e12, 0.0), substrate=(2e11, 0.5)),
    stack((1.0, 1e12, 0.3), substrate=(1e6, 0.3)),
]


@parametrize_with_checks(MEDIA)
def test_layered_media_conform(component, check):
    check(component)


def material(key, **parameters):
    return ec.make(key, kind="constitutive-law", **parameters)


TURNED = {"x_axis": (1.0, 2.0, 2.0), "y_axis": (2.0, 1.0, -2.0)}
NICKEL = {"c11": "246.5 GPa", "c12": "147.3 GPa", "c44": "124.7 GPa"}
FIBRE = {"axial_modulus": 230e9, "transverse_modulus": 15e9, "axial_shear_modulus": 24e9, "axis": (1.0, 2.0, -3.0)}
PLY = {"moduli": (130e9, 10e9, 8e9), "poisson_ratios": (0.3, 0.25, 0.4), "shear_moduli": (5e9, 4e9, 3e9)}
STEEL = {"young_modulus": "210 GPa", "poisson_ratio": 0.3}
MATERIALS = [
    material("elastic", **STEEL),
    material("isotropic", young_modulus="70 GPa", poisson_ratio=0.33),
    material("isotropic", young_modulus=1e3, poisson_ratio=-0.9),
    material("isotropic", young_modulus="1 MPa", poisson_ratio=0.5),
    material("isotropic", young_modulus=0.0, poisson_ratio=0.5),
    material("void"),
    material("rigid"),
    material("cubic", **NICKEL),
    material("cubic", **NICKEL, **TURNED),
    material("orthotropic", **PLY, **TURNED),
    material("orthotropic", moduli=(1e9,) * 3, poisson_ratios=(0.5,) * 3, shear_moduli=(1e9 / 3,) * 3),
    material("transversely-isotropic", **FIBRE, axial_poisson_ratio=0.2, transverse_poisson_ratio=0.4),
    material("transversely-isotropic", **FIBRE, axial_poisson_ratio=0.5, transverse_poisson_ratio=1 - 7.5 / 230),
    material("stiffness", stiffness=[[1e9 * ((i == j) + 0.1) for j in range(6)] for i in range(6)], **TURNED),
]


@parametrize_with_checks(MATERIALS)
def test_constitutive_laws_conform(component, check):
    check(component)


def curve(kind, key, **parameters):
    return ec.make(key, kind=kind, **parameters)


CURVES = [
    curve("hardening-law", "perfect", yield_stress="1 GPa"),
    curve("hardening-law", "linear", yield_stress="1 GPa", modulus="20 GPa"),
    curve("hardening-law", "linear", yield_stress="1 GPa", modulus="-20 GPa", least_stress="50 MPa"),
    curve("hardening-law", "swift", B="1240 MPa", C=30, n=0.085),
    curve("hardening-law", "ludwik", yield_stress="1 GPa", strength="2 GPa", n=0.4),
    curve("hardening-law", "voce", yield_stress="1 GPa", saturation="0.5 GPa", rate=40),
    curve("hardening-law", "tabulated", strain=(0, 0.01, 0.1), stress=("1 GPa", "1.2 GPa", "1.5 GPa")),
    curve("hardening-law", "prager", modulus="20 GPa"),
    curve("hardening-law", "armstrong-frederick", modulus="100 GPa", recovery=500),
    curve("damage-law", "exponential", saturation=0.6, strain=0.02),
    curve("damage-law", "tabulated", strain=(0, 0.01, 0.1), values=(0, 0.3, 0.4)),
    curve("damage-law", "mazars", threshold=1e-4, A=0.9, B=2e4),
    curve("damage-law", "mazars", threshold=1e-3, A=1.0, B=500.0),
    curve("damage-law", "tabulated", strain=(0, 1e-4, 0.1), values=(0, 0, 0.9)),
]


@parametrize_with_checks(CURVES)
def test_hardening_and_damage_laws_conform(component, check):
    check(component)


YIELDING = [
    material("j2", **STEEL, hardening=CURVES[0]),
    material("j2", **STEEL, hardening=CURVES[3]),
    material("j2", young_modulus="18.6 GPa", poisson_ratio=0.49, hardening=(CURVES[1], CURVES[7])),
    material("j2", **STEEL, hardening=(CURVES[0], CURVES[8], CURVES[7])),
    material("j2", **STEEL, hardening=CURVES[0], damage=CURVES[9]),
    material("j2", **STEEL, hardening=CURVES[2], damage=CURVES[9], yield_on="effective"),
]
YIELDING.append(
    material("by-depth", interfaces=("1 um", "1 mm"), laws=(YIELDING[0], material("elastic", **STEEL), YIELDING[3]))
)


CONCRETE = {"young_modulus": "30 GPa", "poisson_ratio": 0.2}
YIELDING += [
    material(
        "j2",
        **STEEL,
        hardening=CURVES[0],
        damage=curve("damage-law", "exponential", saturation=0.6, strain=0.02, length="1 um"),
    ),
    *(
        material("brittle", **CONCRETE, damage=damage, crack_closure=closure)
        for damage in CURVES[11:]
        for closure in (False, True)
    ),
    material("brittle", damage=curve("damage-law", "mazars", threshold=1e-4, A=0.9, B=2e4, length="1 mm")),
]


@parametrize_with_checks(YIELDING)
def test_laws_that_yield_conform(component, check):
    check(component)


@pytest.fixture(scope="module", params=[0.45, 0.5])
def lattice(request, tmp_path_factory):
    """File of a map: E falls with the depth and along x; incompressible at depth or nowhere."""
    path = tmp_path_factory.mktemp("map") / "moduli.npz"
    axis = np.geomspace(1e-7, 1e-2, 6)
    along = np.concatenate([-axis[::-1], axis])
    moduli = 1e9 * np.arange(6.0, 0.0, -1.0)[:, None, None] * np.arange(1.0, 13.0) * np.ones((2, 1))
    ratios = np.full(moduli.shape, 0.3)
    ratios[-1] = request.param
    np.savez(path, x=along, y=[0.0, 1.0], z=axis, young_modulus=moduli, poisson_ratio=ratios)
    return path


def test_a_map_conforms(lattice):
    law = material("map", file=str(lattice))
    for check in checks_for(law):
        check(law)

"""Shapes, laws, eigenstrain field and observer keep the promises of their kinds."""

from pathlib import Path

from eigencontact_sample_shapes.adhesive import Adhesive
from eigencontact_sample_shapes.deepest_shear import DeepestShear
from eigencontact_sample_shapes.laminate import Laminate
from eigencontact_sample_shapes.measured import Measured
from eigencontact_sample_shapes.spheroid import Spheroid
from eigencontact_sample_shapes.torus import Torus

from eigencontact_verification.conformance import parametrize_with_checks

UM, MPA = 1e-6, 1e6
SHAPES = [
    Torus(center=(0.0, 1 * UM, 20 * UM), ring_radius=8 * UM, tube_radius=3 * UM),
    Spheroid(center=(1 * UM, 2 * UM, 20 * UM), equatorial_radius=10 * UM, polar_radius=4 * UM),
    Spheroid(center=(0.1, 0.2, 3.0), equatorial_radius=1.0, polar_radius=3.0),  # touches the surface
    Spheroid(center=(0.0, 0.0, 0.2), equatorial_radius=1.0, polar_radius=0.1),
]
LAWS = [Adhesive(tau0=20 * MPA, coefficient=0.1, cap=300 * MPA), Adhesive(tau0=0.0, coefficient=0.5, cap=1e12)]
FIELDS = [Measured(measurement=str(Path(__file__).with_name("peened.txt")), factor=factor) for factor in (1.0, -0.5)]
MATERIALS = [
    Laminate(moduli=(200e9, 3e9), poisson_ratios=(0.3, 0.4), share=0.3, normal=(1.0, 2.0, -2.0)),
    Laminate(moduli=(1e9, 1e9), poisson_ratios=(0.0, -0.5), share=1.0),
]
OBSERVERS = [DeepestShear(depth=5 * UM, x=1 * UM)]


@parametrize_with_checks([*SHAPES, *LAWS, *FIELDS, *MATERIALS, *OBSERVERS])
def test_conformance(component, check):
    """One test for every component and check."""
    check(component)

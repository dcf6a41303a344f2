"""Two spheres closer than a radius, half a contact radius deep: sign of their interaction by solid elements.

Figure 3.35: the text has two soft spheres relax the shear stress between them, and two stiff ones raise it; elements
and program have it the other way round. Both runs of a pair use one mesh: errors of cut elements nearly drop out.
"""

import numpy as np
import pytest

import eigencontact as ec
from close import close
from eigencontact_verification.fem.loaded_body import LoadedBody, Tractions
from eigencontact_verification.fem.loaded_solid import solve_loaded
from eigencontact_verification.fem.model import Region
from eigencontact_verification.studies.catalogue import STUDIES

STUDY = STUDIES.find("two-spheres-spacing")
SIZE = STUDY.constants["r"] / STUDY.constants["a"]
DEPTH, GAP = 0.5, 0.25
#: Just inside of the first sphere, just outside, and in the middle of the gap; in its radii.
PLACES = np.array([0.96, 1.02, 1.0 + GAP / 2])


def ball(x, gamma):
    def contains(px, py, pz):
        return (px - x) ** 2 + py**2 + (pz - DEPTH) ** 2 < SIZE**2

    bounds = ((x - SIZE, -SIZE, DEPTH - SIZE), (x + SIZE, SIZE, DEPTH + SIZE))
    return Region(contains=contains, bounds=bounds, young_modulus=gamma, poisson_ratio=0.3)


def largest_shear(gamma, second, level):
    """By the program in the middle of the gap, and by elements at all places under the program's pressure; over p0."""
    values = {"h": DEPTH, "gamma1": gamma} | ({"gamma2": gamma, "beta": GAP} if second else {})
    found = ec.run(STUDY.scene(values, coarse=False)).dataset
    a, p0 = STUDY.constants["a"], STUDY.constants["p0"]
    half = 0.5 * float(found["x"][1] - found["x"][0])
    x, y = (np.append(found[axis] - half, float(found[axis][-1]) + half) / a for axis in "xy")
    pressure = found["pressure"].values[-1] / p0
    tractions = Tractions(x=x, y=y, values=np.stack([0 * pressure, 0 * pressure, pressure]))
    regions = (ball(0.0, gamma), ball((2 + GAP) * SIZE, gamma if second else 1.0))
    body = LoadedBody(young_modulus=1.0, poisson_ratio=0.3, regions=regions, tractions=tractions)
    points = np.stack([PLACES * SIZE, 0 * PLACES, 0 * PLACES + DEPTH], axis=1)
    solution = solve_loaded(body, level=level, outer="fixed", watched=points, budget=400_000, read=points)
    principal = np.linalg.eigvalsh(solution.stress(points))
    return 0.5 * found["beside_tresca"].values[-1, 0] / p0, 0.5 * (principal[:, 2] - principal[:, 0])


@pytest.mark.slow
@pytest.mark.parametrize(("gamma", "sign"), [(0.5, 1), (2.0, -1)])
def test_soft_spheres_raise_the_stress_between_them_and_stiff_ones_lower_it(gamma, sign):
    pair, alone = (largest_shear(gamma, second, 2) for second in (True, False))
    by_elements = pair[1] / alone[1]
    assert np.all(sign * (by_elements - 1) > 0.02)
    assert pair[0] / alone[0] == close(by_elements[2], rel=0.08)
    assert pair[0] == close(pair[1][2], rel=0.12)

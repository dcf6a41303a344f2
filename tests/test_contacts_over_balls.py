"""Contact over a ball as a scene with polynomial eigenstrain, against the oracle of a ball below a contact."""

import numpy as np
import pytest

import eigencontact as ec
from eigencontact_verification.oracles.ball_under_contact import ball_under_contact

NU, RADIUS = 0.3, 10.0
MODULUS = 1.0 / (1.0 - NU**2)
LOAD, P0 = 4.0 / 3.0 * MODULUS / RADIUS, 2.0 * MODULUS / (np.pi * RADIUS)  # contact radius 1 without the ball


def error(ratio, radius, depth, degree, cells):
    """Largest difference of the pressure over p0 within 0.85 contact radii."""
    inside = {"young-modulus": ratio, "poisson-ratio": NU} if ratio else {"void": True}
    ball = {"name": "ball", "type": "sphere", "center": [0, 0, depth], "radius": radius, "material": inside}
    found = ec.run(
        {
            "title": "contact over a ball",
            "body1": {"young-modulus": 1.0, "poisson-ratio": NU},
            "body2": {"rigid": True},
            "geometry": {"type": "sphere", "radius": RADIUS},
            "inclusions": [ball],
            "grid": {"cells-per-contact-radius": cells, "margin": 1.5},
            "numerics": {"inclusion-resolution": {"whole": degree}},
            "steps": {"normal-load": LOAD},
        }
    ).dataset
    oracle = ball_under_contact(radius=radius, depth=depth, nu=NU, ratio=ratio, degree=degree)
    r = np.hypot(*np.meshgrid(found["x"], found["y"]))
    inner = r < 0.85 * oracle.radius
    pressure = np.asarray(found["pressure"])[-1] / P0
    return np.abs(pressure[inner] - oracle.pressure(r[inner])).max()


@pytest.mark.parametrize(
    ("ratio", "radius", "depth", "degree", "bound"),
    [
        (2.0, 0.33, 0.5, 1, 4e-4),
        pytest.param(2.0, 0.33, 0.5, 4, 4e-4, marks=pytest.mark.slow),
        pytest.param(0.0, 0.33, 0.5, 6, 8e-4, marks=pytest.mark.slow),
        pytest.param(2.0, 0.17, 0.2, 6, 8e-3, marks=pytest.mark.slow),
    ],
)
def test_pressure_at_any_degree_tends_to_the_oracle(ratio, radius, depth, degree, bound):
    """By the square of the cell size, as piecewise constant pressure does; the bound is that of cells of 1/32."""
    errors = [error(ratio, radius, depth, degree, cells) for cells in (16, 32)]
    assert errors[1] < bound
    assert errors[0] / errors[1] > 2.5


def test_another_degree_is_seen():
    """At degree 0 the pressure in the middle is 5 % lower: the oracle of degree 0 agrees, that of degree 4 does not."""
    assert error(2.0, 0.33, 0.5, 0, 16) < 4e-3
    zero, four = (ball_under_contact(radius=0.33, depth=0.5, nu=NU, ratio=2.0, degree=degree) for degree in (0, 4))
    assert four.central_pressure - zero.central_pressure > 0.05

"""Contact HZ-1 of the tests, a rigid sphere on steel, and balls below it."""

from math import pi

#: Young's modulus, Poisson's ratio, radius of the sphere and load.
E, NU, RADIUS, LOAD = 210e9, 0.3, 105e-6, 0.65
#: Contact modulus, contact radius and largest pressure by Hertz's theory.
MODULUS = E / (1 - NU**2)
A = (0.75 * LOAD * RADIUS / MODULUS) ** (1 / 3)
P0 = 1.5 * LOAD / (pi * A**2)
#: The same load, then a pull below the limit of friction.
FRICTION = {
    "friction": {"type": "coulomb", "coefficient": 0.3},
    "steps": [{"normal-load": LOAD}, {"tangential-load-x": 0.2 * LOAD}],
}


def grain(ratio, radius, depth, x=0.0, **more):
    """Ball with so many times the stiffness of the body, 0 for a void; places in contact radii."""
    material = {"young-modulus": ratio * E, "poisson-ratio": NU} if ratio else {"void": True}
    return {"type": "sphere", "center": [x * A, 0.0, depth * A], "radius": radius * A, "material": material, **more}

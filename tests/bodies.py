"""Bodies that many tests press together."""

#: As arguments in Python.
STEEL = {"young_modulus": 210e9, "poisson_ratio": 0.3}
#: As keys of a scene file.
STEEL_TABLE = {"young-modulus": 210e9, "poisson-ratio": 0.3}

#: Swift's hardening of the finite-element reference EP-1.
SWIFT = {"type": "j2", "hardening": {"type": "swift", "B": "1240 MPa", "C": 30, "n": 0.085}}
#: Under 0.65 N its contact with steel (HZ-1) has a radius of 6 um.
BALL = {"type": "sphere", "radius": "105 um"}


def perfect(stress="7344 MPa", **more):
    """Law without hardening, by default that of EP-2."""
    return {"type": "j2", "hardening": {"type": "perfect", "yield-stress": stress}, **more}


def pressed(law, steps, cells, **more):
    """Tables of a sphere on steel with a law, or elastic without one."""
    return {
        "body1": {**STEEL, **({"law": law} if law else {})}, "geometry": BALL, "steps": list(steps),
        "grid": {"cells": [cells, cells], "size": ["22 um", "22 um"]}, "output": {"pictures": False}, **more,
    }  # fmt: skip


def rubbed(**changes):
    """Tables of a ball with friction on steel, without those that are changed to None."""
    tables = {
        "body1": {"young-modulus": "210 GPa", "poisson-ratio": 0.3},
        "geometry": BALL,
        "friction": {"type": "coulomb", "coefficient": 0.5},
        "numerics": {"threads": 1, "coupling": "none"},
        "output": {"pictures": False, "vtk": False},
    } | changes
    return {name: table for name, table in tables.items() if table is not None}

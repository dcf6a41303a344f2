"""Case WR-17: a ball on a coated body in gross sliding, by exact layers or by cells."""

import numpy as np

import eigencontact as ec
from eigencontact.execution.run.driver import drive

#: Thickness of the layer = contact radius on the bare substrate, constants of the substrate; a ball of 10 H.
H, E, NU = 20e-6, 210e9, 0.3
RADIUS = 10 * H
MODULUS = E / (1 - NU**2)
LOAD, PEAK = 4 / 3 * MODULUS * H**3 / RADIUS, 2 * MODULUS * H / (np.pi * RADIUS)
VOLUME = np.pi * H**4 / (4 * RADIUS)
K = 1e-15
ARCHARD = {"type": "archard", "coefficient": K}
SOLID = {"young-modulus": E, "poisson-ratio": NU}


def gross_sliding(worn, increments, **tables):
    """Gross sliding without friction to some worn volumes, in parts of that of the case."""
    paths = np.diff([0.0, *worn]) * VOLUME / (K * LOAD)
    slides = [
        {"normal-load": LOAD, "sliding-distance": float(path), "increments": count}
        for path, count in zip(paths, increments, strict=True)
    ]
    return ec.Scene(
        **{
            "body1": SOLID, "body2": {"rigid": True}, "geometry": {"type": "sphere", "radius": RADIUS},
            "wear": ARCHARD, "steps": [{"normal-load": LOAD}, *slides], "numerics": {"threads": 1}, **tables,
        }
    )  # fmt: skip


def records(scene):
    return list(drive(ec.plan(scene)))

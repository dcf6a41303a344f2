"""A made-up run: Hertz pressure in closed form, and sub-surface fields that are exact on the axis only."""

from __future__ import annotations

import numpy as np

from eigencontact.core.grid import Grid
from eigencontact.core.tensors import hydrostatic, principal, to_mandel, von_mises
from eigencontact.reference.numbers import known_numbers
from eigencontact.results.memory import MemoryStore
from eigencontact.results.records import RegionRecord, RunInfo, StepRecord

RADIUS, E_STAR, LOAD = 105e-6, 230.77e9, 0.65


def info(nx=24, ny=20, size_x=16e-6, size_y=16e-6, steps=2, scene_hash="a" * 64, name="synthetic", title="Sphere"):
    return RunInfo(
        numbers=known_numbers(),
        title=title,
        name=name,
        grid=Grid(nx=nx, ny=ny, dx=size_x / nx, dy=size_y / ny),
        scene_toml='title = "Sphere"\n[geometry.sphere]\nradius = 105e-6\n',
        scene_hash=scene_hash,
        versions={"python": "3.11.7", "numpy": "2.0"},
        references=("doi:10.1017/CBO9781139171731, section 4.2",),
        contact_modulus=E_STAR,
        steps=steps,
    )


def hertz(load):
    """Contact radius [m], largest pressure [Pa], approach [m]."""
    a = (0.75 * load * RADIUS / E_STAR) ** (1 / 3)
    return a, 1.5 * load / (np.pi * a**2) if load else 0.0, a**2 / RADIUS


def made_up_stress(x, y, z, a, p0):
    """Plain components (6, ...): the axis values of Hertz (nu = 0.3), fading with the distance from the axis."""
    s = np.maximum(z, 0) / a
    szz = -1 / (1 + s**2)
    sxx = -1.3 * (1 - s * np.arctan2(1, s)) - 0.5 * szz
    fade = np.exp(-(x**2 + y**2) / a**2)
    shear = 0.2 * (x / a) * s / (1 + s**2) ** 2
    zero = np.zeros(np.broadcast_shapes(np.shape(x), np.shape(y), np.shape(z)))
    return p0 * fade * np.stack([part + zero for part in (sxx, sxx, szz, 0.0, shear, 0.0)])


def region(name, shape, a, p0):
    x, y, z = np.linspace(-2 * a, 2 * a, 33), np.linspace(-a, a, 9), np.linspace(0, 2 * a, 21)
    dims, coords, points = {
        "plane": (("z", "x"), {"x": x, "y": 0.0, "z": z}, (x[None], 0.0, z[:, None])),
        "depth": (("y", "x"), {"x": x, "y": y, "z": 0.5 * a}, (x[None], y[:, None], 0.5 * a)),
        "volume": (("z", "y", "x"), {"x": x, "y": y, "z": z}, (x[None, None], y[None, :, None], z[:, None, None])),
        "line": (("point",), {"x": 0 * z, "y": 0 * z, "z": z}, (0 * z, 0 * z, z)),
        "points": (("point",), {"x": z[:3], "y": -z[:3], "z": z[1:4]}, (z[:3], -z[:3], z[1:4])),
    }[shape]
    stress = made_up_stress(*points, a, p0)
    mandel = to_mandel(stress)
    return RegionRecord(
        name=name,
        shape="plane" if shape == "depth" else shape,
        body=1,
        dims=dims,
        coords=coords,
        fields={
            "stress": stress,
            "von_mises": von_mises(mandel),
            "hydrostatic": hydrostatic(mandel),
            "principal": principal(mandel),
        },
    )


def step(info, index=1, load=LOAD, regions=("plane",), reference=True, observed=False, error=2e-3):
    grid = info.grid
    y, x = grid.axes()
    a, p0, delta = hertz(load)
    r2 = x**2 + y**2
    exact = p0 * np.sqrt(np.maximum(0, 1 - r2 / a**2)) if load else np.zeros(grid.shape)
    pressure = exact * (1 + error * np.cos(3e6 * x))
    a_ref = hertz(LOAD)[0]
    made = {f"{shape}_{n}": region(f"{shape}_{n}", shape, a_ref, p0) for n, shape in enumerate(regions)}
    area = grid.cell_area * np.count_nonzero(pressure)
    scalars = {
        "normal_load": float(pressure.sum() * grid.cell_area),
        "approach": delta,
        "tilt_x": 0.0,
        "contact_area": area,
        "contact_radius": float(np.sqrt(area / np.pi)),
        "max_pressure": float(pressure.max()),
        "iterations": 12.0 + index,
        "convolutions": 15.0 + index,
        "solve_seconds": 0.25,
        "gap_residual": 1e-9,
        "penetration_residual": 2e-9,
        "load_residual": 0.0,
    }
    if made:
        scalars |= {"max_von_mises": 0.62 * p0, "max_von_mises_depth": 0.48 * a}
    fields = {"pressure": pressure, "gap": np.maximum(0, r2 / (2 * RADIUS) - delta), "displacement_z": delta - 0 * r2}
    if reference:
        fields["reference_pressure"] = exact
    return StepRecord(
        index=index,
        time=float(index),
        scalars=scalars,
        fields=fields,
        regions=made,
        observed={"probe_pressure": float(index)} if observed else {},
    )


def opened(run, records):
    """Dataset of made-up steps, as that of a stored run."""
    store = MemoryStore(run)
    for record in records:
        store.write_step(record)
    return store.dataset()

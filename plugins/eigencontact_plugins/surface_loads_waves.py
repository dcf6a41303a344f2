"""Response of a homogeneous half-space to tractions that vary as exp(i (kx x + ky y)), at any depth.

With k = sqrt(kx² + ky²), z ln(R + z) - R has the transform (2π/k³) exp(-kz). The displacement of thesis 2.15-2.22 (2.22
corrected) and Hooke's law then give the tables below, each times exp(-kz), with s = 1 - 2ν. There is no division by s:
the volume strain has this factor, which cancels it.

A shear along y follows from the shear along x by exchange of x and y. Stresses are plain components inside the tables.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact.plugin import FloatArray, Material
from eigencontact_plugins.surface_loads_corner import SWAPPED, mandel_factor

__all__ = ["wave_response"]

ComplexArray = NDArray[np.complex128]
Formula = Callable[["Wave", float], NDArray[Any]]


class Wave:
    """Direction cosines (m, n) = (kx, ky)/k, the product d = kz and the number k; k = 1 where kx = ky = 0."""

    def __init__(self, kx: FloatArray, ky: FloatArray, z: float) -> None:
        length = np.hypot(kx, ky)
        self.zero = length == 0
        self.k = np.where(self.zero, 1.0, length)
        self.m, self.n = kx / self.k, ky / self.k
        self.d = length * z
        self.decay = np.exp(-self.d)


# 2Gk times the displacement and the stress, for a pressure and for a shear along x; without the factor exp(-kz).
PRESSURE: dict[str, Formula] = {
    "x": lambda w, nu: 1j * w.m * ((1 - 2 * nu) - w.d),
    "y": lambda w, nu: 1j * w.n * ((1 - 2 * nu) - w.d),
    "z": lambda w, nu: 2 * (1 - nu) + w.d,
    "xx": lambda w, nu: -w.m * w.m * ((1 - 2 * nu) - w.d) - 2 * nu,
    "yy": lambda w, nu: -w.n * w.n * ((1 - 2 * nu) - w.d) - 2 * nu,
    "zz": lambda w, _: -1 - w.d,
    "yz": lambda w, _: 1j * w.n * w.d,
    "xz": lambda w, _: 1j * w.m * w.d,
    "xy": lambda w, nu: -w.m * w.n * ((1 - 2 * nu) - w.d),
}
SHEAR_X: dict[str, Formula] = {
    "x": lambda w, nu: 2 - w.m * w.m * (2 * nu + w.d),
    "y": lambda w, nu: -w.m * w.n * (2 * nu + w.d),
    "z": lambda w, nu: -1j * w.m * ((1 - 2 * nu) + w.d),
    "xx": lambda w, nu: 1j * w.m * (2 * (1 + nu) - w.m * w.m * (2 * nu + w.d)),
    "yy": lambda w, nu: 1j * w.m * (2 * nu - w.n * w.n * (2 * nu + w.d)),
    "zz": lambda w, _: 1j * w.m * w.d,
    "yz": lambda w, _: w.m * w.n * w.d,
    "xz": lambda w, _: -1 + w.m * w.m * w.d,
    "xy": lambda w, nu: 1j * w.n * (1 - w.m * w.m * (2 * nu + w.d)),
}
# Stress of a uniform traction (k = 0); all other components, also the in-plane ones, are 0.
UNIFORM = {("z", "zz"): -1.0, ("x", "xz"): -1.0, ("y", "yz"): -1.0}


def wave_response(
    direction: str,
    quantity: str,
    components: Sequence[str],
    kx: FloatArray,
    ky: FloatArray,
    z: float,
    material: Material,
) -> ComplexArray:
    """Amplitudes per unit traction along `direction` (x, y or z), ``(len(components), ...)`` [m/Pa] or Mandel [-].

    At k = 0 displacements are 0, and so are the stresses that do not balance the traction: the in-plane normal stresses
    have no limit there (it depends on the direction of k, which corresponds to a choice of lateral boundary
    conditions).
    """
    wave = Wave(ky, kx, z) if direction == "y" else Wave(kx, ky, z)
    table = PRESSURE if direction == "z" else SHEAR_X
    out = np.zeros((len(components), *wave.k.shape), dtype=complex)
    for row, name in enumerate(components):
        values = table[SWAPPED[name] if direction == "y" else name](wave, material.poisson_ratio) * wave.decay
        if quantity == "displacement":
            out[row] = np.where(wave.zero, 0.0, values / (2 * material.shear_modulus * wave.k))
        else:
            out[row] = np.where(wave.zero, UNIFORM.get((direction, name), 0.0), values) * mandel_factor(name)
    return out

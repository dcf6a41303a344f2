"""Fields of regions with polynomial eigenstrain, from potentials of polynomial densities.

The half-space theorem never uses that the eigenstrain is uniform: Green's function holds the source through the
differences of coordinates alone, so each density of an eigenstrain ``Σ E_n ρ_n`` contributes the forms of a uniform
one (`eigencontact.halfspace.theorem`) with its own potentials, and no others. Weights of all densities and derivatives
are contracted before a point is visited.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache, partial
from math import comb

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.core.parallel import available_threads, in_parallel
from eigencontact.errors import require
from eigencontact.halfspace.mirror import integrated_chi
from eigencontact.halfspace.potentials import HasMomentIntegrals, HasMomentPotentials, HasMomentSums, Order
from eigencontact.halfspace.theorem import QUANTITIES, response

__all__ = ["degree_of", "densities_up_to", "moment_field", "moment_sums", "stress_integrals", "surface_displacement"]

#: Numbers that are held for a chunk of points.
_CHUNK_VALUES = 4_000_000
#: Points of a shape whose sums are not its own: all potentials of all densities are held.
_CHUNK_POINTS = 512
_LAPLACIAN: tuple[Order, ...] = ((2, 0, 0), (0, 2, 0), (0, 0, 2))
_UNIT = ((1, 0, 0), (0, 1, 0), (0, 0, 1))

Weights = Mapping[str, tuple[Sequence[Order], FloatArray]]
Points = tuple[FloatArray, FloatArray, FloatArray]


def densities_up_to(degree: int) -> int:
    """Number of densities up to a degree: of monomials in three coordinates."""
    return comb(degree + 3, 3)


def degree_of(coefficients: FloatArray) -> int:
    """Smallest degree of an eigenstrain ``(6, n)`` per density, without trailing zero densities."""
    used = np.flatnonzero(coefficients.any(axis=0))
    degree = 0
    while used.size and densities_up_to(degree) <= used[-1]:
        degree += 1
    return degree


def moment_field(
    shape: HasMomentPotentials,
    coefficients: FloatArray,
    points: Points,
    *,
    degree: int,
    poisson_ratio: float,
    quantity: str,
    space: str = "half",
    threads: int | None = None,
) -> FloatArray:
    """Field of an eigenstrain ``coefficients @ densities``, or of several.

    Parameters
    ----------
    shape : HasMomentPotentials
        The region.
    coefficients : (..., 6, n)
        Mandel eigenstrain [-] per density of the shape, n = `densities_up_to` the degree.
    points : three of (m,)
        x, y, z [m]; z >= 0 where there is a surface.
    degree : int
        Of the eigenstrain, at least 0.
    poisson_ratio : float
        -1 < ν <= 0.5.
    quantity : {"displacement", "strain", "stress"}
        Metres; Mandel strain; Mandel stress in units of the shear modulus.
    space : {"half", "full"}
        With or without the free surface z = 0.
    threads : int, optional
        Cores to use; by default all.

    Returns
    -------
    (..., 3 or 6, m)

    Raises
    ------
    SceneError
        Coefficients whose shape is not that of the degree.
    """
    coefficients = np.asarray(coefficients, dtype=float)
    expected = (6, densities_up_to(degree))
    require(coefficients.shape[-2:] == expected, "moments", "coefficients", coefficients.shape, f"(..., {expected})")
    x, y, z = (np.ascontiguousarray(values, dtype=float) for values in points)
    z = z + 0.0  # a surface point is seen from inside: no -0.0
    batch = coefficients.reshape(-1, *expected)
    rows = QUANTITIES[quantity]
    real, image = _weights(batch, quantity, poisson_ratio, space)
    out = np.empty((len(batch), rows, x.size))
    step = int(np.clip(_CHUNK_VALUES // (4 * len(batch) * rows), 256, 4096))

    def fill(first: int) -> None:
        at = slice(first, first + step)
        points = (x[at], y[at], z[at])
        values = moment_sums(shape, degree, real, points, image=False).reshape(len(batch), rows, -1)
        if image:
            powers = moment_sums(shape, degree, image, points, image=True).reshape(-1, *values.shape)
            total = powers[-1]
            for power in powers[-2::-1]:
                total = total * points[2] + power
            values = values + total
        out[:, :, at] = values

    in_parallel(threads or available_threads(), [partial(fill, first) for first in range(0, x.size, step)])
    return out.reshape(*coefficients.shape[:-2], rows, x.size)


def stress_integrals(
    shape: HasMomentPotentials,
    coefficients: FloatArray,
    points: Points,
    tests: FloatArray,
    *,
    degree: int,
    poisson_ratio: float,
    space: str = "half",
    threads: int | None = None,
) -> FloatArray:
    """Sums over points of the stress of several eigenstrains times each of some functions, ``(k, 6, d)``.

    Parameters
    ----------
    tests : (d, m)
        Functions at the points, weights of the integral included.
    shape, coefficients, points, degree, poisson_ratio, space, threads
        As for `moment_field`; coefficients are ``(k, 6, n)``.
    """
    if not isinstance(shape, HasMomentIntegrals):
        stress = moment_field(
            shape, coefficients, points, degree=degree, poisson_ratio=poisson_ratio, quantity="stress", space=space,
            threads=threads,
        )  # fmt: skip
        return np.asarray(np.einsum("kim,dm->kid", stress, tests, optimize=True))
    x, y, z = points
    real, image = _weights(coefficients, "stress", poisson_ratio, space)
    total = np.asarray(shape.moment_integrals(degree, real, x, y, z, tests, image=False))
    if image:
        powers = len(next(iter(image.values()))[1]) // len(total)
        products = np.concatenate([tests * z**power for power in range(powers)])
        integrals = shape.moment_integrals(degree, image, x, y, z, products, image=True)
        total = total + np.einsum("pkpd->kd", integrals.reshape(powers, len(total), powers, len(tests)))
    return total.reshape(len(coefficients), 6, -1)


def surface_displacement(
    shape: HasMomentPotentials,
    coefficients: FloatArray,
    points: tuple[FloatArray, FloatArray],
    rows: Sequence[int],
    *,
    degree: int,
    poisson_ratio: float,
    threads: int | None = None,
) -> FloatArray:
    """Displacement at the surface z = 0 of a half-space [m], ``(k, len(rows), m)``: see `moment_field`.

    There the region and its image coincide, and no power of z remains. `rows` are components, 0 to 2 for x to z.
    """
    x, y = (np.ascontiguousarray(values, dtype=float) for values in points)
    tables = _surface_forms(poisson_ratio, tuple(rows))
    weights = {
        name: (orders, np.einsum("cuo,kun->kcno", table, coefficients, optimize=True).reshape(
            -1, coefficients.shape[2], len(orders)
        ))
        for name, (orders, table) in tables.items()
    }  # fmt: skip
    out = np.empty((len(coefficients) * len(rows), x.size))
    step = int(np.clip(_CHUNK_VALUES // len(out), 256, 4096))

    def fill(first: int) -> None:
        at = slice(first, first + step)
        out[:, at] = moment_sums(shape, degree, weights, (x[at], y[at], np.zeros_like(x[at])), image=True)

    in_parallel(threads or available_threads(), [partial(fill, first) for first in range(0, x.size, step)])
    return out.reshape(len(coefficients), len(rows), x.size)


def moment_sums(
    shape: HasMomentPotentials, degree: int, weights: Weights, points: Points, *, image: bool
) -> FloatArray:
    """Weighted sums of derivatives of moment potentials, ``(k, m)``; see `HasMomentSums`.

    Of a shape without that ability Psi follows from Phi of one degree more, and Chi from an integral along a line.
    """
    x, y, z = points
    if isinstance(shape, HasMomentSums):
        return np.asarray(shape.moment_sums(degree, weights, x, y, z, image=image))
    count = next(len(of_orders) for _, of_orders in weights.values())
    out = np.zeros((count, x.size))
    for first in range(0, x.size, _CHUNK_POINTS):
        stop = first + _CHUNK_POINTS
        chunk_points = x[first:stop], y[first:stop], z[first:stop]
        for name, (orders, of_orders) in weights.items():
            values = _potentials(shape, degree, name, list(orders), chunk_points, image=image)
            out[:, first:stop] += np.einsum("kno,nop->kp", of_orders, values, optimize=True)
    return out


def _potentials(
    shape: HasMomentPotentials, degree: int, name: str, orders: list[Order], points: Points, *, image: bool
) -> FloatArray:
    """Derivatives of one potential of all densities, ``(n, len(orders), m)``."""
    x, y, z = points
    if name == "chi":
        densities = _Densities(shape, degree)
        return np.moveaxis(integrated_chi(densities, orders, x, y, z), 0, 1)
    at = (x, y, -z) if image else points
    values = shape.phi_moments(degree, orders, *at) if name == "phi" else _psi(shape, degree, orders, at)
    if image:
        values = values * np.array([-1.0 if order[2] % 2 else 1.0 for order in orders])[:, None]
    return values


class _Densities:
    """Phi of all densities of a shape, for `integrated_chi`."""

    def __init__(self, shape: HasMomentPotentials, degree: int) -> None:
        self._shape, self._degree, self.bounds = shape, degree, shape.bounds

    def phi(self, orders: Sequence[Order], x: FloatArray, y: FloatArray, z: FloatArray) -> FloatArray:
        """``(len(orders), n, m)``."""
        return np.moveaxis(self._shape.phi_moments(self._degree, orders, x, y, z), 0, 1)


def _psi(shape: HasMomentPotentials, degree: int, orders: Sequence[Order], points: Points) -> FloatArray:
    """Derivatives of Psi by ``Psi[ρ],i = x_i Phi[ρ] - Phi[x_i ρ]``, x from the middle of the shape."""
    middle, products = _products(shape, degree)
    places_of_phi: dict[Order, int] = {}
    parts: list[tuple[int, Order, Order | None, int]] = []
    for order in orders:
        axis = int(np.argmax(order))
        lowered = _lowered(order, axis)
        lower = _lowered(lowered, axis) if lowered[axis] else None
        parts.append((axis, lowered, lower, lowered[axis]))
        for needed in (lowered, *([lower] if lower is not None else [])):
            places_of_phi.setdefault(needed, len(places_of_phi))
    n = densities_up_to(degree)
    phi = shape.phi_moments(degree + 1, list(places_of_phi), *points)
    out = np.empty((n, len(orders), points[0].size))
    for row, (axis, lowered, lower, times) in enumerate(parts):
        values = phi[:, places_of_phi[lowered]]
        out[:, row] = (points[axis] - middle[axis]) * values[:n] - products[axis] @ values
        if lower is not None:
            out[:, row] += times * phi[:n, places_of_phi[lower]]
    return out


def _lowered(order: Order, axis: int) -> Order:
    nx, ny, nz = (count - step for count, step in zip(order, _UNIT[axis], strict=True))
    return nx, ny, nz


def _products(shape: HasMomentPotentials, degree: int) -> tuple[FloatArray, FloatArray]:
    """Middle of a shape, and matrices ``(3, n, n of one degree more)`` of x_i ρ in its densities."""
    counts = (degree + 3, degree + 3, 2 * degree + 5)
    places, of_places = shape.density_rule(counts)
    middle = of_places @ places / of_places.sum()
    values = shape.densities(degree + 1, *places.T)
    gram = (values * of_places) @ values.T
    lower = values[: densities_up_to(degree)]
    moments = [(lower * (of_places * offset)) @ values.T for offset in (places - middle).T]
    return middle, np.stack([np.linalg.solve(gram, moment.T).T for moment in moments])


def _weights(
    coefficients: FloatArray, quantity: str, nu: float, space: str
) -> tuple[dict[str, tuple[list[Order], FloatArray]], dict[str, tuple[list[Order], FloatArray]]]:
    """Weights of the potentials of the region, rows (k, components), and of its image, rows (power of z, k, ...)."""
    of_real, of_image = _forms(quantity, nu, space)
    by_density = np.ascontiguousarray(np.swapaxes(coefficients, 1, 2))[:, None]
    out: list[dict[str, tuple[list[Order], FloatArray]]] = []
    for tables in (of_real, of_image):
        weights = {}
        for name, (orders, table) in tables.items():  # (power, component, unit eigenstrain, order)
            combined = by_density @ table[:, None]  # (power, k, component, density, order)
            weights[name] = (orders, combined.reshape(-1, coefficients.shape[2], len(orders)))
        out.append(weights)
    return out[0], out[1]


@cache
def _surface_forms(nu: float, rows: tuple[int, ...]) -> dict[str, tuple[list[Order], FloatArray]]:
    """Coefficients of the displacement of the surface by potential of the image: orders, (rows, 6, orders)."""
    forms = response("displacement", nu, "half")
    entries: dict[tuple[str, Order], dict[tuple[int, int], float]] = {}
    for place, row in enumerate(rows):
        for unit, form in enumerate(forms[row]):
            for _, (_, name, order), value in form.on_surface():
                entry = entries.setdefault((name, order), {})
                entry[place, unit] = entry.get((place, unit), 0.0) + value
    out = {}
    for name in ("phi", "psi", "chi"):
        orders = sorted(order for kernel, order in entries if kernel == name)
        table = np.zeros((len(rows), 6, len(orders)))
        for column, order in enumerate(orders):
            for (place, unit), value in entries[name, order].items():
                table[place, unit, column] = value
        if orders:
            out[name] = (orders, table)
    return out


@cache
def _forms(
    quantity: str, nu: float, space: str
) -> tuple[dict[str, tuple[list[Order], FloatArray]], dict[str, tuple[list[Order], FloatArray]]]:
    """Coefficients of the theorem by potential, of the region and of its image: orders, (powers, rows, 6, orders).

    The indicator of the region becomes the density there, -1/4π of the Laplacian of its Phi.
    """
    terms: dict[str, dict[tuple[str, Order], dict[tuple[int, int, int], float]]] = {"real": {}, "image": {}}
    highest = {"real": 0, "image": 0}
    forms = response(quantity, nu, space)
    for row, of_units in enumerate(forms):
        for unit, form in enumerate(of_units):
            for power, (origin, name, order), value in form:
                inside = origin == "inside"
                whose = "real" if inside else origin
                highest[whose] = max(highest[whose], power)
                for target in _LAPLACIAN if inside else (order,):
                    entry = terms[whose].setdefault(("phi" if inside else name, target), {})
                    place = (power, row, unit)
                    entry[place] = entry.get(place, 0.0) + (value / (-4.0 * np.pi) if inside else value)
    out = []
    for whose, by_kernel in terms.items():
        tables = {}
        for name in ("phi", "psi", "chi"):
            orders = sorted(order for kernel, order in by_kernel if kernel == name)
            table = np.zeros((highest[whose] + 1, len(forms), 6, len(orders)))
            for column, order in enumerate(orders):
                for place, value in by_kernel[name, order].items():
                    table[(*place, column)] = value
            if orders:
                tables[name] = (orders, table)
        out.append(tables)
    return out[0], out[1]

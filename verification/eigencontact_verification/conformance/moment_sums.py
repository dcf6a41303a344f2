"""Weighted sums of moment potentials: they equal sums of phi_moments, with Psi by identity and Chi along the depth."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.conformance.arrays import mirror_orders
from eigencontact_verification.conformance.densities import DEGREE, density_sizes, values_of
from eigencontact_verification.conformance.moments import phi_of
from eigencontact_verification.conformance.orders import AXES, Order, add, name, of_total
from eigencontact_verification.conformance.quadrature import depth_rule
from eigencontact_verification.conformance.report import agree, check
from eigencontact_verification.conformance.sampling import region, sample, within

FloatArray = NDArray[np.float64]

_ROWS = 4


def _places(shape: Any, *, image: bool) -> FloatArray:
    """Points inside and outside; z >= 0 for the image."""
    groups = sample(shape)
    places: FloatArray = np.concatenate([group.places for group in groups])
    signs = np.where(places < 0, [-1.0, -1.0, 1.0], 1.0)
    return np.asarray(np.abs(places) * signs) if image else places


def _mirrored(places: FloatArray) -> FloatArray:
    return np.asarray(places * np.array([1.0, 1.0, -1.0]))


def _weights(shape: Any, degree: int, count: int) -> FloatArray:
    """Weights ``(k, n, orders)``, always the same ones, per root mean square of each density."""
    sizes = density_sizes(shape, degree)
    return np.asarray(np.random.default_rng(7).normal(size=(_ROWS, len(sizes), count)))


def _sums(
    shape: Any, which: str, orders: list[Order], weights: FloatArray, places: FloatArray, *, image: bool
) -> FloatArray:
    scaled = weights / density_sizes(shape, DEGREE)[:, None]
    return np.asarray(
        shape.moment_sums(DEGREE, {which: (orders, scaled)}, *np.ascontiguousarray(places.T), image=image)
    )


def _signs(orders: list[Order]) -> FloatArray:
    return np.array([(-1.0) ** order[2] for order in orders])[:, None]


def _potentials(shape: Any, which: str, orders: list[Order], places: FloatArray, *, image: bool) -> FloatArray:
    """Derivatives of Phi or, by the identity, Psi of all densities from phi_moments, ``(n, orders, points)``."""
    at = _mirrored(places) if image else places
    values = phi_of(shape, DEGREE, orders, at) if which == "phi" else _psi(shape, orders, at)
    return values * _signs(orders) if image else values


def _psi(shape: Any, orders: list[Order], places: FloatArray) -> FloatArray:
    """``Psi[ρ],i = x_i Phi[ρ] - Phi[x_i ρ]``, the product expanded in the densities of one degree more."""
    origin = region(shape).center
    points = within(shape)
    higher = values_of(shape, DEGREE + 1, points) / density_sizes(shape, DEGREE + 1)[:, None]
    lower = values_of(shape, DEGREE, points) / density_sizes(shape, DEGREE)[:, None]
    products = [np.linalg.lstsq(higher.T, (offset * lower).T, rcond=None)[0].T for offset in (points - origin).T]
    needed: list[Order] = [order for total in range(1, max(map(sum, orders))) for order in of_total(total)]
    phi = dict(zip(needed, phi_of(shape, DEGREE + 1, needed, places).swapaxes(0, 1), strict=True))
    potentials = dict(zip(needed, phi_of(shape, DEGREE, needed, places).swapaxes(0, 1), strict=True))
    out = []
    for order in orders:
        axis = int(np.argmax(np.array(order) > 0))
        reduced = add(order, AXES[axis], -1)
        value = (places - origin)[:, axis] * potentials[reduced] - products[axis] @ phi[reduced]
        if reduced[axis]:
            value += reduced[axis] * potentials[add(reduced, AXES[axis], -1)]
        out.append(value)
    return np.stack(out, axis=1)


def _compare(
    shape: Any, which: str, totals: tuple[int, ...], *, image: bool, tolerance: float, rule: str, advice: str
) -> None:
    places = _places(shape, image=image)
    for total in totals:
        orders = of_total(total)
        weights = _weights(shape, DEGREE, len(orders))
        values = _potentials(shape, which, orders, places, image=image)
        agree(
            [f"sum {row} of {which} of order {total}{' of the image' if image else ''}" for row in range(_ROWS)],
            _sums(shape, which, orders, weights, places, image=image),
            np.einsum("kno,nop->kp", weights, values),
            scale=np.max(np.abs(values), axis=(0, 1)) * np.sqrt(weights[0].size),
            tolerance=tolerance, points=places, rule=rule, advice=advice,
        )  # fmt: skip


@check
def check_sums_of_phi(shape: Any) -> None:
    """Sums of phi are sums of phi_moments, orders 0 to 5; of the image at the mirrored point, odd along z reversed."""
    for image in (False, True):
        _compare(
            shape, "phi", (0, 1, 2, 3, 4, 5), image=image, tolerance=1e-9, rule="the sum of phi_moments",
            advice="weights are (k, n, len(orders)); the image at z is the region at -z, odd orders along z reversed",
        )  # fmt: skip


@check
def check_sums_of_psi(shape: Any) -> None:
    """Sums of psi, orders 3 to 5, follow from Psi,i[ρ] = x_i Phi[ρ] - Phi[x_i ρ], and their Laplacian is 2 Phi."""
    for image in (False, True):
        _compare(
            shape, "psi", (3, 4, 5), image=image, tolerance=1e-8, rule="that of x_i Phi[ρ] - Phi[x_i ρ]",
            advice="derive Psi of every density from Phi by this identity, and compare",
        )  # fmt: skip
        places = _places(shape, image=image)
        for total in (1, 2, 3):
            bases = of_total(total)
            raised = [add(base, axis, 2) for base in bases for axis in AXES]
            weights = _weights(shape, DEGREE, len(bases))
            expected = 2 * _sums(shape, "phi", bases, weights, places, image=image)
            size = np.max(np.abs(_potentials(shape, "phi", bases, places, image=image)), axis=(0, 1))
            agree(
                [f"the Laplacian of sum {row} of psi of order {total}" for row in range(_ROWS)],
                _sums(shape, "psi", raised, np.repeat(weights, 3, axis=2), places, image=image), expected,
                scale=size * np.sqrt(weights[0].size), tolerance=1e-8, points=places, rule="twice that of phi",
                advice="compare the factor of psi with that of phi, order by order",
            )  # fmt: skip


@check
def check_sums_of_chi(shape: Any) -> None:
    """Sums of chi are integrals of (t - Z) Phi,ab of the image along the depth (to 1e-8), and Chi,xx + Chi,yy is -Phi.

    Orders 3 and 4, at most one along z. The allowed error grows by four times the difference of two rules.
    """
    places = _places(shape, image=True)[::2]
    places[:, 2] = np.linspace(0.05, 1.5, len(places)) * region(shape).size
    for total in (3, 4):
        orders = mirror_orders(total)
        weights = _weights(shape, DEGREE, len(orders))
        coarse, values = (_chi_integrals(shape, orders, places, count) for count in (100, 150))
        expected, rough = (np.einsum("kno,nop->kp", weights, integrals) for integrals in (values, coarse))
        scale = np.max(np.abs(values), axis=(0, 1)) * np.sqrt(weights[0].size)
        agree(
            [f"sum {row} of chi of order {total}" for row in range(_ROWS)],
            _sums(shape, "chi", orders, weights, places, image=True), expected, scale=scale,
            tolerance=1e-8 + 4 * np.max(np.abs(expected - rough), axis=0) / scale, points=places,
            rule="its integral of Phi of the image",
            advice="densities of the image are mirrored too: odd ones along z change sign",
        )  # fmt: skip
        plane = mirror_orders(total - 2)
        raised = [add(base, axis, 2) for base in plane for axis in AXES[:2]]
        weights = _weights(shape, DEGREE, len(plane))
        values = _potentials(shape, "phi", plane, places, image=True)
        agree(
            [f"{name('chi', plane[0])}xx + {name('chi', plane[0])}yy of sum {row}" for row in range(_ROWS)],
            _sums(shape, "chi", raised, np.repeat(weights, 2, axis=2), places, image=True),
            -np.einsum("kno,nop->kp", weights, values),
            scale=np.max(np.abs(values), axis=(0, 1)) * np.sqrt(weights[0].size), tolerance=1e-8, points=places,
            rule="minus the same sum of phi of the image: Chi is harmonic, Chi,zz = Phi",
            advice="compare the factor of chi with that of phi",
        )  # fmt: skip


def _chi_integrals(shape: Any, orders: list[Order], places: FloatArray, count: int) -> FloatArray:
    """Orders of chi as integrals along the depth, ``(n, orders, points)``."""
    reach, weights, points = depth_rule(region(shape).size, places, count)
    phi = phi_of(shape, DEGREE, [(i, j, 0) for i, j, _ in orders], points)
    factors = np.array([-weights if k else weights * reach for _, _, k in orders])
    return np.asarray(np.einsum("nopc,oc->nop", phi, factors))

"""Identities of the potentials of any region, without quadrature: Laplacians, one order from the next, symmetry."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.conformance.orders import AXES, Order, add, name, of_total
from eigencontact_verification.conformance.report import agree, check
from eigencontact_verification.conformance.sampling import (
    derivative_along,
    evenly,
    inside,
    natural_scale,
    potential,
    region,
    row_scales,
    sample,
)

FloatArray = NDArray[np.float64]


def _all_points(shape: Any) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Points, their clearance, and 1 inside or 0 outside."""
    within, without = sample(shape)
    places = np.concatenate([within.places, without.places])
    return places, np.concatenate([within.clearance, without.clearance]), inside(shape, places).astype(float)


def _laplacian(shape: Any, which: str, bases: list[Order], places: FloatArray) -> FloatArray:
    terms = [add(base, axis, 2) for base in bases for axis in AXES]
    values: FloatArray = potential(shape, which, terms, places).reshape(len(bases), 3, -1).sum(axis=1)
    return values


@check
def check_phi_laplacian(shape: Any) -> None:
    """Phi,xx + Phi,yy + Phi,zz is -4 pi inside and 0 outside; so are the derivatives of that sum 0 (orders 3, 4)."""
    places, _, indicator = _all_points(shape)
    for total in (0, 1, 2):
        bases = of_total(total)
        expected = np.zeros((len(bases), len(places)))
        if total == 0:
            expected[:] = -4 * np.pi * indicator
        agree(
            [f"the Laplacian of {name('phi', base).rstrip(',')}" for base in bases],
            _laplacian(shape, "phi", bases, places),
            expected,
            scale=np.maximum(natural_scale(shape, "phi", total + 2, places), np.abs(expected)),
            tolerance=1e-9,
            points=places,
            rule="-4 pi inside and 0 outside" if total == 0 else "0",
            advice="Phi is the integral of +1/R over the region: look for a sign, a factor, a wrong component, or a "
            "boundary that is not that of contains",
        )


@check
def check_psi_laplacian(shape: Any) -> None:
    """Psi,xx + Psi,yy + Psi,zz is 2 Phi: compared as derivatives of order 3, 4 and 5."""
    places, _, _ = _all_points(shape)
    for total in (1, 2, 3):
        bases = of_total(total)
        agree(
            [f"the Laplacian of {name('psi', base)}" for base in bases],
            _laplacian(shape, "psi", bases, places),
            2 * potential(shape, "phi", bases, places),
            scale=natural_scale(shape, "psi", total + 2, places),
            tolerance=1e-9,
            points=places,
            rule="twice the same derivative of Phi",
            advice="Psi is the integral of +R over the region: compare its factor with that of Phi, order by order",
        )


@check
def check_phi_derivatives(shape: Any) -> None:
    """Every derivative of Phi of order 2 to 4 is the derivative of each of order one less that leads to it."""
    _one_from_the_next(shape, "phi", (1, 2, 3))


@check
def check_psi_derivatives(shape: Any) -> None:
    """Every derivative of Psi of order 4 and 5 is the derivative of each of order one less that leads to it."""
    _one_from_the_next(shape, "psi", (3, 4))


def _one_from_the_next(shape: Any, which: str, totals: tuple[int, ...]) -> None:
    """Differentiate through 17 points on a line through each point, a quarter of its clearance to both sides."""
    places, clearance, _ = _all_points(shape)
    reach = clearance / 4
    for total in totals:
        orders = of_total(total)
        scale = natural_scale(shape, which, total + 1, places)
        scale = np.maximum(scale, 1e-6 * natural_scale(shape, which, total, places) / reach)
        for axis in AXES:
            slopes = derivative_along(axis, places, reach, partial(potential, shape, which, orders))
            raised = [add(order, axis) for order in orders]
            agree(
                [name(which, order) for order in raised],
                potential(shape, which, raised, places),
                slopes,
                scale=scale,
                tolerance=1e-7,
                points=places,
                rule="the derivative of the order below it",
                advice="differentiate that row again; a wrong row disagrees with itself along another axis too",
            )


@check
def check_parity(shape: Any) -> None:
    """A region that equals its mirror image about a plane through its centre has potentials even or odd about it."""
    box = region(shape)
    probes = box.half * evenly(2048)
    contained = inside(shape, box.center + probes)
    places = _all_points(shape)[0][::2]
    offset = places - box.center
    for axis in range(3):
        flip = np.where(np.arange(3) == axis, -1.0, 1.0)
        if not np.array_equal(inside(shape, box.center + flip * probes), contained):
            continue
        mirrored = box.center + flip * offset
        for which, totals in (("phi", (1, 2, 3, 4)), ("psi", (3, 4, 5))):
            orders = [order for total in totals for order in of_total(total)]
            values = potential(shape, which, orders, places)
            agree(
                [name(which, order) for order in orders],
                potential(shape, which, orders, mirrored),
                np.array([(-1.0) ** order[axis] for order in orders])[:, None] * values,
                scale=row_scales(box.size, orders, values),
                tolerance=1e-9,
                points=mirrored,
                rule=f"even or odd about the middle {'xyz'[axis]}-plane, where contains is symmetric",
                advice="check signs of offsets from the centre",
            )

"""Potentials as functions of arrays: shapes, order of the orders, purity, finite values."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact.plugin import HasMirrorPotential
from eigencontact_verification.conformance.orders import Order, name, of_total
from eigencontact_verification.conformance.report import check, ensure, ensure_array, ensure_pure, place_of
from eigencontact_verification.conformance.sampling import evenly, inside, potential, region, sample

FloatArray = NDArray[np.float64]


def mirror_orders(total: int) -> list[Order]:
    """Orders of chi that the half-space theorem asks for: at most one derivative along z."""
    return [order for order in of_total(total) if order[2] <= 1]


def _potentials(shape: Any) -> Iterator[tuple[str, list[Order]]]:
    """Everything the framework asks for, potential by potential."""
    yield "phi", [order for total in (1, 2, 3, 4) for order in of_total(total)]
    yield "psi", [order for total in (3, 4, 5) for order in of_total(total)]
    if isinstance(shape, HasMirrorPotential):
        yield "chi", [order for total in (3, 4) for order in mirror_orders(total)]


def _places(shape: Any, which: str) -> FloatArray:
    """Twelve points or so away from the boundary; those of chi have z >= 0 and stand for their mirror points."""
    within, without = sample(shape)
    places = np.concatenate([within.places, without.places])
    return np.abs(places) * np.where(places < 0, [-1, -1, 1], 1) if which == "chi" else places


@check
def check_potential_arrays(shape: Any) -> None:
    """Answers have shape (len(orders), ...) for 0-d, (1,), (n,), (nz, ny, nx) and no points; each point for itself."""
    for which, orders in _potentials(shape):
        chosen_orders, places = orders[::3], _places(shape, which)[:12]
        flat = potential(shape, which, chosen_orders, places)
        for form in ((), (1,), (12,), (3, 2, 2), (0,)):
            count = int(np.prod(form))
            points = np.resize(places, (12, 3))[:count].reshape((*form, 3))
            answer = potential(shape, which, chosen_orders, points)
            ensure_array(
                answer,
                (len(chosen_orders), *form),
                f"{which} of {len(chosen_orders)} orders at points of shape {form}",
                "allocate np.empty((len(orders), *x.shape))",
            )
            expected = np.resize(places, (12, 3))[:count]
            in_a_row = potential(shape, which, chosen_orders, expected).reshape(answer.shape)
            ensure(
                np.allclose(answer, in_a_row, rtol=1e-9, atol=1e-12 * float(np.nanmax(np.abs(flat))), equal_nan=True),
                f"{which} at points of shape {form}",
                "what it is at the same points in a row",
                "something else",
                "treat every point alike, whatever the shape of the arrays",
            )
        backwards = potential(shape, which, chosen_orders[::-1], places)[::-1]
        ensure(
            np.array_equal(backwards, flat, equal_nan=True),
            f"{which} of orders in reverse",
            "the same rows in reverse",
            "different rows",
            "answer row by row in the order of `orders`",
        )


@check
def check_potentials_pure(shape: Any) -> None:
    """Same answer twice; inputs stay as they were, and may be read-only."""
    for which, orders in _potentials(shape):
        points = np.ascontiguousarray(_places(shape, which).T)

        def ask(which: str = which, orders: list[Order] = orders, points: FloatArray = points) -> Any:
            return getattr(shape, which)(orders, *points)

        ensure_pure(which, ask, [points], arguments=f"the arrays given to {which}")


@check
def check_potentials_finite(shape: Any) -> None:
    """No NaN, infinity or numpy warning on axes, edge extensions, face planes, centre, and at corners of bounds.

    Orders of the displacement (Phi 1, Psi 3) are finite everywhere; higher ones away from the boundary (the stress on
    an edge is infinite, NaN is allowed there).
    """
    box = region(shape)
    steps = np.array([-3.0, -1.0, -0.5, 0.0, 0.25, 1.0, 2.0])
    lattice = box.center + box.half * np.stack(np.meshgrid(steps, steps, steps), axis=-1).reshape(-1, 3)
    below = lattice[lattice[:, 2] <= 0]
    probes = 1e-6 * box.size * evenly(24)
    for which, orders in _potentials(shape):
        # chi belongs to the image: what it is asked at depth Z concerns the place Z above the surface
        points_of_call, real = (below * [1, 1, -1], below) if which == "chi" else (lattice, lattice)
        state = inside(shape, real[:, None, :] + probes)
        quiet = np.all(state == state[:, :1], axis=1)
        for order, row in zip(orders, potential(shape, which, orders, points_of_call), strict=True):
            everywhere = (which, sum(order)) in {("phi", 1), ("psi", 3)}
            bad = ~np.isfinite(row) & (everywhere | quiet)
            ensure(
                not np.any(bad),
                f"{name(which, order)} at {place_of(points_of_call[bad])}",
                "finite",
                f"{row[bad][:1]}",
                "use forms without 0/0 on axes and edge extensions, log(rho^2/(R-x)) for log(R+x) where x < 0; "
                "points where a denominator vanishes take their limit",
            )

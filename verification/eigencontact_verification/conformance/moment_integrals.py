"""Integrals of moment potentials with test functions: they equal the weighted sums at each point, added."""

from __future__ import annotations

from typing import Any

import numpy as np

from eigencontact_verification.conformance.arrays import mirror_orders
from eigencontact_verification.conformance.densities import DEGREE, density_sizes
from eigencontact_verification.conformance.orders import of_total
from eigencontact_verification.conformance.report import check, ensure
from eigencontact_verification.conformance.sampling import sample

_ROWS, _TESTS = 3, 2
_TOLERANCE = 1e-9


@check
def check_moment_integrals(shape: Any) -> None:
    """moment_integrals are the sums of moment_sums times each test over the points, of the region and of its image."""
    places = np.concatenate([group.places for group in sample(shape)])
    sizes, rng = density_sizes(shape, DEGREE), np.random.default_rng(5)
    tests = rng.normal(size=(_TESTS, len(places)))
    for image in (False, True):
        x, y, z = np.ascontiguousarray(places.T)
        z = np.abs(z) if image else z
        orders = {"phi": of_total(3), "psi": of_total(4), **({"chi": mirror_orders(3)} if image else {})}
        weights = {
            name: (of_name, rng.normal(size=(_ROWS, len(sizes), len(of_name))) / sizes[:, None])
            for name, of_name in orders.items()
        }
        sums = np.asarray(shape.moment_sums(DEGREE, weights, x, y, z, image=image))
        expected = sums @ tests.T
        got = np.asarray(shape.moment_integrals(DEGREE, weights, x, y, z, tests, image=image))
        error = np.abs(got - expected) / (np.abs(sums) @ np.abs(tests).T)
        ensure(
            bool(np.all(error <= _TOLERANCE)),
            f"moment_integrals{' of the image' if image else ''}",
            "the sums over the points of moment_sums times each test",
            f"relative error {np.max(error):.1e}, allowed {_TOLERANCE:.0e}",
            "add over all points, those on the boundary by their share of each side",
        )

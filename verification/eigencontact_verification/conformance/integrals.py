"""Potentials as integrals over the region: against the kit's own quadrature, from afar, and along the depth."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact.plugin import HasFarField, PointSources
from eigencontact_verification.conformance.arrays import mirror_orders
from eigencontact_verification.conformance.orders import Order, name, of_total, point_derivatives
from eigencontact_verification.conformance.quadrature import Rule, depth_rule, quadrature_rules
from eigencontact_verification.conformance.report import agree, check, ensure
from eigencontact_verification.conformance.sampling import (
    evenly,
    natural_scale,
    potential,
    region,
    sample,
)

FloatArray = NDArray[np.float64]

#: Share of a volume that both quadratures may miss: ends thinner than the distance of the places looked at.
_MISSED = 3e-5
_POTENTIALS = (("phi", -1, (1, 2, 3, 4)), ("psi", 1, (3, 4, 5)))


def directions(count: int) -> FloatArray:
    """Directions that favour no axis, ``(count, 3)``."""
    spread = evenly(8 * count)
    spread = spread[(np.linalg.norm(spread, axis=1) < 1) & (np.linalg.norm(spread, axis=1) > 0.3)][:count]
    directions: FloatArray = spread / np.linalg.norm(spread, axis=1, keepdims=True)
    return directions


def _integrate(rule: Rule, power: int, orders: list[Order], places: FloatArray) -> FloatArray:
    """Derivatives of the integral of R**power over the region."""
    offset = (places[:, None, :] - rule.nodes).transpose(2, 0, 1)
    values: FloatArray = point_derivatives(power, orders, offset) @ rule.weights
    return values


@check
def check_quadrature(shape: Any) -> None:
    """All orders of Phi and Psi, twice the half diagonal from the centre, equal integrals of 1/R and R over contains.

    The allowed error is four times the difference of two quadratures; that must be below 2 %.
    """
    box = region(shape)
    places = box.center + 2 * box.radius * directions(4)
    coarse, fine = quadrature_rules(shape)
    for which, power, totals in _POTENTIALS:
        for total in totals:
            orders = of_total(total)
            expected = _integrate(fine, power, orders, places)
            scale = np.max(np.abs(expected))
            doubt = float(np.max(np.abs(expected - _integrate(coarse, power, orders, places))) / scale)
            ensure(
                doubt < 2e-2,
                "the kit's quadrature over contains",
                "settled: two rules must differ by less than 2 %",
                f"{doubt:.1e}",
                "make bounds tight; a shape of thin parts may waive this check and say why",
            )
            agree(
                [name(which, order) for order in orders],
                potential(shape, which, orders, places),
                expected,
                scale=scale,
                tolerance=4 * doubt + _MISSED,
                points=places,
                rule=f"the integral of {'1/R' if power < 0 else 'R'} over the points that contains accepts",
                advice="look for a factor, a shifted centre, or half edges taken for edges",
            )


def flux_volume(shape: Any) -> float:
    """Volume [m^3] that the potentials stand for: the flux of grad Phi through a ball around the shape over -4 pi."""
    box = region(shape)
    cosines, gauss = np.polynomial.legendre.leggauss(24)
    angles = 2 * np.pi * np.arange(48) / 48
    sine = np.sqrt(1 - cosines**2)[:, None]
    rays = np.stack([sine * np.cos(angles), sine * np.sin(angles), cosines[:, None] + 0 * angles], axis=-1)
    radius = 2 * box.radius
    slopes = potential(shape, "phi", of_total(1), box.center + radius * rays)
    flux = np.sum(slopes * np.moveaxis(rays, -1, 0), axis=0)
    return float(-(radius**2) * np.sum(gauss @ flux) * 2 * np.pi / 48 / (4 * np.pi))


@check
def check_volume(shape: Any) -> None:
    """The volume seen by the potentials (the flux of grad Phi) is the volume that contains fills."""
    coarse, fine = quadrature_rules(shape)
    doubt = abs(coarse.volume / fine.volume - 1)
    volume = flux_volume(shape)
    ensure(
        abs(volume / fine.volume - 1) < 4 * doubt + _MISSED,
        "the volume in the potentials",
        f"that of contains, {fine.volume:.8g} m^3 within {4 * doubt + _MISSED:.0e}",
        f"{volume:.8g} m^3",
        "the factor in front of Phi is wrong, or contains describes another size",
    )


@check
def check_decay(shape: Any) -> None:
    """Far away all orders fall with their power of the distance and are those of a point of the same volume."""
    box = region(shape)
    _, fine = quadrature_rules(shape)
    rays = directions(6)
    volume = flux_volume(shape)
    for which, power, totals in _POTENTIALS:
        for total in totals:
            orders = of_total(total)
            near, far = (
                potential(shape, which, orders, fine.centroid + factor * box.radius * rays) for factor in (50, 100)
            )
            expected = power - total
            sizes = [np.sqrt(np.sum(tensor**2)) for tensor in (near, far)]
            with np.errstate(divide="ignore", invalid="ignore"):
                rate = float(np.log2(np.divide(sizes[1], sizes[0])))
            ensure(
                abs(rate - expected) < 0.05,
                f"the power of the distance with which {which} of order {total} falls",
                f"{expected} within 0.05",
                f"{rate:.3f}",
                "a term that should cancel far away does not; offer far_field if the closed form loses its digits",
            )
            point = volume * point_derivatives(power, orders, (100 * box.radius * rays).T)
            agree(
                [name(which, order) for order in orders],
                far,
                point,
                scale=np.max(np.abs(point)),
                tolerance=0.02,
                points=fine.centroid + 100 * box.radius * rays,
                rule=f"near that of a point of {volume:.6g} m^3",
                advice="compare the factor of this order with that of the others",
            )


def _from_sources(sources: PointSources, which: str, orders: list[Order], places: FloatArray) -> FloatArray:
    offset = (places[:, None, :] - sources.positions).transpose(2, 0, 1)
    if which == "phi":
        return np.asarray(point_derivatives(-1, orders, offset) @ sources.volumes)
    spread = point_derivatives(-1, orders, offset) @ (sources.volumes * sources.spreads)
    return np.asarray(point_derivatives(1, orders, offset) @ sources.volumes + spread)


@check
def check_far_field(shape: Any) -> None:
    """Point sources, coarser ones too, lie in the body, hold the volume, and give all orders beyond (to 1e-8)."""
    for sources in shape.far_field().levels:
        _check_sources(shape, sources)


def _check_sources(shape: Any, sources: PointSources) -> None:
    shapes = {
        "center": (np.shape(sources.center), (3,)),
        "positions": (np.shape(sources.positions), (np.size(sources.volumes), 3)),
        "spreads": (np.shape(sources.spreads), np.shape(sources.volumes)),
    }
    for field, (got, expected) in shapes.items():
        ensure(got == expected, f"far_field().{field}", f"of shape {expected}", got, "see PointSources")
    ensure(
        np.all(sources.positions[:, 2] >= 0),
        "positions of far_field",
        "in the body, z >= 0",
        f"z = {np.min(sources.positions[:, 2]):.6g}",
        "use points inside the shape",
    )
    volume = flux_volume(shape)
    ensure(
        abs(np.sum(sources.volumes) / volume - 1) < 1e-9,
        "the sum of volumes of far_field",
        f"the volume, {volume:.12g} m^3",
        f"{np.sum(sources.volumes):.12g} m^3",
        "weights must add up to the volume",
    )
    rays = directions(6)
    for factor in (1.02, 1.5):
        places = sources.center + factor * sources.distance * rays
        for which, _, totals in _POTENTIALS:
            for total in totals:
                orders = of_total(total)
                agree(
                    [f"{name(which, order)} of far_field" for order in orders],
                    _from_sources(sources, which, orders, places),
                    potential(shape, which, orders, places),
                    scale=natural_scale(shape, which, total, places),
                    tolerance=1e-8,
                    points=places,
                    rule="that of the shape",
                    advice="enlarge its distance or use more points",
                )


@check
def check_chi(shape: Any) -> None:
    """Chi,ab is the integral from Z on of (t - Z) Phi,ab at (x, y, -t); so are its further derivatives (to 1e-9).

    The allowed error grows by four times the difference of two rules; beyond its distance `far_field` gives Phi.
    """
    box = region(shape)
    within, without = sample(shape)
    places = np.concatenate([within.places, without.places])[::2]
    places[:, 2] = np.linspace(0.05, 1.5, len(places)) * box.size
    for total in (3, 4):
        orders = mirror_orders(total)
        coarse, expected = (_chi_integrals(shape, orders, places, count) for count in (150, 220))
        scale = np.max(np.abs(expected), axis=0)
        agree(
            [name("chi", order) for order in orders],
            potential(shape, "chi", orders, places),
            expected,
            scale=scale,
            tolerance=1e-9 + 4 * np.max(np.abs(expected - coarse), axis=0) / scale,
            points=places,
            rule="its integral of Phi of the image",
            advice="chi sees the mirror image, its distance along z is z + z'; or leave chi out: it is then integrated",
        )


def _chi_integrals(shape: Any, orders: list[Order], places: FloatArray, count: int) -> FloatArray:
    """Orders of chi as integrals of Phi along the depth."""
    reach, weights, points = depth_rule(region(shape).size, places, count)
    line = points.reshape(-1, 3)
    sources = shape.far_field() if isinstance(shape, HasFarField) else None
    away = np.zeros(len(line), bool)
    if sources is not None:
        away = np.linalg.norm(line - sources.center, axis=1) > 1.02 * sources.distance
    flat = [(i, j, 0) for i, j, _ in orders]
    phi = np.empty((len(orders), len(line)))
    phi[:, ~away] = potential(shape, "phi", flat, line[~away])
    if sources is not None:
        phi[:, away] = _from_sources(sources, "phi", flat, line[away])
    factors = np.array([-weights if k else weights * reach for _, _, k in orders])
    return np.asarray(np.einsum("onc,oc->on", phi.reshape(len(orders), len(places), count), factors))

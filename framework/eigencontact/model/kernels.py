"""Influence coefficients for the solvers, from the influence plugins and the two bodies."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.array_types import FloatArray
from eigencontact.core.material import Material
from eigencontact.core.symmetry import parity
from eigencontact.core.tensors import COMPONENTS
from eigencontact.core.tractions import TRACTIONS, side
from eigencontact.errors import PlanError
from eigencontact.plugin import HasWavenumberResponse, LayeredMedium, SurfaceInfluence

__all__ = ["KernelUse", "PairCoefficients", "Solid", "Solids", "StressCoefficients"]

#: Half widths of a strip to the depth at which its displacement is zero, where none is named.
_DEEP = 1e4

#: What a body that is not rigid is made of. A layered one goes with the influence that knows layers
#: (`eigencontact.model.bodies.influence_for`), which takes it where others take a Material.
Solid = Material | LayeredMedium
Solids = tuple[Solid | None, Solid | None]


@dataclass(frozen=True, slots=True)
class KernelUse:
    """One influence coefficient that a plan needs, for `explain` and for the cost."""

    response: str
    traction: str
    influence: str
    layout: str
    count: int = 1

    def __str__(self) -> str:
        times = f" x {self.count}" if self.count > 1 else ""
        return f"{self.response} <- {self.traction} (plugin {self.influence!r}), {self.layout}{times}"


def _sampled(
    influence: SurfaceInfluence,
    quantity: str,
    components: list[str],
    place: tuple[FloatArray, FloatArray, float],
    half_widths: tuple[float, float],
    body: Any,
    datum: float | None,
    period: float | None,
) -> FloatArray:
    """Influence coefficients of a rectangle, or of one that repeats along y with a `period`.

    The displacement of a strip, and so the mean of one that repeats, is that against the point at the depth `datum`
    below the strip.
    """
    if period is not None:
        from eigencontact.halfspace.images import repeated  # late: few contacts repeat along y alone

        x, y, z = place
        strip = (x, np.zeros(1), z), (half_widths[0], np.inf)
        mean = _sampled(influence, quantity, components, *strip, body, datum, None)
        evaluate = influence.displacement if quantity == "displacement" else influence.stress

        def field(y: FloatArray, b: float) -> FloatArray:
            if b == half_widths[1]:
                return influence.sample(quantity, components, x, y, z, half_widths, body)
            return evaluate(components, x[None, :], y[:, None], z, (half_widths[0], b), body)

        return repeated(field, y, half_widths[1], period, mean)
    values = influence.sample(quantity, components, *place, half_widths, body)
    shift = _of_datum(influence, quantity, components, half_widths, body, datum)
    return values if shift is None else values - shift


def _of_datum(
    influence: SurfaceInfluence,
    quantity: str,
    components: list[str],
    half_widths: tuple[float, float],
    body: Any,
    datum: float | None,
) -> FloatArray | None:
    """Displacement ``(n, 1, 1)`` of the point at the depth `datum` below the middle of a strip; else None."""
    if quantity != "displacement" or half_widths[1] < np.inf:
        return None
    middle, depth = np.zeros(1), _DEEP * half_widths[0] if datum is None else datum
    return influence.sample(quantity, components, middle, middle, depth, half_widths, body)


@dataclass(frozen=True, slots=True)
class PairCoefficients:
    """Relative surface displacement of two bodies under one traction component.

    Normal response to normal traction (and tangential to tangential) adds up over the bodies; the cross terms of
    body 2 count negative (thesis eqs 2.63, 2.64). A rigid body is None and costs nothing; like bodies are
    evaluated once.

    Attributes
    ----------
    datum : float or None
        Depth of the points against which the surfaces of a line contact move [m]; by default one that follows the
        cells.
    period : float or None
        Period along y with which the traction repeats [m]; None where it does not.
    """

    influence: SurfaceInfluence
    bodies: Solids
    component: str
    datum: float | None = None
    period: float | None = None

    @property
    def parity(self) -> tuple[int, int]:
        """Parity (in y, in x)."""
        return parity(self.component, TRACTIONS[self.influence.traction].direction)

    def _weights(self) -> dict[Any, float]:
        weights: dict[Solid, float] = {}
        for number, body in enumerate(self.bodies, 1):
            if body is not None:
                sign = side(number, self.component) * side(number, TRACTIONS[self.influence.traction].direction)
                weights[body] = weights.get(body, 0.0) + sign
        return weights

    def table(self, x: FloatArray, y: FloatArray, half_widths: tuple[float, float]) -> FloatArray:
        """Response at offsets x, y [m] of a rectangle under unit traction, ``(ny, nx)`` [m/Pa]."""
        total: FloatArray | None = None
        for body, weight in self._weights().items():
            at = (x, y, 0.0)
            names = [self.component]
            values = _sampled(
                self.influence, "displacement", names, at, half_widths, body, self.datum, self.period
            )[0]  # fmt: skip
            values = weight * values if weight != 1.0 else values
            total = values if total is None else total + values
        assert total is not None
        return total

    def response(self, kx: FloatArray, ky: FloatArray) -> NDArray[np.complex128]:
        """Amplitude of the response to a unit traction wave [m/Pa]."""
        influence = _with_waves(self.influence)
        total = sum(
            weight * influence.wavenumber_response("displacement", [self.component], kx, ky, 0.0, body)[0]
            for body, weight in self._weights().items()
        )
        return np.asarray(total, dtype=complex)


@dataclass(frozen=True, slots=True)
class StressCoefficients:
    """Mandel stress in one body under one traction component, or its displacement.

    Attributes
    ----------
    quantity : "stress" or "displacement"
        Values are per unit traction, [-] or [m/Pa].
    datum, period : float or None
        As of `PairCoefficients`.
    """

    influence: SurfaceInfluence
    body: Any
    quantity: str = "stress"
    datum: float | None = None
    period: float | None = None

    @property
    def components(self) -> tuple[str, ...]:
        """Components of the quantity, in their order."""
        return COMPONENTS if self.quantity == "stress" else ("x", "y", "z")

    def parity(self, component: str) -> tuple[int, int]:
        """Parity (in y, in x) of one component."""
        return parity(component, TRACTIONS[self.influence.traction].direction)

    def table(
        self, components: list[str], x: FloatArray, y: FloatArray, z: float, half_widths: tuple[float, float]
    ) -> FloatArray:
        """Values at offsets x, y and depth z [m] of a rectangle under unit traction, ``(n, ny, nx)``."""
        place = (x, y, z)
        return _sampled(
            self.influence, self.quantity, components, place, half_widths, self.body, self.datum, self.period
        )  # fmt: skip

    def at_depths(
        self, components: list[str], depths: FloatArray, half_widths: tuple[float, float], reach: float
    ) -> Callable[[int, FloatArray, FloatArray], FloatArray]:
        """Tables at several depths with shared work in a layered body; see `HasDepths`."""
        if isinstance(self.body, Material):
            return lambda number, x, y: self.table(components, x, y, float(depths[number]), half_widths)
        layered: Any = self.influence  # the influence that knows layers goes with such a body
        table: Callable[[int, FloatArray, FloatArray], FloatArray]
        table = layered.at_depths(self.quantity, components, depths, half_widths, reach, self.body).on_lattice
        shift = _of_datum(self.influence, self.quantity, components, half_widths, self.body, self.datum)
        return table if shift is None else lambda number, x, y: table(number, x, y) - shift

    def sums_at(
        self,
        components: list[str],
        depths: FloatArray,
        half_widths: tuple[float, float],
        reach: float,
        load: FloatArray,
    ) -> Callable[[int, FloatArray, FloatArray], FloatArray] | None:
        """Sums of a load at several depths without tables, in a layered body; see `HasSums`."""
        if isinstance(self.body, Material) or (self.quantity == "displacement" and half_widths[1] == np.inf):
            return None
        layered: Any = self.influence
        sums: Callable[[int, FloatArray, FloatArray], FloatArray]
        sums = layered.at_depths(self.quantity, components, depths, half_widths, reach, self.body).superposing(load)
        return sums

    def response(self, components: list[str], kx: FloatArray, ky: FloatArray, z: float) -> NDArray[np.complex128]:
        """Amplitudes for a unit traction wave at depth z, ``(n, nky, nkx)``."""
        return _with_waves(self.influence).wavenumber_response(self.quantity, components, kx, ky, z, self.body)

    def responses(
        self, components: list[str], kx: FloatArray, ky: FloatArray, depths: FloatArray
    ) -> Iterable[NDArray[np.complex128]]:
        """Amplitudes for a unit traction wave at several depths, ``(n, nky, nkx)`` each."""
        if isinstance(self.body, Material):
            return (self.response(components, kx, ky, float(z)) for z in depths)
        layered: Any = self.influence
        values = layered.wavenumber_responses(self.quantity, components, kx, ky, depths, self.body)
        return np.asarray(np.moveaxis(values, 1, 0))


def _with_waves(influence: SurfaceInfluence) -> HasWavenumberResponse:
    if not isinstance(influence, HasWavenumberResponse):
        raise PlanError(
            f"numerics.boundary must be 'non-periodic' with surface influence {influence.key!r} (got 'periodic'); "
            "it offers no wavenumber_response"
        )
    return influence

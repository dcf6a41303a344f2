"""Sums over layers of eigenstrain for a batch of plane waves, and the fields from these sums.

A field at a depth needs four sums: of e^-t and t e^-t, t = k |z - z'|, over the layers above and over those below. They
are updated from interface to interface and never grow. In axes along and across a wave, and in lengths of 1/k, the
coefficients are equal for all waves: the linear forms of the half-space theorem at the wave vector (1, 0).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from eigencontact.core.array_types import ComplexArray, FloatArray
from eigencontact.halfspace.forms import Kernel
from eigencontact.halfspace.theorem import response

__all__ = ["ALONG_WAVE", "Coefficients", "LayerSums", "Plane", "coefficients", "plane_at"]

#: Whether an odd number of indices of a component lies along the wave: such components are stored times 1j, so that all
#: numbers are real.
ALONG_WAVE = {"displacement": (1, 0, 0), "strain": (0, 0, 0, 0, 1, 1), "stress": (0, 0, 0, 0, 1, 1)}


@dataclass(frozen=True, slots=True)
class Plane:
    """Position of a depth among the interfaces.

    ``above`` is the last interface at or above it, ``below`` the first at or below it, with the distances; None without
    such an interface. ``inside`` are the layers at this depth and their weights.
    """

    depth: float
    above: tuple[int, float] | None
    below: tuple[int, float] | None
    inside: tuple[tuple[int, float], ...]


def plane_at(interfaces: FloatArray, depth: float) -> Plane:
    """Index of a depth [m] among ascending interfaces [m]; a plane in the surface belongs to the layer below."""
    layers = interfaces.size - 1
    last = int(np.searchsorted(interfaces, depth, side="right")) - 1
    first = int(np.searchsorted(interfaces, depth, side="left"))
    surface = depth == 0.0
    inside: dict[int, float] = {}
    for layer in [last] if surface else [last, first - 1]:
        if 0 <= layer < layers:
            inside[layer] = inside.get(layer, 0.0) + (1.0 if surface else 0.5)
    return Plane(
        depth,
        (last, depth - float(interfaces[last])) if last >= 0 else None,
        (first, float(interfaces[first]) - depth) if first <= layers else None,
        tuple(inside.items()),
    )


@dataclass(frozen=True, slots=True)
class Coefficients:
    """Real matrices from the sums over layers to the field, in axes along and across a wave, lengths in 1/k."""

    above: FloatArray
    below: FloatArray
    local: FloatArray
    image: tuple[FloatArray, ...]


@cache
def coefficients(quantity: str, nu: float) -> Coefficients:
    """Forms of the half-space theorem at the wave vector (1, 0)."""
    forms = response(quantity, nu, "half")
    rows = len(forms)
    above, below, local = np.zeros((rows, 12)), np.zeros((rows, 12)), np.zeros((rows, 6))
    image = [np.zeros((rows, 12)) for _ in range(4)]
    for row, by_source in enumerate(forms):
        for source, form in enumerate(by_source):
            turn = ALONG_WAVE[quantity][row] - ALONG_WAVE["strain"][source]
            for power, kernel, value in form:
                if kernel[2][1]:
                    continue  # a derivative across the wave
                value *= (1j ** (kernel[2][0] + turn)).real  # noqa: PLW2901
                if kernel[0] == "image":
                    zeroth, first = _decay(kernel, upward=False)
                    image[power][row, source] += value * zeroth
                    image[power][row, source + 6] += value * first
                    image[power + 1][row, source] += value * first
                    continue
                local[row, source] += value * _local(kernel)
                for matrix, upward in ((above, False), (below, True)):
                    zeroth, first = _decay(kernel, upward=upward)
                    matrix[row, source] += value * zeroth
                    matrix[row, source + 6] += value * first
    return Coefficients(above, below, local, tuple(matrix for matrix in image if matrix.any()))


def _decay(kernel: Kernel, *, upward: bool) -> tuple[float, float]:
    """Factors of e^-t and t e^-t in a derivative of a potential of a layer at distance t, for k = 1."""
    _, name, (_, _, n) = kernel
    sign = 1.0 if upward else (-1.0) ** n
    if name == "psi":
        return -2.0 * np.pi * sign * (1 - n), -2.0 * np.pi * sign
    return (2.0 * np.pi * sign, 0.0) if name else (0.0, 0.0)


def _local(kernel: Kernel) -> float:
    """Factor of the eigenstrain at the point: Psi,zzzz and Phi,zz of a layer contain a delta function."""
    _, name, order = kernel
    return {("psi", 4): -8.0 * np.pi, ("phi", 2): -4.0 * np.pi, ("", 0): 1.0}.get((name, order[2]), 0.0)


class LayerSums:
    """Sums over the layers for one batch of waves."""

    def __init__(
        self, interfaces: FloatArray, k: FloatArray, source: ComplexArray, planes: list[Plane], weights: Coefficients
    ) -> None:
        self._interfaces, self._k, self._source, self._planes, self._weights = interfaces, k, source, planes, weights
        self._out = np.zeros((len(weights.local), len(planes), k.size), dtype=complex)

    def field(self) -> ComplexArray:
        """Amplitudes ``(3 or 6, nd, waves)``."""
        count = self._source.shape[1]
        sums = np.zeros((2, 6, self._k.size), dtype=complex)
        for node in range(count, -1, -1):  # from below
            for number, plane in enumerate(self._planes):
                if plane.below is not None and plane.below[0] == node:
                    self._add(number, self._weights.below, self._stepped(sums, plane.below[1], node - 1))
            if node:
                sums = self._stepped(sums, float(self._interfaces[node] - self._interfaces[node - 1]), node - 1)
        self._image(self._stepped(sums, float(self._interfaces[0]), -1))
        sums = np.zeros_like(sums)
        for node in range(count + 1):  # from above
            for number, plane in enumerate(self._planes):
                if plane.above is not None and plane.above[0] == node:
                    self._add(number, self._weights.above, self._stepped(sums, plane.above[1], node))
            if node < count:
                sums = self._stepped(sums, float(self._interfaces[node + 1] - self._interfaces[node]), node)
        for number, plane in enumerate(self._planes):
            for layer, share in plane.inside:
                self._out[:, number] += _product(share * self._weights.local, self._source[:, layer])
        return self._out

    def _add(self, number: int, matrix: FloatArray, sums: ComplexArray) -> None:
        self._out[:, number] += _product(matrix, sums.reshape(12, -1))

    def _stepped(self, sums: ComplexArray, distance: float, layer: int) -> ComplexArray:
        """Sums of k e^-t and k t e^-t (times dz) after a further distance, across one layer or (-1, nz) across none."""
        if distance == 0.0:
            return sums
        path = self._k * distance
        decay = np.exp(-path)
        out = np.empty_like(sums)
        np.multiply(sums[0], path, out=out[1])
        out[1] += sums[1]
        out[1] *= decay
        np.multiply(sums[0], decay, out=out[0])
        if 0 <= layer < self._source.shape[1]:
            zeroth = -np.expm1(-path)
            out[0] += zeroth * self._source[:, layer]
            out[1] += (zeroth - path * decay) * self._source[:, layer]
        return out

    def _image(self, sums: ComplexArray) -> None:
        """Field of the image from the sums at the surface: a polynomial in k z times e^-kz."""
        powers = [_product(matrix, sums.reshape(12, -1)) for matrix in self._weights.image]
        for number, plane in enumerate(self._planes):
            path = self._k * plane.depth
            total = powers[-1]
            for term in powers[-2::-1]:
                total = total * path + term
            self._out[:, number] += np.exp(-path) * total


def _product(matrix: FloatArray, values: ComplexArray) -> ComplexArray:
    """Real matrix times complex columns."""
    columns = np.ascontiguousarray(values)
    product: FloatArray = matrix @ columns.view(float)
    return product.view(complex)
